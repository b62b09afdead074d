//! Heat through surfaces: films, fluxes, radiation, faces held warm, and slabs between them.

use super::{CLOSED, Material, NOTHING, ROOM, SOLID, constant, face_centred_section, largest_difference, through};
use crate::slab::{Heating, Slab};
use crate::verify::Kind;
use crate::verify::bonded::{JOINT, LATTICE_CONSTANT, RADIUS, ROCK, SPACING, scene};
use crate::verify::scene::{Bench, Scene};
use std::f64::consts::PI;
use tdem_engine::physics::bond::Form;
use tdem_engine::physics::contact::Law;
use tdem_engine::physics::heat::Exchange;
use tdem_engine::physics::heat::surface::{Cover, STEFAN_BOLTZMANN, surface_conductance};
use tdem_engine::{Around, Course, Fault, State};

/// Surface of a sphere, m².
const AREA: f64 = 4.0 * PI * RADIUS * RADIUS;

/// Spheres that hang far from each other.
fn single(count: usize) -> Scene {
    let mut scene = Scene::new(Law::GNTM, ROCK.with_itself(), 1e-3);
    for k in 0..count {
        scene.sphere(RADIUS, ROCK.density, [10.0 * SPACING * k as f64, 0.0, 0.0]);
    }
    scene.heat(&[SOLID], 0.0, CLOSED);
    scene
}

pub(super) fn lumped(bench: &mut Bench) -> Result<(), Fault> {
    let (film, warmth, flux) = (25.0, 200.0, 4e4);
    let mut scene = single(2);
    let time = scene.capacity(0) / (film * AREA);
    let steps = 400_u32;
    scene.heat_step(time / f64::from(steps));
    let conductance = surface_conductance(AREA, 0.0, SOLID.conductivity, film);
    scene.expose(&[0], &through(Exchange { conductance, ..NOTHING }, Around::fluid(constant(ROOM))));
    // Up and down again, with corners on steps.
    let course = Course(vec![[0.0, 0.0], [0.25 * time, flux], [0.75 * time, -0.5 * flux]]);
    scene.expose(&[1], &through(Exchange { flux_area: AREA, ..NOTHING }, Around::flux(course)));
    scene.state.temperature[0] = ROOM + warmth;
    let state = bench.after(&scene, steps.into())?;
    let left = (state.temperature[0] - ROOM) / warmth;
    let euler = (0..steps).fold(1.0, |left, _| left * (1.0 - 1.0 / f64::from(steps)));
    bench.judge("film: warmth, of the start", "1", left, Kind::ClosedForm.relative(euler, 1e-12));
    // Euler's rule is wrong by 1/(2 n) at t = C/(h A).
    bench.judge(
        "film: the same, in the limit",
        "1",
        left,
        Kind::ClosedForm.relative(libm::exp(-1.0), 0.6 / f64::from(steps)),
    );
    // 0.25/2 + 0.5 (1 - 0.5)/2 - 0.25 * 0.5 of the greatest flux.
    let heat = AREA * flux * time * (0.125 + 0.125 - 0.125);
    let expected = ROOM + heat / scene.capacity(1);
    bench.judge("flux: temperature", "K", state.temperature[1], Kind::ClosedForm.relative(expected, 1e-12));
    Ok(())
}

/// $\int\frac{dT}{T^4 - a^4}$.
fn time_of_radiation(temperature: f64, outside: f64) -> f64 {
    let logarithm = libm::log(((temperature - outside) / (temperature + outside)).abs());
    (0.5 * logarithm - libm::atan(temperature / outside)) / (2.0 * outside * outside * outside)
}

/// The temperature of a surface with $T = T_s + r(T_s^4 - a^4)$, by halving.
fn surface_temperature(temperature: f64, outside: f64, resistance: f64) -> f64 {
    let fourth = |t: f64| t * t * t * t;
    let mut ends = [temperature.min(outside), temperature.max(outside)];
    for _ in 0..80 {
        let middle = 0.5 * (ends[0] + ends[1]);
        let below = middle + resistance * (fourth(middle) - fourth(outside)) < temperature;
        ends[usize::from(!below)] = middle;
    }
    ends[0]
}

