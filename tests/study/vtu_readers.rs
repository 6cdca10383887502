//! Files of fields as other programs read them: meshio and VTK, the library of ParaView.

use std::path::Path;
use std::process::Command;

use unilateral::prelude::*;
use unilateral::problem_file;
use unilateral::scenes::AnyScene;
use unilateral::scenes::Scene;

use crate::support::scratch::Scratch;

/// Reads the files named, each followed by the total contact force, or by nan where there is no contact boundary.
/// Both readers find the same points, cells and arrays, and no cell is inside out.
const SCRIPT: &str = "
import sys, meshio, vtk, numpy as np
from vtk.util.numpy_support import vtk_to_numpy as array

def same(a, b):
    assert a.dtype == b.dtype and np.array_equal(a, b, equal_nan=True), (a, b)

for path, force in zip(sys.argv[1::2], map(float, sys.argv[2::2])):
    reader = vtk.vtkXMLUnstructuredGridReader()
    reader.SetFileName(path)
    reader.Update()
    grid, mesh = reader.GetOutput(), meshio.read(path)
    points = array(grid.GetPoints().GetData())
    assert points.dtype == np.float64 and len(points) > 0
    same(points, mesh.points)
    corners = np.concatenate([block.data.ravel() for block in mesh.cells])
    same(array(grid.GetCells().GetConnectivityArray()), corners)
    data, values = grid.GetCellData(), {}
    for k in range(data.GetNumberOfArrays()):
        name = data.GetArrayName(k)
        values[name] = array(data.GetArray(k))
        same(values[name], np.concatenate(mesh.cell_data[name]))
    assert values.keys() == mesh.cell_data.keys(), values.keys()
    data = grid.GetPointData()
    names = {data.GetArrayName(k) for k in range(data.GetNumberOfArrays())}
    assert names == mesh.point_data.keys() and 'u' in names, names
    for name in names:
        same(array(data.GetArray(name)), mesh.point_data[name])
    assert array(grid.GetFieldData().GetArray('level'))[0] == mesh.field_data['level'][0]
    sizes = vtk.vtkCellSizeFilter()
    sizes.SetInputData(grid)
    sizes.Update()
    dimension = values['dimension'].max()
    size = {d: array(sizes.GetOutput().GetCellData().GetArray(name))
            for d, name in enumerate(['VertexCount', 'Length', 'Area', 'Volume'])}
    is_cell = values['dimension'] == dimension
    assert (size[dimension][is_cell] > 0).all()
    groups = [name for name in values if values[name].dtype == np.uint8 and name != 'dimension']
    inside = sum(values[name].astype(int) for name in groups)
    assert len(groups) > 1 and (inside[~is_cell] > 0).all(), groups
    if not np.isnan(force):
        total = np.nansum(values['pressure'] * size[dimension - 1])
        assert abs(total - force) < 1e-10 * force, (total, force)
    print(path, len(points), len(is_cell), ', '.join(groups))
";

/// Writes the fields of a solution, as arguments of the script.
fn put<const D: usize>(
    arguments: &mut Vec<String>,
    folder: &Path,
    (name, problem): (&str, &Problem<D>),
    meshes: &Hierarchy<D>,
) {
    for scheme in ["p1", "cr", "sipg", "wopsip", "p2", "sipg-p2"] {
        let solved =
            solve(problem, meshes, &*scheme.parse::<NamedScheme>().unwrap().make()).unwrap();
        assert!(solved.converged(), "{name} {scheme}: {}", solved.outcome());
        let force = match problem.gap.is_given() {
            true => solved.multiplier().unwrap().iter().sum(),
            false => f64::NAN,
        };
        let path = folder.join(format!("{name}-{scheme}.vtu"));
        solved.write_vtu_with(&path, |file| file.number("level", 1.0)).unwrap();
        arguments.extend([path.display().to_string(), format!("{force:?}")]);
    }
}

fn put_scene<const D: usize>(
    arguments: &mut Vec<String>,
    folder: &Path,
    scene: &Scene<D>,
    level: usize,
) {
    let meshes = Hierarchy::<D>::of_domain(&scene.domain, level).unwrap();
    put(arguments, folder, (&scene.name, &scene.problem), &meshes);
}

fn put_file(arguments: &mut Vec<String>, folder: &Path, path: &str) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(path);
    let AnyScene::Two(own) = problem_file::read(&path).unwrap().scene else { panic!("plane") };
    let mesh = own.domain.mesh(0).unwrap();
    let meshes = Hierarchy::refine(&mesh, 1).unwrap();
    put(arguments, folder, (&own.name, &own.problem), &meshes);
}

/// `python3 -m pip install meshio vtk`, or another Python by `UNILATERAL_PYTHON=/path/to/python`.
#[test]
#[ignore = "needs meshio and vtk"]
fn needs_meshio_and_vtk_to_read_files() {
    let scratch = Scratch::new("vtu-readers");
    let (folder, mut arguments) = (&scratch.0, Vec::new());
    let to = &mut arguments;
    put_scene::<1>(to, folder, &scenes::signorini_closed_1d(), 8);
    put_scene::<2>(to, folder, &scenes::signorini_2d(), 8);
    put_scene::<2>(to, folder, &scenes::radial(1.0), 8);
    put_scene::<3>(to, folder, &scenes::radial(1.0), 2);
    put_scene::<3>(to, folder, &scenes::signorini_harmonic(), 2);
    put_file(to, folder, "examples/problems/plate.toml");
    put_file(to, folder, "tests/data/problems/utm.toml");
    let python = std::env::var("UNILATERAL_PYTHON").unwrap_or_else(|_| "python3".to_owned());
    let output = Command::new(python).args(["-c", SCRIPT]).args(&arguments).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let read = String::from_utf8(output.stdout).unwrap();
    assert_eq!(read.lines().count(), arguments.len() / 2);
    println!("{read}");
}
