//! A sphere on an incline: rolling, sliding, held by static friction.

use super::scene::{Bench, GRAVITY, Hertz, STEEL, Scene, With};
use super::{Case, Kind, Tier};
use tdem_engine::physics::contact::Law;
use tdem_engine::{Constraint, Fault, WallContact};

pub(super) const CASES: &[Case] = &[
    Case {
        name: "plane/incline-rolling",
        tier: Tier::Quick,
        source: "a = (5/7) g sin(theta) while tan(theta) <= 3.5 mu",
        about: "A solid sphere rolls down inclines of 5, 20 and 40 degrees from rest, mu = 0.3.",
        body: |bench| {
            for angle in [5.0, 20.0, 40.0] {
                run_down(bench, angle, 0.3)?;
            }
            Ok(())
        },
    },
    Case {
        name: "plane/incline-sliding",
        tier: Tier::Quick,
        source: "a = g (sin(theta) - mu cos(theta)), alpha = 5 mu g cos(theta)/(2R) beyond tan(theta) = 3.5 mu",
        about: "A solid sphere slips down inclines of 40, 55 and 75 degrees from rest, mu = 0.2.",
        body: |bench| {
            for angle in [40.0, 55.0, 75.0] {
                run_down(bench, angle, 0.2)?;
            }
            Ok(())
        },
    },
    Case {
        name: "plane/incline-static-friction",
        tier: Tier::Quick,
        source: "Coulomb: no slip if and only if tan(theta) <= mu",
        about: "A sphere that may not turn rests on an incline just below the limit and slips just above it.",
        body: static_friction,
    },
    Case {
        name: "plane/incline-static-and-dynamic-friction",
        tier: Tier::Quick,
        source: "Coulomb with mu_s > mu_d: between the two, rest stays rest and sliding goes on, a = g (sin - mu_d cos)",
        about: "A sphere that may not turn on an incline of tan(theta) = 0.45, mu_s = 0.5, mu_d = 0.4.",
        body: two_coefficients,
    },
    Case {
        name: "plane/incline-sudden-load",
        tier: Tier::Quick,
        source: "the spring and dashpot of the contact come to rest at m g sin(theta)/k_t",
        about: "A sphere that may not turn is let go on an incline of 15 degrees with a slack spring, mu = 0.6.",
        body: sudden_load,
    },
];

const RADIUS: f64 = 0.01;

/// A sphere settled on a plane that is tilted by turning gravity; tangent of the angle.
struct Incline {
    scene: Scene,
    sine: f64,
    cosine: f64,
    /// Tangential displacement at which the spring carries the sphere, m.
    carrying: f64,
    frequency: f64,
}

fn incline(tangent: f64, static_friction: f64, dynamic_friction: f64, law: Law) -> Incline {
    let cosine = 1.0 / (1.0 + tangent * tangent).sqrt();
    let sine = tangent * cosine;
    let mass = STEEL.sphere_mass(RADIUS);
    let mut interaction = STEEL.with_itself().friction(static_friction);
    interaction.dynamic_friction = dynamic_friction;
    let overlap = Hertz::new(&interaction, RADIUS, mass).overlap(mass * GRAVITY * cosine);
    let frequency = (1.5 * GRAVITY * cosine / overlap).sqrt();
    let mut scene = Scene::new(law, interaction.dashpots(frequency, frequency), 0.2 / frequency);
    scene.plan.gravity = [GRAVITY * sine, 0.0, -GRAVITY * cosine];
    scene.plan.ledger = false;
    scene.floor();
    scene.sphere(RADIUS, STEEL.density, [0.0, 0.0, RADIUS - overlap]);
    let stiffness = interaction.tangential_stiffness * (RADIUS * overlap).sqrt();
    Incline { scene, sine, cosine, carrying: mass * GRAVITY * sine / stiffness, frequency }
}

impl Incline {
    fn lock(&mut self) {
        self.scene.hold(0, Constraint { angular_velocity: [Some(0.0); 3], ..Constraint::FREE });
    }
    /// Gives the spring the displacement at which it carries the sphere.
    fn load(&mut self) {
        let displacement = [-self.carrying, 0.0, 0.0];
        self.scene.state.wall_contacts = vec![WallContact { particle: 0, wall: 0, displacement }];
    }
}

