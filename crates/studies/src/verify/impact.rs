//! Central impacts: Hertz, and both kinds of damping.

use super::scene::{Bench, Hertz, Scene, Solid, With, crossing, elastic, solid};
use super::{Case, Kind, Tier};
use tdem_engine::Fault;
use tdem_engine::physics::contact::{Damping, Interaction, Law};

const CHUNG_OOI: &str = "Chung & Ooi, Granular Matter 13 (2011) 643; values: Hertz's theory for these materials";

pub(super) const CASES: &[Case] = &[
    Case {
        name: "contact/chung-ooi-1-glass",
        tier: Tier::Quick,
        source: CHUNG_OOI,
        about: "Two glass spheres, R = 10 mm, meet head-on at 10 m/s each.",
        body: |bench| two_spheres(bench, solid(4.8e10, 0.2, 2800.0), [2.741_127e-4, 1.069_689e4, 4.033_945e-5]),
    },
    Case {
        name: "contact/chung-ooi-1-limestone",
        tier: Tier::Quick,
        source: CHUNG_OOI,
        about: "Two limestone spheres, R = 10 mm, meet head-on at 10 m/s each.",
        body: |bench| two_spheres(bench, solid(2e10, 0.25, 2500.0), [3.683_040e-4, 7.108_241e3, 5.420_100e-5]),
    },
    Case {
        name: "contact/chung-ooi-2-aluminium-alloy",
        tier: Tier::Quick,
        source: CHUNG_OOI,
        about: "An aluminium sphere, R = 100 mm, hits a rigid plane at 0.2 m/s.",
        body: |bench| on_plane(bench, solid(7e10, 0.3, 2699.0), 0.1, 0.2, [4.971_718e-5, 1.136_986e4, 7.316_566e-4]),
    },
    Case {
        name: "contact/chung-ooi-2-magnesium-alloy",
        tier: Tier::Quick,
        source: CHUNG_OOI,
        about: "A magnesium sphere, R = 100 mm, hits a rigid plane at 0.2 m/s.",
        body: |bench| on_plane(bench, solid(4e10, 0.35, 1800.0), 0.1, 0.2, [5.212_329e-5, 7.232_681e3, 7.670_659e-4]),
    },
    Case {
        name: "contact/chung-ooi-3-elastic-aluminium-oxide",
        tier: Tier::Quick,
        source: CHUNG_OOI,
        about: "A sphere of aluminium oxide, R = 2.5 mm, hits a rigid plane at 3.9 m/s, e = 1.",
        body: |bench| {
            on_plane(bench, super::scene::ALUMINIUM_OXIDE, 0.0025, 3.9, [8.088_808e-6, 615.3516, 6.104_51e-6])
        },
    },
    Case {
        name: "contact/chung-ooi-3-elastic-cast-iron",
        tier: Tier::Quick,
        source: CHUNG_OOI,
        about: "A sphere of cast iron, R = 2.5 mm, hits a rigid plane at 3.9 m/s, e = 1.",
        body: |bench| on_plane(bench, CAST_IRON, 0.0025, 3.9, [1.718_871e-5, 506.7602, 1.297_208e-5]),
    },
    Case {
        name: "contact/chung-ooi-3-aluminium-oxide",
        tier: Tier::Quick,
        source: "Chung & Ooi (2011) test 3; Tsuji's damping keeps e exactly if the dashpot may attract",
        about: "A sphere of aluminium oxide hits a rigid plane at 3.9 m/s: rebound for e from 0.2 to 0.98.",
        body: |bench| restitutions(bench, super::scene::ALUMINIUM_OXIDE, 3.9),
    },
    Case {
        name: "contact/chung-ooi-3-cast-iron",
        tier: Tier::Quick,
        source: "Chung & Ooi (2011) test 3; Tsuji's damping keeps e exactly if the dashpot may attract",
        about: "A sphere of cast iron hits a rigid plane at 3.9 m/s: rebound for e from 0.2 to 0.98.",
        body: |bench| restitutions(bench, CAST_IRON, 3.9),
    },
    Case {
        name: "contact/restitution-is-independent-of-speed",
        tier: Tier::Quick,
        source: "Antypov & Elliott, EPL 94 (2011) 50004",
        about: "e = 0.7 at impact speeds over four decades.",
        body: independent_of_speed,
    },
    Case {
        name: "contact/restitution-clamped",
        tier: Tier::Quick,
        source: "integration of the scaled equation of motion by an adaptive Runge-Kutta method (scipy)",
        about: "Tsuji's damping with the normal force clamped at zero: the rebound is faster than e.",
        body: clamped,
    },
    Case {
        name: "contact/viscous-damping",
        tier: Tier::Quick,
        source: "integration of x'' + G x' + x^1.5 = 0 by an adaptive Runge-Kutta method (scipy)",
        about: "Damping by coefficient, which may attract: rebound over impact speed, G = gamma (m*/(k_H sqrt v))^(2/5).",
        body: |bench| viscous(bench, false),
    },
    Case {
        name: "contact/viscous-damping-clamped",
        tier: Tier::Quick,
        source: "integration of x'' + max(G x' + x^1.5, 0) = 0 by an adaptive Runge-Kutta method (scipy)",
        about: "Damping by coefficient, normal force clamped at zero: rebound over impact speed.",
        body: |bench| viscous(bench, true),
    },
    Case {
        name: "contact/materials-by-pair",
        tier: Tier::Quick,
        source: "Hertz, J. reine angew. Math. 92 (1882) 156",
        about: "Glass hits steel: 1/E* = (1-nu1^2)/E1 + (1-nu2^2)/E2, 1/R* = 1/R1 + 1/R2, 1/m* = 1/m1 + 1/m2.",
        body: by_pair,
    },
];

