"""Makes the unstructured meshes of this folder on domains of scenes: unstructured_*.msh.

pip install gmsh==4.15.2; python3 tests/data/unstructured.py
"""

import pathlib

import gmsh

HERE = pathlib.Path(__file__).parent


def mesh(name, lower, upper, size, contact, dimension):
    """Meshes a box; the side where the last coordinate is least is in contact if `contact` says so."""
    gmsh.initialize()
    gmsh.option.setNumber("General.Verbosity", 1)
    gmsh.option.setNumber("Mesh.MeshSizeMin", size)
    gmsh.option.setNumber("Mesh.MeshSizeMax", size)
    gmsh.option.setNumber("Mesh.RandomSeed", 1)
    gmsh.option.setNumber("Mesh.SaveAll", 0)
    sides = [b - a for a, b in zip(lower, upper)]
    if dimension == 2:
        gmsh.model.occ.addRectangle(*lower, 0, *sides)
    else:
        gmsh.model.occ.addBox(*lower, *sides)
    gmsh.model.occ.synchronize()
    facets = [tag for _, tag in gmsh.model.getEntities(dimension - 1)]

    def in_contact(facet):
        centre = gmsh.model.occ.getCenterOfMass(dimension - 1, facet)
        return contact and abs(centre[dimension - 1] - lower[-1]) < 1e-6

    groups = {"contact": [f for f in facets if in_contact(f)]}
    groups["dirichlet"] = [f for f in facets if f not in groups["contact"]]
    for group, members in groups.items():
        if members:
            gmsh.model.addPhysicalGroup(dimension - 1, members, name=group)
    cells = [tag for _, tag in gmsh.model.getEntities(dimension)]
    gmsh.model.addPhysicalGroup(dimension, cells, name="domain")
    gmsh.model.mesh.generate(dimension)
    gmsh.write(str(HERE / f"{name}.msh"))
    gmsh.finalize()


mesh("unstructured_square", (-1.5, -1.5), (1.5, 1.5), 0.25, False, 2)
mesh("unstructured_half_square", (-1, 0), (1, 1), 0.16, True, 2)
mesh("unstructured_cube", (-1.5, -1.5, -1.5), (1.5, 1.5, 1.5), 0.75, False, 3)
mesh("unstructured_half_cube", (-1, -1, 0), (1, 1, 1), 0.4, True, 3)
