//! The laws that kernels call, as functions with named inputs and outputs.

use super::Formula;
use crate::contact::encounter::lever_arm;
use crate::contact::{self, Encounter, Interaction, Law, Period, Response, Sphere, Touch};
use crate::motion::{self, gear, gear::Trajectory, ramp, verlet};
use crate::{Real, Vec3};

/// [`Period::nearest`].
#[derive(Clone, Copy, Debug)]
pub struct NearestImage;

impl Formula for NearestImage {
    const NAME: &'static str = "nearest_image";
    const INPUTS: &'static [&'static str] = &["period", "offset"];
    const OUTPUTS: &'static [&'static str] = &["nearest"];
    type Input<R: Real> = (Period<R>, Vec3<R>);
    type Output<R: Real> = (Vec3<R>,);

    #[inline(always)]
    fn apply<R: Real>(&self, (period, offset): Self::Input<R>) -> Self::Output<R> {
        (period.nearest(offset),)
    }
}

/// [`contact::touch_spheres`].
#[derive(Clone, Copy, Debug)]
pub struct TouchOfSpheres;

impl Formula for TouchOfSpheres {
    const NAME: &'static str = "touch_of_spheres";
    const INPUTS: &'static [&'static str] = &["offset", "radius_sum"];
    const OUTPUTS: &'static [&'static str] = &["touch"];
    type Input<R: Real> = (Vec3<R>, R);
    type Output<R: Real> = (Touch<R>,);

    #[inline(always)]
    fn apply<R: Real>(&self, (offset, radius_sum): Self::Input<R>) -> Self::Output<R> {
        (contact::touch_spheres(offset, radius_sum),)
    }
}

/// [`contact::touch_wall`].
#[derive(Clone, Copy, Debug)]
pub struct TouchOfWall;

impl Formula for TouchOfWall {
    const NAME: &'static str = "touch_of_wall";
    const INPUTS: &'static [&'static str] = &["position", "radius", "wall_point", "wall_normal"];
    const OUTPUTS: &'static [&'static str] = &["touch"];
    type Input<R: Real> = (Vec3<R>, R, Vec3<R>, Vec3<R>);
    type Output<R: Real> = (Touch<R>,);

    #[inline(always)]
    fn apply<R: Real>(&self, (position, radius, wall_point, wall_normal): Self::Input<R>) -> Self::Output<R> {
        (contact::touch_wall(position, radius, wall_point, wall_normal),)
    }
}

/// [`lever_arm`].
#[derive(Clone, Copy, Debug)]
pub struct LeverArm;

impl Formula for LeverArm {
    const NAME: &'static str = "lever_arm";
    const INPUTS: &'static [&'static str] = &["radius", "overlap"];
    const OUTPUTS: &'static [&'static str] = &["arm"];
    type Input<R: Real> = (R, R);
    type Output<R: Real> = (R,);

    #[inline(always)]
    fn apply<R: Real>(&self, (radius, overlap): Self::Input<R>) -> Self::Output<R> {
        (lever_arm(radius, overlap),)
    }
}

/// Two spheres that touch: [`Encounter::of_spheres`] and [`contact::respond`].
#[derive(Clone, Copy, Debug)]
pub struct ContactOfSpheres {
    /// Which law acts; the angular velocities are looked at if it has moments.
    pub law: Law,
}

impl Formula for ContactOfSpheres {
    const NAME: &'static str = "contact_of_spheres";
    const INPUTS: &'static [&'static str] = &["first", "second", "touch", "displacement", "pair", "dt", "lead"];
    const OUTPUTS: &'static [&'static str] = &["response"];
    type Input<R: Real> = (Sphere<R>, Sphere<R>, Touch<R>, Vec3<R>, Interaction<R>, R, R);
    type Output<R: Real> = (Response<R>,);

    #[inline(always)]
    fn apply<R: Real>(&self, (first, second, touch, displacement, pair, dt, lead): Self::Input<R>) -> Self::Output<R> {
        let encounter = Encounter::of_spheres(&first, &second, &touch, self.law.moments, lead);
        (contact::respond(self.law, &encounter, displacement, &pair, dt),)
    }
}

/// A sphere that touches a wall: [`Encounter::with_wall`] and [`contact::respond`].
#[derive(Clone, Copy, Debug)]
pub struct ContactWithWall {
    /// Which law acts; the angular velocity is looked at if it has moments.
    pub law: Law,
}

impl Formula for ContactWithWall {
    const NAME: &'static str = "contact_with_wall";
    const INPUTS: &'static [&'static str] =
        &["sphere", "touch", "wall_normal", "wall_velocity", "displacement", "pair", "dt", "lead"];
    const OUTPUTS: &'static [&'static str] = &["response"];
    type Input<R: Real> = (Sphere<R>, Touch<R>, Vec3<R>, Vec3<R>, Vec3<R>, Interaction<R>, R, R);
    type Output<R: Real> = (Response<R>,);

    #[inline(always)]
    fn apply<R: Real>(
        &self,
        (sphere, touch, wall_normal, wall_velocity, displacement, pair, dt, lead): Self::Input<R>,
    ) -> Self::Output<R> {
        let encounter = Encounter::with_wall(&sphere, &touch, wall_normal, wall_velocity, self.law.moments, lead);
        (contact::respond(self.law, &encounter, displacement, &pair, dt),)
    }
}

