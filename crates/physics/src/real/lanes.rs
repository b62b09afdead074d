//! Eight numbers at once, one AVX-512 register wide; on narrower machines the compiler splits them.

use super::{Branch, Pack, Real};
use std::ops::{Add, Div, Mul, Neg, Sub};

/// Numbers per [`Lanes`].
pub const WIDTH: usize = 8;

/// Eight `f64` that go through a law together, each with the bits it would get alone.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C, align(64))]
pub struct Lanes(pub [f64; WIDTH]);

macro_rules! operators {
    ($($operator:ident $function:ident $assign:tt),*) => {$(
        impl $operator for Lanes {
            type Output = Self;
            #[inline(always)]
            fn $function(mut self, other: Self) -> Self {
                for lane in 0..WIDTH {
                    self.0[lane] $assign other.0[lane];
                }
                self
            }
        }
    )*};
}
operators!(Add add +=, Sub sub -=, Mul mul *=, Div div /=);

impl Neg for Lanes {
    type Output = Self;
    #[inline(always)]
    fn neg(mut self) -> Self {
        for lane in 0..WIDTH {
            self.0[lane] = -self.0[lane];
        }
        self
    }
}

/// All ones or all zeros per lane: bitwise selection vectorises reliably, `[bool; 8]` does not.
impl Real for Lanes {
    type Mask = [u64; WIDTH];

    #[inline(always)]
    fn lit(value: f64) -> Self {
        Lanes([value; WIDTH])
    }
    #[inline(always)]
    fn sqrt(mut self) -> Self {
        for lane in 0..WIDTH {
            self.0[lane] = self.0[lane].sqrt();
        }
        self
    }
    #[inline(always)]
    fn abs(mut self) -> Self {
        for lane in 0..WIDTH {
            self.0[lane] = self.0[lane].abs();
        }
        self
    }
    #[inline(always)]
    fn gt(self, other: Self) -> [u64; WIDTH] {
        let mut mask = [0; WIDTH];
        for lane in 0..WIDTH {
            mask[lane] = if self.0[lane] > other.0[lane] { !0 } else { 0 };
        }
        mask
    }
    #[inline(always)]
    fn select(mask: [u64; WIDTH], if_true: Self, mut if_false: Self) -> Self {
        for lane in 0..WIDTH {
            if_false.0[lane] =
                f64::from_bits(if_true.0[lane].to_bits() & mask[lane] | if_false.0[lane].to_bits() & !mask[lane]);
        }
        if_false
    }
    /// Skipped as a whole when no lane needs it: sliding contacts are rare in a packing at rest.
    #[inline(always)]
    fn when<T: Pack<Self>>(mask: [u64; WIDTH], value: T, then: impl Branch<T>) -> T {
        let mut any = 0;
        for lane in mask {
            any |= lane;
        }
        if any == 0 {
            return value;
        }
        then.taken(value).zip(value, &mut |replaced, kept| Self::select(mask, replaced, kept))
    }
}
