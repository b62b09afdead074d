//! How large a time step may be.
//!
//! Bounds that are proved (an oscillator or a dashpot alone) are told from estimates (a packing, an impact).

use crate::material::Elastic;

/// Time a Rayleigh wave needs to travel around a sphere, s:
/// $T_R = \pi R\sqrt{\rho/G}\,/(0.1631\nu + 0.8766)$. Steps of 0.1 to 0.2 of it are customary with velocity Verlet,
/// 0.03 to 0.1 with Gear.
///
/// # Example
/// ```
/// use tdem_physics::{material::Elastic, stability::rayleigh_time};
/// let plastic = Elastic { young_modulus: 9.33e6, poisson_ratio: 0.352 };
/// assert!((rayleigh_time(0.02, 920.0, plastic) - 1.0985e-3).abs() < 1e-7);
/// ```
///
/// # References
/// Thornton & Randall, in *Micromechanics of Granular Materials* (1988) 133; LIGGGHTS documentation, fix
/// check/timestep/gran.
#[must_use]
pub fn rayleigh_time(radius: f64, density: f64, material: Elastic) -> f64 {
    let wave = (density / material.shear_modulus()).sqrt();
    std::f64::consts::PI * radius * wave / (0.1631 * material.poisson_ratio + 0.8766)
}

/// Duration of an elastic Hertz impact, s: $t_c = 2.8682657\,(m^{*2}/(R^*E^{*2}v))^{1/5}$; infinite at zero speed.
///
/// | argument | symbol | unit |
/// |---|---|---|
/// | `mass_eff` | $m^*$ | kg |
/// | `radius_eff` | $R^*$ | m |
/// | `young_modulus_eff` | $E^*$ | Pa |
/// | `speed` | $v$ | m/s |
///
/// # References
/// Johnson, *Contact Mechanics* (1985), section 11.4.
#[must_use]
pub fn hertz_collision_time(mass_eff: f64, radius_eff: f64, young_modulus_eff: f64, speed: f64) -> f64 {
    if speed == 0.0 {
        return f64::INFINITY;
    }
    let m_per_e = mass_eff / young_modulus_eff;
    2.868_265_7 * libm::pow(m_per_e * m_per_e / (radius_eff * speed), 0.2)
}

/// Largest overlap of an elastic Hertz impact, m: $h_{max} = (15m^*v^2/(16E^*\sqrt{R^*}))^{2/5}$.
#[must_use]
pub fn hertz_largest_overlap(mass_eff: f64, radius_eff: f64, young_modulus_eff: f64, speed: f64) -> f64 {
    libm::pow(15.0 * mass_eff * speed * speed / (16.0 * young_modulus_eff * radius_eff.sqrt()), 0.4)
}

/// Largest $\omega\Delta t$ of an undamped oscillator under velocity Verlet: proved.
pub const VERLET_OSCILLATOR_LIMIT: f64 = 2.0;
/// Largest $\gamma\Delta t$ of a dashpot alone under velocity Verlet, whose forces see the half-step velocity: proved.
pub const VERLET_DASHPOT_LIMIT: f64 = 2.0;
/// Largest $\omega\Delta t$ of an undamped oscillator under Gear's method: spectral radius at most 1 + 1e-9.
pub const GEAR_OSCILLATOR_LIMIT: f64 = 0.312;
/// Largest $\gamma\Delta t$ of a dashpot alone under Gear's method: spectral radius.
pub const GEAR_DASHPOT_LIMIT: f64 = 0.1635;
/// In a dense packing with twelve contacts a sphere feels about this multiple of the damping of one contact: estimate.
pub const DENSE_PACKING_DAMPING: f64 = 4.0;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn collision_of_two_glass_spheres() {
        // Chung & Ooi (2011) test 1: R = 10 mm, rho = 2800, E = 48 GPa, nu = 0.2, +-10 m/s.
        let mass = 4.0 / 3.0 * std::f64::consts::PI * 1e-6 * 2800.0;
        let t = hertz_collision_time(0.5 * mass, 0.005, 2.5e10, 20.0);
        assert!((t / 4.033_945e-5 - 1.0).abs() < 1e-6, "{t}");
        let h = hertz_largest_overlap(0.5 * mass, 0.005, 2.5e10, 20.0);
        assert!((h / 2.741_127e-4 - 1.0).abs() < 1e-6, "{h}");
    }
}
