//! Heat: from the tables of a case to temperatures, and to what a plan says of heat.

mod conductance;
pub(super) mod quasi_static;
mod surface;

pub(crate) use conductance::Warming;
use surface::Exposed;
pub use surface::SurfaceExtent;
pub(super) use surface::Surfaces;

use super::Context;
use super::draft::Draft;
use crate::materials::Materials;
use crate::problem::Problem;
use crate::schema::{self, ContactPath};
use std::f64::consts::FRAC_PI_4;
use tdem_engine::physics::heat::conduction::{contact_radius_ratio, pair_conductivity};
use tdem_engine::physics::heat::{Conductor, Dissipation, Path};
use tdem_engine::physics::material::{Elastic, young_modulus_eff};
use tdem_engine::{Course, HeatPlan, Motion, Relaxation, Scheme, Table, Thermal, ThermalTables};

/// The heat of a case; particles of the draft get temperatures and exposures. What is wrong is added to `problems`.
pub(super) fn of(
    context: &Context<'_>,
    draft: &mut Draft,
    zones: &[Vec<u32>],
    problems: &mut Vec<Problem>,
) -> Option<(HeatPlan, (Surfaces, Vec<SurfaceExtent>))> {
    let case = &context.loaded.case;
    let heat = case.heat.as_ref()?;
    let zero = heat.scale.zero();
    let initial =
        |group: u16| case.particles[usize::from(group)].temperature.unwrap_or(heat.initial_temperature) + zero;
    let known = std::mem::take(&mut draft.state.temperature);
    draft.state.temperature = (draft.group.iter().zip(known))
        // Of another run that had heat, temperatures go on.
        .map(|(&group, known)| {
            if known > 0.0 && case.particles[usize::from(group)].temperature.is_none() { known } else { initial(group) }
        })
        .collect();
    let (Exposed { exposures, sides, extents }, surfaces) = surface::expose(context, heat, draft, zones, problems);
    let materials = context.materials.len();
    let thermal = &context.materials.thermal;
    let tables = ThermalTables {
        conductivity: tables_of(thermal, |of| &of.conductivity),
        specific_heat: tables_of(thermal, |of| &of.specific_heat),
    };
    let conductivity = |k: usize| context.conductivity(k);
    let section = FRAC_PI_4 * (heat.bar_radius() * heat.bar_radius());
    let conductor = |k: usize| {
        let (a, b) = (k / materials, k % materials);
        let conductivity = pair_conductivity(conductivity(a), conductivity(b));
        // Bars and bonds, which know their section, conduct as before.
        let correction = if heat.contacts == ContactPath::Circle { context.contact_radius_ratio(a, b) } else { 1.0 };
        Conductor { conductivity: conductivity * correction, section: section / correction }
    };
    let frozen = heat.motion == schema::Motion::Frozen;
    let plan = HeatPlan {
        time_scale: heat.time_scale(case),
        reference_temperature: heat.reference_temperature.unwrap_or(heat.initial_temperature) + zero,
        // Where nothing moves, nothing expands.
        materials: (thermal.iter())
            .map(|of| Thermal {
                specific_heat: of.specific_heat.least(),
                expansion: if frozen { 0.0 } else { of.expansion },
            })
            .collect(),
        conductors: (0..materials * materials).map(conductor).collect(),
        tables,
        contacts: match heat.contacts {
            ContactPath::Bar => Path::Bar,
            ContactPath::Circle => Path::Circle,
            ContactPath::Closed => Path::Closed,
        },
        exposures,
        sides,
        walls: context.planes.iter().map(|plane| plane.temperature.as_ref().map(|of| course(of, zero))).collect(),
        motion: Motion::Stepped,
        dissipation: Dissipation {
            friction: heat.from_friction.map_or(0.0, schema::Share::get),
            damping: heat.from_damping.map_or(0.0, schema::Share::get),
        },
    };
    Some((plan, (surfaces, extents)))
}

/// What particles do while heat goes on, and the step of the plan, s: that of the heat where heat advances by itself.
pub(super) fn turns(heat: &schema::Heat, step: f64, warming: &Warming, safety: f64) -> (Motion, f64) {
    let (scheme, largest) = match heat.scheme.unwrap_or_default() {
        schema::Scheme::Implicit => (Scheme::Implicit, f64::INFINITY),
        schema::Scheme::Explicit => (Scheme::Explicit, safety * warming.safe_step),
    };
    let step_of_heat = heat.step.map_or(largest, schema::Positive::get);
    match heat.motion {
        schema::Motion::Scaled => (Motion::Stepped, step),
        schema::Motion::Frozen => (Motion::Frozen(scheme), step_of_heat),
        schema::Motion::QuasiStatic => {
            let schema::Relaxation { ratio, at_most_steps, check_every } = heat.relaxation.clone().unwrap_or_default();
            let relaxation = Relaxation { scheme, dt: step, ratio: ratio.get(), at_most_steps, check_every };
            (Motion::QuasiStatic(relaxation), step_of_heat)
        }
    }
}

/// A course of the engine; `zero` is added to its values.
fn course(given: &schema::Course, zero: f64) -> Course {
    Course(given.points().iter().map(|&[time, value]| [time, value + zero]).collect())
}

impl Context<'_> {
    /// Conductivity of a material as a plan has it in its numbers, W/(m K): 1 where tables say what all conduct.
    fn conductivity(&self, material: usize) -> f64 {
        let thermal = &self.materials.thermal;
        let tables = tables_of(thermal, |of| &of.conductivity);
        if tables.is_empty() { thermal[material].conductivity.largest() } else { 1.0 }
    }
}

impl Context<'_> {
    /// Contact radius of the true materials over that of the contact law under the same load; 1 where both are the same.
    fn contact_radius_ratio(&self, a: usize, b: usize) -> f64 {
        let Materials { elastic, original, .. } = &self.materials;
        if elastic[a] == original[a] && elastic[b] == original[b] {
            return 1.0;
        }
        let effective = |of: &[Elastic]| young_modulus_eff(of[a], of[b]);
        contact_radius_ratio(effective(elastic), effective(original))
    }
}

/// A property of all materials over temperature, if it depends on it in any of them.
fn tables_of(thermal: &[Conducting], of: fn(&Conducting) -> &Table) -> Vec<Table> {
    let depends = thermal.iter().any(|material| of(material).0.len() > 1);
    if depends { thermal.iter().map(|material| of(material).clone()).collect() } else { Vec::new() }
}

/// What a material is to heat.
#[derive(Clone, Debug)]
pub(crate) struct Conducting {
    /// W/(m K), over temperature.
    pub(crate) conductivity: Table,
    /// J/(kg K), over temperature.
    pub(crate) specific_heat: Table,
    /// 1/K.
    pub(crate) expansion: f64,
}

impl Conducting {
    /// What conducts nothing; nobody asks for its specific heat.
    pub(crate) fn nothing() -> Self {
        Conducting { conductivity: Table::constant(0.0), specific_heat: Table::constant(1.0), expansion: 0.0 }
    }

    /// `zero` is added to temperatures. A material whose mass is so many times the true one where it moves: what it stores stays.
    pub(crate) fn of(material: &schema::Material, zero: f64, mass_scaling: f64) -> Self {
        let table = |property: &Option<schema::Property>, otherwise: f64| {
            property.as_ref().map_or(Table::constant(otherwise), |property| property.table(zero))
        };
        Conducting {
            conductivity: table(&material.thermal_conductivity, 0.0),
            specific_heat: table(&material.specific_heat, 1.0).divided_by(mass_scaling),
            expansion: material.thermal_expansion.unwrap_or(0.0),
        }
    }
}
