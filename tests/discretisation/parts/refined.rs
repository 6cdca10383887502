//! Parts that are refined each by itself, against the refinement of the whole.

use super::compare::{Differences, differences_of};
use super::meshes::{box_mesh, files, moved};
use super::problems::{obstacle_problem, schemes, signorini_problem};
use crate::shapes;
use crate::support::schemes::Entry;
use unilateral::assemble::DataQuadrature;
use unilateral::mesh::{BoundaryCondition, Domain, Extent, Layers, MeshErrorKind, Part};
use unilateral::prelude::*;

/// A mesh and its parts.
struct Level<const D: usize> {
    mesh: Mesh<D>,
    owners: Vec<u32>,
    parts: Vec<Part<D>>,
}

impl<const D: usize> Level<D> {
    fn new(mesh: &Mesh<D>, parts: usize, layers: Layers) -> Self {
        let owners = mesh.partition(parts).unwrap();
        let part = |number| mesh.part(&owners, number, layers).unwrap();
        let parts = (0..parts as u32).map(part).collect();
        Self { mesh: mesh.clone(), owners, parts }
    }
    /// The refined mesh, and each part refined by itself; the extents of all merged.
    fn refine(&self, domain: Option<&Domain<D>>, layers: Layers) -> Self {
        let refine = |part: &Part<D>| match domain {
            Some(domain) => domain.refine_part(part, layers).unwrap().0,
            None => part.refine(layers).unwrap().0,
        };
        let parts: Vec<_> = self.parts.iter().map(refine).collect();
        let extents = parts.iter().map(|part| Extent::of(&part.mesh));
        let whole = extents.reduce(Extent::merge).unwrap();
        let mesh = match domain {
            Some(domain) => domain.refine(&self.mesh).unwrap().0,
            None => self.mesh.refine().unwrap().0,
        };
        let owners = self.owners.iter().flat_map(|&owner| std::iter::repeat_n(owner, 1 << D));
        let parts = parts.into_iter().map(|part| part.with_extent(whole)).collect();
        Self { mesh, owners: owners.collect(), parts }
    }
    /// Rows of own unknowns with other columns or bits than on the whole mesh.
    fn differences(&self, scheme: &dyn Scheme<D>, problem: &Problem<D>) -> Differences {
        differences_of(scheme, problem, &self.mesh, &self.owners, &self.parts)
    }
    #[track_caller]
    fn same_bits(&self, scheme: &dyn Scheme<D>, problem: &Problem<D>) {
        let quadrature = DataQuadrature::default();
        let discretisation = Discretisation::new(scheme, problem, &self.mesh, quadrature).unwrap();
        let expected = Differences::only_rows(discretisation.unknowns());
        let label = scheme.label_on(problem.constraint_set());
        assert_eq!(self.differences(scheme, problem), expected, "{label}");
    }
}

/// A part with coordinates as bits, so that all of it can be compared.
#[track_caller]
fn same_part<const D: usize>(one: &Part<D>, other: &Part<D>) {
    let bits = |part: &Part<D>| -> Vec<u64> {
        part.mesh.vertices().iter().flat_map(|x| x.iter().map(|c| c.to_bits())).collect()
    };
    assert_eq!((one.number, one.layers), (other.number, other.layers));
    assert_eq!((&one.owners, &one.cells), (&other.owners, &other.cells));
    assert_eq!(bits(one), bits(other));
    assert_eq!(one.mesh.cells(), other.mesh.cells());
    assert_eq!(one.mesh.boundary(), other.mesh.boundary());
    assert_eq!(Extent::of(&one.mesh), Extent::of(&other.mesh));
    assert_eq!(one.mesh.mesh_size().to_bits(), other.mesh.mesh_size().to_bits());
    assert_eq!(one.mesh.domain_diameter().to_bits(), other.mesh.domain_diameter().to_bits());
    for cell in 0..one.mesh.n_cells() {
        assert_eq!(one.mesh.region(cell), other.mesh.region(cell));
    }
}

