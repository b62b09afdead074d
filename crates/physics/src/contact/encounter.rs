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

/// The quantities of a pair in contact that the contact law depends on.
///
/// # Numerics
/// Positions are those of the end of the step. Under velocity Verlet velocities are those of its middle, so that rates are
/// taken with the geometry of the middle: `lead`, the time by which positions are ahead of velocities, is $\Delta t/2$, and
/// the offset there is $\mathbf r - \texttt{lead}(\mathbf v_2-\mathbf v_1)$. With the geometry of the end a body that turns
/// rigidly would have the false relative velocity $\boldsymbol\omega\times(\boldsymbol\omega\times\mathbf r)\Delta t/2$ in
/// each of its contacts. Where positions and velocities belong to the same time (Gear's integrator, a state at rest),
/// `lead` is 0.
#[derive(Clone, Copy, Debug)]
pub struct Encounter<R> {
    /// $\mathbf n$ from the first body to the second, at the end of the step: the direction of the normal force.
    pub normal: Vec3<R>,
    /// $h$ at the end of the step, m.
    pub overlap: R,
    /// $v_n = \mathbf v_c\cdot\mathbf n$ in the geometry that velocities belong to, m/s; negative while approaching.
    pub normal_speed: R,
    /// $\mathbf v_t = \mathbf v_c - v_n\mathbf n$ in the geometry that velocities belong to, projected onto the plane of
    /// contact of the end of the step, m/s.
    pub tangential_velocity: Vec3<R>,
    /// $\mathbf v_c$ of the end of the step, in its geometry, as well as it is known, m/s. Only losses depend on it: forces
    /// of the end of a step do work at the velocity there, and a ledger that took the earlier one would close to first order
    /// only.
    pub settled_velocity: Vec3<R>,
    /// Unit bisector of the normals of the beginning and of the end of the step: a stored displacement turns with the normal
    /// by twice the angle between it and [`Self::normal`].
    pub bisector: Vec3<R>,
    /// $\tfrac12(\boldsymbol\omega_1+\boldsymbol\omega_2)\cdot\mathbf n$, rad/s: the rate at which a stored displacement
    /// turns about the normal.
    pub mean_spin: R,
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
    /// | argument | symbol | unit |
    /// |---|---|---|
    /// | `first`, `second` | $R, \mathbf v, m, \boldsymbol\omega$ | m, m/s, kg, rad/s |
    /// | `touch` | offset, distance and overlap of the end of the step | m |
    /// | `spin` | without it (models without moments) the angular velocities are not looked at | |
    /// | `lead` | time by which positions are ahead of velocities | s |
    #[inline(always)]
    pub fn of_spheres(first: &Sphere<R>, second: &Sphere<R>, touch: &Touch<R>, spin: bool, lead: R) -> Self {
        let normal = (touch.offset * (R::lit(1.0) / touch.distance)).named(["normal_x", "normal_y", "normal_z"]);
        let approach = second.velocity - first.velocity;
        let middle = touch_spheres(touch.offset - approach * lead, first.radius + second.radius);
        let middle_normal = (middle.offset * (R::lit(1.0) / middle.distance)).named([
            "middle_normal_x",
            "middle_normal_y",
            "middle_normal_z",
        ]);
        let velocity_at = |overlap: R, normal: Vec3<R>| {
            if !spin {
                return approach;
            }
            let arms = [lever_arm(first.radius, overlap), lever_arm(second.radius, overlap)];
            let rolling = first.angular_velocity * arms[0] + second.angular_velocity * arms[1];
            approach - rolling.cross(normal)
        };
        let (normal_speed, tangential_velocity) =
            rates(velocity_at(middle.overlap, middle_normal), middle_normal, normal);
        let mean_spin = if spin {
            (R::lit(0.5) * (first.angular_velocity + second.angular_velocity).dot(normal)).named("mean_spin")
        } else {
            R::lit(0.0)
        };
        Encounter {
            normal,
            overlap: touch.overlap,
            normal_speed,
            tangential_velocity,
            settled_velocity: velocity_at(touch.overlap, normal),
            bisector: middle_normal,
            mean_spin,
            radius_eff: radius_eff(first.radius, second.radius).named("radius_eff"),
            mass_eff: (first.mass * second.mass / (first.mass + second.mass)).named("mass_eff"),
        }
    }

