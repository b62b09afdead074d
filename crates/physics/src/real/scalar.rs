//! One number: the plain reference.

use super::{Branch, Pack, Real};

impl Real for f64 {
    type Mask = bool;

    #[inline(always)]
    fn lit(value: f64) -> f64 {
        value
    }
    #[inline(always)]
    fn sqrt(self) -> f64 {
        f64::sqrt(self)
    }
    #[inline(always)]
    fn abs(self) -> f64 {
        f64::abs(self)
    }
    #[inline(always)]
    fn gt(self, other: f64) -> bool {
        self > other
    }
    #[inline(always)]
    fn select(mask: bool, if_true: f64, if_false: f64) -> f64 {
        if mask { if_true } else { if_false }
    }
    #[inline(always)]
    fn when<T: Pack<f64>>(mask: bool, value: T, then: impl Branch<T>) -> T {
        if mask { then.taken(value) } else { value }
    }
}