/// A refined part is the part of the refined mesh, with as many layers as the children make, and is refused with
/// one more.
#[test]
fn a_refined_part_is_the_part_of_the_refined_mesh() {
    fn on<const D: usize>(mesh: &Mesh<D>, parts: usize, pairs: &[(Layers, Layers)]) {
        for &(coarse, fine) in pairs {
            let level = Level::new(mesh, parts, coarse);
            for count in 0..=fine.count {
                let fine = Layers { count, ..fine };
                let refined = level.refine(None, fine);
                for part in &refined.parts {
                    let of_whole = refined.mesh.part(&refined.owners, part.number, fine).unwrap();
                    same_part(part, &of_whole);
                }
            }
            let more = Layers { count: fine.count + 1, ..fine };
            let error = level.parts[0].refine(more).unwrap_err();
            assert_eq!(error.kind, MeshErrorKind::Parameter, "{error}");
        }
    }
    let [facets, vertices] = [Layers::across_facets, Layers::across_vertices];
    let line = [(facets(1), facets(2)), (vertices(2), facets(4)), (facets(1), vertices(2))];
    on(&moved::<1>(20), 3, &line);
    let pairs = [
        (facets(1), facets(1)),
        (facets(2), facets(2)),
        (facets(3), vertices(0)),
        (vertices(1), facets(2)),
    ];
    let plane = [&pairs[..], &[(vertices(1), vertices(2)), (vertices(2), vertices(4))]].concat();
    on(&moved::<2>(6), 4, &plane);
    files::<2>(&mut |mesh| on(mesh, 2, &plane));
    let space = [&pairs[..], &[(vertices(1), vertices(1)), (vertices(2), vertices(2))]].concat();
    on(&moved::<3>(3), 5, &space);
    files::<3>(&mut |mesh| on(mesh, 2, &space));
}

/// Vertices are midpoints of those of the coarse part that are their parents, or these.
#[test]
fn vertices_of_a_refined_part_have_their_parents_in_the_coarse_part() {
    fn on<const D: usize>(mesh: &Mesh<D>) {
        let layers = Layers::across_vertices(1);
        let part = mesh.part(&mesh.partition(3).unwrap(), 1, layers).unwrap();
        let (fine, refinement) = part.refine(layers).unwrap();
        let coarse = part.mesh.vertices();
        let mut n_new = 0;
        assert_eq!(refinement.parents.len(), fine.mesh.vertices().len());
        for (x, [a, b]) in fine.mesh.vertices().iter().zip(refinement.parents) {
            let middle = (coarse[a as usize] + coarse[b as usize]) * 0.5;
            assert_eq!(*x, middle);
            n_new += usize::from(a != b);
        }
        assert!(n_new > 0);
    }
    on(&moved::<1>(9));
    on(&moved::<2>(4));
    on(&moved::<3>(2));
}

/// Numbers of cells that leave no room for those of unknowns are refused.
#[test]
fn numbers_of_cells_are_bounded() {
    let mesh = box_mesh::<2>(3);
    let layers = Layers::across_facets(1);
    let mut part = mesh.part(&mesh.partition(2).unwrap(), 1, layers).unwrap();
    let last = *part.cells.last().unwrap();
    let limit: u64 = 1 << 56;
    part.cells.iter_mut().for_each(|cell| *cell += limit / 4 - 1 - last);
    let (fine, _) = part.refine(layers).unwrap();
    assert!(*fine.cells.last().unwrap() < limit);
    part.cells.iter_mut().for_each(|cell| *cell += 1);
    let error = part.refine(layers).unwrap_err();
    assert_eq!(error.kind, MeshErrorKind::TooLarge, "{error}");
    assert!(error.to_string().contains(" cells, at most "), "{error}");
}

/// Refines parts some times, with the layers that a scheme asks for, and holds each level to the whole.
fn chain<const D: usize>(
    entries: &[Entry<D>],
    (mesh, domain): (&Mesh<D>, Option<&Domain<D>>),
    (parts, refinements): (usize, usize),
) {
    let mut levels: Vec<(Layers, Vec<Level<D>>)> = Vec::new();
    for entry in entries {
        let layers = entry.layers(mesh);
        let known = levels.iter().position(|(of, _)| *of == layers);
        let at = known.unwrap_or_else(|| {
            let mut chain = vec![Level::new(mesh, parts, layers)];
            for k in 0..refinements {
                chain.push(chain[k].refine(domain, layers));
            }
            levels.push((layers, chain));
            levels.len() - 1
        });
        let [obstacle, signorini] =
            [obstacle_problem(), signorini_problem()].map(|problem| problem.on(entry.set.clone()));
        for (k, level) in levels[at].1.iter().enumerate() {
            level.same_bits(&*entry.scheme, &obstacle);
            if k == refinements {
                level.same_bits(&*entry.scheme, &signorini);
            }
        }
    }
}