const CAST_IRON: Solid = solid(1e11, 0.25, 7000.0);

/// Overlap, force and duration of an impact that was watched in every step.
struct Watched {
    largest_overlap: f64,
    largest_force: f64,
    duration: f64,
    velocity: [f64; 3],
}

/// Steps until the overlap that `overlap` finds has ended.
fn watch(bench: &mut Bench, scene: &Scene, overlap: impl Fn(&[[f64; 3]]) -> f64) -> Result<Watched, Fault> {
    let mut simulation = bench.start(scene)?;
    let mut watched = Watched { largest_overlap: 0.0, largest_force: 0.0, duration: f64::NAN, velocity: [f64::NAN; 3] };
    let mut before = 0.0;
    for _ in 0..100_000 {
        simulation.advance(1)?;
        let state = simulation.state()?;
        let h = overlap(&state.position);
        watched.largest_overlap = watched.largest_overlap.max(h);
        watched.largest_force = watched.largest_force.max(state.force[0].iter().map(|f| f * f).sum::<f64>().sqrt());
        if h < 0.0 {
            watched.duration = simulation.time() + (crossing(before, h) - 1.0) * scene.plan.dt;
            watched.velocity = state.velocity[0];
            bench.seal(&state);
            break;
        }
        before = h;
    }
    Ok(watched)
}

/// Steps per impact where the impact is watched: the largest overlap is then sampled to 1e-6.
const WATCHED_STEPS: f64 = 2000.0;

fn judge_hertz(bench: &mut Bench, watched: &Watched, expected: [f64; 3]) {
    bench.judge("largest overlap", "m", watched.largest_overlap, Kind::ClosedForm.relative(expected[0], 1e-5));
    bench.judge("largest force", "N", watched.largest_force, Kind::ClosedForm.relative(expected[1], 1e-5));
    bench.judge("duration", "s", watched.duration, Kind::ClosedForm.relative(expected[2], 1e-5));
}

fn two_spheres(bench: &mut Bench, material: Solid, expected: [f64; 3]) -> Result<(), Fault> {
    let (radius, speed) = (0.01, 10.0);
    let interaction = material.with_itself();
    let hertz = Hertz::new(&interaction, 0.5 * radius, 0.5 * material.sphere_mass(radius));
    let mut scene = Scene::new(Law::GN, interaction, hertz.duration(2.0 * speed) / WATCHED_STEPS);
    scene.moving(radius, material.density, [-radius, 0.0, 0.0], [speed, 0.0, 0.0]);
    scene.moving(radius, material.density, [radius, 0.0, 0.0], [-speed, 0.0, 0.0]);
    let watched = watch(bench, &scene, |x| 2.0 * radius - (x[1][0] - x[0][0]))?;
    judge_hertz(bench, &watched, expected);
    bench.judge("rebound", "m/s", -watched.velocity[0], Kind::ClosedForm.relative(speed, 1e-7));
    Ok(())
}

fn on_plane(bench: &mut Bench, material: Solid, radius: f64, speed: f64, expected: [f64; 3]) -> Result<(), Fault> {
    let interaction = material.with_rigid();
    let hertz = Hertz::new(&interaction, radius, material.sphere_mass(radius));
    let mut scene = Scene::new(Law::GN, interaction, hertz.duration(speed) / WATCHED_STEPS);
    scene.floor();
    scene.moving(radius, material.density, [0.0, 0.0, radius], [0.0, 0.0, -speed]);
    let watched = watch(bench, &scene, |x| radius - x[0][2])?;
    judge_hertz(bench, &watched, expected);
    bench.judge("rebound", "m/s", watched.velocity[2], Kind::ClosedForm.relative(speed, 1e-7));
    Ok(())
}

