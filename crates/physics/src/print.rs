//! The laws as C, for kernels to call.
//!
//! [`source`] prints one file: the structs the laws exchange and every [`Formula`] of contacts and motion as a function;
//! [`bond_source`] adds those of bonds, [`heat_source`] those of heat; [`network_source`] stands alone. A kernel's skeleton
//! (loads, loops over neighbours, stores) includes it after a prelude that defines
//!
//! | word | meaning |
//! |---|---|
//! | `real` | a double |
//! | `DEVICE` | what stands before a function that kernels call |
//! | `sqrt`, `fabs`, `INFINITY`, `NAN` | as in `math.h` |
//!
//! and compiles it without contraction of `a * b + c` and without value-unsafe optimisation. [`HOST_PRELUDE`] does so
//! for C99. A function takes its inputs by value and writes its outputs through pointers:
//!
//! ```c
//! Touch touch;
//! touch_of_spheres(offset, radius_sum, &touch);
//! if (touch.overlap > 0.0) {
//!     Response response;
//!     contact_of_spheres(first, second, touch, displacement, pair, dt, &response);
//! }
//! ```
//!
//! An input that a law does not look at (the position of a sphere in contact) need not be set.

mod bonds;
mod formulas;
mod heat;
mod heat_of_motion;
mod members;

pub use bonds::{
    BondBetween, BondEnergy, BondIncremental, BondLoss, BondRelease, BondRest, BondTempered, BondTotal, ContactBegun,
    LocalDamping, ReversedHistory, TurnOrientation,
};
pub use formulas::{
    ContactOfSpheres, ContactWithWall, Drift, GearCorrect, GearPredict, Kick, LeverArm, NearestImage, RampLine,
    ReleasedBySpheres, ReleasedByWall, SettledContactOfSpheres, SettledContactWithWall, SphereInertia, StoredEnergy,
    TouchOfSpheres, TouchOfWall,
};
pub use heat::{
    AtWall, BetweenSpheres, ForeignAtEnd, FreeStrain, Grown, HeatAlong, HeatFlow, HeatRise, ImplicitBalance,
    ImplicitHeld, LinkBetween, LinkConductance, LinkWithinSide, LongestStep, MeanTemperature, ResidualSquares,
    SurfaceHeat, SurfaceSensitivity, TableSlope, TakenIn, TemperedConductance, TemperedExchange, ThermalSquare, Warmed,
};
pub use heat_of_motion::{
    DissipatedHeat, ElasticAtWall, ElasticBetweenSpheres, ExpansionWorkOfBond, ExpansionWorkOfContacts, HalfStepOfWork,
    HeatRateOfMotion, SofteningWork,
};
pub use members::{Members, Parameter, Parameters};

use crate::bond::{
    self, Advance, Bond, Cement, Coefficients, Form, History, Joint, Modes, Posture, Reaction, Rest, Stress,
};
use crate::contact::{self, Interaction, Law, Losses, Period, Response, Sphere, Touch};
use crate::heat::{Conductor, Dissipation, Exchange, Link, Outside, Path};
use crate::motion::gear::Trajectory;
use crate::motion::orientation::Quaternion;
use crate::real::{CFunction, Symbol};
use crate::{Real, Vec3};

/// Defines for C99 what the printed laws rely on. GCC needs `-ffp-contract=off` besides the pragma.
pub const HOST_PRELUDE: &str = "\
#include <math.h>
#pragma STDC FP_CONTRACT OFF
#define DEVICE static inline
typedef double real;
";

/// A law with named inputs and outputs: one function of the printed C.
pub trait Formula {
    /// Of the function.
    const NAME: &'static str;
    /// Names of the elements of [`Formula::Input`].
    const INPUTS: &'static [&'static str];
    /// Names of the elements of [`Formula::Output`].
    const OUTPUTS: &'static [&'static str];
    /// What the law is given.
    type Input<R: Real>: Parameters<R>;
    /// What it returns.
    type Output<R: Real>: Parameters<R>;

    /// The law itself.
    fn apply<R: Real>(&self, input: Self::Input<R>) -> Self::Output<R>;
}

