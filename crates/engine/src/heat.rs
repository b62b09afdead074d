//! Heat as a plan describes it.

use crate::plan::{Piece, pieces, value_at};
use crate::{Fault, Motion, Plan, State, Table};
use tdem_physics::bond;
use tdem_physics::heat::conduction::tempered;
use tdem_physics::heat::table::mean_temperature;
use tdem_physics::heat::warming::{grown, taken_in, warmed};
use tdem_physics::heat::{Conductor, Dissipation, Exchange, Link, Outside, Path};

/// What a plan says of heat.
#[derive(Clone, Debug, PartialEq)]
pub struct HeatPlan {
    /// $S$: how much faster the time of the heat goes than that of the motion, positive. Heat rates of conduction and of
    /// surfaces are multiplied by it.
    pub time_scale: f64,
    /// $T_0$, K: where radii are those that were given and bonds are free of stress.
    pub reference_temperature: f64,
    /// Of each material, walls' included, `(materials)`.
    pub materials: Vec<Thermal>,
    /// What conducts between each pair of materials, `(materials, materials)`, symmetric, row by row.
    pub conductors: Vec<Conductor<f64>>,
    /// What of that depends on temperature.
    pub tables: ThermalTables,
    /// How heat goes through contacts. A contact within a bond that holds conducts nothing.
    pub contacts: Path,
    /// How particles may exchange heat with their surroundings; the first entry is [`Exposure::default`], insulated.
    pub exposures: Vec<Exposure>,
    /// Open sides of a lattice at which particles of each exposure lie, a bit for each side, `(exposures)`. Bonds of two
    /// particles at one side conduct as [`Link::within_side`] says. Empty where nothing is known of sides.
    pub sides: Vec<u8>,
    /// Temperatures of walls, K, over the time of the heat, `(walls)`; `None` is insulated.
    pub walls: Vec<Option<Course>>,
    /// What particles do while heat goes on.
    pub motion: Motion,
    /// Which parts of the energy that motion loses become heat; anything but 0 needs a ledger, which knows the losses, and
    /// heat that goes along with the motion.
    pub dissipation: Dissipation<f64>,
}

/// Properties of materials that depend on temperature. Each list is for all materials, or empty where none depends on it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ThermalTables {
    /// $\lambda(T)$, W/(m K), `(materials)`. A pair conducts with both values at its mean temperature, a particle at a wall
    /// at theirs, and what lies before the centre of a particle at a surface at that of the particle; then all
    /// [`HeatPlan::conductors`] have a conductivity of 1, or with [`Path::Circle`] what corrects the contact radius, and all
    /// exchanges are those through material of conductivity 1.
    pub conductivity: Vec<Table>,
    /// $c(T)$, J/(kg K), `(materials)`, in the place of [`Thermal::specific_heat`].
    pub specific_heat: Vec<Table>,
}

/// What a material is to heat.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Thermal {
    /// $c$, J/(kg K); not looked at where it depends on temperature.
    pub specific_heat: f64,
    /// $\alpha$, 1/K.
    pub expansion: f64,
}

/// Values over time: points of time, s, and value; straight between them, constant before the first and behind the last.
/// Times ascend strictly.
#[derive(Clone, Debug, PartialEq)]
pub struct Course(pub Vec<[f64; 2]>);

impl Course {
    /// The value at a time.
    #[must_use]
    pub fn value(&self, time: f64) -> f64 {
        value_at(&self.0, time)
    }
    pub(crate) fn pieces(&self) -> impl Iterator<Item = Piece> {
        pieces(&self.0)
    }
    /// Whether it says something, in the order of time, and nothing else but finite numbers.
    fn is_sound(&self) -> bool {
        !self.0.is_empty()
            && self.0.iter().flatten().all(|number| number.is_finite())
            && self.0.is_sorted_by(|a, b| a[0] < b[0])
    }
}

/// How a particle exchanges heat with its surroundings.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Exposure {
    /// Its temperature over the time of the heat, K, if that is prescribed; then the exchanges do nothing.
    pub temperature: Option<Course>,
    /// What goes through its surfaces, one exchange for each, added up in this order.
    pub exchanges: Vec<(Exchange<f64>, Around)>,
}

