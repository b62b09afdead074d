//! The laws of heat that kernels call, as functions with named inputs and outputs.

use super::Formula;
use crate::Real;
use crate::contact::Touch;
use crate::heat::{Conductor, Exchange, Link, Outside, Path, conduction, implicit, table, warming};

/// [`conduction::between_spheres`].
#[derive(Clone, Copy, Debug)]
pub struct BetweenSpheres {
    /// How heat goes through contacts.
    pub path: Path,
}

impl Formula for BetweenSpheres {
    const NAME: &'static str = "between_spheres";
    const INPUTS: &'static [&'static str] = &["conductor", "first_radius", "second_radius", "touch"];
    const OUTPUTS: &'static [&'static str] = &["conductance"];
    type Input<R: Real> = (Conductor<R>, R, R, Touch<R>);
    type Output<R: Real> = (R,);

    #[inline(always)]
    fn apply<R: Real>(&self, (conductor, first_radius, second_radius, touch): Self::Input<R>) -> Self::Output<R> {
        (conduction::between_spheres(self.path, &conductor, first_radius, second_radius, &touch),)
    }
}

/// [`conduction::at_wall`].
#[derive(Clone, Copy, Debug)]
pub struct AtWall {
    /// How heat goes through contacts.
    pub path: Path,
}

impl Formula for AtWall {
    const NAME: &'static str = "at_wall";
    const INPUTS: &'static [&'static str] = &["conductor", "radius", "touch"];
    const OUTPUTS: &'static [&'static str] = &["conductance"];
    type Input<R: Real> = (Conductor<R>, R, Touch<R>);
    type Output<R: Real> = (R,);

    #[inline(always)]
    fn apply<R: Real>(&self, (conductor, radius, touch): Self::Input<R>) -> Self::Output<R> {
        (conduction::at_wall(self.path, &conductor, radius, &touch),)
    }
}

/// [`conduction::flow`].
#[derive(Clone, Copy, Debug)]
pub struct HeatFlow;

impl Formula for HeatFlow {
    const NAME: &'static str = "heat_flow";
    const INPUTS: &'static [&'static str] = &["conductance", "first_temperature", "second_temperature"];
    const OUTPUTS: &'static [&'static str] = &["heat_rate"];
    type Input<R: Real> = (R, R, R);
    type Output<R: Real> = (R,);

    #[inline(always)]
    fn apply<R: Real>(&self, (conductance, first_temperature, second_temperature): Self::Input<R>) -> Self::Output<R> {
        (conduction::flow(conductance, first_temperature, second_temperature),)
    }
}

/// [`conduction::tempered`].
#[derive(Clone, Copy, Debug)]
pub struct TemperedConductance;

impl Formula for TemperedConductance {
    const NAME: &'static str = "tempered_conductance";
    const INPUTS: &'static [&'static str] = &["unit_conductance", "first", "second"];
    const OUTPUTS: &'static [&'static str] = &["conductance"];
    type Input<R: Real> = (R, R, R);
    type Output<R: Real> = (R,);

    #[inline(always)]
    fn apply<R: Real>(&self, (unit_conductance, first, second): Self::Input<R>) -> Self::Output<R> {
        (conduction::tempered(unit_conductance, first, second),)
    }
}

/// [`table::mean_temperature`].
#[derive(Clone, Copy, Debug)]
pub struct MeanTemperature;

impl Formula for MeanTemperature {
    const NAME: &'static str = "mean_temperature";
    const INPUTS: &'static [&'static str] = &["first", "second"];
    const OUTPUTS: &'static [&'static str] = &["mean"];
    type Input<R: Real> = (R, R);
    type Output<R: Real> = (R,);

    #[inline(always)]
    fn apply<R: Real>(&self, (first, second): Self::Input<R>) -> Self::Output<R> {
        (table::mean_temperature(first, second),)
    }
}

/// [`table::heat_along`].
#[derive(Clone, Copy, Debug)]
pub struct HeatAlong;

