//! A step of the backward rule of Euler, body by body: what its system of equations and the norm of its errors are made of.
//!
//! With $C = mc$ and conductances $H$, the changes $\delta$ of the temperatures solve
//!
//! $$\Big(\frac{C_i}{\Delta t} + K_i\Big)\delta_i - \sum_j H_{ij}(\delta_j - \delta_i) = Q_i$$
//!
//! where $Q$ are the heat rates at the beginning and $K$ is how much less comes in from outside per kelvin:
//! [`Exchange::sensitivity`](super::Exchange::sensitivity), walls included.

use crate::Real;

/// $C/\Delta t + K$, W/K: what a body of capacity $C$ (J/K) holds back in a step $\Delta t$ (s) per kelvin, and gives to its
/// surroundings.
#[inline(always)]
pub fn held<R: Real>(capacity: R, step: R, sensitivity: R) -> R {
    capacity / step + sensitivity
}

/// The left side of the equation of a body, W.
///
/// | argument | symbol | unit |
/// |---|---|---|
/// | `held` | $C/\Delta t + K$, see [`held`] | W/K |
/// | `change` | $\delta_i$ | K |
/// | `conducted` | $\sum_j H_{ij}(\delta_j - \delta_i)$ | W |
#[inline(always)]
pub fn balance<R: Real>(held: R, change: R, conducted: R) -> R {
    held * change - conducted
}

/// What comes in from outside at the end of the step, W: $Q - K\delta$.
#[inline(always)]
pub fn foreign_at_end<R: Real>(foreign: R, sensitivity: R, change: R) -> R {
    foreign - sensitivity * change
}

/// $CT^2$, J K: the square by which temperatures and their errors are measured.
#[inline(always)]
pub fn square<R: Real>(capacity: R, kelvins: R) -> R {
    capacity * (kelvins * kelvins)
}

/// Squares of what is missing in the equation of a body: by the inverse of the diagonal, $r^2/D$, W K; and of the
/// temperature that it stands for, $C\epsilon^2$ with $\epsilon = \Delta t\,r/C$, J K.
///
/// | argument | symbol | unit |
/// |---|---|---|
/// | `residual` | $r$ | W |
/// | `diagonal` | $D = C/\Delta t + K + \sum H$ | W/K |
/// | `capacity`, `step` | $C, \Delta t$ | J/K, s |
#[inline(always)]
pub fn residual_squares<R: Real>(residual: R, diagonal: R, capacity: R, step: R) -> [R; 2] {
    let kelvins = residual * (step / capacity);
    [residual * (residual / diagonal), square(capacity, kelvins)]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One body between a wall and a neighbour that stays as it is: the equation can be solved by hand.
    #[test]
    fn the_change_of_one_body_balances_its_heat() {
        let (capacity, step, wall, neighbour, rate) = (3.0, 0.5, 2.0, 4.0, 60.0);
        let held = held(capacity, step, wall);
        let change = rate / (capacity / step + wall + neighbour);
        let balance = balance(held, change, neighbour * (0.0 - change));
        assert!((balance - rate).abs() < 1e-13);
        // What it stores is what came in at the end of the step.
        let stored = capacity * change / step;
        let came = foreign_at_end(rate, wall, change) - neighbour * change;
        assert!((stored - came).abs() < 1e-13, "{stored} {came}");
    }

    #[test]
    fn squares_are_those_of_the_formulas() {
        let (residual, diagonal, capacity, step) = (-6.0, 4.0, 3.0, 0.5);
        assert_eq!(residual_squares(residual, diagonal, capacity, step), [9.0, 3.0]);
        assert_eq!(square(3.0, 2.0), 12.0);
    }
}