/// What is outside of a surface, over the time of the heat; what is absent does nothing.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Around {
    /// Heat that enters, W/m².
    pub flux: Option<Course>,
    /// Temperature of the fluid, or what the surface is held at, K.
    pub fluid: Option<Course>,
    /// Temperature of what it exchanges radiation with, K.
    pub surroundings: Option<Course>,
}

impl Around {
    /// Nothing but a flux, W/m².
    #[must_use]
    pub fn flux(course: Course) -> Self {
        Around { flux: Some(course), ..Around::default() }
    }
    /// Nothing but a fluid, or a temperature that the surface is held at, K.
    #[must_use]
    pub fn fluid(course: Course) -> Self {
        Around { fluid: Some(course), ..Around::default() }
    }
    /// Nothing but what it exchanges radiation with, K.
    #[must_use]
    pub fn surroundings(course: Course) -> Self {
        Around { surroundings: Some(course), ..Around::default() }
    }
    /// What is outside: the flux of one time, and the temperatures of another.
    #[must_use]
    pub fn at(&self, flux: f64, temperatures: f64) -> Outside<f64> {
        let value = |course: &Option<Course>, time| course.as_ref().map_or(0.0, |course| course.value(time));
        Outside {
            flux: value(&self.flux, flux),
            fluid: value(&self.fluid, temperatures),
            surroundings: value(&self.surroundings, temperatures),
        }
    }
    /// All that is there.
    pub fn courses(&self) -> impl Iterator<Item = &Course> {
        self.flux.iter().chain(self.temperatures())
    }
    /// Those of temperatures.
    pub fn temperatures(&self) -> impl Iterator<Item = &Course> {
        self.fluid.iter().chain(&self.surroundings)
    }
}

impl Exposure {
    /// All courses that it has.
    pub fn courses(&self) -> impl Iterator<Item = &Course> {
        self.temperature.iter().chain(self.exchanges.iter().flat_map(|(_, around)| around.courses()))
    }
    /// Outside values of its exchanges in a step; none where the temperature is prescribed.
    pub(crate) fn outside(&self, flux: f64, temperatures: f64) -> Vec<Outside<f64>> {
        let acting = if self.temperature.is_some() { &[][..] } else { &self.exchanges };
        acting.iter().map(|(_, around)| around.at(flux, temperatures)).collect()
    }
}

/// Columns of [`State::heat_accounts`], each summed over all steps, J.
pub mod heat_accounts {
    /// Came in through surfaces and walls, and by prescribed temperatures.
    pub const IN: usize = 0;
    /// Left through them, positive.
    pub const OUT: usize = 1;
    /// Made by friction and dashpots.
    pub const MADE: usize = 2;
    /// Not heat: work that expansion did on springs, which is energy of the motion.
    pub const EXPANSION: usize = 3;
}

/// Books heat that came in, or left if it is negative, J.
pub(crate) fn book(account: &mut [f64; 4], heat: f64) {
    if heat > 0.0 {
        account[heat_accounts::IN] += heat;
    } else {
        account[heat_accounts::OUT] -= heat;
    }
}

