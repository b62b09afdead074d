//! Who meets whom: the geometry and kinematics of a contact.

use crate::{Real, Vec3, vec3};

/// A sphere as a contact sees it.
#[derive(Clone, Copy, Debug)]
pub struct Sphere<R> {
    /// $\mathbf x$, m.
    pub position: Vec3<R>,
    /// $R$, m.
    pub radius: R,
    /// $\mathbf v$, m/s.
    pub velocity: Vec3<R>,
    /// $m$, kg.
    pub mass: R,
    /// $\boldsymbol\omega$, rad/s.
    pub angular_velocity: Vec3<R>,
}

/// Lengths of a periodic box, m; a direction that does not repeat has `half` infinite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Period<R> {
    /// Length of the box.
    pub length: Vec3<R>,
    /// Half of it, or infinity.
    pub half: Vec3<R>,
}

impl Period<f64> {
    /// A box that repeats in the directions that have a length.
    #[must_use]
    pub fn new(length: [Option<f64>; 3]) -> Self {
        let [x, y, z] = length;
        Period {
            length: vec3(x.unwrap_or(0.0), y.unwrap_or(0.0), z.unwrap_or(0.0)),
            half: vec3(
                x.map_or(f64::INFINITY, |l| 0.5 * l),
                y.map_or(f64::INFINITY, |l| 0.5 * l),
                z.map_or(f64::INFINITY, |l| 0.5 * l),
            ),
        }
    }
    /// Whether any direction repeats.
    #[must_use]
    pub fn any(&self) -> bool {
        self.half.x < f64::INFINITY || self.half.y < f64::INFINITY || self.half.z < f64::INFINITY
    }
}

impl<R: Real> Period<R> {
    /// The shortest of all images of an offset between two points of the box. Exactly odd in `offset`.
    #[inline(always)]
    #[must_use]
    pub fn nearest(&self, offset: Vec3<R>) -> Vec3<R> {
        let one = |offset: R, length: R, half: R| {
            let below = R::select(offset.lt(-half), offset + length, offset);
            R::select(offset.gt(half), offset - length, below)
        };
        vec3(
            one(offset.x, self.length.x, self.half.x),
            one(offset.y, self.length.y, self.half.y),
            one(offset.z, self.length.z, self.half.z),
        )
    }
}

/// How two bodies lie to each other.
#[derive(Clone, Copy, Debug)]
pub struct Touch<R> {
    /// From the first centre to the second, or to the wall's nearest point, m.
    pub offset: Vec3<R>,
    /// Its length $L$, m.
    pub distance: R,
    /// $h$, m; positive in contact.
    pub overlap: R,
}

/// Two spheres, given the offset of their centres: $h = R_1 + R_2 - L$.
#[inline(always)]
pub fn touch_spheres<R: Real>(offset: Vec3<R>, radius_sum: R) -> Touch<R> {
    let distance = offset.dot(offset).sqrt();
    Touch { offset, distance, overlap: radius_sum - distance }
}

/// A sphere and a plane wall whose unit `wall_normal` points to the side where particles are: $h = R - \text{distance}$.
#[inline(always)]
pub fn touch_wall<R: Real>(position: Vec3<R>, radius: R, wall_point: Vec3<R>, wall_normal: Vec3<R>) -> Touch<R> {
    let distance = (position - wall_point).dot(wall_normal);
    Touch { offset: wall_normal * -distance, distance, overlap: radius - distance }
}

/// All that the contact law needs to know of a meeting.
#[derive(Clone, Copy, Debug)]
pub struct Encounter<R> {
    /// $\mathbf n$ from the first body to the second.
    pub normal: Vec3<R>,
    /// $h$, m.
    pub overlap: R,
    /// $\mathbf v_c$, velocity of the second surface relative to the first, m/s. Forces and history see it; under velocity
    /// Verlet it is that of the middle of the step.
    pub relative_velocity: Vec3<R>,
    /// The same at the end of the step, as well as it is known, m/s. Only losses see it: forces at the end of a step do
    /// work at the velocity there, and a ledger that took the earlier one would close to first order only.
    pub settled_velocity: Vec3<R>,
    /// $R^*$, m.
    pub radius_eff: R,
    /// $m^*$, kg.
    pub mass_eff: R,
}

impl<R: Real> Encounter<R> {
    /// Two spheres:
    /// $\mathbf v_c = \mathbf v_2 - \mathbf v_1 - (d_1\boldsymbol\omega_1 + d_2\boldsymbol\omega_2)\times\mathbf n$,
    /// $1/R^* = 1/R_1 + 1/R_2$, $1/m^* = 1/m_1 + 1/m_2$.
    ///
    /// Without `spin` (models without moments) the angular velocities are not looked at.
    #[inline(always)]
    pub fn of_spheres(first: &Sphere<R>, second: &Sphere<R>, touch: &Touch<R>, spin: bool) -> Self {
        let normal = (touch.offset * (R::lit(1.0) / touch.distance)).named(["normal_x", "normal_y", "normal_z"]);
        let arms = [lever_arm(first.radius, touch.overlap), lever_arm(second.radius, touch.overlap)];
        let mut relative_velocity = second.velocity - first.velocity;
        if spin {
            let rolling = first.angular_velocity * arms[0] + second.angular_velocity * arms[1];
            relative_velocity = relative_velocity - rolling.cross(normal);
        }
        Encounter {
            normal,
            overlap: touch.overlap,
            relative_velocity,
            settled_velocity: relative_velocity,
            radius_eff: radius_eff(first.radius, second.radius).named("radius_eff"),
            mass_eff: (first.mass * second.mass / (first.mass + second.mass)).named("mass_eff"),
        }
    }

