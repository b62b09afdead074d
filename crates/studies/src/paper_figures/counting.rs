//! Operations of a step, counted by the laws themselves: each law is printed once, and the printer counts.
//!
//! An addition, a subtraction, a multiplication, a division and a square root count one each; comparisons, selections and
//! changes of sign none. Only laws are counted, not the sums around them, so that numbers are lower bounds. A branch of a law
//! (sliding) is counted as not taken in `always` and as taken in `at_most`.

use serde::{Deserialize, Serialize};
use std::ops::{Add, Mul};
use tdem_engine::physics::bond::Form;
use tdem_engine::physics::heat::Path;
use tdem_engine::physics::print::{
    BetweenSpheres, BondIncremental, BondRest, BondTotal, ContactOfSpheres, Drift, Formula, FreeStrain, GearCorrect,
    GearPredict, Grown, HeatFlow, Kick, LeverArm, LinkConductance, LocalDamping, SphereInertia, TouchOfSpheres,
    TurnOrientation, Warmed, function,
};
use tdem_engine::{Integrator, Plan};

/// A number of operations.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Count {
    /// If no branch of a law is taken.
    pub always: f64,
    /// If all are.
    pub at_most: f64,
}

impl Add for Count {
    type Output = Count;
    fn add(self, other: Count) -> Count {
        Count { always: self.always + other.always, at_most: self.at_most + other.at_most }
    }
}

impl Mul<f64> for Count {
    type Output = Count;
    fn mul(self, times: f64) -> Count {
        Count { always: self.always * times, at_most: self.at_most * times }
    }
}

/// How many bodies and pairs there are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Numbers {
    /// Particles.
    pub particles: usize,
    /// Touching pairs.
    pub contacts: usize,
    /// Bonds that hold.
    pub bonds: usize,
}

/// How often a pair is evaluated in a step: once, or from each of its sides.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Evaluations {
    /// Of a contact.
    pub contact: usize,
    /// Of a bond.
    pub bond: usize,
}

/// Operations of a step, stage by stage.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Work {
    /// Motion, orientation, temperature, radius.
    pub predict: Count,
    /// Bonds, with the heat through them.
    pub bond: Count,
    /// Contacts, with the heat through them.
    pub contact: Count,
    /// Local damping.
    pub boundary: Count,
    /// Corrections of the motion.
    pub correct: Count,
}

fn of<F: Formula>(formula: &F) -> Count {
    let function = function(formula);
    Count { always: function.always.arithmetic() as f64, at_most: function.operations().arithmetic() as f64 }
}

fn when(on: bool, count: Count) -> Count {
    if on { count } else { Count::default() }
}