impl HeatPlan {
    /// What conducts between two materials.
    #[must_use]
    pub fn conductor(&self, first: u16, second: u16) -> &Conductor<f64> {
        &self.conductors[usize::from(first) * self.materials.len() + usize::from(second)]
    }
    /// A conductance at the temperatures of both ends, K: as it is, or times the conductivities at their mean, W/K.
    #[inline(always)]
    pub(crate) fn tempered(&self, conductance: f64, materials: [u16; 2], temperatures: [f64; 2]) -> f64 {
        if self.tables.conductivity.is_empty() {
            return conductance;
        }
        let [first, second] = self.conductivities(materials, temperatures);
        tempered(conductance, first, second)
    }
    /// Conductivities of both materials at the mean of two temperatures, K, where they depend on it, W/(m K).
    #[inline(always)]
    pub(crate) fn conductivities(&self, materials: [u16; 2], temperatures: [f64; 2]) -> [f64; 2] {
        let mean = mean_temperature(temperatures[0], temperatures[1]);
        materials.map(|material| self.tables.conductivity[usize::from(material)].value(mean))
    }
    /// What a particle exchanges through a surface, at its temperature, K.
    #[inline(always)]
    pub(crate) fn exchange(&self, exchange: &Exchange<f64>, material: u16, temperature: f64) -> Exchange<f64> {
        match self.tables.conductivity.get(usize::from(material)) {
            None => *exchange,
            Some(table) => exchange.tempered(table.value(temperature)),
        }
    }
    /// $mc$ of a particle at its temperature, J/K.
    #[must_use]
    pub fn capacity(&self, material: u16, mass: f64, temperature: f64) -> f64 {
        let material = usize::from(material);
        let table = self.tables.specific_heat.get(material);
        mass * table.map_or(self.materials[material].specific_heat, |table| table.value(temperature))
    }
    /// Heat of a particle at one temperature less that at another, K, in J.
    #[must_use]
    pub fn heat_between(&self, material: u16, mass: f64, from: f64, to: f64) -> f64 {
        match self.tables.specific_heat.get(usize::from(material)) {
            None => mass * self.materials[usize::from(material)].specific_heat * (to - from),
            Some(table) => mass * table.heat_between(from, to),
        }
    }
    /// The temperature of a particle after a step of the heat, s, K.
    #[inline(always)]
    pub(crate) fn warmed(&self, material: u16, mass: f64, temperature: f64, heat_rate: f64, step: f64) -> f64 {
        match self.tables.specific_heat.get(usize::from(material)) {
            None => warmed(temperature, heat_rate, mass * self.materials[usize::from(material)].specific_heat, step),
            Some(table) => table.warmed(temperature, taken_in(heat_rate, mass, step)),
        }
    }
    /// Whether heat goes along with the motion; not where the motion has its turn, and temperatures stay as they are.
    pub(crate) fn flows(&self) -> bool {
        self.time_scale > 0.0
    }
    /// Whether contacts conduct along with the motion.
    pub(crate) fn through_contacts(&self) -> bool {
        self.flows() && self.contacts != Path::Closed
    }
    /// Whether friction or dashpots make heat.
    #[must_use]
    pub fn makes_heat(&self) -> bool {
        self.dissipation != Dissipation::default()
    }
    /// Whether anything depends on exposures.
    pub(crate) fn exposes(&self) -> bool {
        self.bounds() || self.exposures.iter().any(|exposure| *exposure != Exposure::default())
    }
    /// Whether any particles lie at open sides.
    pub(crate) fn bounds(&self) -> bool {
        !self.sides.is_empty()
    }
    /// Whether particles of two exposures lie at one open side.
    #[must_use]
    pub fn at_one_side(&self, exposures: [u16; 2]) -> bool {
        self.bounds() && self.sides[usize::from(exposures[0])] & self.sides[usize::from(exposures[1])] != 0
    }
    /// What a bond is to heat between particles of two exposures: more, if both lie at one open side.
    pub(crate) fn where_it_lies(&self, link: Link<f64>, exposures: [u16; 2]) -> Link<f64> {
        if self.at_one_side(exposures) { link.within_side() } else { link }
    }
    /// Whether any material grows.
    #[must_use]
    pub fn expands(&self) -> bool {
        self.materials.iter().any(|material| material.expansion != 0.0)
    }
    /// $\alpha$ of a material, 1/K.
    #[must_use]
    pub fn expansion(&self, material: u16) -> f64 {
        self.materials[usize::from(material)].expansion
    }
    /// What a bond is to heat, from materials and radii (m) at bonding.
    pub(crate) fn link(&self, materials: [u16; 2], radii: [f64; 2]) -> Link<f64> {
        let expansions = materials.map(|material| self.expansion(material));
        Link::between(self.conductor(materials[0], materials[1]), radii, expansions)
    }
    fn is_sound(&self, plan: &Plan) -> bool {
        let not_negative = |number: f64| number.is_finite() && number >= 0.0;
        let warm = |course: &Course| course.0.iter().all(|point| point[1] > 0.0);
        let exchanges = || self.exposures.iter().flat_map(|exposure| &exposure.exchanges);
        let prescribed = self.exposures.iter().filter_map(|exposure| exposure.temperature.as_ref());
        let positive = |number: f64| number.is_finite() && number > 0.0;
        let courses = self.exposures.iter().flat_map(Exposure::courses);
        let part = |number: f64| (0.0..=1.0).contains(&number);
        positive(self.time_scale)
            && part(self.dissipation.friction)
            && part(self.dissipation.damping)
            && positive(self.reference_temperature)
            && self.materials.len() == plan.materials
            && self.materials.iter().all(|m| positive(m.specific_heat) && m.expansion.is_finite())
            && self.conductors.len() == plan.materials * plan.materials
            && self.tables.are_sound(plan.materials)
            && (self.tables.conductivity.is_empty()
                || self.contacts == Path::Circle
                || self.conductors.iter().all(|c| c.conductivity == 1.0))
            && self.conductors.iter().all(|c| not_negative(c.conductivity) && not_negative(c.section))
            && exchanges().all(|(Exchange { flux_area, conductance, radiation, resistance }, around)| {
                [flux_area, conductance, radiation, resistance].iter().all(|&&number| not_negative(number))
                    // What is absent is at absolute zero, and nothing may be exchanged with that.
                    && (*conductance == 0.0 || around.fluid.is_some())
                    && (*radiation == 0.0 || around.surroundings.is_some())
                    && around.temperatures().all(warm)
            })
            && prescribed.chain(self.walls.iter().flatten()).all(warm)
            && self.exposures.first() == Some(&Exposure::default())
            && (self.sides.is_empty() || self.sides.len() == self.exposures.len())
            && self.walls.len() == plan.walls.len()
            && courses.chain(self.walls.iter().flatten()).all(Course::is_sound)
    }
}