/// A formula as a function of C.
///
/// # Panics
/// If the formula does not name each of its inputs and outputs.
#[must_use]
pub fn function<F: Formula>(formula: &F) -> CFunction {
    let inputs = F::Input::<Symbol>::described(F::INPUTS);
    let outputs = F::Output::<Symbol>::described(F::OUTPUTS);
    let by_value = inputs.iter().map(|parameter| format!("const {}", parameter.value));
    let by_address = outputs.iter().map(|parameter| parameter.pointer.clone());
    CFunction::record(&head(F::NAME, by_value.chain(by_address)), |c| {
        let mut sources = inputs.iter().flat_map(|parameter| &parameter.members);
        let mut targets = outputs.iter().flat_map(|parameter| &parameter.pointed);
        let input = F::Input::read(&mut || c.input(sources.next().expect("each number has a path")));
        formula.apply(input).write(&mut |value| c.output(targets.next().expect("each number has a path"), value));
    })
}

/// `DEVICE void name(parameters)`, wrapped.
fn head(name: &str, parameters: impl Iterator<Item = String>) -> String {
    const WIDTH: usize = 120;
    let start = format!("DEVICE void {name}(");
    let mut text = start.clone();
    let mut column = start.len();
    for (count, parameter) in parameters.enumerate() {
        let needed = parameter.len() + 2;
        if count > 0 && column + needed > WIDTH {
            text.push_str(",\n");
            text.extend(std::iter::repeat_n(' ', start.len()));
            column = start.len();
        } else if count > 0 {
            text.push_str(", ");
        }
        text += &parameter;
        column += needed;
    }
    text + ")"
}

/// The structs that the functions exchange, as typedefs.
#[must_use]
pub fn types() -> String {
    [
        Vec3::<Symbol>::definition(),
        Period::<Symbol>::definition(),
        Sphere::<Symbol>::definition(),
        contact::Kick::<Symbol>::definition(),
        Touch::<Symbol>::definition(),
        Interaction::<Symbol>::definition(),
        Losses::<Symbol>::definition(),
        Response::<Symbol>::definition(),
        Trajectory::<Symbol>::definition(),
    ]
    .concat()
}

fn entry<F: Formula>(formula: &F) -> (&'static str, CFunction) {
    (F::NAME, function(formula))
}

/// Every formula of contacts and motion by its name, as a function, in the given variant of the contact law.
#[must_use]
pub fn functions(law: Law) -> Vec<(&'static str, CFunction)> {
    vec![
        entry(&NearestImage),
        entry(&TouchOfSpheres),
        entry(&TouchOfWall),
        entry(&LeverArm),
        entry(&ContactOfSpheres { law }),
        entry(&ContactWithWall { law }),
        entry(&SettledContactOfSpheres { law }),
        entry(&SettledContactWithWall { law }),
        entry(&ReleasedBySpheres { law }),
        entry(&ReleasedByWall { law }),
        entry(&StoredEnergy),
        entry(&SphereInertia),
        entry(&Kick),
        entry(&Drift),
        entry(&RampLine),
        entry(&GearPredict),
        entry(&GearCorrect),
    ]
}

/// Types and functions in one text, to stand between a prelude and a kernel.
#[must_use]
pub fn source(law: Law) -> String {
    functions(law).into_iter().fold(types(), |text, (_, function)| text + "\n" + &function.text)
}

/// The structs that the functions of bonds exchange besides those of [`types`], as typedefs.
#[must_use]
pub fn bond_types() -> String {
    [
        Quaternion::<Symbol>::definition(),
        Modes::<Symbol>::definition(),
        Coefficients::<Symbol>::definition(),
        Cement::<Symbol>::definition(),
        Joint::<Symbol>::definition(),
        Bond::<Symbol>::definition(),
        Posture::<Symbol>::definition(),
        Rest::<Symbol>::definition(),
        History::<Symbol>::definition(),
        Advance::<Symbol>::definition(),
        Stress::<Symbol>::definition(),
        Reaction::<Symbol>::definition(),
    ]
    .concat()
}

