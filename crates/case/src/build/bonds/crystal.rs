//! Whether bonds that are made for a lattice lie on that lattice.

use super::super::Context;
use super::super::draft::Draft;
use super::{Given, offset};
use crate::codes;
use crate::problem::Problem;
use rayon::prelude::*;
use std::f64::consts::FRAC_1_SQRT_2;

/// How far a bond may point from where a lattice has it: a cosine.
const ASTRAY: f64 = 1e-3;

/// The stiffness and the strength that `lattice` gives are those of spheres on a face-centred cubic lattice along the axes
/// of space: bonds lie along face diagonals of a cube, and who is not at a surface has twelve. One warning for each entry
/// whose bonds are others.
pub(super) fn check(context: &Context<'_>, draft: &Draft, given: &Given, pairs: &[[u32; 2]]) -> Vec<Problem> {
    let (joints, state) = (&context.loaded.case.bond, &draft.state);
    if joints.iter().all(|joint| joint.lattice.is_none()) {
        return Vec::new();
    }
    let entry_of = |pair: [u32; 2]| given.entry(state, pair.map(|index| index as usize));
    let mut bonds = vec![[0_usize; 2]; joints.len()];
    let mut of_particle = vec![0_u32; state.len()];
    let on_lattice: Vec<bool> =
        pairs.par_iter().map(|&pair| is_diagonal(context, draft, pair.map(|index| index as usize))).collect();
    for (&pair, on_lattice) in pairs.iter().zip(on_lattice) {
        for index in pair {
            of_particle[index as usize] += 1;
        }
        if let Some(entry) = entry_of(pair) {
            bonds[entry][0] += 1;
            bonds[entry][1] += usize::from(!on_lattice);
        }
    }
    let most = of_particle.into_iter().max().unwrap_or(0);
    let wrong = |&(_, &[all, astray]): &(usize, &[usize; 2])| all > 0 && (astray > 0 || most < 12);
    let entries = bonds.iter().enumerate().filter(|(entry, _)| joints[*entry].lattice.is_some());
    entries.filter(wrong).map(|(entry, &counts)| warning(context, entry, counts, most)).collect()
}

/// Whether a bond lies along a face diagonal of a cube.
fn is_diagonal(context: &Context<'_>, draft: &Draft, pair: [usize; 2]) -> bool {
    let offset = offset(&context.domain, &draft.state, pair);
    let length = offset.dot(offset).sqrt();
    let mut cosines = [offset.x, offset.y, offset.z].map(|component| component.abs() / length);
    cosines.sort_unstable_by(f64::total_cmp);
    cosines.into_iter().zip([0.0, FRAC_1_SQRT_2, FRAC_1_SQRT_2]).all(|(found, right)| (found - right).abs() <= ASTRAY)
}

fn warning(context: &Context<'_>, entry: usize, [all, astray]: [usize; 2], most: u32) -> Problem {
    let [a, b] = &context.loaded.case.bond[entry].between;
    let what = if astray > 0 {
        format!("{astray} of {all} bonds of `{a}` and `{b}` do not lie along face diagonals of a cube")
    } else {
        format!("no particle has more than {most} bonds, where the inside of that lattice has 12")
    };
    Problem::new(
        codes::NOT_THE_LATTICE,
        format!("`lattice` is right for spheres on the lattice \"fcc\" along x, y and z, but {what}"),
    )
    .at(context.loaded.tree.place(&["bond", &entry.to_string(), "lattice"]), "the solid will be another")
    .help(
        "say how stiff bonds are with `micro = { young_modulus = ..., stiffness_ratio = ... }`, and find its values by \
           pulling a sample",
    )
}
