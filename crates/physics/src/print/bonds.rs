//! The laws of bonds that kernels call, as functions with named inputs and outputs.

use super::Formula;
use crate::bond::{
    self, Advance, Bond, Damping, Ends, History, Joint, Modes, Posture, Reaction, Rest, Tension, damping,
};
use crate::contact::{self, Encounter, Interaction, Sphere, Touch};
use crate::motion::local_damping;
use crate::motion::orientation::Quaternion;
use crate::{Real, Vec3};

/// [`Joint::bond_of_spheres`].
#[derive(Clone, Copy, Debug)]
pub struct BondBetween {
    /// Whether there are dashpots; masses are looked at if there are.
    pub damping: Damping,
}

impl Formula for BondBetween {
    const NAME: &'static str = "bond_between";
    const INPUTS: &'static [&'static str] = &["joint", "first", "second", "bonded_length", "strength"];
    const OUTPUTS: &'static [&'static str] = &["bond"];
    type Input<R: Real> = (Joint<R>, Sphere<R>, Sphere<R>, R, R);
    type Output<R: Real> = (Bond<R>,);

    #[inline(always)]
    fn apply<R: Real>(&self, (joint, first, second, bonded_length, strength): Self::Input<R>) -> Self::Output<R> {
        (joint.bond_of_spheres(self.damping, &first, &second, bonded_length, strength),)
    }
}

/// [`Bond::tempered`].
#[derive(Clone, Copy, Debug)]
pub struct BondTempered;

impl Formula for BondTempered {
    const NAME: &'static str = "bond_tempered";
    const INPUTS: &'static [&'static str] = &["bond", "stiffness", "strength"];
    const OUTPUTS: &'static [&'static str] = &["tempered"];
    type Input<R: Real> = (Bond<R>, R, R);
    type Output<R: Real> = (Bond<R>,);

    #[inline(always)]
    fn apply<R: Real>(&self, (bond, stiffness, strength): Self::Input<R>) -> Self::Output<R> {
        (bond.tempered(stiffness, strength),)
    }
}

/// [`Rest::of`].
#[derive(Clone, Copy, Debug)]
pub struct BondRest;

impl Formula for BondRest {
    const NAME: &'static str = "bond_rest";
    const INPUTS: &'static [&'static str] = &["bonded_length", "free_strain", "earlier_free_strain"];
    const OUTPUTS: &'static [&'static str] = &["rest"];
    type Input<R: Real> = (R, R, R);
    type Output<R: Real> = (Rest<R>,);

    #[inline(always)]
    fn apply<R: Real>(&self, (bonded_length, free_strain, earlier): Self::Input<R>) -> Self::Output<R> {
        (Rest::of(bonded_length, free_strain, earlier),)
    }
}

/// [`bond::respond_total`].
#[derive(Clone, Copy, Debug)]
pub struct BondTotal {
    /// Whether there are dashpots; velocities are looked at if there are.
    pub damping: Damping,
}

impl Formula for BondTotal {
    const NAME: &'static str = "bond_total";
    const INPUTS: &'static [&'static str] = &["first", "second", "offset", "posture", "bond", "lead"];
    const OUTPUTS: &'static [&'static str] = &["reaction"];
    type Input<R: Real> = (Sphere<R>, Sphere<R>, Vec3<R>, Posture<R>, Bond<R>, R);
    type Output<R: Real> = (Reaction<R>,);

    #[inline(always)]
    fn apply<R: Real>(&self, (first, second, offset, posture, bond, lead): Self::Input<R>) -> Self::Output<R> {
        (bond::respond_total(self.damping, &Ends { first, second, offset, lead }, &posture, &bond),)
    }
}

/// [`bond::respond_incremental`].
#[derive(Clone, Copy, Debug)]
pub struct BondIncremental {
    /// Where the normal force comes from.
    pub tension: Tension,
    /// Whether there are dashpots.
    pub damping: Damping,
}

impl Formula for BondIncremental {
    const NAME: &'static str = "bond_incremental";
    const INPUTS: &'static [&'static str] = &["first", "second", "offset", "advance", "bond", "lead"];
    const OUTPUTS: &'static [&'static str] = &["history", "reaction"];
    type Input<R: Real> = (Sphere<R>, Sphere<R>, Vec3<R>, Advance<R>, Bond<R>, R);
    type Output<R: Real> = (History<R>, Reaction<R>);

    #[inline(always)]
    fn apply<R: Real>(&self, (first, second, offset, advance, bond, lead): Self::Input<R>) -> Self::Output<R> {
        let ends = Ends { first, second, offset, lead };
        bond::respond_incremental(self.tension, self.damping, &ends, &advance, &bond)
    }
}

/// [`History::reversed`].
#[derive(Clone, Copy, Debug)]
pub struct ReversedHistory;