fn run_down(bench: &mut Bench, angle: f64, friction: f64) -> Result<(), Fault> {
    let tangent = libm::tan(angle.to_radians());
    let Incline { scene, sine, cosine, .. } = incline(tangent, friction, friction, Law::GNTM);
    let steps = (0.05 / scene.plan.dt) as u64;
    let state = bench.after(&scene, steps)?;
    let time = scene.plan.time(steps);
    let (acceleration, angular) = if tangent <= 3.5 * friction {
        let a = 5.0 / 7.0 * GRAVITY * sine;
        (a, a / RADIUS)
    } else {
        (GRAVITY * (sine - friction * cosine), 2.5 * friction * GRAVITY * cosine / RADIUS)
    };
    let got = state.velocity[0][0] / time;
    bench.judge(format!("{angle} deg: acceleration"), "m/s2", got, Kind::ClosedForm.relative(acceleration, 5e-3));
    let got = state.angular_velocity[0][1] / time;
    bench.judge(format!("{angle} deg: angular"), "rad/s2", got, Kind::ClosedForm.relative(angular, 5e-3));
    let got = 2.0 * state.position[0][0] / (time * time);
    bench.judge(format!("{angle} deg: from the way"), "m/s2", got, Kind::ClosedForm.relative(acceleration, 5e-3));
    Ok(())
}

fn static_friction(bench: &mut Bench) -> Result<(), Fault> {
    let friction = 0.4;
    let mut below = incline(0.999 * friction, friction, friction, Law::GNTM);
    below.lock();
    below.load();
    let steps = 20_000;
    let state = bench.after(&below.scene, steps)?;
    let creep = state.position[0][0].abs() / RADIUS / below.scene.plan.time(steps);
    bench.judge("creep at 0.999 of the limit, radii per second", "1/s", creep, Kind::ClosedForm.at_most(1e-6));
    let mut above = incline(1.001 * friction, friction, friction, Law::GNTM);
    above.lock();
    above.load();
    let state = bench.after(&above.scene, steps)?;
    let got = state.velocity[0][0] / above.scene.plan.time(steps);
    let expected = GRAVITY * (above.sine - friction * above.cosine);
    bench.judge("acceleration at 1.001 of the limit", "m/s2", got, Kind::ClosedForm.relative(expected, 5e-3));
    Ok(())
}

fn two_coefficients(bench: &mut Bench) -> Result<(), Fault> {
    let mut rest = incline(0.45, 0.5, 0.4, Law::GNT);
    rest.load();
    let steps = 5000;
    let state = bench.after(&rest.scene, steps)?;
    let creep = state.position[0][0].abs() / RADIUS / rest.scene.plan.time(steps);
    bench.judge("creep from rest, radii per second", "1/s", creep, Kind::ClosedForm.at_most(1e-6));
    let mut moving = incline(0.45, 0.5, 0.4, Law::GNT);
    moving.scene.state.velocity[0][0] = 0.01;
    let state = bench.after(&moving.scene, steps)?;
    let got = (state.velocity[0][0] - 0.01) / moving.scene.plan.time(steps);
    let expected = GRAVITY * (moving.sine - 0.4 * moving.cosine);
    bench.judge("acceleration while sliding", "m/s2", got, Kind::ClosedForm.relative(expected, 5e-3));
    Ok(())
}

fn sudden_load(bench: &mut Bench) -> Result<(), Fault> {
    let mut slack = incline(libm::tan(15_f64.to_radians()), 0.6, 0.6, Law::GNTM);
    slack.lock();
    let mut simulation = bench.start(&slack.scene)?;
    simulation.advance(2000)?;
    let before = simulation.state()?;
    simulation.advance(2000)?;
    let state = simulation.state()?;
    let got = -state.wall_contacts.first().map_or(f64::NAN, |contact| contact.displacement[0]);
    bench.judge("displacement of the spring", "m", got, Kind::ClosedForm.relative(slack.carrying, 1e-6));
    bench.judge("way", "m", state.position[0][0], Kind::ClosedForm.relative(slack.carrying, 1e-6));
    let speed = (state.position[0][0] - before.position[0][0]).abs() * slack.frequency / 400.0 / RADIUS;
    bench.judge("creep afterwards, radii per second", "1/s", speed, Kind::ClosedForm.at_most(1e-6));
    bench.seal(&state);
    Ok(())
}
