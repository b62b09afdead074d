//! The number a law is written over.
//!
//! [`Real`] offers exactly the operations that IEEE 754 rounds the same way on every machine: `+ - * /`, square root,
//! absolute value, comparison and selection. There is no `mul_add`, no `pow`, no `exp` and no `sin`: what cannot be
//! reproduced to the last bit cannot be written.

mod lanes;
mod scalar;
mod symbolic;

pub use lanes::{Lanes, WIDTH};
pub use symbolic::{CFunction, Operations, Recorder, Symbol, SymbolMask};

use std::ops::{Add, Div, Mul, Neg, Sub};

/// A real number, several at once, or the name of one.
///
/// # Numerics
/// `min` and `max` are comparison and selection, so that all instances treat equal and signed-zero arguments alike:
/// `a.min(b)` is `a` if `a < b`, otherwise `b`.
pub trait Real:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self> + Neg<Output = Self>
{
    /// The outcome of a comparison.
    type Mask: Copy;

    /// A constant.
    fn lit(value: f64) -> Self;
    /// Square root, correctly rounded.
    #[must_use]
    fn sqrt(self) -> Self;
    /// Absolute value.
    #[must_use]
    fn abs(self) -> Self;
    /// `self > other`; false where either is not a number.
    fn gt(self, other: Self) -> Self::Mask;
    /// `if_true` where `mask` holds, else `if_false`. Both are computed.
    fn select(mask: Self::Mask, if_true: Self, if_false: Self) -> Self;

    /// `self < other`; false where either is not a number.
    #[inline(always)]
    fn lt(self, other: Self) -> Self::Mask {
        other.gt(self)
    }
    /// The smaller of two.
    #[inline(always)]
    #[must_use]
    fn min(self, other: Self) -> Self {
        Self::select(self.lt(other), self, other)
    }
    /// The larger of two.
    #[inline(always)]
    #[must_use]
    fn max(self, other: Self) -> Self {
        Self::select(self.gt(other), self, other)
    }
    /// `value`, replaced by `then(value)` where `mask` holds: a branch for one number, both sides and a selection for
    /// several, an `if` in printed C. What `then` computes must not be used outside it.
    #[inline(always)]
    fn when<T: Pack<Self>>(mask: Self::Mask, value: T, then: impl Branch<T>) -> T {
        then.taken(value).zip(value, &mut |replaced, kept| Self::select(mask, replaced, kept))
    }
    /// The same number, remembered under a name where names exist (printed C).
    #[inline(always)]
    #[must_use]
    fn named(self, _name: &'static str) -> Self {
        self
    }
}

/// What [`Real::when`] does where its mask holds.
///
/// A closure will do; a type of one's own is inlined for certain, which a long branch needs: a closure that stays a
/// function is compiled without the instruction set of its caller.
pub trait Branch<T> {
    /// The new value.
    fn taken(self, value: T) -> T;
}

impl<T, F: FnOnce(T) -> T> Branch<T> for F {
    #[inline(always)]
    fn taken(self, value: T) -> T {
        self(value)
    }
}

/// A bundle of numbers (one, a vector, a tuple of bundles), so that [`Real::when`] can carry several values.
pub trait Pack<R>: Copy {
    /// Combines two bundles number by number.
    #[must_use]
    fn zip(self, other: Self, combine: &mut impl FnMut(R, R) -> R) -> Self;
}

impl<R: Real> Pack<R> for R {
    #[inline(always)]
    fn zip(self, other: R, combine: &mut impl FnMut(R, R) -> R) -> R {
        combine(self, other)
    }
}

impl<R: Real, A: Pack<R>, B: Pack<R>> Pack<R> for (A, B) {
    #[inline(always)]
    fn zip(self, other: Self, combine: &mut impl FnMut(R, R) -> R) -> Self {
        (self.0.zip(other.0, combine), self.1.zip(other.1, combine))
    }
}

impl<R: Real, A: Pack<R>, B: Pack<R>, C: Pack<R>> Pack<R> for (A, B, C) {
    #[inline(always)]
    fn zip(self, other: Self, combine: &mut impl FnMut(R, R) -> R) -> Self {
        (self.0.zip(other.0, combine), self.1.zip(other.1, combine), self.2.zip(other.2, combine))
    }
}
