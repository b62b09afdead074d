//! Dashpots of the normal direction: by coefficient (the paper's) and by coefficient of restitution.

use crate::Real;

/// Viscous damping by coefficient: $F_{vis} = -\gamma_n m^* v_n$.
///
/// | argument | symbol | unit | range |
/// |---|---|---|---|
/// | `coefficient` | $\gamma_n$ | 1/s | >= 0 |
/// | `mass_eff` | $m^*$ | kg | > 0 |
/// | `normal_speed` | $v_n$ | m/s | negative while approaching |
///
/// # Returns
/// The repulsive force, N. The restitution it gives rises with the impact speed.
///
/// # Numerics
/// The paper prints the coefficients 1500 and 150 without unit; as N s/m no usable step would be stable, as 1/s times
/// the effective mass they are sensible.
///
/// # References
/// Džiugys & Peters, Granular Matter 3 (2001) 231; Pacevič & Kačeniauskas (2022) section 2.1.
#[inline(always)]
pub fn viscous<R: Real>(coefficient: R, mass_eff: R, normal_speed: R) -> R {
    -(coefficient * mass_eff * normal_speed)
}

/// Damping that gives the same restitution at every speed: $F_{vis} = -2\sqrt{5/6}\,\beta\sqrt{S_n m^*}\,v_n$.
///
/// | argument | symbol | unit | range |
/// |---|---|---|---|
/// | `factor` | $2\sqrt{5/6}\,\beta$, see [`restitution_factor`] | 1 | >= 0 |
/// | `stiffness` | $S_n$, Hertz's tangent stiffness | N/m | > 0 |
/// | `mass_eff` | $m^*$ | kg | > 0 |
/// | `normal_speed` | $v_n$ | m/s | negative while approaching |
///
/// # Returns
/// The repulsive force, N.
///
/// # Validity
/// The restitution is met exactly if the dashpot may attract. With the force clamped at zero the rebound is faster:
/// 0.5 becomes 0.5503, 0.9 becomes 0.9020.
///
/// # References
/// Tsuji, Tanaka & Ishida, Powder Technology 71 (1992) 239; Antypov & Elliott, EPL 94 (2011) 50004.
#[inline(always)]
pub fn restitution<R: Real>(factor: R, stiffness: R, mass_eff: R, normal_speed: R) -> R {
    -(factor * (stiffness * mass_eff).sqrt() * normal_speed)
}

/// $2\sqrt{5/6}\,\beta$ with $\beta = -\ln e/\sqrt{\pi^2+\ln^2e}$, for a coefficient of restitution $0 < e \le 1$.
///
/// # Example
/// ```
/// use tdem_physics::contact::damping::restitution_factor;
/// assert_eq!(restitution_factor(1.0), 0.0); // elastic
/// assert!((restitution_factor(0.5) - 0.39336).abs() < 1e-5);
/// ```
#[must_use]
pub fn restitution_factor(restitution: f64) -> f64 {
    let log = libm::log(restitution);
    let beta = -log / (std::f64::consts::PI * std::f64::consts::PI + log * log).sqrt();
    2.0 * (5.0_f64 / 6.0).sqrt() * beta + 0.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dashpots_oppose_the_motion() {
        assert!(viscous(1500.0, 0.03, -1.0) > 0.0);
        assert!(viscous(1500.0, 0.03, 1.0) < 0.0);
        assert!(restitution(0.4, 1e5, 0.03, -1.0) > 0.0);
        assert!(restitution(0.4, 1e5, 0.03, 1.0) < 0.0);
    }
}