impl ThermalTables {
    /// Whether nothing depends on temperature.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.conductivity.is_empty() && self.specific_heat.is_empty()
    }
    /// Whether each list is for all materials or for none, and no value is out of range.
    fn are_sound(&self, materials: usize) -> bool {
        let all = |tables: &[Table]| tables.is_empty() || tables.len() == materials;
        all(&self.conductivity)
            && all(&self.specific_heat)
            && self.conductivity.iter().all(|table| table.is_sound(|value| value >= 0.0))
            && self.specific_heat.iter().all(|table| table.is_sound(|value| value > 0.0))
    }
}

/// A table of [`State::alike_links`] with nothing going through pairs without bonds.
pub(crate) fn filled(links: &[Option<Link<f64>>]) -> Vec<Link<f64>> {
    let nothing = Link { conductance_length: 0.0, first_growth: 0.0, second_growth: 0.0 };
    links.iter().map(|link| link.unwrap_or(nothing)).collect()
}

impl Plan {
    /// $S\,\Delta t$: the time of the heat in one step, s.
    #[must_use]
    pub fn heat_step(&self) -> f64 {
        self.heat.as_ref().map_or(0.0, |heat| heat.time_scale * self.dt)
    }
    /// Time in the middle of the step of the heat that follows so many others, s.
    #[must_use]
    pub fn heat_middle(&self, step: u64) -> f64 {
        0.5 * (self.heat_time(step) + self.heat_time(step + 1))
    }
    /// Whether radii and bonds follow temperatures.
    #[must_use]
    pub fn expands(&self) -> bool {
        self.heat.as_ref().is_some_and(HeatPlan::expands)
    }
    /// Whether stiffnesses of bonds depend on temperature.
    pub(crate) fn softens(&self) -> bool {
        self.bonds.as_ref().is_some_and(|bonds| !bonds.tables.stiffness.is_empty())
    }
    /// Whether the ledger follows the work that expansion and softening do on springs.
    pub(crate) fn books_expansion(&self) -> bool {
        self.ledger && (self.expands() || self.heat.is_some() && self.softens())
    }
    /// Whether friction or dashpots make heat.
    pub(crate) fn makes_heat(&self) -> bool {
        self.heat.as_ref().is_some_and(HeatPlan::makes_heat)
    }
    /// Time of the heat after a number of steps, s.
    #[must_use]
    pub fn heat_time(&self, step: u64) -> f64 {
        step as f64 * self.heat_step()
    }
}