impl Formula for ReversedHistory {
    const NAME: &'static str = "reversed_history";
    const INPUTS: &'static [&'static str] = &["history"];
    const OUTPUTS: &'static [&'static str] = &["reversed"];
    type Input<R: Real> = (History<R>,);
    type Output<R: Real> = (History<R>,);

    #[inline(always)]
    fn apply<R: Real>(&self, (history,): Self::Input<R>) -> Self::Output<R> {
        (history.reversed(),)
    }
}

/// [`damping::loss`].
#[derive(Clone, Copy, Debug)]
pub struct BondLoss;

impl Formula for BondLoss {
    const NAME: &'static str = "bond_loss";
    const INPUTS: &'static [&'static str] =
        &["first", "second", "settled_first", "settled_second", "offset", "bond", "dt", "lead"];
    const OUTPUTS: &'static [&'static str] = &["loss"];
    type Input<R: Real> = (Sphere<R>, Sphere<R>, Sphere<R>, Sphere<R>, Vec3<R>, Bond<R>, R, R);
    type Output<R: Real> = (R,);

    #[inline(always)]
    fn apply<R: Real>(
        &self,
        (first, second, settled_first, settled_second, offset, bond, dt, lead): Self::Input<R>,
    ) -> Self::Output<R> {
        let settled = Ends { first: settled_first, second: settled_second, offset, lead: R::lit(0.0) };
        (damping::loss(&Ends { first, second, offset, lead }, &settled, &bond, dt),)
    }
}

/// [`bond::stored_energy`].
#[derive(Clone, Copy, Debug)]
pub struct BondEnergy;

impl Formula for BondEnergy {
    const NAME: &'static str = "bond_energy";
    const INPUTS: &'static [&'static str] = &["load", "bond"];
    const OUTPUTS: &'static [&'static str] = &["energy"];
    type Input<R: Real> = (Modes<R>, Bond<R>);
    type Output<R: Real> = (R,);

    #[inline(always)]
    fn apply<R: Real>(&self, (load, bond): Self::Input<R>) -> Self::Output<R> {
        (bond::stored_energy(&load, &bond),)
    }
}

/// [`bond::released_energy`].
#[derive(Clone, Copy, Debug)]
pub struct BondRelease;

impl Formula for BondRelease {
    const NAME: &'static str = "bond_release";
    const INPUTS: &'static [&'static str] = &["first", "second", "offset", "load", "bond", "dt", "lead"];
    const OUTPUTS: &'static [&'static str] = &["energy"];
    type Input<R: Real> = (Sphere<R>, Sphere<R>, Vec3<R>, Modes<R>, Bond<R>, R, R);
    type Output<R: Real> = (R,);

    #[inline(always)]
    fn apply<R: Real>(&self, (first, second, offset, load, bond, dt, lead): Self::Input<R>) -> Self::Output<R> {
        (bond::released_energy(&Ends { first, second, offset, lead }, &load, &bond, dt),)
    }
}

/// [`contact::begun_energy`].
#[derive(Clone, Copy, Debug)]
pub struct ContactBegun;

impl Formula for ContactBegun {
    const NAME: &'static str = "contact_begun";
    const INPUTS: &'static [&'static str] = &["first", "second", "touch", "pair", "dt", "lead"];
    const OUTPUTS: &'static [&'static str] = &["energy"];
    type Input<R: Real> = (Sphere<R>, Sphere<R>, Touch<R>, Interaction<R>, R, R);
    type Output<R: Real> = (R,);

    #[inline(always)]
    fn apply<R: Real>(&self, (first, second, touch, pair, dt, lead): Self::Input<R>) -> Self::Output<R> {
        (contact::begun_energy(&Encounter::of_spheres(&first, &second, &touch, true, lead), &pair, dt),)
    }
}

/// [`Quaternion::turned`].
#[derive(Clone, Copy, Debug)]
pub struct TurnOrientation;

impl Formula for TurnOrientation {
    const NAME: &'static str = "turn_orientation";
    const INPUTS: &'static [&'static str] = &["orientation", "angular_velocity", "dt"];
    const OUTPUTS: &'static [&'static str] = &["turned"];
    type Input<R: Real> = (Quaternion<R>, Vec3<R>, R);
    type Output<R: Real> = (Quaternion<R>,);

    #[inline(always)]
    fn apply<R: Real>(&self, (orientation, angular_velocity, dt): Self::Input<R>) -> Self::Output<R> {
        (orientation.turned(angular_velocity, dt),)
    }
}

/// [`local_damping::damped`].
#[derive(Clone, Copy, Debug)]
pub struct LocalDamping;

impl Formula for LocalDamping {
    const NAME: &'static str = "local_damping";
    const INPUTS: &'static [&'static str] = &["force", "velocity", "coefficient"];
    const OUTPUTS: &'static [&'static str] = &["damped"];
    type Input<R: Real> = (Vec3<R>, Vec3<R>, R);
    type Output<R: Real> = (Vec3<R>,);

    #[inline(always)]
    fn apply<R: Real>(&self, (force, velocity, coefficient): Self::Input<R>) -> Self::Output<R> {
        (local_damping::damped(force, velocity, coefficient),)
    }
}
