//! Where a bond lies and how its ends move against each other.

use super::Modes;
use crate::contact::Sphere;
use crate::{Real, Vec3};

/// The two bodies of a bond.
#[derive(Clone, Copy, Debug)]
pub struct Ends<R> {
    /// Of its members only `radius` is looked at everywhere; `position` never is.
    pub first: Sphere<R>,
    /// The other one.
    pub second: Sphere<R>,
    /// From the first centre to the second, the nearest image, m.
    pub offset: Vec3<R>,
    /// Time by which the offset is ahead of the velocities, s: half a step under velocity Verlet, else 0
    /// ([`crate::contact::Encounter`]).
    pub lead: R,
}

impl<R: Real> Ends<R> {
    /// $L$, m.
    #[inline(always)]
    pub(super) fn length(&self) -> R {
        self.offset.dot(self.offset).sqrt().named("bond_length")
    }

    /// The rates of deformation in the geometry that the velocities belong to, m/s and rad/s; vectors lie across the normal of
    /// that geometry.
    #[inline(always)]
    #[must_use]
    pub fn rates(&self) -> Modes<R> {
        let offset = self.offset - (self.second.velocity - self.first.velocity) * self.lead;
        Axis::of(&Ends { offset, ..*self }).motion(self)
    }
}

/// Where a bond lies.
#[derive(Clone, Copy, Debug)]
pub struct Axis<R> {
    /// $\mathbf n$ from the first body to the second.
    pub normal: Vec3<R>,
    /// $L$, m.
    pub length: R,
    /// $d_1 = LR_1/(R_1+R_2)$, m.
    pub first_arm: R,
    /// $d_2 = LR_2/(R_1+R_2)$, m.
    pub second_arm: R,
}

impl<R: Real> Axis<R> {
    /// The axis between two bodies.
    ///
    /// # Numerics
    /// The arms add up to the length, whatever the radii: linear and angular momentum are both conserved. A thermal
    /// growth of the radii that both bodies share does not move the middle.
    #[inline(always)]
    #[must_use]
    pub fn of(ends: &Ends<R>) -> Self {
        let length = ends.length();
        Axis::along(ends, length, R::lit(1.0) / length)
    }

    /// The same of a length $L$ and its inverse.
    #[inline(always)]
    pub(super) fn along(ends: &Ends<R>, length: R, inverse: R) -> Self {
        let normal = (ends.offset * inverse).named(["normal_x", "normal_y", "normal_z"]);
        let (first, second) = (ends.first.radius, ends.second.radius);
        // The inverse of sums that are all alike is found once.
        let length_per_radius = length * (R::lit(1.0) / (first + second));
        Axis {
            normal,
            length,
            first_arm: (length_per_radius * first).named("first_arm"),
            second_arm: (length_per_radius * second).named("second_arm"),
        }
    }

    /// The rates of deformation of a bond along this axis, m/s and rad/s.
    ///
    /// $$\mathbf v_c = \mathbf v_2 - \mathbf v_1 - (d_1\boldsymbol\omega_1 + d_2\boldsymbol\omega_2)\times\mathbf n,\qquad
    /// \boldsymbol\omega_r = \boldsymbol\omega_2 - \boldsymbol\omega_1$$
    ///
    /// # Returns
    /// $\mathbf v_c\cdot\mathbf n$, $\mathbf v_c - (\mathbf v_c\cdot\mathbf n)\mathbf n$, $\boldsymbol\omega_r\cdot\mathbf
    /// n$, $\boldsymbol\omega_r - (\boldsymbol\omega_r\cdot\mathbf n)\mathbf n$.
    #[inline(always)]
    #[must_use]
    pub fn motion(&self, ends: &Ends<R>) -> Modes<R> {
        let (first, second) = (&ends.first, &ends.second);
        let rolling = first.angular_velocity * self.first_arm + second.angular_velocity * self.second_arm;
        let velocity = second.velocity - first.velocity - rolling.cross(self.normal);
        let spin = second.angular_velocity - first.angular_velocity;
        let stretching = velocity.dot(self.normal).named("stretching");
        let twisting = spin.dot(self.normal).named("twisting");
        Modes {
            normal: stretching,
            shear: velocity - self.normal * stretching,
            torsion: twisting,
            bending: spin - self.normal * twisting,
        }
    }

    /// [`Ends::rates`] with vectors projected onto the plane across this axis.
    #[inline(always)]
    #[must_use]
    pub fn rates(&self, ends: &Ends<R>) -> Modes<R> {
        let rates = ends.rates();
        Modes { shear: self.across(rates.shear), bending: self.across(rates.bending), ..rates }
    }

    /// The part of a vector across the axis.
    #[inline(always)]
    fn across(&self, vector: Vec3<R>) -> Vec3<R> {
        vector - self.normal * vector.dot(self.normal)
    }

    /// $M_t\mathbf n + \mathbf M_b$ of a load.
    #[inline(always)]
    #[must_use]
    pub fn couple(&self, load: &Modes<R>) -> Vec3<R> {
        self.normal * load.torsion + load.bending
    }
}