/// As [`ContactOfSpheres`], with losses at the velocities that the kicks settle: [`Encounter::settled`].
#[derive(Clone, Copy, Debug)]
pub struct SettledContactOfSpheres {
    /// Which law acts.
    pub law: Law,
}

impl Formula for SettledContactOfSpheres {
    const NAME: &'static str = "settled_contact_of_spheres";
    const INPUTS: &'static [&'static str] =
        &["first", "second", "touch", "first_kick", "second_kick", "displacement", "pair", "dt", "lead"];
    const OUTPUTS: &'static [&'static str] = &["response"];
    type Input<R: Real> =
        (Sphere<R>, Sphere<R>, Touch<R>, contact::Kick<R>, contact::Kick<R>, Vec3<R>, Interaction<R>, R, R);
    type Output<R: Real> = (Response<R>,);

    #[inline(always)]
    fn apply<R: Real>(
        &self,
        (first, second, touch, first_kick, second_kick, displacement, pair, dt, lead): Self::Input<R>,
    ) -> Self::Output<R> {
        let encounter =
            Encounter::of_spheres(&first, &second, &touch, self.law.moments, lead).settled([first_kick, second_kick]);
        (contact::respond(self.law, &encounter, displacement, &pair, dt),)
    }
}

/// As [`ContactWithWall`], with losses at the velocity that the kick settles: [`Encounter::settled`].
#[derive(Clone, Copy, Debug)]
pub struct SettledContactWithWall {
    /// Which law acts.
    pub law: Law,
}

impl Formula for SettledContactWithWall {
    const NAME: &'static str = "settled_contact_with_wall";
    const INPUTS: &'static [&'static str] =
        &["sphere", "touch", "wall_normal", "wall_velocity", "sphere_kick", "displacement", "pair", "dt", "lead"];
    const OUTPUTS: &'static [&'static str] = &["response"];
    type Input<R: Real> = (Sphere<R>, Touch<R>, Vec3<R>, Vec3<R>, contact::Kick<R>, Vec3<R>, Interaction<R>, R, R);
    type Output<R: Real> = (Response<R>,);

    #[inline(always)]
    fn apply<R: Real>(
        &self,
        (sphere, touch, wall_normal, wall_velocity, sphere_kick, displacement, pair, dt, lead): Self::Input<R>,
    ) -> Self::Output<R> {
        let encounter = Encounter::with_wall(&sphere, &touch, wall_normal, wall_velocity, self.law.moments, lead)
            .settled([sphere_kick, contact::Kick::none()]);
        (contact::respond(self.law, &encounter, displacement, &pair, dt),)
    }
}

/// [`contact::released_energy`] of two spheres that have parted.
#[derive(Clone, Copy, Debug)]
pub struct ReleasedBySpheres {
    /// Which law acted.
    pub law: Law,
}

impl Formula for ReleasedBySpheres {
    const NAME: &'static str = "released_by_spheres";
    const INPUTS: &'static [&'static str] = &["first", "second", "touch", "displacement", "pair", "dt", "lead"];
    const OUTPUTS: &'static [&'static str] = &["energy"];
    type Input<R: Real> = (Sphere<R>, Sphere<R>, Touch<R>, Vec3<R>, Interaction<R>, R, R);
    type Output<R: Real> = (R,);

    #[inline(always)]
    fn apply<R: Real>(&self, (first, second, touch, displacement, pair, dt, lead): Self::Input<R>) -> Self::Output<R> {
        let encounter = Encounter::of_spheres(&first, &second, &touch, self.law.moments, lead);
        (contact::released_energy(&encounter, displacement, &pair, dt),)
    }
}

/// [`contact::released_energy`] of a sphere that has parted from a wall.
#[derive(Clone, Copy, Debug)]
pub struct ReleasedByWall {
    /// Which law acted.
    pub law: Law,
}

impl Formula for ReleasedByWall {
    const NAME: &'static str = "released_by_wall";
    const INPUTS: &'static [&'static str] =
        &["sphere", "touch", "wall_normal", "wall_velocity", "displacement", "pair", "dt", "lead"];
    const OUTPUTS: &'static [&'static str] = &["energy"];
    type Input<R: Real> = (Sphere<R>, Touch<R>, Vec3<R>, Vec3<R>, Vec3<R>, Interaction<R>, R, R);
    type Output<R: Real> = (R,);

    #[inline(always)]
    fn apply<R: Real>(
        &self,
        (sphere, touch, wall_normal, wall_velocity, displacement, pair, dt, lead): Self::Input<R>,
    ) -> Self::Output<R> {
        let encounter = Encounter::with_wall(&sphere, &touch, wall_normal, wall_velocity, self.law.moments, lead);
        (contact::released_energy(&encounter, displacement, &pair, dt),)
    }
}

