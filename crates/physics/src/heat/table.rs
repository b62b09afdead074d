//! Properties of materials that depend on temperature: tables, straight between their points.

use crate::Real;
use crate::motion::ramp::line;

/// $\bar T = \tfrac12(T_1 + T_2)$, K: at which a pair has its properties.
///
/// # Numerics
/// With $\lambda(T)$ straight, $\lambda(\bar T)(T_2 - T_1)$ is exactly $\int_{T_1}^{T_2}\lambda\,dT$, so that a chain has the
/// temperatures of Kirchhoff's transform at its particles.
#[inline(always)]
pub fn mean_temperature<R: Real>(first: R, second: R) -> R {
    R::lit(0.5) * (first + second)
}

/// Heat per mass that a body takes in between two temperatures of one straight piece of $c(T)$:
/// $\int_{T}^{T'}c\,dT = \tfrac12\big(c(T) + c(T')\big)(T' - T)$, J/kg.
///
/// | argument | symbol | unit |
/// |---|---|---|
/// | `start`, `end` | two points $(T_k, c_k)$ of the piece | K, J/(kg K) |
/// | `from`, `to` | $T, T'$ | K |
#[inline(always)]
pub fn heat_along<R: Real>(start: [R; 2], end: [R; 2], from: R, to: R) -> R {
    mean_temperature(line(start, end, from), line(start, end, to)) * (to - from)
}

/// $\frac{v_1 - v_0}{T_1 - T_0}$: by how much a property changes per kelvin along one straight piece.
#[inline(always)]
pub fn slope<R: Real>(start: [R; 2], end: [R; 2]) -> R {
    (end[1] - start[1]) / (end[0] - start[0])
}

/// By how much a body becomes warmer that takes in heat within one straight piece of $c(T)$: $\int_T^{T'}c\,dT = q$ is
/// quadratic in $T' - T$.
///
/// $$T' - T = \frac{2q}{c + \sqrt{c^2 + 2sq}},\qquad c = c(T),\quad s = \frac{c_1 - c_0}{T_1 - T_0}$$
///
/// | argument | symbol | unit |
/// |---|---|---|
/// | `start`, `end` | the points $(T_0, c_0)$ and $(T_1, c_1)$ of the piece | K, J/(kg K) |
/// | `from` | $T$ | K |
/// | `heat` | $q$, per mass | J/kg |
///
/// # Validity
/// $T'$ lies within the piece: whoever asks takes the next piece before.
///
/// # Numerics
/// The form without cancellation; exactly $q/c$ where $c$ is constant, and 0 for $q = 0$.
///
/// # Example
/// ```
/// use tdem_physics::heat::table::{heat_along, rise};
/// let (start, end) = ([300.0, 900.0], [400.0, 1100.0]);
/// let heat = heat_along(start, end, 310.0, 390.0);
/// assert!((rise(start, end, 310.0, heat) - 80.0).abs() < 1e-12);
/// ```
#[inline(always)]
pub fn rise<R: Real>(start: [R; 2], end: [R; 2], from: R, heat: R) -> R {
    let two = R::lit(2.0);
    let slope = slope(start, end);
    let specific = line(start, end, from);
    two * heat / (specific + (specific * specific + two * (slope * heat)).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rise_takes_its_heat() {
        for (start, end) in [([300.0, 900.0], [400.0, 1700.0]), ([300.0, 1700.0], [400.0, 900.0])] {
            for (from, to) in [(300.0, 400.0), (400.0, 300.0), (345.6, 345.6 + 1e-9), (399.0, 301.5)] {
                let found = rise(start, end, from, heat_along(start, end, from, to));
                assert!((found - (to - from)).abs() <= 1e-13 * 400.0, "{found} {}", to - from);
            }
        }
    }

    #[test]
    fn no_heat_and_a_constant_are_exact() {
        let level = ([300.0, 901.7], [301.0, 901.7]);
        assert_eq!(rise(level.0, level.1, 277.3, 1234.5).to_bits(), (1234.5_f64 / 901.7).to_bits());
        assert_eq!(rise([300.0, 900.0], [400.0, 1700.0], 333.3, 0.0), 0.0);
    }
}
