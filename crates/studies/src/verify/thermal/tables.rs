//! Materials and bonds that depend on temperature, by tables.

use super::{CLOSED, Material, NOTHING, SOLID, constant, held_at, through};
use crate::verify::Kind;
use crate::verify::bonded::{FORMS, JOINT, RADIUS, ROCK, SPACING, Way, numbers, scene};
use crate::verify::scene::{Bench, Scene};
use std::f64::consts::PI;
use tdem_engine::physics::bond::{Cement, Form, Joint};
use tdem_engine::physics::heat::Exchange;
use tdem_engine::{Course, Fault, Motion, Scheme, State, Table, heat_accounts};

impl Scene {
    /// Lets a property of all materials depend on temperature.
    fn conductivity_over_temperature(&mut self, table: &Table) {
        if let Some(heat) = &mut self.plan.heat {
            heat.conductors.iter_mut().for_each(|conductor| conductor.conductivity = 1.0);
            heat.tables.conductivity = vec![table.clone(); self.plan.materials];
        }
    }
    fn specific_heat_over_temperature(&mut self, table: &Table) {
        if let Some(heat) = &mut self.plan.heat {
            heat.tables.specific_heat = vec![table.clone(); self.plan.materials];
        }
    }
    /// Factors on stiffness and strength of all bonds.
    fn bonds_over_temperature(&mut self, stiffness: Option<&Table>, strength: Option<&Table>) {
        let pairs = self.plan.materials * self.plan.materials;
        if let Some(bonds) = &mut self.plan.bonds {
            bonds.tables.stiffness = stiffness.map_or(Vec::new(), |table| vec![table.clone(); pairs]);
            bonds.tables.strength = strength.map_or(Vec::new(), |table| vec![table.clone(); pairs]);
        }
    }
}

/// Conductivity of a rod, straight from one temperature to another, K and W/(m K).
const FALLING: [[f64; 2]; 2] = [[250.0, 2.0], [1000.0, 0.5]];

pub(super) fn conductivity(bench: &mut Bench) -> Result<(), Fault> {
    let (links, hot, cold) = (9, 900.0, 300.0);
    let mut scene = scene(Form::Total, JOINT, 0.3);
    scene.chain(links);
    scene.hold_all();
    scene.heat(&[SOLID], PI / 4.0, CLOSED);
    scene.conductivity_over_temperature(&Table(FALLING.to_vec()));
    // A bar as thick as the spheres, of a conductivity of 1 W/(m K).
    let unit = PI * RADIUS * RADIUS / SPACING;
    scene.heat_step(0.5 * scene.capacity(0) / (2.0 * unit));
    scene.expose(&[0], &held_at(constant(hot)));
    scene.expose(&[links], &held_at(constant(cold)));

    // Kirchhoff: what counts is the integral of the conductivity, quadratic in the temperature, which is straight.
    let [[from, first], [to, last]] = FALLING;
    let slope = (last - first) / (to - from);
    let at = |temperature: f64| first + slope * (temperature - from);
    let integral = |temperature: f64| (0.5 * (first + at(temperature))) * (temperature - from);
    let part =
        |state: &State, k: usize| (integral(hot) - integral(state.temperature[k])) / (integral(hot) - integral(cold));
    let off = |state: &State| (0..=links).map(|k| (part(state, k) - k as f64 / links as f64).abs()).fold(0.0, f64::max);
    let begin = bench.after(&scene, 2000)?;
    bench.judge(
        "integral of the conductivity: largest difference from the line, of the whole",
        "1",
        off(&begin),
        Kind::ClosedForm.at_most(1e-9),
    );
    let sag = (hot + (cold - hot) * 5.0 / links as f64) - begin.temperature[5];
    bench.judge("temperature beside the middle below the line", "K", sag, Kind::ClosedForm.at_least(20.0));
    let (steps, step) = (50, scene.plan.heat_step());
    let through = steps as f64 * step * unit * (integral(hot) - integral(cold)) / links as f64;
    scene.state = begin;
    let later = bench.after(&scene, steps)?;
    for (what, column) in [("heat in", heat_accounts::IN), ("heat out", heat_accounts::OUT)] {
        let sum = |state: &State| state.heat_accounts.iter().map(|account| account[column]).sum::<f64>();
        let got = sum(&later) - sum(&scene.state);
        bench.judge(format!("{what}, {steps} steps"), "J", got, Kind::ClosedForm.relative(through, 1e-9));
    }

    // Heat alone, in steps so long that each is a steady state of the conductivities at its beginning.
    scene.state.temperature[1..links].fill(cold);
    (scene.plan.dt, scene.state.step) = (1e4 * step, 0);
    if let Some(heat) = &mut scene.plan.heat {
        (heat.motion, heat.time_scale) = (Motion::Frozen(Scheme::Implicit), 1.0);
    }
    let alone = bench.after(&scene, 60)?;
    let what = "the same by itself, in 60 implicit steps";
    bench.judge(what, "1", off(&alone), Kind::ClosedForm.at_most(1e-9));
    Ok(())
}

/// A specific heat that rises, with a peak as of water that boils away.
const BOILING: [[f64; 2]; 5] = [[300.0, 900.0], [370.0, 1000.0], [375.0, 9000.0], [380.0, 1000.0], [500.0, 1200.0]];
/// Temperatures at the start and at the end of spheres, and the heat per mass on the way, by trapezia, K and J/kg.
const WAYS: [(&str, f64, f64, f64); 4] = [
    ("within one piece", 310.0, 340.0, (914.285_714_285_714_3 + 957.142_857_142_857_1) * 15.0),
    ("onto the peak", 320.0, 375.0, (928.571_428_571_428_6 + 1000.0) * 25.0 + 5000.0 * 5.0),
    ("over the peak and the end", 300.0, 510.0, 950.0 * 70.0 + 5000.0 * 10.0 + 1100.0 * 120.0 + 1200.0 * 10.0),
    ("down over the peak", 380.0, 290.0, -(5000.0 * 10.0 + 950.0 * 70.0 + 900.0 * 10.0)),
];