#[test]
fn every_scheme_has_the_rows_of_refined_meshes_on_an_interval() {
    chain(&schemes(), (&box_mesh::<1>(5), None), (4, 3));
    chain(&schemes(), (&moved::<1>(4), None), (2, 3));
}

#[test]
fn every_scheme_has_the_rows_of_refined_meshes_in_the_plane() {
    chain(&schemes(), (&box_mesh::<2>(2), None), (3, 3));
}

#[test]
fn every_scheme_has_the_rows_of_refined_meshes_in_space() {
    chain(&schemes(), (&box_mesh::<3>(1), None), (2, 2));
}

/// Schemes of every kind on meshes of files, on the disc, whose vertices move to the circle, and with shapes.
#[test]
fn parts_of_curved_and_foreign_meshes_have_the_rows_of_the_refined_whole() {
    let list = |names: &[&str]| NamedScheme::list(names.iter().copied()).unwrap();
    fn entries<const D: usize>(schemes: &[NamedScheme]) -> Vec<Entry<D>> {
        schemes.iter().map(|scheme| scheme.make().into()).collect()
    }
    let plane = list(&["p1", "cr", "sipg", "wopsip@weight=anisotropic", "br2-p2"]);
    files::<2>(&mut |mesh| chain(&entries(&plane), (mesh, None), (3.min(mesh.n_cells()), 2)));
    files::<3>(&mut |mesh| chain(&entries(&plane[..4]), (mesh, None), (2, 1)));
    let domain: Domain<2> = Domain::Disc { radius: 1.0 };
    let disc = domain.mesh(3).unwrap();
    let schemes = list(&["p1", "p2", "cr", "sipg", "wopsip@weight=anisotropic", "ldg", "wopsip"]);
    chain(&entries(&schemes), (&disc, Some(&domain)), (3, 3));
    let decided = |_: &str| Some(BoundaryCondition::Dirichlet);
    let disc = shapes::disc().with_boundary_conditions(&decided).unwrap();
    chain(&entries(&schemes), (&disc, None), (3, 2));
    let ball = shapes::ball().with_boundary_conditions(&decided).unwrap().refine().unwrap().0;
    chain(&entries(&plane[..4]), (&ball, None), (5, 1));
}

/// With a layer less some rows differ on the refined mesh, and a part cannot have more layers than its parent
/// makes.
#[test]
fn one_layer_less_is_not_enough_on_refined_parts() {
    fn on<const D: usize>(mesh: &Mesh<D>, domain: Option<&Domain<D>>, names: &[&str]) {
        for scheme in NamedScheme::list(names.iter().copied()).unwrap() {
            let scheme = scheme.make::<D>();
            let layers = scheme.layers(mesh);
            let fewer = Layers { count: layers.count - 1, ..layers };
            let level = Level::new(mesh, 3, layers).refine(domain, layers).refine(domain, fewer);
            let found = level.differences(&*scheme, &signorini_problem());
            assert!(found.columns > 0, "{} {found:?}", scheme.name());
            let part = mesh.part(&mesh.partition(3).unwrap(), 0, Layers { count: 0, ..layers });
            assert!(part.unwrap().refine(layers).is_err());
        }
    }
    let names = ["p1", "p2", "cr", "sipg", "wopsip", "br2", "ldg", "bmmpr", "ldg-switch-p2"];
    on(&moved::<1>(6), None, &names);
    on(&box_mesh::<2>(3), None, &names);
    on(&box_mesh::<3>(1), None, &names);
    let domain: Domain<2> = Domain::Disc { radius: 1.0 };
    on(&domain.mesh(3).unwrap(), Some(&domain), &names);
    files::<2>(&mut |mesh| {
        if mesh.n_cells() > 20 {
            on(mesh, None, &names[..5]);
        }
    });
}

/// A box of another size on one part of a disc: without the extent of all, schemes that read the mesh as a whole
/// have other rows or are refused.
#[test]
fn the_extent_of_all_parts_is_needed() {
    let domain: Domain<2> = Domain::Disc { radius: 1.0 };
    let mesh = domain.mesh(3).unwrap();
    let layers = Layers::across_facets(1);
    let part = Level::new(&mesh, 3, layers).parts.remove(0);
    let (fine, _) = domain.refine_part(&part, layers).unwrap();
    assert!(fine.mesh.mesh_size().is_nan() && fine.mesh.domain_diameter().is_nan());
    let own = fine.clone().with_extent(Extent::of(&fine.mesh));
    let whole = domain.refine(&mesh).unwrap().0;
    assert!(own.mesh.domain_diameter() < whole.domain_diameter());
}