impl Formula for HeatAlong {
    const NAME: &'static str = "heat_along";
    const INPUTS: &'static [&'static str] = &["start", "start_value", "end", "end_value", "from", "to"];
    const OUTPUTS: &'static [&'static str] = &["heat"];
    type Input<R: Real> = (R, R, R, R, R, R);
    type Output<R: Real> = (R,);

    #[inline(always)]
    fn apply<R: Real>(&self, (start, low, end, high, from, to): Self::Input<R>) -> Self::Output<R> {
        (table::heat_along([start, low], [end, high], from, to),)
    }
}

/// [`table::slope`].
#[derive(Clone, Copy, Debug)]
pub struct TableSlope;

impl Formula for TableSlope {
    const NAME: &'static str = "table_slope";
    const INPUTS: &'static [&'static str] = &["start", "start_value", "end", "end_value"];
    const OUTPUTS: &'static [&'static str] = &["slope"];
    type Input<R: Real> = (R, R, R, R);
    type Output<R: Real> = (R,);

    #[inline(always)]
    fn apply<R: Real>(&self, (start, low, end, high): Self::Input<R>) -> Self::Output<R> {
        (table::slope([start, low], [end, high]),)
    }
}

/// [`table::rise`].
#[derive(Clone, Copy, Debug)]
pub struct HeatRise;

impl Formula for HeatRise {
    const NAME: &'static str = "heat_rise";
    const INPUTS: &'static [&'static str] = &["start", "start_value", "end", "end_value", "from", "heat"];
    const OUTPUTS: &'static [&'static str] = &["rise"];
    type Input<R: Real> = (R, R, R, R, R, R);
    type Output<R: Real> = (R,);

    #[inline(always)]
    fn apply<R: Real>(&self, (start, low, end, high, from, heat): Self::Input<R>) -> Self::Output<R> {
        (table::rise([start, low], [end, high], from, heat),)
    }
}

/// [`warming::taken_in`].
#[derive(Clone, Copy, Debug)]
pub struct TakenIn;

impl Formula for TakenIn {
    const NAME: &'static str = "heat_taken_in";
    const INPUTS: &'static [&'static str] = &["heat_rate", "mass", "heat_dt"];
    const OUTPUTS: &'static [&'static str] = &["heat"];
    type Input<R: Real> = (R, R, R);
    type Output<R: Real> = (R,);

    #[inline(always)]
    fn apply<R: Real>(&self, (heat_rate, mass, heat_dt): Self::Input<R>) -> Self::Output<R> {
        (warming::taken_in(heat_rate, mass, heat_dt),)
    }
}

/// [`Link::between`].
#[derive(Clone, Copy, Debug)]
pub struct LinkBetween;

impl Formula for LinkBetween {
    const NAME: &'static str = "link_between";
    const INPUTS: &'static [&'static str] = &["conductor", "radii", "expansions"];
    const OUTPUTS: &'static [&'static str] = &["link"];
    type Input<R: Real> = (Conductor<R>, [R; 2], [R; 2]);
    type Output<R: Real> = (Link<R>,);

    #[inline(always)]
    fn apply<R: Real>(&self, (conductor, radii, expansions): Self::Input<R>) -> Self::Output<R> {
        (Link::between(&conductor, radii, expansions),)
    }
}

/// [`Link::within_side`].
#[derive(Clone, Copy, Debug)]
pub struct LinkWithinSide;

impl Formula for LinkWithinSide {
    const NAME: &'static str = "link_within_side";
    const INPUTS: &'static [&'static str] = &["link"];
    const OUTPUTS: &'static [&'static str] = &["within"];
    type Input<R: Real> = (Link<R>,);
    type Output<R: Real> = (Link<R>,);

    #[inline(always)]
    fn apply<R: Real>(&self, (link,): Self::Input<R>) -> Self::Output<R> {
        (link.within_side(),)
    }
}

/// [`Link::conductance`].
#[derive(Clone, Copy, Debug)]
pub struct LinkConductance;

impl Formula for LinkConductance {
    const NAME: &'static str = "link_conductance";
    const INPUTS: &'static [&'static str] = &["link", "bonded_length"];
    const OUTPUTS: &'static [&'static str] = &["conductance"];
    type Input<R: Real> = (Link<R>, R);
    type Output<R: Real> = (R,);

    #[inline(always)]
    fn apply<R: Real>(&self, (link, bonded_length): Self::Input<R>) -> Self::Output<R> {
        (link.conductance(bonded_length),)
    }
}

