//! Distances of contact set and multiplier from those of a solution on a refinement of the mesh.

use super::entity::ContactEntity;
use crate::algebra::Inequality;
use crate::assemble::Discretisation;
use crate::assemble::space::Space;
use crate::inequality::Solution;
use crate::instances::compiled;
use crate::measure::errors::ContactErrors;
use crate::mesh::Refinement;

/// A solution with its space and inequality.
type DiscreteSolution<'s, 'a, const D: usize> =
    (&'s Discretisation<'a, D>, &'s Inequality<f64>, &'s Solution<f64>);

/// Distances of multiplier and contact set of a solution from those of another one, on the mesh that
/// these refinements make of its own, coarsest first. The definitions are those of
/// [`Discretisation::contact_errors`]. The measure of the symmetric difference is that of the cells (or contact
/// facets) of the finer mesh. The multiplier of the finer solution is tested with the hat functions of the coarser
/// mesh, exactly.
pub(crate) fn contact_difference<const D: usize>(
    solved: DiscreteSolution<'_, '_, D>,
    reference: DiscreteSolution<'_, '_, D>,
    refinements: &[&Refinement],
) -> ContactErrors {
    compiled!(const D: fn(DiscreteSolution<'_, '_, D>, DiscreteSolution<'_, '_, D>, &[&Refinement]) -> ContactErrors
            = difference
    )(solved, reference, refinements)
}

fn difference<const D: usize>(
    (own, inequality, solution): DiscreteSolution<'_, '_, D>,
    (fine, fine_inequality, fine_solution): DiscreteSolution<'_, '_, D>,
    refinements: &[&Refinement],
) -> ContactErrors {
    let (space, solved) = (&own.space, (inequality, solution));
    let (fine, fine_solved) = (&fine.space, (fine_inequality, fine_solution));
    let mut errors = ContactErrors::default();
    // with both an obstacle and a contact boundary there are two multipliers of different kind
    if space.problem.has_obstacle() == space.problem.acts_on_boundary() {
        return errors;
    }
    let (entities, fine_entities) = (space.entities(), fine.entities());
    let touching = space.in_contact(&entities, solved);
    let fine_touching = fine.in_contact(&fine_entities, fine_solved);
    let measures = fine.measures_of(&fine_entities);
    let of_fine = fine_entities.iter().zip(&measures).zip(fine_touching);
    let area = of_fine.map(|((&entity, measure), touches)| {
        let ancestor = ancestor(space, &entities, (fine, entity), refinements.len());
        let differs = ancestor.is_some_and(|k| touching[k] != touches);
        if differs { *measure } else { 0.0 }
    });
    errors.contact_area_error = Some(area.sum());

    let of_fine = fine.vertex_multipliers(fine_solved);
    let own = space.vertex_multipliers(solved);
    let (Some(mut multipliers), Some(own)) = (of_fine, own) else { return errors };
    for refinement in refinements.iter().rev() {
        multipliers = tested_with_coarser_hats(&multipliers, refinement);
    }
    multipliers.iter_mut().zip(own).for_each(|(m, own)| *m -= own);
    let weights = space.hat_integrals(&entities, &space.measures_of(&entities));
    [errors.multiplier_l1, errors.multiplier_l2] = space.density_norms(&multipliers, &weights);
    errors
}

/// The position of the entity that contains an entity of a refinement.
fn ancestor<const D: usize>(
    space: &Space<'_, D>,
    entities: &[ContactEntity],
    (fine, entity): (&Space<'_, D>, ContactEntity),
    refinements: usize,
) -> Option<usize> {
    let cell = entity.cell >> (D * refinements);
    let first = entities.partition_point(|e| e.cell < cell);
    let of_cell = || (first..entities.len()).take_while(|&k| entities[k].cell == cell);
    let Some(local) = entity.facet else { return of_cell().next() };
    let x = fine.mesh.facet_barycentre(entity.cell, local);
    let geometry = space.mesh.geometry(cell);
    // the barycentric coordinate of a facet vanishes on it
    let coordinate = |k: &usize| {
        let facet = entities[*k].facet.expect("all entities are facets, or all are cells");
        let on_facet = space.mesh.facet_barycentre(cell, facet);
        geometry.gradient(facet).dot(&(x - on_facet)).abs()
    };
    of_cell().min_by(|a, b| coordinate(a).total_cmp(&coordinate(b)))
}

/// What is tested with the hat functions of a refined mesh, tested with those of its parent.
fn tested_with_coarser_hats(fine: &[f64], refinement: &Refinement) -> Vec<f64> {
    let n = refinement.parents.iter().flatten().max().map_or(0, |&v| v as usize + 1);
    let mut coarse = vec![0.0; n];
    for (&value, &[a, b]) in fine.iter().zip(&refinement.parents) {
        coarse[a as usize] += 0.5 * value;
        coarse[b as usize] += 0.5 * value;
    }
    coarse
}
