//! From measured values to bonds, for any packing: the inverse of two tests.
//!
//! At a given ratio of stiffnesses $\kappa$ the modulus is in exact proportion to the stiffness of the bonds and Poisson's
//! ratio does not depend on it; so $\kappa$ is found first, as the root of $\nu(\kappa) = \nu$, then one factor gives the
//! modulus. Both come from static equilibrium ([`crate::statics`]). At a given ratio of shear to tensile strength, and as
//! far as strains are small, the strength of the packing is in proportion to that of the bonds; it comes from tests that
//! tear the packing apart in the engine ([`crate::uniaxial`]).

use crate::uniaxial::{Elasticity, Error as UniaxialError, Failure, Sense, Specimen};
use tdem_engine::physics::bond::Joint;
use tdem_engine::physics::bond::mean_field::{self, Packing};
use tdem_engine::{ExactSum, Fault, Plan, Simulation, State};

/// Values of the solid that are to come out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Targets {
    /// Pa.
    pub young_modulus: f64,
    /// `None` leaves the ratio of stiffnesses as it is.
    pub poisson_ratio: Option<f64>,
    /// Pa; `None` leaves strengths as they are and breaks nothing.
    pub tensile_strength: Option<f64>,
    /// Whether the packing is crushed, too, with the strengths found: that strength is reported, not sought.
    pub compression: bool,
}

/// Why there is no calibration.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Error {
    /// No ratio of stiffnesses gives this Poisson's ratio.
    #[error(
        "no bonds give this packing a Poisson's ratio of {target}: it goes from {least:.4} at a stiffness ratio of \
         {} to {greatest:.4} at {}",
        RATIOS[1],
        RATIOS[0]
    )]
    PoissonOutOfReach {
        /// What was asked for.
        target: f64,
        /// At the greatest ratio of stiffnesses.
        least: f64,
        /// At the least ratio of stiffnesses.
        greatest: f64,
    },
    /// The packing cannot be tested.
    #[error(transparent)]
    Uniaxial(#[from] UniaxialError),
}

/// What was found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Calibration {
    /// The bonds.
    pub joint: Joint<f64>,
    /// What these bonds would give if all particles moved with the mean: an upper bound of the modulus. See
    /// [`mod@mean_field`].
    pub mean_field: Elasticity,
    /// Modulus and Poisson's ratio of the packing with these bonds, in static equilibrium.
    pub elasticity: Elasticity,
    /// The last test in tension.
    pub tension: Option<Failure>,
    /// The test in compression.
    pub compression: Option<Failure>,
    /// Static solutions that it took.
    pub solutions: usize,
    /// Tests to failure that it took.
    pub tests: usize,
}

/// Ratios of stiffnesses among which one is sought.
pub const RATIOS: [f64; 2] = [0.01, 4.0];
/// Poisson's ratio is found to this.
const POISSON: f64 = 1e-5;
/// Strengths are scaled until they are right to this part, or so often.
const STRENGTH: f64 = 0.01;
const MOST_TESTS: usize = 4;

/// Bonds that give a specimen the values of a solid. `start` makes the simulation of a state and a plan.
///
/// # Errors
/// See [`Error`].
pub fn calibrate(
    specimen: &Specimen,
    targets: &Targets,
    start: impl Fn(State, Plan) -> Result<Simulation, Fault>,
) -> Result<Calibration, Error> {
    let mut solutions = 0;
    let mut joint = specimen.joint();
    let mut elasticity = match targets.poisson_ratio {
        None => {
            solutions += 1;
            specimen.elasticity()?
        }
        Some(target) => {
            let mut try_ratio = |ratio: f64| {
                solutions += 1;
                specimen.with(with_ratio(joint, ratio)).elasticity()
            };
            let (ratio, found) = ratio_of(target, &mut try_ratio)?;
            joint = with_ratio(joint, ratio);
            found
        }
    };
    let factor = targets.young_modulus / elasticity.young_modulus;
    joint.stiffness_per_area *= factor;
    joint.young_modulus *= factor;
    elasticity.young_modulus *= factor;
    let mean_field = mean_field(specimen, &joint);
    let mut found =
        Calibration { joint, mean_field, elasticity, tension: None, compression: None, solutions, tests: 0 };
    if let Some(target) = targets.tensile_strength {
        strengthen(specimen, target, &start, &mut found)?;
    }
    if targets.compression {
        found.compression = Some(specimen.with(found.joint).load_to_failure(Sense::Compression, &start)?);
        found.tests += 1;
    }
    Ok(found)
}

