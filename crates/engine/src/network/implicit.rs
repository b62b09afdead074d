//! A step of the backward rule of Euler: the temperatures of its end by conjugate gradients.
//!
//! [`tdem_physics::heat::implicit`] has the equations. The matrix is never stored; it is preconditioned by its diagonal.

use super::{CHUNK, Network, Rates, Stuck, Surroundings};
use crate::HeatPlan;
use crate::exact::exact_sums;
use rayon::prelude::*;
use tdem_physics::heat::implicit::{balance, foreign_at_end, held, residual_squares, square};

/// Of the temperatures: so far, in the mean, may the solution be from what the balance of heat says.
pub(crate) const TOLERANCE: f64 = 1e-12;
/// Iterations beyond which it is given up.
pub(crate) const MOST_ITERATIONS: u64 = 20_000;

/// The matrix of a step, without the rows of prescribed temperatures.
struct Matrix<'a> {
    network: &'a Network,
    /// Whether the temperature is not prescribed, `(N)`.
    free: Vec<bool>,
    /// $C/\Delta t + K$, W/K, `(N)`.
    held: Vec<f64>,
    /// The same with all conductances, W/K, `(N)`.
    diagonal: Vec<f64>,
}

impl Matrix<'_> {
    /// What it makes of a vector that is zero where temperatures are prescribed.
    fn times(&self, vector: &[f64], product: &mut [f64]) {
        product.par_iter_mut().with_min_len(CHUNK).enumerate().for_each(|(i, product)| {
            let free = self.free[i];
            *product = if free { balance(self.held[i], vector[i], self.network.conducted(i, vector)) } else { 0.0 };
        });
    }
}

impl Network {
    /// Heat rates of a step of backward Euler, at the temperatures of its end, and the iterations that it took to find
    /// them. Temperatures that follow these rates keep the balance of heat to rounding.
    ///
    /// # Errors
    /// The temperatures $T_n + \Delta t\,Q/C$ that follow from the rates differ from those of the last iteration by
    /// $\epsilon_i = \Delta t\,r_i/C_i$ with the residual $r$. Iterations end where
    /// $\sum C\epsilon^2 \le (10^{-12})^2\sum CT^2$: at 300 K, 3e-10 K in the mean. The exact solution lies between: no
    /// farther from either, by the same norm. Rounding adds about $10^{-16}\,T\,\Delta t\sum H/C$.
    pub(crate) fn implicit(
        &self,
        temperature: &[f64],
        exposure: &[u16],
        heat: &HeatPlan,
        around: &Surroundings,
        step: f64,
    ) -> Result<(Rates, u64), Stuck> {
        let n = temperature.len();
        let prescribed = |i: usize| around.prescribed[usize::from(exposure[i])];
        let mut end: Vec<f64> = (0..n).map(|i| prescribed(i).unwrap_or(temperature[i])).collect();
        let beginning = self.rates(&end, exposure, heat, around);
        let loss = each(n, |i| self.sensitivity(i, end[i], exposure[i], heat, around));
        let held = each(n, |i| held(self.capacity[i], step, loss[i]));
        let diagonal = each(n, |i| held[i] + (self.contacts.sum(i) + self.bonds.sum(i)));
        let free = (0..n).map(|i| prescribed(i).is_none()).collect();
        let matrix = Matrix { network: self, free, held, diagonal };

        let mut residual = each(n, |i| if matrix.free[i] { beginning.total[i] } else { 0.0 });
        let mut change = vec![0.0; n];
        let mut way = each(n, |i| residual[i] / matrix.diagonal[i]);
        let mut product = vec![0.0; n];
        // The square of the preconditioned residual, and of the temperatures that it stands for, by capacities.
        let squares = |residual: &[f64]| {
            exact_sums(n, |i| residual_squares(residual[i], matrix.diagonal[i], self.capacity[i], step))
        };
        let [content, capacity] = exact_sums(n, |i| [square(self.capacity[i], temperature[i]), self.capacity[i]]);
        let [mut missing, mut error] = squares(&residual);
        let mut iterations = 0;
        while error > TOLERANCE * TOLERANCE * content {
            matrix.times(&way, &mut product);
            let [work] = exact_sums(n, |i| [way[i] * product[i]]);
            if iterations == MOST_ITERATIONS || work.is_nan() || work <= 0.0 {
                return Err(Stuck { iterations, error: (error / capacity).sqrt() });
            }
            let part = missing / work;
            advance(&mut change, &way, part);
            advance(&mut residual, &product, -part);
            let before = missing;
            [missing, error] = squares(&residual);
            let turn = missing / before;
            way.par_iter_mut()
                .with_min_len(CHUNK)
                .enumerate()
                .for_each(|(i, way)| *way = residual[i] / matrix.diagonal[i] + turn * *way);
            iterations += 1;
        }
        // Also true of what is not a number.
        if !error.is_finite() {
            return Err(Stuck { iterations, error });
        }
        end.iter_mut().zip(&change).for_each(|(end, change)| *end += change);
        let foreign = each(n, |i| foreign_at_end(beginning.foreign[i], loss[i], change[i]));
        let total = each(n, |i| self.conducted(i, &end) + foreign[i]);
        Ok((Rates { total, foreign }, iterations))
    }
}

fn each(n: usize, value: impl Fn(usize) -> f64 + Sync + Send) -> Vec<f64> {
    (0..n).into_par_iter().with_min_len(CHUNK).map(value).collect()
}

fn advance(vector: &mut [f64], by: &[f64], part: f64) {
    vector.par_iter_mut().with_min_len(CHUNK).zip(by).for_each(|(vector, by)| *vector += part * by);
}
