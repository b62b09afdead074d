//! Heat that motion makes and work that expansion does, as functions with named inputs and outputs.

use super::Formula;
use crate::Real;
use crate::contact::encounter::radius_eff;
use crate::contact::{self, Interaction};
use crate::heat::dissipation::{self, Dissipation};
use crate::heat::expansion_work;

/// [`Dissipation::heat`].
#[derive(Clone, Copy, Debug)]
pub struct DissipatedHeat;

impl Formula for DissipatedHeat {
    const NAME: &'static str = "dissipated_heat";
    const INPUTS: &'static [&'static str] = &["dissipation", "friction_loss", "damping_loss"];
    const OUTPUTS: &'static [&'static str] = &["energy"];
    type Input<R: Real> = (Dissipation<R>, R, R);
    type Output<R: Real> = (R,);

    #[inline(always)]
    fn apply<R: Real>(&self, (dissipation, friction, damping): Self::Input<R>) -> Self::Output<R> {
        (dissipation.heat(friction, damping),)
    }
}

/// [`dissipation::heat_rate`].
#[derive(Clone, Copy, Debug)]
pub struct HeatRateOfMotion;

impl Formula for HeatRateOfMotion {
    const NAME: &'static str = "heat_rate_of_motion";
    const INPUTS: &'static [&'static str] = &["energy", "heat_dt"];
    const OUTPUTS: &'static [&'static str] = &["heat_rate"];
    type Input<R: Real> = (R, R);
    type Output<R: Real> = (R,);

    #[inline(always)]
    fn apply<R: Real>(&self, (energy, step): Self::Input<R>) -> Self::Output<R> {
        (dissipation::heat_rate(energy, step),)
    }
}

/// [`contact::elastic_force`] of two spheres.
#[derive(Clone, Copy, Debug)]
pub struct ElasticBetweenSpheres;

impl Formula for ElasticBetweenSpheres {
    const NAME: &'static str = "elastic_between_spheres";
    const INPUTS: &'static [&'static str] = &["first_radius", "second_radius", "overlap", "pair"];
    const OUTPUTS: &'static [&'static str] = &["elastic"];
    type Input<R: Real> = (R, R, R, Interaction<R>);
    type Output<R: Real> = (R,);

    #[inline(always)]
    fn apply<R: Real>(&self, (first, second, overlap, pair): Self::Input<R>) -> Self::Output<R> {
        (contact::elastic_force(radius_eff(first, second), overlap, &pair),)
    }
}

/// [`contact::elastic_force`] of a sphere at a wall.
#[derive(Clone, Copy, Debug)]
pub struct ElasticAtWall;

impl Formula for ElasticAtWall {
    const NAME: &'static str = "elastic_at_wall";
    const INPUTS: &'static [&'static str] = &["radius", "overlap", "pair"];
    const OUTPUTS: &'static [&'static str] = &["elastic"];
    type Input<R: Real> = (R, R, Interaction<R>);
    type Output<R: Real> = (R,);

    #[inline(always)]
    fn apply<R: Real>(&self, (radius, overlap, pair): Self::Input<R>) -> Self::Output<R> {
        (contact::elastic_force(radius, overlap, &pair),)
    }
}

/// [`expansion_work::of_bond`].
#[derive(Clone, Copy, Debug)]
pub struct ExpansionWorkOfBond;

impl Formula for ExpansionWorkOfBond {
    const NAME: &'static str = "expansion_work_of_bond";
    const INPUTS: &'static [&'static str] = &["growth", "tension", "bonded_length"];
    const OUTPUTS: &'static [&'static str] = &["work_per_kelvin"];
    type Input<R: Real> = (R, R, R);
    type Output<R: Real> = (R,);

    #[inline(always)]
    fn apply<R: Real>(&self, (growth, tension, bonded_length): Self::Input<R>) -> Self::Output<R> {
        (expansion_work::of_bond(growth, tension, bonded_length),)
    }
}

/// [`expansion_work::of_softening`].
#[derive(Clone, Copy, Debug)]
pub struct SofteningWork;

impl Formula for SofteningWork {
    const NAME: &'static str = "softening_work";
    const INPUTS: &'static [&'static str] = &["energy", "factor", "slope"];
    const OUTPUTS: &'static [&'static str] = &["work_per_kelvin"];
    type Input<R: Real> = (R, R, R);
    type Output<R: Real> = (R,);

    #[inline(always)]
    fn apply<R: Real>(&self, (energy, factor, slope): Self::Input<R>) -> Self::Output<R> {
        (expansion_work::of_softening(energy, factor, slope),)
    }
}

/// [`expansion_work::of_contacts`].
#[derive(Clone, Copy, Debug)]
pub struct ExpansionWorkOfContacts;

impl Formula for ExpansionWorkOfContacts {
    const NAME: &'static str = "expansion_work_of_contacts";
    const INPUTS: &'static [&'static str] = &["pressure", "expansion", "reference_radius"];
    const OUTPUTS: &'static [&'static str] = &["work_per_kelvin"];
    type Input<R: Real> = (R, R, R);
    type Output<R: Real> = (R,);

    #[inline(always)]
    fn apply<R: Real>(&self, (pressure, expansion, reference_radius): Self::Input<R>) -> Self::Output<R> {
        (expansion_work::of_contacts(pressure, expansion, reference_radius),)
    }
}

/// [`expansion_work::half_step`].
#[derive(Clone, Copy, Debug)]
pub struct HalfStepOfWork;

impl Formula for HalfStepOfWork {
    const NAME: &'static str = "half_step_of_work";
    const INPUTS: &'static [&'static str] = &["work_per_kelvin", "warming"];
    const OUTPUTS: &'static [&'static str] = &["work"];
    type Input<R: Real> = (R, R);
    type Output<R: Real> = (R,);

    #[inline(always)]
    fn apply<R: Real>(&self, (work_per_kelvin, warming): Self::Input<R>) -> Self::Output<R> {
        (expansion_work::half_step(work_per_kelvin, warming),)
    }
}
