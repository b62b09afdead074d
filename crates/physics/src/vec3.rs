//! Vectors of three reals.

use crate::real::{Pack, Real};
use std::ops::{Add, Mul, Neg, Sub};

/// A vector in space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vec3<R> {
    /// First component.
    pub x: R,
    /// Second component.
    pub y: R,
    /// Third component.
    pub z: R,
}

/// A vector from its components.
#[inline(always)]
pub const fn vec3<R>(x: R, y: R, z: R) -> Vec3<R> {
    Vec3 { x, y, z }
}

impl<R: Real> Vec3<R> {
    /// The null vector.
    #[inline(always)]
    #[must_use]
    pub fn zero() -> Self {
        vec3(R::lit(0.0), R::lit(0.0), R::lit(0.0))
    }
    /// Scalar product, summed in the order x, y, z.
    #[inline(always)]
    pub fn dot(self, other: Self) -> R {
        self.x * other.x + self.y * other.y + self.z * other.z
    }
    /// Vector product.
    #[inline(always)]
    #[must_use]
    pub fn cross(self, other: Self) -> Self {
        vec3(
            self.y * other.z - self.z * other.y,
            self.z * other.x - self.x * other.z,
            self.x * other.y - self.y * other.x,
        )
    }
    /// Applies a function to each component.
    #[inline(always)]
    #[must_use]
    pub fn map<S>(self, mut function: impl FnMut(R) -> S) -> Vec3<S> {
        vec3(function(self.x), function(self.y), function(self.z))
    }
    /// `if_true` where `mask` holds, else `if_false`.
    #[inline(always)]
    #[must_use]
    pub fn select(mask: R::Mask, if_true: Self, if_false: Self) -> Self {
        if_true.zip(if_false, &mut |a, b| R::select(mask, a, b))
    }
    /// The same vector, its components remembered under names where names exist.
    #[inline(always)]
    #[must_use]
    pub fn named(self, names: [&'static str; 3]) -> Self {
        vec3(self.x.named(names[0]), self.y.named(names[1]), self.z.named(names[2]))
    }
}

impl<R: Real> Add for Vec3<R> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        vec3(self.x + other.x, self.y + other.y, self.z + other.z)
    }
}
impl<R: Real> Sub for Vec3<R> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        vec3(self.x - other.x, self.y - other.y, self.z - other.z)
    }
}
impl<R: Real> Mul<R> for Vec3<R> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, factor: R) -> Self {
        vec3(self.x * factor, self.y * factor, self.z * factor)
    }
}
impl<R: Real> Neg for Vec3<R> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        vec3(-self.x, -self.y, -self.z)
    }
}
impl<R: Real> Pack<R> for Vec3<R> {
    #[inline(always)]
    fn zip(self, other: Self, combine: &mut impl FnMut(R, R) -> R) -> Self {
        vec3(combine(self.x, other.x), combine(self.y, other.y), combine(self.z, other.z))
    }
}
impl From<[f64; 3]> for Vec3<f64> {
    fn from([x, y, z]: [f64; 3]) -> Self {
        vec3(x, y, z)
    }
}
impl From<Vec3<f64>> for [f64; 3] {
    fn from(v: Vec3<f64>) -> Self {
        [v.x, v.y, v.z]
    }
}
