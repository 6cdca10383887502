"""Makes the Gmsh meshes of docs/results/solvers.md, binary MSH 4.1, in a folder.

    pip install gmsh
    python3 benches/gmsh/make_meshes.py target/gmsh          # square.msh, cube.msh
    python3 benches/gmsh/make_meshes.py target/gmsh 0.1      # with this element size

Numbers of cells depend on the version of Gmsh by a few parts in ten thousand.
"""

import pathlib
import sys

import gmsh

folder = pathlib.Path(sys.argv[1])
folder.mkdir(parents=True, exist_ok=True)
for dimension, name in [(2, "square"), (3, "cube")]:
    size = ["-setnumber", "size", sys.argv[2]] if len(sys.argv) > 2 else []
    gmsh.initialize(["gmsh", *size])
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.option.setNumber("Mesh.Binary", 1)
    gmsh.open(str(pathlib.Path(__file__).parent / f"{name}.geo"))
    gmsh.model.mesh.generate(dimension)
    _, elements, _ = gmsh.model.mesh.getElements(dimension)
    gmsh.write(str(folder / f"{name}.msh"))
    print(f"{name}.msh: {sum(map(len, elements))} cells")
    gmsh.finalize()