pub(super) fn specific_heat(bench: &mut Bench) -> Result<(), Fault> {
    let (steps, area, time) = (160_u32, 1e-4, 50.0);
    let mut scene = scene(Form::Total, JOINT, 0.3);
    for k in 0..WAYS.len() {
        scene.sphere(RADIUS, ROCK.density, [10.0 * SPACING * k as f64, 0.0, 0.0]);
    }
    scene.heat(&[SOLID], 0.0, CLOSED);
    scene.specific_heat_over_temperature(&Table(BOILING.to_vec()));
    scene.heat_step(time / f64::from(steps));
    for (k, (_, from, _, heat)) in WAYS.into_iter().enumerate() {
        let flux = heat * scene.state.mass[k] / (area * time);
        scene.state.temperature[k] = from;
        scene.expose(&[k], &through(Exchange { flux_area: area, ..NOTHING }, constant(flux)));
    }
    let state = bench.after(&scene, steps.into())?;
    for (k, (what, _, to, _)) in WAYS.into_iter().enumerate() {
        let what = format!("{what}: temperature");
        bench.judge(what, "K", state.temperature[k], Kind::ClosedForm.relative(to, 1e-12));
    }
    Ok(())
}

pub(super) fn stiffness(bench: &mut Bench) -> Result<(), Fault> {
    let (links, strain, seconds) = (3, 1e-4, 100.0);
    let softening = [[300.0, 1.0], [600.0, 0.7], [900.0, 0.1]];
    let mut scene = scene(Form::Total, JOINT, 0.3);
    scene.chain(links);
    for k in 0..=links {
        scene.state.position[k][0] *= 1.0 + strain;
    }
    scene.hold_all();
    scene.heat(&[Material { conductivity: 0.0, ..SOLID }], 0.0, CLOSED);
    scene.bonds_over_temperature(Some(&Table(softening.to_vec())), None);
    scene.heat_step(1.0);
    // The first 60 K colder than the others.
    let course = |by: f64| held_at(Course(vec![[0.0, 300.0 + by], [seconds, 900.0 + by]]));
    scene.expose(&[0], &course(-60.0));
    scene.expose(&(1..=links).collect::<Vec<_>>(), &course(0.0));
    let force = numbers(&JOINT).stiffness.normal * SPACING * strain;
    let factor = |t: f64| if t < 600.0 { 1.0 - 0.001 * (t - 300.0) } else { 0.7 - 0.002 * (t - 600.0) };
    for steps in [40, 52, 90] {
        // Of the middle of a bond: T = 300 + 6 t, 30 K less at the first.
        let state = bench.after(&scene, steps)?;
        let temperature = 300.0 + 6.0 * steps as f64;
        for (what, got, at) in
            [("first", state.force[0][0], temperature - 30.0), ("last", -state.force[links][0], temperature)]
        {
            let what = format!("the {what} bond at {at} K: force over that at 300 K");
            bench.judge(what, "1", got / force, Kind::ClosedForm.relative(factor(at), 1e-10));
        }
    }
    Ok(())
}

pub(super) fn strength(bench: &mut Bench) -> Result<(), Fault> {
    let (strain, warmth, seconds) = (1e-4, 600.0, 2000.0);
    // The stress is 0.6 of the strength at room temperature, which the table says for 300 + 600 * 0.4/0.8 = 600 K.
    let weakening = Table(vec![[300.0, 1.0], [900.0, 0.2]]);
    let stress = JOINT.stiffness_per_area * SPACING * strain;
    let cement = Cement { tensile_strength: stress / 0.6, ..JOINT.cement };
    for (what, form) in FORMS {
        let mut scene = scene(form, Joint { cement, ..JOINT }, 0.3);
        scene.chain(3);
        let dt = scene.plan.dt;
        scene.hold_all();
        // Stored forces need motion to come about.
        let stretch = 100_u32;
        for k in 1..=3 {
            let shift = [Some(SPACING * strain * k as f64), Some(0.0), Some(0.0)];
            let way = Way { shift, turn: [Some(0.0); 3] };
            scene.hold(k, way.at_rate(1.0 / f64::from(stretch), dt));
        }
        scene.heat(&[Material { conductivity: 0.0, ..SOLID }], 0.0, CLOSED);
        scene.bonds_over_temperature(None, Some(&weakening));
        scene.heat_step(1.0);
        scene.state.temperature.fill(300.0);
        scene.state = bench.after(&scene, stretch.into())?;
        (2..=4).for_each(|held| scene.plan.constraints[held] = scene.plan.constraints[1]);
        let begun = f64::from(stretch);
        let course = Course(vec![[begun, 300.0], [begun + seconds, 300.0 + warmth]]);
        scene.expose(&[0, 1, 2, 3], &held_at(course));
        let state = bench.after(&scene, 1500)?;
        let steps = state.bonds.iter().filter_map(|bond| bond.breakage).map(|breakage| breakage.step as f64 - begun);
        let hottest = steps.map(|step| 300.0 + warmth * step / seconds).fold(0.0, f64::max);
        let broken = state.bonds.iter().filter(|bond| !bond.holds()).count();
        bench.judge(format!("{what}: bonds that broke"), "1", broken as f64, Kind::ClosedForm.within(3.0, 0.0));
        let per_step = warmth / seconds;
        let what = format!("{what}: temperature at which the last broke");
        bench.judge(what, "K", hottest, Kind::ClosedForm.within(600.0, 1.01 * per_step));
    }
    Ok(())
}
