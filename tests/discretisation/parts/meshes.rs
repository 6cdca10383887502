//! Meshes and their parts.

use crate::support::meshes::{Random, Raw, mixed_box};
use std::path::Path;
use unilateral::error_bound::NoBound;
use unilateral::mesh::{BisectedMesh, Extent, Facets, Layers, Neighbour, Neighbours, gmsh};
use unilateral::prelude::*;

/// The unit box with all parts of the boundary.
pub fn box_mesh<const D: usize>(n: usize) -> Mesh<D> {
    Mesh::kuhn_box(&mixed_box(), [n; D]).unwrap()
}

/// That box with its inner vertices moved, and any order of vertices and cells.
pub fn moved<const D: usize>(n: usize) -> Mesh<D> {
    let mut random = Random(7);
    Raw::jittered(&mixed_box::<D>(), n, 0.3, &mut random).shuffled(&mut random).mesh()
}

/// That box refined towards a corner.
pub fn bisected<const D: usize>(n: usize) -> Mesh<D> {
    let mut refined = BisectedMesh::new(box_mesh::<D>(n));
    for _ in 0..4 {
        let mesh = refined.mesh();
        let marked: Vec<usize> = (0..mesh.n_cells()).filter(|&c| mesh.cell(c)[0] == 0).collect();
        refined = refined.bisect(&marked).unwrap().0;
    }
    refined.into_mesh()
}

/// Every mesh file of this dimension with more than one cell.
pub fn files<const D: usize>(work: &mut dyn FnMut(&Mesh<D>)) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data");
    let mut paths: Vec<_> = folder.read_dir().unwrap().map(|entry| entry.unwrap().path()).collect();
    paths.sort();
    paths.retain(|path| path.extension().is_some_and(|extension| extension == "msh"));
    let mut n = 0;
    for path in paths {
        let file = gmsh::GmshFile::read(&path).unwrap();
        if file.dimension() == D {
            let mesh = file.mesh::<D>().unwrap().mesh;
            if mesh.n_cells() > 2 {
                work(&mesh);
                n += 1;
            }
        }
    }
    assert!(n > 0);
}

/// Half-facets of a mesh beyond which a part of it ends.
fn cut<const D: usize>(mesh: &Mesh<D>) -> Vec<(usize, usize)> {
    let neighbours = Neighbours::new(mesh);
    let all = (0..mesh.n_cells()).flat_map(|cell| (0..=D).map(move |local| (cell, local)));
    all.filter(|&(cell, local)| neighbours.across(cell, local) == Neighbour::Cut).collect()
}

/// Cells and vertices keep their order, boundary facets and regions their names; a facet is cut if its other
/// cell is not there; every cell is owned once.
#[test]
fn a_part_is_a_mesh_of_cells_of_the_whole() {
    fn on<const D: usize>(mesh: &Mesh<D>, parts: usize) {
        let owners = mesh.partition(parts).unwrap();
        let neighbours = Neighbours::new(mesh);
        let mut owned = vec![0; mesh.n_cells()];
        for number in 0..parts as u32 {
            for layers in
                [Layers::across_facets(0), Layers::across_facets(2), Layers::across_vertices(1)]
            {
                let part = mesh.part(&owners, number, layers).unwrap();
                let inside = &part.mesh;
                assert!(part.cells.is_sorted());
                let mut vertices = vec![None; inside.vertices().len()];
                assert!(inside.is_part() && !mesh.is_part());
                assert_eq!(inside.boundary_groups(), mesh.boundary_groups());
                assert_eq!(inside.domain_diameter().to_bits(), mesh.domain_diameter().to_bits());
                assert_eq!(inside.mesh_size().to_bits(), mesh.mesh_size().to_bits());
                let within = Neighbours::new(inside);
                for (cell, &whole) in part.cells.iter().enumerate() {
                    let whole = whole as usize;
                    assert_eq!(part.owners[cell], owners[whole]);
                    assert_eq!(inside.region(cell), mesh.region(whole));
                    for (&v, &of_whole) in inside.cell(cell).iter().zip(mesh.cell(whole)) {
                        assert_eq!(*vertices[v as usize].get_or_insert(of_whole), of_whole);
                    }
                    owned[whole] += usize::from(part.owns(cell) && layers.count == 0);
                    for local in 0..=D {
                        let group = inside.boundary_group(cell, local);
                        assert_eq!(group, mesh.boundary_group(whole, local));
                        let expected = match neighbours.across(whole, local) {
                            Neighbour::Cell { cell, local } => {
                                match part.cells.binary_search(&cell.into()) {
                                    Ok(cell) => Neighbour::Cell { cell: cell as u32, local },
                                    Err(_) => Neighbour::Cut,
                                }
                            }
                            on_boundary => on_boundary,
                        };
                        assert_eq!(within.across(cell, local), expected);
                    }
                }
                assert!(vertices.iter().all(Option::is_some) && vertices.is_sorted());
                assert_eq!(Facets::new(inside, &within).cut().len(), cut(inside).len());
            }
        }
        assert!(owned.iter().all(|&times| times == 1));
    }
    on(&box_mesh::<1>(7), 3);
    on(&moved::<2>(4), 4);
    on(&box_mesh::<3>(2), 5);
    files::<2>(&mut |mesh| on(mesh, 2));
}

