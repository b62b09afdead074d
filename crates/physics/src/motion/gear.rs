//! Gear's predictor-corrector with six values (fifth order), the paper's integrator.

use crate::{Real, Vec3};

/// The scaled second to fifth derivatives $\mathbf r_k = \frac{\Delta t^k}{k!}\mathbf x^{(k)}$, m.
pub type Derivatives<R> = [Vec3<R>; 4];

/// Position, velocity and higher derivatives of one particle.
#[derive(Clone, Copy, Debug)]
pub struct Trajectory<R> {
    /// $\mathbf x$, m.
    pub position: Vec3<R>,
    /// $\mathbf v$, m/s.
    pub velocity: Vec3<R>,
    /// $\mathbf r_2 \dots \mathbf r_5$, m.
    pub derivatives: Derivatives<R>,
}

/// The predictor: a Taylor step, $\mathbf r_i^p = \sum_{j\ge i}\binom ji\mathbf r_j$.
///
/// # References
/// Allen & Tildesley, *Computer Simulation of Liquids* (1987), appendix E.
#[inline(always)]
#[must_use]
pub fn predict<R: Real>(now: &Trajectory<R>, step: R) -> Trajectory<R> {
    let [r2, r3, r4, r5] = now.derivatives;
    let r1 = now.velocity * step;
    let c = |factor: f64| R::lit(factor);
    let r1p = r1 + r2 * c(2.0) + r3 * c(3.0) + r4 * c(4.0) + r5 * c(5.0);
    Trajectory {
        position: now.position + r1 + r2 + r3 + r4 + r5,
        velocity: r1p * (c(1.0) / step),
        derivatives: [
            r2 + r3 * c(3.0) + r4 * c(6.0) + r5 * c(10.0),
            r3 + r4 * c(4.0) + r5 * c(10.0),
            r4 + r5 * c(5.0),
            r5,
        ],
    }
}

/// The corrector: $\boldsymbol\Delta = \frac{\Delta t^2}{2}\frac{\mathbf F}{m} - \mathbf r_2^p$,
/// $\mathbf r_k = \mathbf r_k^p + \alpha_k\boldsymbol\Delta$ with
/// $\alpha = (\tfrac3{16}, \tfrac{251}{360}, 1, \tfrac{11}{18}, \tfrac16, \tfrac1{60})$.
///
/// # Validity
/// Undamped oscillations are stable for $\omega\Delta t \le 0.312$ (velocity Verlet: 2). The first coefficient is 3/16,
/// not 3/20, because contact forces depend on velocity.
///
/// # References
/// Gear, *Numerical Initial Value Problems in Ordinary Differential Equations* (1971); Allen & Tildesley table E.2.
#[inline(always)]
#[must_use]
pub fn correct<R: Real>(predicted: &Trajectory<R>, force: Vec3<R>, mass: R, step: R) -> Trajectory<R> {
    let [r2, r3, r4, r5] = predicted.derivatives;
    let half_step_squared = R::lit(0.5) * step * step;
    let delta = force * (half_step_squared / mass) - r2;
    let a = |numerator: f64, denominator: f64| R::lit(numerator / denominator);
    Trajectory {
        position: predicted.position + delta * a(3.0, 16.0),
        velocity: predicted.velocity + delta * (a(251.0, 360.0) / step),
        derivatives: [r2 + delta, r3 + delta * a(11.0, 18.0), r4 + delta * a(1.0, 6.0), r5 + delta * a(1.0, 60.0)],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::vec3;

    /// Error of a unit oscillator after 2 time units.
    fn oscillator_error(steps: u32) -> f64 {
        let step = 2.0 / f64::from(steps);
        let mut now =
            Trajectory { position: vec3(1.0, 0.0, 0.0), velocity: Vec3::zero(), derivatives: [Vec3::zero(); 4] };
        now.derivatives[0] = now.position * (-0.5 * step * step);
        // The true higher derivatives: the start-up error would hide the order.
        let s2 = step * step;
        now.derivatives[2] = now.position * (s2 * s2 / 24.0);
        for _ in 0..steps {
            let p = predict(&now, step);
            now = correct(&p, -p.position, 1.0, step);
        }
        (now.position.x - libm::cos(2.0)).abs()
    }

    #[test]
    fn fifth_order_on_a_smooth_oscillator() {
        let ratio = oscillator_error(40) / oscillator_error(80);
        assert!((20.0..70.0).contains(&ratio), "error ratio {ratio}, 2^5 = 32");
    }
}