/// Inside and outside temperature, K, and the resistance of the depth, K/W.
const RADIATION: [(&str, f64, f64, f64); 3] = [
    ("cooling", 1200.0, 300.0, 0.0),
    ("heating", 300.0, 1200.0, 0.0),
    ("cooling, behind a depth", 1200.0, 300.0, 20.0),
];

pub(super) fn radiation(bench: &mut Bench) -> Result<(), Fault> {
    let radiation = 0.8 * STEFAN_BOLTZMANN * AREA;
    let mut scene = single(RADIATION.len());
    for (k, (_, inside, outside, resistance)) in RADIATION.into_iter().enumerate() {
        scene.state.temperature[k] = inside;
        scene.expose(
            &[k],
            &through(Exchange { radiation, resistance, ..NOTHING }, Around::surroundings(constant(outside))),
        );
    }
    // As long as a sphere of 1200 K would radiate all its heat at that rate.
    let time = scene.capacity(0) / (radiation * 1200.0 * 1200.0 * 1200.0);
    // What the temperatures say of the time, over the time that passed.
    let mut clocks = |steps: u32| {
        scene.heat_step(time / f64::from(steps));
        let state = bench.after(&scene, steps.into())?;
        let mut found = [[0.0; 2]; 3];
        for (k, (_, inside, outside, resistance)) in RADIATION.into_iter().enumerate() {
            let behind = resistance * radiation;
            let clock = |temperature: f64| {
                let surface = surface_temperature(temperature, outside, behind);
                let fourth = |t: f64| t * t * t * t;
                // dT = (1 + 4 r T_s^3) dT_s on the way of the surface.
                time_of_radiation(surface, outside) + behind * libm::log((fourth(surface) - fourth(outside)).abs())
            };
            let now = state.temperature[k];
            let took = scene.capacity(k) / radiation * (clock(inside) - clock(now));
            found[k] = [took / time, (now - inside) / (outside - inside)];
        }
        Ok::<_, Fault>(found)
    };
    let (coarse, fine) = (clocks(500)?, clocks(1000)?);
    for (k, (what, ..)) in RADIATION.into_iter().enumerate() {
        // Euler's rule is of first order; what is left when that is taken out is of second.
        let extrapolated = 2.0 * fine[k][0] - coarse[k][0];
        let order = libm::log2((coarse[k][0] - 1.0) / (fine[k][0] - 1.0));
        let time = format!("{what}: time that it takes, in the limit of small steps, of the time that passed");
        bench.judge(time, "1", extrapolated, Kind::ClosedForm.within(1.0, 1e-4));
        bench.judge(format!("{what}: order"), "1", order, Kind::Order.within(1.0, 0.05));
        let moved = format!("{what}: part of the way to the surroundings");
        bench.judge(moved, "1", fine[k][1], Kind::ClosedForm.at_least(0.3));
    }
    Ok(())
}

/// What a slab is made of.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Body {
    /// One column of a simple cubic lattice.
    Column,
    /// A face-centred cubic lattice whose sides repeat.
    Lattice,
    /// A cube cut out of it, bars thicker for the bonds that its sides lack.
    Block,
}

/// A slab of layers that are held in place, and what its material is to the exact solution.
struct Layers {
    scene: Scene,
    /// The layer of each particle.
    layer: Vec<usize>,
    /// From layer to layer, m.
    spacing: f64,
    /// Of a face, of one particle, m².
    area: f64,
}