fn with_ratio(mut joint: Joint<f64>, ratio: f64) -> Joint<f64> {
    joint.cement.stiffness_ratio = ratio;
    joint
}

fn with_strengths(mut joint: Joint<f64>, factor: f64) -> Joint<f64> {
    joint.cement.tensile_strength *= factor;
    joint.cement.shear_strength *= factor;
    joint
}

/// The ratio of stiffnesses that gives a Poisson's ratio: false position on the logarithm, the end that stays counted half
/// (the Illinois rule).
fn ratio_of(
    target: f64,
    elasticity: &mut dyn FnMut(f64) -> Result<Elasticity, UniaxialError>,
) -> Result<(f64, Elasticity), Error> {
    let mut ends = RATIOS.map(libm::log);
    let [greatest, least] = [elasticity(RATIOS[0])?.poisson_ratio, elasticity(RATIOS[1])?.poisson_ratio];
    if !(least..=greatest).contains(&target) {
        return Err(Error::PoissonOutOfReach { target, least, greatest });
    }
    let mut off = [greatest - target, least - target];
    let mut kept = 2;
    loop {
        let at = ends[0] + (ends[1] - ends[0]) * off[0] / (off[0] - off[1]);
        let found = elasticity(libm::exp(at))?;
        let error = found.poisson_ratio - target;
        if error.abs() <= POISSON || ends[1] - ends[0] < 1e-9 {
            return Ok((libm::exp(at), found));
        }
        let (moved, other) = if error > 0.0 { (0, 1) } else { (1, 0) };
        (ends[moved], off[moved]) = (at, error);
        if kept == other {
            off[other] *= 0.5;
        }
        kept = other;
    }
}

/// A specimen as the mean field sees it: what is farther from the sides than one and a half diameters, where packings are
/// looser; all of it if that leaves nothing.
fn packing(specimen: &Specimen) -> Packing {
    let state = specimen.state();
    let count = state.len() as f64;
    let radius = ExactSum::of(state.radius.iter().copied()).value() / count;
    let box_within = |margin: f64| specimen.extent().map(|[low, high]| [low + margin, high - margin]);
    let lies_in = |k: usize, room: &[[f64; 2]; 3]| {
        state.position[k].iter().zip(room).all(|(x, [low, high])| (low..=high).contains(&x))
    };
    let inner = box_within(3.0 * radius);
    let room = if (0..state.len()).any(|k| lies_in(k, &inner)) { inner } else { box_within(0.0) };
    let mut bonds = vec![0_u32; state.len()];
    for id in state.bonds.iter().flat_map(|bond| [bond.first, bond.second]) {
        state.index_of(id).into_iter().for_each(|k| bonds[k] += 1);
    }
    let within: Vec<usize> = (0..state.len()).filter(|&k| lies_in(k, &room)).collect();
    let sphere = |k: &usize| 4.0 / 3.0 * std::f64::consts::PI * state.radius[*k] * state.radius[*k] * state.radius[*k];
    let volume: f64 = room.iter().map(|[low, high]| high - low).product();
    Packing {
        solid_fraction: ExactSum::of(within.iter().map(sphere)).value() / volume,
        coordination: within.iter().map(|&k| f64::from(bonds[k])).sum::<f64>() / within.len() as f64,
        radius,
    }
}

/// What the mean field says of bonds.
fn mean_field(specimen: &Specimen, joint: &Joint<f64>) -> Elasticity {
    let packing = packing(specimen);
    let ratio = joint.cement.stiffness_ratio;
    let bond = joint.bond(packing.radius, packing.radius, 2.0 * packing.radius, 1.0);
    Elasticity {
        young_modulus: packing.young_modulus(bond.stiffness.normal, ratio),
        poisson_ratio: mean_field::poisson_ratio(ratio),
    }
}

/// Scales both strengths until the packing bears a tensile stress, Pa.
fn strengthen(
    specimen: &Specimen,
    target: f64,
    start: &impl Fn(State, Plan) -> Result<Simulation, Fault>,
    found: &mut Calibration,
) -> Result<(), Error> {
    // The first bond breaks long before the packing does.
    let first = specimen.with(found.joint).first_breakage(Sense::Tension)? * found.elasticity.young_modulus;
    found.joint = with_strengths(found.joint, 0.5 * target / first);
    loop {
        let failure = specimen.with(found.joint).load_to_failure(Sense::Tension, start)?;
        found.tests += 1;
        found.tension = Some(failure);
        if (failure.strength / target - 1.0).abs() <= STRENGTH || found.tests == MOST_TESTS {
            return Ok(());
        }
        found.joint = with_strengths(found.joint, target / failure.strength);
    }
}