/// [`Link::free_strain`].
#[derive(Clone, Copy, Debug)]
pub struct FreeStrain;

impl Formula for FreeStrain {
    const NAME: &'static str = "free_strain";
    const INPUTS: &'static [&'static str] = &["link", "first_warmth", "second_warmth"];
    const OUTPUTS: &'static [&'static str] = &["strain"];
    type Input<R: Real> = (Link<R>, R, R);
    type Output<R: Real> = (R,);

    #[inline(always)]
    fn apply<R: Real>(&self, (link, first_warmth, second_warmth): Self::Input<R>) -> Self::Output<R> {
        (link.free_strain(first_warmth, second_warmth),)
    }
}

/// [`Exchange::heat_rate`].
#[derive(Clone, Copy, Debug)]
pub struct SurfaceHeat;

impl Formula for SurfaceHeat {
    const NAME: &'static str = "surface_heat";
    const INPUTS: &'static [&'static str] = &["exchange", "temperature", "outside"];
    const OUTPUTS: &'static [&'static str] = &["heat_rate"];
    type Input<R: Real> = (Exchange<R>, R, Outside<R>);
    type Output<R: Real> = (R,);

    #[inline(always)]
    fn apply<R: Real>(&self, (exchange, temperature, outside): Self::Input<R>) -> Self::Output<R> {
        (exchange.heat_rate(temperature, &outside),)
    }
}

/// [`Exchange::sensitivity`].
#[derive(Clone, Copy, Debug)]
pub struct SurfaceSensitivity;

impl Formula for SurfaceSensitivity {
    const NAME: &'static str = "surface_sensitivity";
    const INPUTS: &'static [&'static str] = &["exchange", "temperature", "outside"];
    const OUTPUTS: &'static [&'static str] = &["sensitivity"];
    type Input<R: Real> = (Exchange<R>, R, Outside<R>);
    type Output<R: Real> = (R,);

    #[inline(always)]
    fn apply<R: Real>(&self, (exchange, temperature, outside): Self::Input<R>) -> Self::Output<R> {
        (exchange.sensitivity(temperature, &outside),)
    }
}

/// [`Exchange::tempered`].
#[derive(Clone, Copy, Debug)]
pub struct TemperedExchange;

impl Formula for TemperedExchange {
    const NAME: &'static str = "tempered_exchange";
    const INPUTS: &'static [&'static str] = &["exchange", "conductivity"];
    const OUTPUTS: &'static [&'static str] = &["tempered"];
    type Input<R: Real> = (Exchange<R>, R);
    type Output<R: Real> = (Exchange<R>,);

    #[inline(always)]
    fn apply<R: Real>(&self, (exchange, conductivity): Self::Input<R>) -> Self::Output<R> {
        (exchange.tempered(conductivity),)
    }
}

/// [`warming::warmed`].
#[derive(Clone, Copy, Debug)]
pub struct Warmed;

impl Formula for Warmed {
    const NAME: &'static str = "warmed";
    const INPUTS: &'static [&'static str] = &["temperature", "heat_rate", "capacity", "heat_dt"];
    const OUTPUTS: &'static [&'static str] = &["warmer"];
    type Input<R: Real> = (R, R, R, R);
    type Output<R: Real> = (R,);

    #[inline(always)]
    fn apply<R: Real>(&self, (temperature, heat_rate, capacity, heat_dt): Self::Input<R>) -> Self::Output<R> {
        (warming::warmed(temperature, heat_rate, capacity, heat_dt),)
    }
}

/// [`warming::longest_step`].
#[derive(Clone, Copy, Debug)]
pub struct LongestStep;

impl Formula for LongestStep {
    const NAME: &'static str = "longest_step";
    const INPUTS: &'static [&'static str] = &["capacity", "conductance"];
    const OUTPUTS: &'static [&'static str] = &["step"];
    type Input<R: Real> = (R, R);
    type Output<R: Real> = (R,);

    #[inline(always)]
    fn apply<R: Real>(&self, (capacity, conductance): Self::Input<R>) -> Self::Output<R> {
        (warming::longest_step(capacity, conductance),)
    }
}