    /// A sphere and a plane wall moving at `wall_velocity`: the limit $R_2, m_2 \to \infty$, so $R^* = R$, $m^* = m$ and
    /// the lever arm is $R - h/2$.
    #[inline(always)]
    pub fn with_wall(
        sphere: &Sphere<R>,
        touch: &Touch<R>,
        wall_normal: Vec3<R>,
        wall_velocity: Vec3<R>,
        spin: bool,
    ) -> Self {
        let normal = (-wall_normal).named(["normal_x", "normal_y", "normal_z"]);
        let mut relative_velocity = wall_velocity - sphere.velocity;
        if spin {
            let arm = lever_arm(sphere.radius, touch.overlap);
            relative_velocity = relative_velocity - (sphere.angular_velocity * arm).cross(normal);
        }
        Encounter {
            normal,
            overlap: touch.overlap,
            relative_velocity,
            settled_velocity: relative_velocity,
            radius_eff: sphere.radius,
            mass_eff: sphere.mass,
        }
    }

    /// Adds what the second half of the step will change, guessed from the first: `kicks` are the changes of velocity and
    /// angular velocity (times lever arm) of the first and the second body in a half step.
    #[inline(always)]
    #[must_use]
    pub fn settled(self, kicks: [Kick<R>; 2]) -> Self {
        let [first, second] = kicks;
        let rolling = (first.rolling + second.rolling).cross(self.normal);
        let change = (second.velocity - first.velocity) - rolling;
        Encounter { settled_velocity: self.relative_velocity + change, ..self }
    }
}

/// How half a step changed the motion of a body.
#[derive(Clone, Copy, Debug)]
pub struct Kick<R> {
    /// Change of velocity, m/s.
    pub velocity: Vec3<R>,
    /// Change of angular velocity times lever arm, m/s; zero without moments.
    pub rolling: Vec3<R>,
}

impl<R: Real> Kick<R> {
    /// A body that moves as it is told.
    #[must_use]
    #[inline(always)]
    pub fn none() -> Self {
        Kick { velocity: Vec3::zero(), rolling: Vec3::zero() }
    }
}

/// $R^* = R_1R_2/(R_1+R_2)$ of two spheres, m; of a sphere and a plane it is the sphere's radius.
#[inline(always)]
pub fn radius_eff<R: Real>(first: R, second: R) -> R {
    first * second / (first + second)
}

/// $d = R - h/2$, m: the distance from a centre to the contact point. The two arms of a pair add up to the distance of
/// the centres, so that linear and angular momentum are both conserved.
#[inline(always)]
pub fn lever_arm<R: Real>(radius: R, overlap: R) -> R {
    radius - R::lit(0.5) * overlap
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn images_are_nearest_and_exactly_odd() {
        let period = Period::new([Some(1.0), None, Some(2.0)]);
        assert!(period.any());
        let offset = vec3(0.9, 5.0, -1.5);
        let near = period.nearest(offset);
        assert!((near.x + 0.1).abs() < 1e-15 && near.y == 5.0 && near.z == 0.5);
        assert_eq!(period.nearest(-offset), -near);
        assert!(!Period::new([None; 3]).any());
    }

    #[test]
    fn rolling_without_slip_has_no_relative_velocity() {
        // A sphere rolling on a floor: v = omega (R - h/2).
        let (radius, overlap) = (0.1, 0.001);
        let arm = lever_arm(radius, overlap);
        let sphere = Sphere {
            position: vec3(0.0, 0.0, radius - overlap),
            radius,
            velocity: vec3(arm * 3.0, 0.0, 0.0),
            mass: 1.0,
            angular_velocity: vec3(0.0, 3.0, 0.0),
        };
        let up = vec3(0.0, 0.0, 1.0);
        let touch = touch_wall(sphere.position, radius, Vec3::zero(), up);
        let encounter = Encounter::with_wall(&sphere, &touch, up, Vec3::zero(), true);
        assert!((touch.overlap - overlap).abs() < 1e-15);
        assert!(encounter.relative_velocity.dot(encounter.relative_velocity) < 1e-30);
    }

    #[test]
    fn exchange_of_the_bodies_changes_only_signs() {
        let a = Sphere {
            position: vec3(0.0, 0.1, 0.2),
            radius: 0.7,
            velocity: vec3(1.0, 2.0, 3.0),
            mass: 1.3,
            angular_velocity: vec3(0.3, -0.2, 0.9),
        };
        let b = Sphere {
            position: vec3(1.0, 0.3, -0.2),
            radius: 0.6,
            velocity: vec3(-1.0, 0.5, 0.1),
            mass: 0.4,
            angular_velocity: vec3(0.1, 0.2, -0.4),
        };
        let meet = |a: &Sphere<f64>, b: &Sphere<f64>| {
            let touch = touch_spheres(b.position - a.position, a.radius + b.radius);
            Encounter::of_spheres(a, b, &touch, true)
        };
        let (ab, ba) = (meet(&a, &b), meet(&b, &a));
        assert_eq!(ab.normal, -ba.normal);
        assert_eq!(ab.relative_velocity, -ba.relative_velocity);
        assert_eq!((ab.overlap, ab.radius_eff, ab.mass_eff), (ba.overlap, ba.radius_eff, ba.mass_eff));
    }
}
