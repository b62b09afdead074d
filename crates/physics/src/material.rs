//! Effective elastic values of a pair of materials.

/// Elasticity of one material.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Elastic {
    /// $E$, Pa.
    pub young_modulus: f64,
    /// $\nu$, in (-1, 0.5].
    pub poisson_ratio: f64,
}

impl Elastic {
    /// Infinitely stiff: a rigid wall.
    pub const RIGID: Elastic = Elastic { young_modulus: f64::INFINITY, poisson_ratio: 0.0 };

    /// $G = E/(2(1+\nu))$, Pa.
    #[must_use]
    pub fn shear_modulus(self) -> f64 {
        self.young_modulus / (2.0 * (1.0 + self.poisson_ratio))
    }
}

/// $1/E^* = (1-\nu_1^2)/E_1 + (1-\nu_2^2)/E_2$, in Pa.
///
/// # Example
/// ```
/// use tdem_physics::material::{Elastic, young_modulus_eff};
/// let glass = Elastic { young_modulus: 4.8e10, poisson_ratio: 0.2 };
/// assert!((young_modulus_eff(glass, glass) - 2.5e10).abs() < 1.0);
/// assert!((young_modulus_eff(glass, Elastic::RIGID) - 5.0e10).abs() < 1.0);
/// ```
#[must_use]
pub fn young_modulus_eff(a: Elastic, b: Elastic) -> f64 {
    let compliance = |m: Elastic| (1.0 - m.poisson_ratio * m.poisson_ratio) / m.young_modulus;
    1.0 / (compliance(a) + compliance(b))
}

/// $1/G^* = (2-\nu_1)/G_1 + (2-\nu_2)/G_2$, in Pa.
#[must_use]
pub fn shear_modulus_eff(a: Elastic, b: Elastic) -> f64 {
    let compliance = |m: Elastic| (2.0 - m.poisson_ratio) / m.shear_modulus();
    1.0 / (compliance(a) + compliance(b))
}