fn by_pair(bench: &mut Bench) -> Result<(), Fault> {
    let (glass, steel) = (solid(4.8e10, 0.2, 2800.0), super::scene::STEEL);
    let (small, large, speed) = (0.01, 0.025, 3.0);
    // Materials 0 and 1; contacts within a material are made ten times stiffer, so that only the right entry fits.
    let mixed = elastic(glass.elastic, steel.elastic);
    let wrong = Interaction { normal_stiffness: 10.0 * mixed.normal_stiffness, ..mixed };
    let (mg, ms) = (glass.sphere_mass(small), steel.sphere_mass(large));
    let e_eff = 1.0 / ((1.0 - 0.04) / 4.8e10 + (1.0 - 0.09) / 2.08e11);
    let (r_eff, m_eff) = (1.0 / (1.0 / small + 1.0 / large), 1.0 / (1.0 / mg + 1.0 / ms));
    let overlap = libm::pow(15.0 * m_eff * speed * speed / (16.0 * e_eff * r_eff.sqrt()), 0.4);
    let force = 4.0 / 3.0 * e_eff * r_eff.sqrt() * overlap * overlap.sqrt();
    let duration = 2.868_265_7 * libm::pow(m_eff * m_eff / (r_eff * e_eff * e_eff * speed), 0.2);
    let mut scene = Scene::new(Law::GN, wrong, duration / WATCHED_STEPS);
    (scene.plan.interactions[1], scene.plan.interactions[2]) = (mixed, mixed);
    scene.moving(small, glass.density, [-small, 0.0, 0.0], [speed, 0.0, 0.0]);
    scene.sphere(large, steel.density, [large, 0.0, 0.0]);
    scene.state.material[1] = 1;
    let watched = watch(bench, &scene, |x| small + large - (x[1][0] - x[0][0]))?;
    judge_hertz(bench, &watched, [overlap, force, duration]);
    let rebound = speed * (mg - ms) / (mg + ms);
    bench.judge(
        "velocity of the glass afterwards",
        "m/s",
        watched.velocity[0],
        Kind::ClosedForm.relative(rebound, 1e-6),
    );
    Ok(())
}

/// How finely and how long a set of impacts is followed: steps per elastic impact, and elastic impacts.
#[derive(Clone, Copy)]
struct Watch {
    parts: f64,
    durations: f64,
}

/// Rebound speeds of spheres that hit a plane side by side, extrapolated to vanishing steps: forces see the velocity of
/// the half step, which costs an error of first order.
fn rebounds(
    bench: &mut Bench,
    law: Law,
    interactions: &[Interaction<f64>],
    speeds: &[f64],
    watch: Watch,
) -> Result<Vec<f64>, Fault> {
    let (radius, material) = (0.0025, CAST_IRON);
    let mass = material.sphere_mass(radius);
    let shortest = interactions
        .iter()
        .zip(speeds)
        .map(|(i, &speed)| Hertz::new(i, radius, mass).duration(speed))
        .fold(f64::INFINITY, f64::min);
    let longest = interactions
        .iter()
        .zip(speeds)
        .map(|(i, &speed)| Hertz::new(i, radius, mass).duration(speed))
        .fold(0.0, f64::max);
    let mut rough = Vec::new();
    let mut fine = Vec::new();
    for (parts, found) in [(watch.parts, &mut rough), (2.0 * watch.parts, &mut fine)] {
        let mut scene = Scene::side_by_side(law, interactions, shortest / parts);
        scene.floor();
        for (k, &speed) in speeds.iter().enumerate() {
            let at = [4.0 * radius * k as f64, 0.0, radius];
            let index = scene.moving(radius, material.density, at, [0.0, 0.0, -speed]);
            scene.state.material[index] = k as u16;
        }
        let steps = (watch.durations * longest / scene.plan.dt) as u64;
        let state = bench.after(&scene, steps)?;
        let parted = |k: usize| !state.wall_contacts.iter().any(|c| c.particle as usize == k);
        found.extend((0..speeds.len()).map(|k| if parted(k) { state.velocity[k][2] / speeds[k] } else { f64::NAN }));
    }
    Ok(rough.iter().zip(&fine).map(|(rough, fine)| 2.0 * fine - rough).collect())
}

const TSUJI: Law = Law { damping: Damping::Restitution, ..Law::GN };

