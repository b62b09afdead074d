//! Conjugate gradients over particles, preconditioned by the block of each particle.

use super::{Assembly, Boundary, Error, Six};
use rayon::prelude::*;
use tdem_engine::exact_sums;

/// The square of the preconditioned residual has fallen by the square of this at the end.
const TOLERANCE: f64 = 1e-13;
/// Iterations beyond which it is given up, however many particles.
const MOST_ITERATIONS: usize = 30_000;

/// Displacements and rotations at rest, and the iterations that they took.
pub(super) fn solve(assembly: &Assembly, boundary: &Boundary) -> Result<(Vec<Six>, usize), Error> {
    let mut solution: Vec<Six> = boundary.held.iter().map(|held| held.map(Option::unwrap_or_default)).collect();
    let blocks: Vec<Block> = (0..assembly.particles())
        .into_par_iter()
        .map(|k| Block::inverse_of(assembly, k, boundary.held[k].map(|held| held.is_some())))
        .collect();
    let mut residual = assembly.forces(&solution);
    for ((residual, load), held) in residual.iter_mut().zip(&boundary.loads).zip(&boundary.held) {
        (0..6).for_each(|k| residual[k] = if held[k].is_some() { 0.0 } else { residual[k] + load[k] });
    }
    let mut way: Vec<Six> = blocks.iter().zip(&residual).map(|(block, residual)| block.times(residual)).collect();
    let mut square = dot(&way, &residual);
    let first = square;
    let mut iterations = 0;
    let most = MOST_ITERATIONS.min(1000 + 6 * assembly.particles());
    while square > TOLERANCE * TOLERANCE * first {
        let (resistance, work) = resistance(assembly, boundary, &way);
        let stuck = || Error::NotHeld { iterations, residual: (square / first).sqrt() };
        if iterations == most || work.is_nan() || work <= 0.0 {
            return Err(stuck());
        }
        let step = square / work;
        advance(&mut solution, &way, step);
        advance(&mut residual, &resistance, -step);
        let before = square;
        let eased: Vec<Six> = blocks.par_iter().zip(&residual).map(|(block, residual)| block.times(residual)).collect();
        square = dot(&eased, &residual);
        let part = square / before;
        way.par_iter_mut().zip(&eased).for_each(|(way, eased)| (0..6).for_each(|k| way[k] = eased[k] + part * way[k]));
        iterations += 1;
    }
    Ok((solution, iterations))
}

/// What free components resist a way with, and the work of it.
fn resistance(assembly: &Assembly, boundary: &Boundary, way: &[Six]) -> (Vec<Six>, f64) {
    let of = |particle: usize| {
        let (pull, held) = (assembly.pull(particle, way), &boundary.held[particle]);
        std::array::from_fn(|k| if held[k].is_some() { 0.0 } else { -pull[k] })
    };
    let resistance: Vec<Six> = (0..way.len()).into_par_iter().map(of).collect();
    let work = dot(&resistance, way);
    (resistance, work)
}

fn advance(vector: &mut [Six], by: &[Six], step: f64) {
    vector.par_iter_mut().zip(by).for_each(|(vector, by)| (0..6).for_each(|k| vector[k] += step * by[k]));
}

/// The sum of the products of all components, exactly but for the rounding of each product.
fn dot(a: &[Six], b: &[Six]) -> f64 {
    let [sum] = exact_sums(6 * a.len(), |k| [a[k / 6][k % 6] * b[k / 6][k % 6]]);
    sum
}

/// What a particle alone resists with, all others being held: inverted, over its free components.
struct Block([Six; 6]);

impl Block {
    /// Part of a diagonal element below which a component counts as one that nothing resists.
    const NOTHING: f64 = 1e-12;

    fn inverse_of(assembly: &Assembly, particle: usize, held: [bool; 6]) -> Self {
        let mut matrix = [[0.0; 6]; 6];
        for link in assembly.row(particle) {
            for column in (0..6).filter(|&column| !held[column]) {
                let mut unit = [0.0; 6];
                unit[column] = 1.0;
                let pull = link.pull(&unit, &[0.0; 6]);
                (0..6).filter(|&row| !held[row]).for_each(|row| matrix[row][column] -= pull[row]);
            }
        }
        Block(inverse(matrix))
    }

    fn times(&self, vector: &Six) -> Six {
        std::array::from_fn(|row| (0..6).map(|k| self.0[row][k] * vector[k]).sum())
    }
}

/// The inverse of a symmetric matrix without negative eigenvalues, by Gauss and Jordan; components that nothing resists
/// are left out.
fn inverse(mut matrix: [Six; 6]) -> [Six; 6] {
    let diagonal: Six = std::array::from_fn(|k| matrix[k][k]);
    let mut swept = [false; 6];
    for pivot in 0..6 {
        let value = matrix[pivot][pivot];
        if value <= Block::NOTHING * diagonal[pivot] {
            continue;
        }
        swept[pivot] = true;
        for row in (0..6).filter(|&row| row != pivot) {
            let factor = matrix[row][pivot] / value;
            for column in (0..6).filter(|&column| column != pivot) {
                matrix[row][column] -= factor * matrix[pivot][column];
            }
            matrix[row][pivot] = -factor;
        }
        for column in (0..6).filter(|&column| column != pivot) {
            matrix[pivot][column] /= value;
        }
        matrix[pivot][pivot] = 1.0 / value;
    }
    std::array::from_fn(|row| std::array::from_fn(|k| if swept[row] && swept[k] { matrix[row][k] } else { 0.0 }))
}
