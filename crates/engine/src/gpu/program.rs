//! The kernels of a run: the printed laws and the skeletons around them, in one text.

use super::layout;
use crate::{Integrator, Plan};
use std::fmt::Write;
use tdem_physics::contact::Friction;
use tdem_physics::print;

/// What is decided when the kernels are built.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Variant {
    pub(crate) law: tdem_physics::contact::Law,
    pub(crate) gear: bool,
    pub(crate) ledger: bool,
    pub(crate) periodic: bool,
    /// Whether components of motion are prescribed for any particle.
    pub(crate) constrained: bool,
    /// Whether there is but one material.
    pub(crate) one_pair: bool,
}

impl Variant {
    pub(crate) fn of(plan: &Plan) -> Self {
        Variant {
            law: plan.law,
            gear: plan.integrator == Integrator::Gear,
            ledger: plan.ledger,
            periodic: plan.domain.period().any(),
            constrained: plan.constraints.len() > 1,
            one_pair: plan.materials == 1,
        }
    }
    /// Whether a step is one kernel.
    pub(crate) fn fused(&self) -> bool {
        !self.gear && !self.ledger
    }
    /// The names of its kernels.
    pub(crate) fn kernels(&self) -> Vec<&'static str> {
        layout::heads().into_iter().map(|head| head.name).filter(|&name| name != "fused" || self.fused()).collect()
    }
    /// The whole text but the prelude.
    ///
    /// # Panics
    /// If a kernel of the table is not written exactly once.
    pub(crate) fn source(&self) -> String {
        let mut text = String::new();
        let switches = [
            ("FRICTION", self.law.friction != Friction::Off),
            ("MOMENTS", self.law.moments),
            ("GEAR", self.gear),
            ("LEDGER", self.ledger),
            ("PERIODIC", self.periodic),
            ("CONSTRAINED", self.constrained),
            ("ONE_PAIR", self.one_pair),
        ];
        for (name, on) in switches {
            let _ = writeln!(text, "#define {name} {}", u8::from(on));
        }
        text.push('\n');
        text += &print::source(self.law);
        text.push('\n');
        text += &layout::record_definitions();
        let mut skeletons = String::new();
        for file in [
            include_str!("kernels/particle.cl"),
            include_str!("kernels/predict.cl"),
            include_str!("kernels/contact.cl"),
            include_str!("kernels/correct.cl"),
            include_str!("kernels/fused.cl"),
            include_str!("kernels/scan.cl"),
            include_str!("kernels/history.cl"),
            include_str!("kernels/search.cl"),
        ] {
            skeletons.push('\n');
            skeletons += file;
        }
        for head in layout::heads() {
            let marker = format!("\nkernel {}\n", head.name);
            assert_eq!(skeletons.matches(&marker).count(), 1, "kernel {} is written once", head.name);
            skeletons = skeletons.replace(&marker, &format!("\n{}\n", head.text));
        }
        text + &skeletons
    }
}