    /// A sphere and a plane wall moving at `wall_velocity`: the limit $R_2, m_2 \to \infty$, so $R^* = R$, $m^* = m$ and
    /// the lever arm is $R - h/2$. A wall does not turn.
    #[inline(always)]
    pub fn with_wall(
        sphere: &Sphere<R>,
        touch: &Touch<R>,
        wall_normal: Vec3<R>,
        wall_velocity: Vec3<R>,
        spin: bool,
        lead: R,
    ) -> Self {
        let normal = -wall_normal;
        let approach = wall_velocity - sphere.velocity;
        let middle_overlap = touch.overlap + lead * approach.dot(normal);
        let velocity_at = |overlap: R| {
            if !spin {
                return approach;
            }
            approach - (sphere.angular_velocity * lever_arm(sphere.radius, overlap)).cross(normal)
        };
        let (normal_speed, tangential_velocity) = rates(velocity_at(middle_overlap), normal, normal);
        let mean_spin = if spin { R::lit(0.5) * sphere.angular_velocity.dot(normal) } else { R::lit(0.0) };
        Encounter {
            normal,
            overlap: touch.overlap,
            normal_speed,
            tangential_velocity,
            settled_velocity: velocity_at(touch.overlap),
            bisector: normal,
            mean_spin,
            radius_eff: sphere.radius,
            mass_eff: sphere.mass,
        }
    }

    /// Adds the change of velocities in the second half of the step, estimated by that in the first: `kicks` are the changes
    /// of velocity and angular velocity (times lever arm) of the first and the second body in a half step.
    #[inline(always)]
    #[must_use]
    pub fn settled(self, kicks: [Kick<R>; 2]) -> Self {
        let [first, second] = kicks;
        let rolling = (first.rolling + second.rolling).cross(self.normal);
        let change = (second.velocity - first.velocity) - rolling;
        Encounter { settled_velocity: self.settled_velocity + change, ..self }
    }

    /// The same contact after its history was advanced: a step of zero length leaves stored displacements where they are.
    #[inline(always)]
    #[must_use]
    pub fn advanced(self) -> Self {
        Encounter { bisector: self.normal, ..self }
    }
}

/// Normal speed and tangential velocity of a relative velocity, by the normal that it belongs to; the tangential part lies in
/// the plane across the normal of the end of the step.
///
/// # Numerics
/// The angle between the two normals is that of half a step, $\varphi/2$; the projection shortens what lies in the plane of
/// rotation by $\varphi^2/8$, which is of the order of the scheme.
#[inline(always)]
fn rates<R: Real>(velocity: Vec3<R>, velocity_normal: Vec3<R>, normal: Vec3<R>) -> (R, Vec3<R>) {
    let normal_speed = velocity.dot(velocity_normal).named("normal_speed");
    let across = velocity - velocity_normal * normal_speed;
    let tangential = across - normal * across.dot(normal);
    (normal_speed, tangential.named(["tangential_velocity_x", "tangential_velocity_y", "tangential_velocity_z"]))
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
        let encounter = Encounter::with_wall(&sphere, &touch, up, Vec3::zero(), true, 0.0);
        assert!((touch.overlap - overlap).abs() < 1e-15);
        let slip = encounter.tangential_velocity;
        assert!(encounter.normal_speed.abs() < 1e-15 && slip.dot(slip) < 1e-30);
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
            Encounter::of_spheres(a, b, &touch, true, 0.01)
        };
        let (ab, ba) = (meet(&a, &b), meet(&b, &a));
        assert_eq!(ab.normal, -ba.normal);
        assert_eq!((ab.tangential_velocity, ab.bisector), (-ba.tangential_velocity, -ba.bisector));
        assert_eq!((ab.settled_velocity, ab.normal_speed), (-ba.settled_velocity, ba.normal_speed));
        assert_eq!((ab.overlap, ab.radius_eff, ab.mass_eff), (ba.overlap, ba.radius_eff, ba.mass_eff));
    }
}