/// Every formula of bonds by its name, as a function, in the given variant: the law itself is `bond_total` or
/// `bond_incremental`.
#[must_use]
pub fn bond_functions(law: bond::Law) -> Vec<(&'static str, CFunction)> {
    let bond::Law { form, damping } = law;
    vec![
        entry(&BondBetween { damping }),
        entry(&BondTempered),
        entry(&BondRest),
        match form {
            Form::Total => entry(&BondTotal { damping }),
            Form::Incremental(tension) => entry(&BondIncremental { tension, damping }),
        },
        entry(&ReversedHistory),
        entry(&BondLoss),
        entry(&BondEnergy),
        entry(&BondRelease),
        entry(&ContactBegun),
        entry(&TurnOrientation),
        entry(&LocalDamping),
    ]
}

/// What bonds add to [`source`], to stand behind it.
#[must_use]
pub fn bond_source(law: bond::Law) -> String {
    bond_functions(law).into_iter().fold(bond_types(), |text, (_, function)| text + "\n" + &function.text)
}

/// The structs that the functions of heat exchange besides those of [`types`], as typedefs.
#[must_use]
pub fn heat_types() -> String {
    [
        Conductor::<Symbol>::definition(),
        Link::<Symbol>::definition(),
        Exchange::<Symbol>::definition(),
        Outside::<Symbol>::definition(),
        Dissipation::<Symbol>::definition(),
    ]
    .concat()
}

/// Every formula of heat by its name, as a function, for contacts that conduct in the given way.
#[must_use]
pub fn heat_functions(path: Path) -> Vec<(&'static str, CFunction)> {
    vec![
        entry(&BetweenSpheres { path }),
        entry(&AtWall { path }),
        entry(&HeatFlow),
        entry(&TemperedConductance),
        entry(&MeanTemperature),
        entry(&HeatAlong),
        entry(&HeatRise),
        entry(&TableSlope),
        entry(&TakenIn),
        entry(&LinkBetween),
        entry(&LinkWithinSide),
        entry(&LinkConductance),
        entry(&FreeStrain),
        entry(&TemperedExchange),
        entry(&SurfaceHeat),
        entry(&Warmed),
        entry(&Grown),
        entry(&DissipatedHeat),
        entry(&HeatRateOfMotion),
        entry(&ElasticBetweenSpheres),
        entry(&ElasticAtWall),
        entry(&ExpansionWorkOfBond),
        entry(&ExpansionWorkOfContacts),
        entry(&HalfStepOfWork),
        entry(&SofteningWork),
    ]
}

/// What heat adds to [`source`], to stand behind it.
#[must_use]
pub fn heat_source(path: Path) -> String {
    heat_functions(path).into_iter().fold(heat_types(), |text, (_, function)| text + "\n" + &function.text)
}

/// Every formula by its name, as a function, that is needed where heat goes on alone through conductances that are known.
#[must_use]
pub fn network_functions() -> Vec<(&'static str, CFunction)> {
    vec![
        entry(&HeatFlow),
        entry(&SurfaceHeat),
        entry(&SurfaceSensitivity),
        entry(&Warmed),
        entry(&LongestStep),
        entry(&ImplicitHeld),
        entry(&ImplicitBalance),
        entry(&ForeignAtEnd),
        entry(&ThermalSquare),
        entry(&ResidualSquares),
    ]
}

/// The structs and the functions of [`network_functions`] in one text, which needs nothing of [`source`].
#[must_use]
pub fn network_source() -> String {
    let types = [Exchange::<Symbol>::definition(), Outside::<Symbol>::definition()].concat();
    network_functions().into_iter().fold(types, |text, (_, function)| text + "\n" + &function.text)
}

#[cfg(test)]
mod tests;