impl State {
    /// The radius of a particle at the reference temperature, m: that of its bonds.
    #[must_use]
    pub fn bonded_radius(&self, index: usize) -> f64 {
        self.reference_radius.get(index).map_or(self.radius[index], |&radius| radius)
    }

    /// Lets radii follow temperatures, from those at the reference temperature. By how much one shrank at most, m.
    pub fn follow_temperatures(&mut self, plan: &Plan) -> f64 {
        let Some(heat) = plan.heat.as_ref().filter(|heat| heat.expands()) else { return 0.0 };
        let mut shrunk = 0.0_f64;
        for i in 0..self.len() {
            let warmth = self.temperature[i] - heat.reference_temperature;
            let radius = grown(self.reference_radius[i], heat.expansion(self.material[i]), warmth);
            shrunk = shrunk.max(self.radius[i] - radius);
            self.radius[i] = radius;
        }
        shrunk
    }

    /// What a bond is to heat, from indices of particles, wherever these lie; `None` without heat.
    pub(crate) fn link(&self, plan: &Plan, first: usize, second: usize) -> Option<Link<f64>> {
        let heat = plan.heat.as_ref()?;
        let materials = [first, second].map(|index| self.material[index]);
        let radii = [first, second].map(|index| self.bonded_radius(index));
        Some(heat.link(materials, radii))
    }

    /// Links of the bonds of each pair of materials, `(materials, materials)`, row by row, if nothing else decides about
    /// them; `None` of pairs without bonds.
    pub(crate) fn alike_links(&self, plan: &Plan) -> Option<Vec<Option<Link<f64>>>> {
        plan.heat.as_ref()?;
        let mut table: Vec<Option<Link<f64>>> = vec![None; plan.materials * plan.materials];
        for bond in &self.bonds {
            let [i, j] = [bond.first, bond.second].map(|id| self.index_of(id).unwrap_or(0));
            for (first, second) in [(i, j), (j, i)] {
                let link = self.link(plan, first, second)?;
                let place = usize::from(self.material[first]) * plan.materials + usize::from(self.material[second]);
                if *table[place].get_or_insert(link) != link {
                    return None;
                }
            }
        }
        Some(table)
    }

    /// Checks that what belongs to heat is there exactly if the plan has heat.
    pub(crate) fn validate_heat(&self, plan: &Plan) -> Result<(), Fault> {
        let check = |holds: bool, what| if holds { Ok(()) } else { Err(Fault::Inconsistent { what }) };
        let n = if plan.heat.is_some() { self.len() } else { 0 };
        check(
            [self.temperature.len(), self.exposure.len(), self.heat_rate.len()].iter().all(|&l| l == n),
            "with heat all particles have a temperature, a heat rate and an exposure, without heat none",
        )?;
        let growing = if plan.expands() { n } else { 0 };
        check(
            self.reference_radius.len() == growing,
            "particles that expand have a radius at the reference temperature, others none",
        )?;
        check(
            self.work_per_kelvin.is_empty() || plan.books_expansion() && self.work_per_kelvin.len() == n,
            "work per kelvin is for all particles or none, and with a ledger only",
        )?;
        check(
            self.heat_accounts.is_empty() || self.heat_accounts.len() == n,
            "heat accounts are for all particles or none",
        )?;
        let Some(heat) = &plan.heat else { return Ok(()) };
        check(
            heat.is_sound(plan),
            "heat has numbers for every material, pair and wall, and courses that ascend in time",
        )?;
        heat.motion.validate(plan, heat)?;
        check(
            !heat.makes_heat() || plan.ledger && !heat.motion.takes_turns(),
            "what makes heat by motion has a ledger, and heat that goes along with the motion",
        )?;
        check(self.temperature.iter().all(|&t| t > 0.0 && t.is_finite()), "temperatures are above absolute zero")?;
        check(self.exposure.iter().all(|&e| usize::from(e) < heat.exposures.len()), "every exposure is in the plan")?;
        let incremental = plan.bonds.as_ref().is_some_and(|bonds| matches!(bonds.law.form, bond::Form::Incremental(_)));
        check(
            !(incremental && heat.expands() && !self.bonds.is_empty()),
            "bonds that remember forces do not expand: the total form does",
        )
    }
}
