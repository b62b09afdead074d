//! What must come out whatever happens: heat that is kept, and results that do not depend on the time scale.

use super::{CLOSED, Material, NOTHING, ROOM, SOLID, constant, furnace, held_at, largest_difference, through};
use crate::verify::Kind;
use crate::verify::bonded::{JOINT, RADIUS, ROCK, SPACING, numbers, scene};
use crate::verify::conservation::cloud;
use crate::verify::scene::{Bench, HELD, PLASTIC, Scene, With};
use tdem_engine::physics::bond::Form;
use tdem_engine::physics::heat::{Exchange, Path};
use tdem_engine::{Around, Bond, Course, Exposure, Fault, State, heat_accounts};

pub(super) fn time_scale(bench: &mut Bench) -> Result<(), Fault> {
    let (links, steps, part) = (8, 1000, 0.04);
    let expansion = 1e-6;
    let mut scene = scene(Form::Total, JOINT, 0.3);
    scene.chain(links);
    scene.damp_locally(0.7);
    scene.hold(0, HELD);
    scene.hold(links, HELD);
    scene.heat(&[Material { expansion, ..SOLID }], 1.0, CLOSED);
    let conductance = SOLID.conductivity * SPACING;
    let heat_step = part * scene.capacity(0) / conductance;
    let ramp = Course(vec![[0.0, ROOM], [0.5 * steps as f64 * heat_step, ROOM + 400.0]]);
    scene.expose(&[0], &through(Exchange { conductance, ..NOTHING }, Around::fluid(ramp)));
    let mut at = |halved: u64| {
        scene.heat_step(heat_step / halved as f64);
        bench.after(&scene, halved * steps)
    };
    let (fast, slow) = (at(1)?, at(2)?);
    let warmth = fast.temperature[0] - ROOM;
    let off = largest_difference(&fast.temperature, slow.temperature.iter().copied()) / warmth;
    bench.judge(
        "S against S/2: temperatures, largest difference, of the warmth",
        "1",
        off,
        Kind::Invariance.at_most(0.01),
    );
    bench.judge("warmth at the end that is heated", "K", warmth, Kind::Invariance.at_least(100.0));
    let force = |state: &State| -state.force[links][0];
    let between = force(&fast) / force(&slow);
    bench.judge("S against S/2: force at the rigid end", "1", between, Kind::Invariance.within(1.0, 0.01));
    for (what, state) in [("S", &fast), ("S/2", &slow)] {
        let warmths: f64 = state.temperature.windows(2).map(|pair| 0.5 * (pair[0] + pair[1]) - ROOM).sum();
        let expected = -numbers(&JOINT).stiffness.normal * SPACING * expansion * warmths / links as f64;
        let what = format!("{what}: force at the rigid end");
        bench.judge(what, "N", force(state), Kind::ClosedForm.relative(expected, 0.01));
    }
    Ok(())
}

/// Spheres of [`PLASTIC`] between walls, some of them bonded.
fn crowd() -> Scene {
    let mut scene = scene(Form::Total, JOINT, 0.1);
    let contact = PLASTIC.with_itself().friction(0.5).dashpots(20.0, 5.0).clamped();
    scene.plan.interactions.fill(contact);
    let spacing = 2.4 * RADIUS;
    cloud(&mut scene, spacing, 0.7 * RADIUS, RADIUS, 1.0);
    let bonded = scene.state.len() as u32;
    for k in 0..3 {
        let place = [3.3 * spacing, SPACING * f64::from(k) + RADIUS, 1.5 * spacing];
        scene.moving(RADIUS, ROCK.density, place, [-0.5, 0.2, 0.0]);
    }
    scene.state.make_bonds(vec![Bond::new(bonded, bonded + 1, 1.0), Bond::new(bonded + 1, bonded + 2, 1.0)]);
    let ends = [3.3 * spacing + RADIUS, 3.0 * spacing, 3.0 * spacing];
    for d in 0..3 {
        let mut normal = [0.0; 3];
        normal[d] = 1.0;
        scene.wall(normal, [0.0; 3]);
        scene.wall(normal.map(|n| -n), ends);
    }
    scene
}

pub(super) fn first_law(bench: &mut Bench) -> Result<(), Fault> {
    let mut scene = crowd();
    scene.heat(&[Material { expansion: 2e-5, ..SOLID }], 1.0, Path::Bar);
    scene.heat_step(0.5);
    let (steps, parts) = (2000, 20);
    let duration = 0.5 * steps as f64;
    let cool = Course(vec![[0.0, 250.0], [duration, 350.0]]);
    scene.warm_walls(&[Some(constant(600.0)), None, None, Some(cool), None, None]);
    let flux = Exchange { flux_area: 3e-5, ..NOTHING };
    let film = Exchange { conductance: 1e-4, radiation: 2e-12, resistance: 30.0, ..NOTHING };
    let exchanges = vec![(flux, Around::flux(Course(vec![[0.0, 3e3], [duration, -2e3]]))), (film, furnace(500.0))];
    scene.expose(&[0, 4, 8, 12, 16, 20, 24], &Exposure { temperature: None, exchanges });
    scene.expose(&[5, 13], &held_at(Course(vec![[0.0, ROOM], [0.5 * duration, 500.0], [duration, 320.0]])));
    scene.expose(&[27], &through(film, furnace(900.0)));
    let stored = |state: &State| {
        let of = |k: usize| scene.capacity(k) * state.temperature[k] + state.heat_rate[k] * scene.plan.heat_step();
        (0..state.len()).map(of).sum::<f64>()
    };
    let begin = bench.after(&scene, 0)?;
    let mut simulation = bench.start(&scene)?;
    let mut met = 0;
    for _ in 0..parts {
        simulation.advance(steps / parts)?;
        let state = simulation.state()?;
        met += state.contacts.len() + state.wall_contacts.len();
    }
    let end = simulation.state()?;
    bench.seal(&end);
    let [came, left] = [heat_accounts::IN, heat_accounts::OUT]
        .map(|column| end.heat_accounts.iter().map(|account| account[column]).sum::<f64>());
    let error = (stored(&end) - stored(&begin) - came + left).abs() / stored(&end);
    bench.judge("stored - in + out, of the heat stored", "1", error, Kind::Conservation.at_most(1e-12));
    let part = |heat: f64| heat / stored(&begin);
    bench.judge("came in, of the heat stored", "1", part(came), Kind::Conservation.at_least(0.05));
    bench.judge("went out, of the heat stored", "1", part(left), Kind::Conservation.at_least(0.02));
    bench.judge("contacts, sum of 20 moments", "1", met as f64, Kind::Conservation.at_least(20.0));
    Ok(())
}