fn restitutions(bench: &mut Bench, material: Solid, speed: f64) -> Result<(), Fault> {
    let wanted = [0.2, 0.4, 0.5, 0.6, 0.8, 0.9, 0.98];
    let interactions = wanted.map(|e| material.with_rigid().restitution(e));
    let found = rebounds(bench, TSUJI, &interactions, &[speed; 7], Watch { parts: 2000.0, durations: 4.0 })?;
    for (e, found) in wanted.iter().zip(found) {
        bench.judge(format!("rebound over impact speed, e = {e}"), "1", found, Kind::ClosedForm.within(*e, 2e-5));
    }
    Ok(())
}

fn independent_of_speed(bench: &mut Bench) -> Result<(), Fault> {
    let speeds = [0.003, 0.03, 0.3, 3.0, 30.0];
    let interactions = speeds.map(|_| CAST_IRON.with_rigid().restitution(0.7));
    let found = rebounds(bench, TSUJI, &interactions, &speeds, Watch { parts: 2000.0, durations: 2.0 })?;
    for (speed, found) in speeds.iter().zip(found) {
        bench.judge(
            format!("rebound over impact speed at {speed} m/s"),
            "1",
            found,
            Kind::ClosedForm.within(0.7, 2e-5),
        );
    }
    Ok(())
}

fn clamped(bench: &mut Bench) -> Result<(), Fault> {
    let table = [
        (0.2, 0.32486),
        (0.4, 0.47201),
        (0.5, 0.55028),
        (0.6, 0.63229),
        (0.8, 0.80810),
        (0.9, 0.90203),
        (0.98, 0.98008),
    ];
    let interactions = table.map(|(e, _)| CAST_IRON.with_rigid().restitution(e).clamped());
    let found = rebounds(bench, TSUJI, &interactions, &[1.0; 7], Watch { parts: 2000.0, durations: 4.0 })?;
    for ((e, out), found) in table.iter().zip(found) {
        bench.judge(format!("rebound over impact speed, e = {e}"), "1", found, Kind::Reference.within(*out, 2e-5));
    }
    Ok(())
}

fn viscous(bench: &mut Bench, clamp: bool) -> Result<(), Fault> {
    // G, rebound if the dashpot may attract, rebound if not.
    let table = [
        (0.05, 0.91372, 0.91756),
        (0.1, 0.83335, 0.84488),
        (0.2, 0.68856, 0.72143),
        (0.3, 0.56253, 0.62068),
        (0.5, 0.35691, 0.46804),
        (0.7, 0.20110, 0.36044),
        (1.0, 0.04132, 0.25184),
        (1.5, f64::NAN, 0.14908),
        (2.0, f64::NAN, 0.09493),
    ];
    let radius = 0.0025;
    let plain = CAST_IRON.with_rigid();
    let hertz = Hertz::new(&plain, radius, CAST_IRON.sphere_mass(radius));
    let unit = libm::pow(hertz.mass_eff / hertz.stiffness, 0.4);
    let mut table = table.to_vec();
    if !clamp {
        table.retain(|row| row.1.is_finite());
    }
    let interactions: Vec<_> = table
        .iter()
        .map(|&(g, ..)| {
            let damped = plain.dashpots(g / unit, 0.0);
            if clamp { damped.clamped() } else { damped }
        })
        .collect();
    // Where the dashpot may attract, it still pulls when the contact opens, somewhere within a step: an error of about
    // gamma dt e that extrapolation cannot remove.
    let (watch, width) = if clamp {
        (Watch { parts: 2000.0, durations: 12.0 }, 2e-5)
    } else {
        (Watch { parts: 8000.0, durations: 5.0 }, 1e-4)
    };
    let found = rebounds(bench, Law::GN, &interactions, &vec![1.0; table.len()], watch)?;
    for (&(g, attracting, pushing), found) in table.iter().zip(found) {
        let expected = if clamp { pushing } else { attracting };
        bench.judge(format!("rebound over impact speed, G = {g}"), "1", found, Kind::Reference.within(expected, width));
    }
    if !clamp {
        // Beyond G of about 1.1 the dashpot holds the sphere back: it does not rebound.
        let damped = plain.dashpots(2.0 / unit, 0.0);
        let mut scene = Scene::new(Law::GN, damped, hertz.duration(1.0) / 100.0);
        scene.floor();
        scene.moving(radius, CAST_IRON.density, [0.0, 0.0, radius], [0.0, 0.0, -1.0]);
        let state = bench.after(&scene, 10_000)?;
        let touching = state.wall_contacts.len() as f64;
        bench.judge("contacts left long after, G = 2", "1", touching, Kind::Reference.within(1.0, 0.0));
        bench.judge("speed left long after, G = 2", "m/s", state.velocity[0][2].abs(), Kind::Reference.at_most(1e-5));
    }
    Ok(())
}
