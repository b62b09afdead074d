//! How temperature and radius follow the heat.

use crate::Real;

/// One explicit step of the temperature, $T \leftarrow T + \frac{\Delta t}{mc}Q$, K.
///
/// | argument | symbol | unit |
/// |---|---|---|
/// | `temperature` | $T$ | K |
/// | `heat_rate` | $Q$, into the body | W |
/// | `capacity` | $mc$ | J/K |
/// | `step` | $\Delta t$ of the heat | s |
///
/// # Validity
/// Stable and without oscillation for $\Delta t \le mc/\sum H$; the exact limit is twice that of the stiffest mode.
///
/// # References
/// Pacevič & Kačeniauskas (2022), eq. 4, by Euler's rule.
#[inline(always)]
pub fn warmed<R: Real>(temperature: R, heat_rate: R, capacity: R, step: R) -> R {
    temperature + heat_rate * (step / capacity)
}

/// $q = \frac{\Delta t}{m}Q$, J/kg: the heat per mass that a body takes in in a step, where its specific heat depends on
/// temperature; [`super::table`] says how much warmer it becomes.
///
/// | argument | symbol | unit |
/// |---|---|---|
/// | `heat_rate` | $Q$, into the body | W |
/// | `mass` | $m$ | kg |
/// | `step` | $\Delta t$ of the heat | s |
#[inline(always)]
pub fn taken_in<R: Real>(heat_rate: R, mass: R, step: R) -> R {
    heat_rate * (step / mass)
}

/// $\Delta t = mc/\sum H$, s: the longest explicit step in which a body is not carried beyond its neighbours.
///
/// | argument | symbol | unit |
/// |---|---|---|
/// | `capacity` | $mc$ | J/K |
/// | `conductance` | $\sum H$, of all bonds, contacts, walls and surfaces | W/K |
///
/// # Returns
/// Infinity for a body that is insulated.
#[inline(always)]
pub fn longest_step<R: Real>(capacity: R, conductance: R) -> R {
    capacity / conductance
}

/// $R = R_0\,(1 + \alpha(T - T_0))$, m.
///
/// | argument | symbol | unit |
/// |---|---|---|
/// | `radius` | $R_0$, at the reference temperature | m |
/// | `expansion` | $\alpha$ | 1/K |
/// | `warmth` | $T - T_0$ | K |
///
/// # References
/// Pacevič & Kačeniauskas (2022), eq. 7; its printed minus would let bodies shrink when heated.
#[inline(always)]
pub fn grown<R: Real>(radius: R, expansion: R, warmth: R) -> R {
    radius * (R::lit(1.0) + expansion * warmth)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_of_the_longest_meets_the_neighbour() {
        let step = longest_step(3.0, 2.0);
        let rate = super::super::conduction::flow(2.0, 300.0, 400.0);
        assert_eq!(warmed(300.0, rate, 3.0, step), 400.0);
        assert_eq!(longest_step(3.0, 0.0), f64::INFINITY);
    }

    #[test]
    fn two_bodies_keep_their_heat() {
        let (mut a, mut b, conductance, step) = (300.0_f64, 400.0_f64, 2.0, 0.01);
        for _ in 0..100 {
            let rate = super::super::conduction::flow(conductance, a, b);
            (a, b) = (warmed(a, rate, 3.0, step), warmed(b, -rate, 5.0, step));
        }
        assert!((3.0 * a + 5.0 * b - 2900.0).abs() < 1e-11);
        let factor = 1.0 - step * conductance * (1.0 / 3.0 + 1.0 / 5.0);
        let decay = (0..100).fold(1.0, |decay, _| decay * factor);
        assert!(((b - a) / 100.0 - decay).abs() < 1e-14);
    }
}
