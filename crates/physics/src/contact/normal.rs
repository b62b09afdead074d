//! Hertz: the elastic normal force of two spheres.

use crate::Real;

/// Hertz's force.
///
/// $$F_{el} = \tfrac43 E^*\sqrt{R^*}\,h^{3/2} = \left(\tfrac43E^*\right) a\,h,\qquad a = \sqrt{R^*h}$$
///
/// | argument | symbol | unit | range |
/// |---|---|---|---|
/// | `normal_stiffness` | $\tfrac43E^*$ | Pa | > 0 |
/// | `contact_radius` | $a$ | m | > 0 |
/// | `overlap` | $h$ | m | > 0 |
///
/// # Returns
/// The repulsive force, N.
///
/// # Validity
/// Smooth elastic bodies, $a \ll R$; in practice $h \lesssim 0.1 R$.
///
/// # Numerics
/// Written with the contact radius, which damping and friction need too: one square root serves all.
///
/// # Example
/// ```
/// use tdem_physics::contact::normal::hertz;
/// // A glass sphere of 10 mm on its like, pressed together by 0.01 mm: E* = 25 GPa, R* = 5 mm.
/// let contact_radius = (5e-3_f64 * 1e-5).sqrt();
/// assert!((hertz(4.0 / 3.0 * 25e9, contact_radius, 1e-5) - 74.5356).abs() < 1e-4);
/// ```
///
/// # References
/// H. Hertz, J. reine angew. Math. 92 (1882) 156; K. L. Johnson, *Contact Mechanics* (1985), eq. 4.22-4.24.
#[inline(always)]
pub fn hertz<R: Real>(normal_stiffness: R, contact_radius: R, overlap: R) -> R {
    normal_stiffness * contact_radius * overlap
}

/// Hertz's tangent stiffness $S_n = \mathrm dF/\mathrm dh = 2E^*a = \tfrac32\left(\tfrac43E^*\right)a$, N/m.
///
/// # Example
/// ```
/// use tdem_physics::contact::normal::{hertz, hertz_stiffness};
/// let (k, r, h, d) = (1e9, 5e-3_f64, 1e-5, 1e-9);
/// let slope = (hertz(k, (r * (h + d)).sqrt(), h + d) - hertz(k, (r * (h - d)).sqrt(), h - d)) / (2.0 * d);
/// assert!((hertz_stiffness(k, (r * h).sqrt()) / slope - 1.0).abs() < 1e-6);
/// ```
#[inline(always)]
pub fn hertz_stiffness<R: Real>(normal_stiffness: R, contact_radius: R) -> R {
    R::lit(1.5) * normal_stiffness * contact_radius
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_overlap_no_force() {
        assert_eq!(hertz(1e9, 0.0, 0.0), 0.0);
    }

    #[test]
    fn force_grows_with_the_power_three_halves() {
        let force = |overlap: f64| hertz(1e9, (5e-3 * overlap).sqrt(), overlap);
        assert!((force(4e-6) / force(1e-6) - 8.0).abs() < 1e-12);
    }
}