impl Work {
    /// Of a step under a plan. Walls, surfaces and what is prescribed concern few particles and are not counted; listed pairs
    /// that do not touch neither, nor the numbers of bonds that are not looked up.
    #[must_use]
    pub fn of_step(plan: &Plan, numbers: Numbers, evaluations: Evaluations) -> Self {
        let particles = numbers.particles as f64;
        let gear = plan.integrator == Integrator::Gear;
        let turn = when(plan.law.moments, of(&SphereInertia) + of(&Kick));
        let move_on = if gear { of(&GearPredict) } else { of(&Kick) + of(&Drift) + turn };
        let heat = plan.heat.as_ref();
        let expands = plan.expands();
        let predict = move_on
            + when(plan.bonds.is_some() && numbers.bonds > 0, of(&TurnOrientation))
            + when(heat.is_some(), of(&Warmed))
            + when(expands, of(&Grown));
        let correct = if gear { of(&GearCorrect) } else { of(&Kick) } + turn;
        let damped = plan.bonds.as_ref().is_some_and(|bonds| bonds.local_damping > 0.0);
        let path = heat.map(|heat| heat.contacts).filter(|&path| path != Path::Closed);
        let contact = of(&TouchOfSpheres)
            + of(&ContactOfSpheres { law: plan.law })
            + path.map_or(Count::default(), |path| of(&BetweenSpheres { path }) + of(&HeatFlow));
        // Each side has an arm, whoever evaluates the pair.
        let arms = when(plan.law.moments, of(&LeverArm) * 2.0);
        let bond = plan.bonds.as_ref().map_or(Count::default(), |bonds| {
            let law = match bonds.law.form {
                Form::Total => of(&BondTotal { damping: bonds.law.damping }),
                Form::Incremental(tension) => {
                    of(&BondRest) + of(&BondIncremental { tension, damping: bonds.law.damping })
                }
            };
            law + when(heat.is_some(), of(&LinkConductance) + of(&HeatFlow)) + when(expands, of(&FreeStrain))
        });
        Work {
            predict: predict * particles,
            bond: bond * (evaluations.bond * numbers.bonds) as f64,
            contact: (contact * evaluations.contact as f64 + arms) * numbers.contacts as f64,
            boundary: when(damped, of(&LocalDamping) * 2.0) * particles,
            correct: correct * particles,
        }
    }
    /// Of all stages together.
    #[must_use]
    pub fn sum(&self) -> Count {
        self.predict + self.bond + self.contact + self.boundary + self.correct
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::paper_figures::{Mode, Model, Scene, Size};

    const NUMBERS: Numbers = Numbers { particles: 100, contacts: 600, bonds: 590 };
    const ONCE: Evaluations = Evaluations { contact: 1, bond: 1 };
    const TWICE: Evaluations = Evaluations { contact: 2, bond: 2 };

    fn work(model: Model, mode: Mode, evaluations: Evaluations) -> Work {
        let scene = Scene::build(model, Size::Small, mode).expect("the cases of this program are sound");
        Work::of_step(&scene.built().plan, NUMBERS, evaluations)
    }

    #[test]
    fn a_contact_counts_what_the_printer_counts() {
        let [once, twice] = [ONCE, TWICE].map(|evaluations| work(Model::GNTM, Mode::Best, evaluations));
        // The law of a contact is 105 + 151 + 5 + 4 operations, and 5 + 12 + 2 + 2 more if it slides: see the tests of the
        // printer.
        assert_eq!(once.contact.at_most - once.contact.always, 21.0 * 600.0);
        let one = (twice.contact.always - once.contact.always) / 600.0;
        let arms = once.contact.always / 600.0 - one;
        assert_eq!(one, of(&TouchOfSpheres).always + 265.0);
        assert_eq!(arms, 2.0 * of(&LeverArm).always);
        assert_eq!((once.bond, once.boundary), (Count::default(), Count::default()));
        assert_eq!(once.predict, twice.predict, "particles move once");
        assert!(work(Model::GN, Mode::Best, ONCE).contact.always < once.contact.always / 3.0);
    }

    #[test]
    fn bonds_heat_and_gear_add_what_they_compute() {
        let [bonds, heat] = [Model::BPM, Model::TBPM].map(|model| work(model, Mode::Paper, ONCE));
        let by_heat = of(&LinkConductance) + of(&HeatFlow) + of(&FreeStrain);
        assert_eq!(heat.bond.always - bonds.bond.always, 590.0 * by_heat.always);
        assert_eq!(heat.predict.always - bonds.predict.always, 100.0 * (of(&Warmed) + of(&Grown)).always);
        assert_eq!(bonds.boundary, of(&LocalDamping) * 200.0);
        let [gear, verlet] = Mode::ALL.map(|mode| work(Model::GN, mode, ONCE));
        assert!(gear.predict.always > 3.0 * verlet.predict.always && gear.correct.always > verlet.correct.always);
        assert_eq!(gear.contact, verlet.contact);
        let sum = heat.sum();
        let parts = [heat.predict, heat.bond, heat.contact, heat.boundary, heat.correct];
        assert_eq!(sum.always, parts.iter().map(|part| part.always).sum::<f64>());
    }
}