/// [`contact::stored_energy`].
#[derive(Clone, Copy, Debug)]
pub struct StoredEnergy;

impl Formula for StoredEnergy {
    const NAME: &'static str = "stored_energy";
    const INPUTS: &'static [&'static str] = &["radius_eff", "overlap", "displacement", "pair"];
    const OUTPUTS: &'static [&'static str] = &["normal_energy", "tangential_energy"];
    type Input<R: Real> = (R, R, Vec3<R>, Interaction<R>);
    type Output<R: Real> = (R, R);

    #[inline(always)]
    fn apply<R: Real>(&self, (radius_eff, overlap, displacement, pair): Self::Input<R>) -> Self::Output<R> {
        contact::stored_energy(radius_eff, overlap, displacement, &pair)
    }
}

/// [`motion::sphere_inertia`].
#[derive(Clone, Copy, Debug)]
pub struct SphereInertia;

impl Formula for SphereInertia {
    const NAME: &'static str = "sphere_inertia";
    const INPUTS: &'static [&'static str] = &["mass", "radius"];
    const OUTPUTS: &'static [&'static str] = &["inertia"];
    type Input<R: Real> = (R, R);
    type Output<R: Real> = (R,);

    #[inline(always)]
    fn apply<R: Real>(&self, (mass, radius): Self::Input<R>) -> Self::Output<R> {
        (motion::sphere_inertia(mass, radius),)
    }
}

/// [`verlet::kick`].
#[derive(Clone, Copy, Debug)]
pub struct Kick;

impl Formula for Kick {
    const NAME: &'static str = "kick";
    const INPUTS: &'static [&'static str] = &["velocity", "force", "mass", "dt"];
    const OUTPUTS: &'static [&'static str] = &["kicked"];
    type Input<R: Real> = (Vec3<R>, Vec3<R>, R, R);
    type Output<R: Real> = (Vec3<R>,);

    #[inline(always)]
    fn apply<R: Real>(&self, (velocity, force, mass, dt): Self::Input<R>) -> Self::Output<R> {
        (verlet::kick(velocity, force, mass, dt),)
    }
}

/// [`verlet::drift`].
#[derive(Clone, Copy, Debug)]
pub struct Drift;

impl Formula for Drift {
    const NAME: &'static str = "drift";
    const INPUTS: &'static [&'static str] = &["position", "velocity", "dt"];
    const OUTPUTS: &'static [&'static str] = &["drifted"];
    type Input<R: Real> = (Vec3<R>, Vec3<R>, R);
    type Output<R: Real> = (Vec3<R>,);

    #[inline(always)]
    fn apply<R: Real>(&self, (position, velocity, dt): Self::Input<R>) -> Self::Output<R> {
        (verlet::drift(position, velocity, dt),)
    }
}

/// [`ramp::line`].
#[derive(Clone, Copy, Debug)]
pub struct RampLine;

impl Formula for RampLine {
    const NAME: &'static str = "ramp_line";
    const INPUTS: &'static [&'static str] = &["start", "start_value", "end", "end_value", "time"];
    const OUTPUTS: &'static [&'static str] = &["value"];
    type Input<R: Real> = (R, R, R, R, R);
    type Output<R: Real> = (R,);

    #[inline(always)]
    fn apply<R: Real>(&self, (start, start_value, end, end_value, time): Self::Input<R>) -> Self::Output<R> {
        (ramp::line([start, start_value], [end, end_value], time),)
    }
}

/// [`gear::predict`].
#[derive(Clone, Copy, Debug)]
pub struct GearPredict;

impl Formula for GearPredict {
    const NAME: &'static str = "gear_predict";
    const INPUTS: &'static [&'static str] = &["now", "dt"];
    const OUTPUTS: &'static [&'static str] = &["predicted"];
    type Input<R: Real> = (Trajectory<R>, R);
    type Output<R: Real> = (Trajectory<R>,);

    #[inline(always)]
    fn apply<R: Real>(&self, (now, dt): Self::Input<R>) -> Self::Output<R> {
        (gear::predict(&now, dt),)
    }
}

/// [`gear::correct`].
#[derive(Clone, Copy, Debug)]
pub struct GearCorrect;

impl Formula for GearCorrect {
    const NAME: &'static str = "gear_correct";
    const INPUTS: &'static [&'static str] = &["predicted", "force", "mass", "dt"];
    const OUTPUTS: &'static [&'static str] = &["corrected"];
    type Input<R: Real> = (Trajectory<R>, Vec3<R>, R, R);
    type Output<R: Real> = (Trajectory<R>,);

    #[inline(always)]
    fn apply<R: Real>(&self, (predicted, force, mass, dt): Self::Input<R>) -> Self::Output<R> {
        (gear::correct(&predicted, force, mass, dt),)
    }
}