/// Parts have equally many cells, up to one, and depend on the mesh alone.
#[test]
fn a_partition_is_balanced() {
    let mesh = moved::<2>(5);
    for parts in 1..=7 {
        let owners = mesh.partition(parts).unwrap();
        let sizes: Vec<usize> = (0..parts as u32)
            .map(|part| owners.iter().filter(|&&owner| owner == part).count())
            .collect();
        let [least, most] = [sizes.iter().min(), sizes.iter().max()].map(Option::unwrap);
        assert!(most - least <= 1, "{sizes:?}");
        assert_eq!(owners, mesh.clone().partition(parts).unwrap());
    }
    assert!(mesh.partition(0).is_err() && mesh.partition(51).is_err());
    let layers = Layers::across_facets(1);
    assert!(mesh.part(&[0; 50], 1, layers).is_err() && mesh.part(&[0; 49], 0, layers).is_err());
}

/// The children of a part are the children that its cells have in the whole mesh, and the facets of cut
/// facets are cut, also where a mesh is bisected.
#[test]
fn refinement_inherits_cut_facets() {
    fn on<const D: usize>(mesh: &Mesh<D>) {
        let owners = mesh.partition(3).unwrap();
        let part = mesh.part(&owners, 1, Layers::across_vertices(1)).unwrap();
        let n_cut = cut(&part.mesh).len();
        assert!(n_cut > 0);
        let (fine, _) = mesh.refine().unwrap();
        let (refined, _) = part.mesh.refine().unwrap();
        assert_eq!(cut(&refined).len(), n_cut << (D - 1));
        for cell in 0..refined.n_cells() {
            let whole = ((part.cells[cell >> D] as usize) << D) + cell % (1 << D);
            let points = |mesh: &Mesh<D>, cell: usize| -> Vec<Point<D>> {
                mesh.cell(cell).iter().map(|&v| mesh.vertices()[v as usize]).collect()
            };
            assert_eq!(points(&refined, cell), points(&fine, whole));
        }
        // the mesh size of the whole is not known until the parts are merged
        assert_eq!(refined.domain_diameter(), fine.domain_diameter());
        assert!(refined.mesh_size().is_nan());
        let extents = (0..3).map(|number| {
            let part = mesh.part(&owners, number, Layers::across_facets(0)).unwrap();
            Extent::of(&part.mesh.refine().unwrap().0)
        });
        let merged = extents.reduce(Extent::merge).unwrap();
        assert_eq!(merged, Extent::of(&fine));
        assert_eq!(refined.with_extent(merged).mesh_size(), fine.mesh_size());

        let all: Vec<usize> = (0..part.mesh.n_cells()).collect();
        let bisected = BisectedMesh::new(part.mesh).bisect(&all).unwrap().0.into_mesh();
        assert!(bisected.is_part() && cut(&bisected).len() >= n_cut);
    }
    on(&moved::<1>(9));
    on(&moved::<2>(4));
    on(&moved::<3>(2));
}

/// An over-penalty with the mesh size in its weight is refused where that is not known.
#[test]
fn an_unknown_mesh_size_is_an_error() {
    let mesh = box_mesh::<2>(4);
    let part = mesh.part(&mesh.partition(2).unwrap(), 0, Layers::across_facets(1)).unwrap();
    let (refined, _) = part.mesh.refine().unwrap();
    let scheme = Wopsip { weight: WeightRule::Anisotropic, ..Wopsip::default() };
    let problem = Problem::new();
    let of = |mesh| Discretisation::new(&scheme, &problem, mesh, Default::default()).map(|_| ());
    assert!(of(&part.mesh).is_ok());
    assert!(matches!(of(&refined), Err(Error::Parameter(_))));
    assert!(of(&refined.clone().with_extent(Extent::of(&mesh.refine().unwrap().0))).is_ok());
}

/// Fluxes balance on the whole mesh only: a part has no bound.
#[test]
fn a_part_has_no_error_bound() {
    let mesh = box_mesh::<2>(4);
    let part = mesh.part(&mesh.partition(2).unwrap(), 0, Layers::across_vertices(1)).unwrap();
    let problem = Problem::new().constant_source(1.0);
    let on = |mesh| solve(&problem, mesh, &ConformingP1).unwrap().primal_dual_pair().map(|_| ());
    assert!(on(&mesh).is_ok());
    assert!(matches!(on(&part.mesh), Err(NoBound::Part)));
}
