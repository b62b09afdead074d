//! Values that are prescribed along straight pieces of time.

use crate::Real;

/// A straight piece of a course, $v = v_0 + (v_1 - v_0)\frac{t - t_0}{t_1 - t_0}$.
///
/// | argument | symbol | unit |
/// |---|---|---|
/// | `start` | $t_0, v_0$ | s, any |
/// | `end` | $t_1, v_1$ | s, the same |
/// | `time` | $t$ | s |
///
/// # Returns
/// $v$, in the unit of the values.
///
/// # Validity
/// $t_0 < t_1$. The line goes on beyond both points.
///
/// # Numerics
/// Exactly $v_0$ at $t_0$, and everywhere if $v_1 = v_0$; $v_1$ at $t_1$ to rounding: whoever wants it exact takes the next
/// piece there.
///
/// # Example
/// ```
/// use tdem_physics::motion::ramp::line;
/// assert_eq!(line([1.0, 10.0], [3.0, 30.0], 1.5), 15.0);
/// ```
#[inline(always)]
pub fn line<R: Real>(start: [R; 2], end: [R; 2], time: R) -> R {
    let ([from, first], [to, last]) = (start, end);
    first + (last - first) * ((time - from) / (to - from))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_point_and_a_constant_are_exact() {
        assert_eq!(line([0.1, 0.3], [0.7, -0.9], 0.1).to_bits(), 0.3_f64.to_bits());
        for time in [-3.0, 0.1, 0.2, 0.7, 9.0] {
            assert_eq!(line([0.1, 0.3], [0.7, 0.3], time).to_bits(), 0.3_f64.to_bits());
        }
    }
}