/// [`warming::grown`].
#[derive(Clone, Copy, Debug)]
pub struct Grown;

impl Formula for Grown {
    const NAME: &'static str = "grown";
    const INPUTS: &'static [&'static str] = &["reference_radius", "expansion", "warmth"];
    const OUTPUTS: &'static [&'static str] = &["radius"];
    type Input<R: Real> = (R, R, R);
    type Output<R: Real> = (R,);

    #[inline(always)]
    fn apply<R: Real>(&self, (reference_radius, expansion, warmth): Self::Input<R>) -> Self::Output<R> {
        (warming::grown(reference_radius, expansion, warmth),)
    }
}

/// [`implicit::held`].
#[derive(Clone, Copy, Debug)]
pub struct ImplicitHeld;

impl Formula for ImplicitHeld {
    const NAME: &'static str = "implicit_held";
    const INPUTS: &'static [&'static str] = &["capacity", "step", "sensitivity"];
    const OUTPUTS: &'static [&'static str] = &["held"];
    type Input<R: Real> = (R, R, R);
    type Output<R: Real> = (R,);

    #[inline(always)]
    fn apply<R: Real>(&self, (capacity, step, sensitivity): Self::Input<R>) -> Self::Output<R> {
        (implicit::held(capacity, step, sensitivity),)
    }
}

/// [`implicit::balance`].
#[derive(Clone, Copy, Debug)]
pub struct ImplicitBalance;

impl Formula for ImplicitBalance {
    const NAME: &'static str = "implicit_balance";
    const INPUTS: &'static [&'static str] = &["held", "change", "conducted"];
    const OUTPUTS: &'static [&'static str] = &["balance"];
    type Input<R: Real> = (R, R, R);
    type Output<R: Real> = (R,);

    #[inline(always)]
    fn apply<R: Real>(&self, (held, change, conducted): Self::Input<R>) -> Self::Output<R> {
        (implicit::balance(held, change, conducted),)
    }
}

/// [`implicit::foreign_at_end`].
#[derive(Clone, Copy, Debug)]
pub struct ForeignAtEnd;

impl Formula for ForeignAtEnd {
    const NAME: &'static str = "foreign_at_end";
    const INPUTS: &'static [&'static str] = &["foreign", "sensitivity", "change"];
    const OUTPUTS: &'static [&'static str] = &["at_end"];
    type Input<R: Real> = (R, R, R);
    type Output<R: Real> = (R,);

    #[inline(always)]
    fn apply<R: Real>(&self, (foreign, sensitivity, change): Self::Input<R>) -> Self::Output<R> {
        (implicit::foreign_at_end(foreign, sensitivity, change),)
    }
}

/// [`implicit::square`].
#[derive(Clone, Copy, Debug)]
pub struct ThermalSquare;

impl Formula for ThermalSquare {
    const NAME: &'static str = "thermal_square";
    const INPUTS: &'static [&'static str] = &["capacity", "kelvins"];
    const OUTPUTS: &'static [&'static str] = &["square"];
    type Input<R: Real> = (R, R);
    type Output<R: Real> = (R,);

    #[inline(always)]
    fn apply<R: Real>(&self, (capacity, kelvins): Self::Input<R>) -> Self::Output<R> {
        (implicit::square(capacity, kelvins),)
    }
}

/// [`implicit::residual_squares`].
#[derive(Clone, Copy, Debug)]
pub struct ResidualSquares;

impl Formula for ResidualSquares {
    const NAME: &'static str = "residual_squares";
    const INPUTS: &'static [&'static str] = &["residual", "diagonal", "capacity", "step"];
    const OUTPUTS: &'static [&'static str] = &["square", "error"];
    type Input<R: Real> = (R, R, R, R);
    type Output<R: Real> = (R, R);

    #[inline(always)]
    fn apply<R: Real>(&self, (residual, diagonal, capacity, step): Self::Input<R>) -> Self::Output<R> {
        implicit::residual_squares(residual, diagonal, capacity, step).into()
    }
}