impl Layers {
    /// So many layers that hold as much heat as a solid of the density of [`ROCK`].
    fn of(body: Body, layers: usize) -> Self {
        let mut scene = scene(Form::Total, JOINT, 0.3);
        let (layer, spacing, area, section) = match body {
            Body::Column => {
                scene.chain(layers - 1);
                ((0..layers).collect(), SPACING, SPACING * SPACING, 1.0)
            }
            Body::Lattice | Body::Block => {
                let n = layers / 2;
                let (cells, open) = match body {
                    Body::Block => ([n; 3], Some([n as u32; 2])),
                    _ => ([2, 2, n], None),
                };
                if open.is_none() {
                    scene.repeat(cells, [true, true, false]);
                }
                let layer = scene.block(cells).into_iter().map(|site| site[2]).collect();
                let face = 0.5 * LATTICE_CONSTANT * LATTICE_CONSTANT;
                (layer, 0.5 * LATTICE_CONSTANT, face, face_centred_section(open))
            }
        };
        scene.hold_all();
        let bulk = scene.state.mass[0] / (area * spacing);
        let specific_heat = SOLID.specific_heat * ROCK.density / bulk;
        scene.heat(&[Material { specific_heat, ..SOLID }], section, CLOSED);
        Layers { scene, layer, spacing, area }
    }
    fn thickness(&self) -> f64 {
        let layers = self.layer.iter().fold(0, |last, &layer| last.max(layer)) + 1;
        layers as f64 * self.spacing
    }
    fn diffusivity() -> f64 {
        SOLID.conductivity / (ROCK.density * SOLID.specific_heat)
    }
    /// $G$ between a layer and what is behind a film on the face half a spacing away.
    fn conductance(&self, film: f64) -> f64 {
        surface_conductance(self.area, 0.5 * self.spacing, SOLID.conductivity, film)
    }
    fn particles(&self, layer: usize) -> Vec<usize> {
        (0..self.layer.len()).filter(|&k| self.layer[k] == layer).collect()
    }
    fn expose(&mut self, layer: usize, film: f64, outside: Course) {
        let exchange = Exchange { conductance: self.conductance(film), ..NOTHING };
        let particles = self.particles(layer);
        self.scene.expose(&particles, &through(exchange, Around::fluid(outside)));
    }
    /// Mean temperature of a layer.
    fn temperature(&self, state: &State, layer: usize) -> f64 {
        let particles = self.particles(layer);
        particles.iter().map(|&k| state.temperature[k]).sum::<f64>() / particles.len() as f64
    }
}

pub(super) fn one_surface(bench: &mut Bench) -> Result<(), Fault> {
    let (layers, inside, film, emissivity) = (6, 1100.0, 40.0, 0.8);
    let (flux, fluid, surroundings) = (2e3, 320.0, 450.0);
    let mut column = Layers::of(Body::Column, layers);
    column.expose(0, f64::INFINITY, constant(inside));
    let depth = 0.5 * column.spacing;
    let cover = Cover { area: column.area, depth, conductivity: SOLID.conductivity, film, emissivity };
    let around =
        Around { flux: Some(constant(flux)), fluid: Some(constant(fluid)), surroundings: Some(constant(surroundings)) };
    column.scene.expose(&[layers - 1], &through(cover.exchange(), around));
    // A quarter of the time that heat takes from layer to layer; a third would be the limit.
    column.scene.heat_step(0.25 * column.spacing * column.spacing / Layers::diffusivity());
    let state = bench.after(&column.scene, 2000)?;

    let slab = column.thickness() / SOLID.conductivity;
    let fourth = |t: f64| t * t * t * t;
    let lost = |face: f64| {
        film * (face - fluid) + emissivity * STEFAN_BOLTZMANN * (fourth(face) - fourth(surroundings)) - flux
    };
    let mut ends = [0.0, inside];
    for _ in 0..80 {
        let middle = 0.5 * (ends[0] + ends[1]);
        ends[usize::from((inside - middle) / slab < lost(middle))] = middle;
    }
    let face = ends[0];
    let layer = |k: usize| inside + (face - inside) * (k as f64 + 0.5) / layers as f64;
    let off = largest_difference(&state.temperature, (0..layers).map(layer));
    bench.judge("layers: largest difference", "K", off, Kind::ClosedForm.at_most(1e-8));
    let rate = column.conductance(f64::INFINITY) * (inside - state.temperature[0]) / column.area;
    bench.judge("heat through the slab", "W/m²", rate, Kind::ClosedForm.relative(lost(face), 1e-9));
    Ok(())
}

pub(super) fn semi_infinite(bench: &mut Bench) -> Result<(), Fault> {
    let (layers, reach, jump) = (112, 12.0, 100.0);
    let mut column = Layers::of(Body::Column, layers);
    column.expose(0, f64::INFINITY, constant(ROOM + jump));
    let unit = column.spacing * column.spacing / Layers::diffusivity();
    // A sixth of the unit is the step at which the errors of space and time cancel within.
    let steps = (6.0 * reach * reach) as u32;
    column.scene.heat_step(reach * reach * unit / f64::from(steps));
    let state = bench.after(&column.scene, steps.into())?;
    // x/(2 sqrt(alpha t)) of the middle of a layer.
    let place = |layer: usize| (layer as f64 + 0.5) / (2.0 * reach);
    let expected = (0..layers).map(|layer| ROOM + jump * libm::erfc(place(layer)));
    let off = largest_difference(&state.temperature, expected) / jump;
    bench.judge("temperatures: largest difference, of the jump", "1", off, Kind::ClosedForm.at_most(1e-3));
    let third = (state.temperature[2] - ROOM) / jump;
    bench.judge("third layer, of the jump", "1", third, Kind::ClosedForm.relative(libm::erfc(place(2)), 1e-3));
    Ok(())
}

/// The heating of refractory concrete: 0.2 m with $L^2/\alpha_T$ = 15 h, in `cells` cells of two layers each. Only
/// $\alpha_Tt/L^2$ and $hL/\lambda$ matter, so times are scaled to the layers that there are.
pub(super) fn slab(bench: &mut Bench, body: Body, cells: usize, tolerance: f64) -> Result<(), Fault> {
    let layers = 2 * cells;
    let mut wall = Layers::of(body, layers);
    let thickness = wall.thickness();
    // So many seconds here are an hour there.
    let hour = thickness * thickness / Layers::diffusivity() / 15.0;
    let film_coefficient = 10.0 * 0.2 / thickness;
    let at = |seconds: f64, celsius: f64| [seconds / 3600.0 * hour, 273.15 + celsius];
    let top = Course(vec![at(0.0, 20.0), at(10560.0, 900.0), at(12360.0, 900.0), at(20280.0, 20.0)]);
    let exact =
        Slab { thickness, diffusivity: Layers::diffusivity(), conductivity: SOLID.conductivity, film_coefficient };
    let heating = Heating { initial: ROOM, surroundings: ROOM, top: top.clone() };
    wall.expose(0, f64::INFINITY, top);
    wall.expose(layers - 1, film_coefficient, constant(ROOM));
    // Half an hour in steps of a quarter of the time that heat takes from layer to layer; a half would be the limit. At a
    // sixth the errors of space and time would cancel.
    let steps = (2.0 * (layers * layers) as f64 / 15.0).ceil();
    wall.scene.heat_step(0.5 * hour / steps);
    let mut simulation = bench.start(&wall.scene)?;
    let (mut off, mut middle_off, mut bottom) = (0.0_f64, 0.0_f64, 0.0);
    for half in 1..=11 {
        simulation.advance(steps as u64)?;
        let state = simulation.state()?;
        let time = 0.5 * hour * f64::from(half);
        let last = wall.temperature(&state, layers - 1);
        let rate = wall.conductance(film_coefficient) * (last - ROOM);
        bottom = ROOM + rate / (wall.area * film_coefficient);
        off = off.max((bottom - exact.temperature(&heating, thickness, time)).abs());
        let middle = wall.temperature(&state, cells);
        let depth = (cells as f64 + 0.5) * wall.spacing;
        middle_off = middle_off.max((middle - exact.temperature(&heating, depth, time)).abs());
    }
    bench.seal(&simulation.state()?);
    bench.judge("bottom surface: largest difference", "K", off, Kind::ClosedForm.at_most(tolerance));
    // The middle becomes twice as warm as the bottom.
    let what = "layer behind the middle: largest difference";
    bench.judge(what, "K", middle_off, Kind::ClosedForm.at_most(2.0 * tolerance));
    bench.judge("bottom surface after 5.5 h", "K", bottom, Kind::Reference.within(273.15 + 201.2599, tolerance));
    Ok(())
}
