//! Impacts of two free spheres: impulses in closed form.

use super::scene::{ALUMINIUM_ALLOY, Bench, Hertz, STEEL, Scene, Solid, With, solid};
use super::{Case, Kind, Tier};
use tdem_engine::physics::contact::{Damping, Interaction, Law};
use tdem_engine::{Fault, State};

const COPPER: Solid = solid(1.2e11, 0.35, 8900.0);
const DISPLACEMENT: Law = Law { damping: Damping::Restitution, ..Law::GNTM };
const COULOMB: &str = "impulses of rigid bodies with the realised restitution: P_n = (1+e) m* v_n, P_t = mu P_n";

pub(super) const CASES: &[Case] = &[
    Case {
        name: "contact/chung-ooi-7-aluminium-alloy",
        tier: Tier::Quick,
        source: "Chung & Ooi, Granular Matter 13 (2011) 643, test 7",
        about: "Two equal spheres with opposite spins, so that the surfaces do not slip: no friction, no change of spin.",
        body: |bench| matched_spins(bench, ALUMINIUM_ALLOY),
    },
    Case {
        name: "contact/chung-ooi-7-copper",
        tier: Tier::Quick,
        source: "Chung & Ooi, Granular Matter 13 (2011) 643, test 7",
        about: "Two equal spheres with opposite spins, so that the surfaces do not slip: no friction, no change of spin.",
        body: |bench| matched_spins(bench, COPPER),
    },
    Case {
        name: "contact/chung-ooi-8-large-sphere",
        tier: Tier::Quick,
        source: COULOMB,
        about: "A spinning sphere falls on a larger one at rest and slides throughout.",
        body: |bench| {
            let meeting = Meeting { speed: 0.2, slip: [0.0; 2], spin: [-40.0, 0.0], radius: [0.1, 0.4] };
            sliding(
                bench,
                DISPLACEMENT,
                &meeting,
                ALUMINIUM_ALLOY.with_itself().friction(0.4).restitution(0.5).clamped(),
            )
        },
    },
    Case {
        name: "contact/sliding-impulse",
        tier: Tier::Quick,
        source: COULOMB,
        about: "Two unequal spheres, both spinning, slide on each other throughout while they move across together.",
        body: |bench| {
            let meeting = Meeting { speed: 0.5, slip: [0.4; 2], spin: [-30.0, -60.0], radius: [0.05, 0.03] };
            sliding(bench, DISPLACEMENT, &meeting, STEEL.with_itself().friction(0.15).restitution(0.8).clamped())
        },
    },
    Case {
        name: "contact/sliding-impulse-viscous",
        tier: Tier::Quick,
        source: COULOMB,
        about: "The same with damping by coefficient.",
        body: |bench| {
            let meeting = Meeting { speed: 0.5, slip: [0.4; 2], spin: [-30.0, -60.0], radius: [0.05, 0.03] };
            sliding(bench, Law::GNTM, &meeting, STEEL.with_itself().friction(0.15).dashpots(2000.0, 300.0).clamped())
        },
    },
    Case {
        name: "contact/sliding-impulse-without-moments",
        tier: Tier::Quick,
        source: COULOMB,
        about: "A sphere without moments hits a plane obliquely: it is braked but does not begin to turn.",
        body: without_moments,
    },
    Case {
        name: "contact/sticking-impulse",
        tier: Tier::Quick,
        source: "impulse that ends the slip of two equal solid spheres: P_t = (2/7) m* slip",
        about: "A strong tangential dashpot without spring brings two surfaces to the same speed.",
        body: sticking,
    },
];

/// Two spheres that touch on the z axis, the first above, and approach along it; they move along x and spin about y.
struct Meeting {
    /// Approach of the first sphere, the second rests in z.
    speed: f64,
    /// Velocities along x.
    slip: [f64; 2],
    /// Angular velocities about y.
    spin: [f64; 2],
    radius: [f64; 2],
}

/// The state after, and m1, m2.
fn collide(
    bench: &mut Bench,
    law: Law,
    meeting: &Meeting,
    density: f64,
    interaction: Interaction<f64>,
) -> Result<(State, [f64; 2]), Fault> {
    let [r1, r2] = meeting.radius;
    let mass = [r1, r2].map(|r| solid(1.0, 0.0, density).sphere_mass(r));
    let hertz = Hertz::new(&interaction, r1 * r2 / (r1 + r2), mass[0] * mass[1] / (mass[0] + mass[1]));
    let duration = hertz.duration(meeting.speed);
    let mut scene = Scene::new(law, interaction, duration / 4000.0);
    scene.moving(r1, density, [0.0, 0.0, r1], [meeting.slip[0], 0.0, -meeting.speed]);
    scene.moving(r2, density, [0.0, 0.0, -r2], [meeting.slip[1], 0.0, 0.0]);
    for k in 0..2 {
        scene.state.angular_velocity[k] = [0.0, meeting.spin[k], 0.0];
    }
    let state = bench.after(&scene, (2.0 * duration / scene.plan.dt) as u64)?;
    bench.judge("contacts left", "1", state.contacts.len() as f64, Kind::ClosedForm.within(0.0, 0.0));
    Ok((state, mass))
}

fn sliding(bench: &mut Bench, law: Law, meeting: &Meeting, interaction: Interaction<f64>) -> Result<(), Fault> {
    let (state, [m1, m2]) = collide(bench, law, meeting, STEEL.density, interaction)?;
    let mass_eff = m1 * m2 / (m1 + m2);
    let e = (state.velocity[0][2] - state.velocity[1][2]) / meeting.speed;
    let normal = (1.0 + e) * mass_eff * meeting.speed;
    let got = m1 * (state.velocity[0][2] + meeting.speed);
    // Their arms are a little shorter than their radii.
    bench.judge("normal impulse", "N s", got, Kind::ClosedForm.relative(normal, 1e-3));
    // Slip of the first surface past the second; the first is above.
    let [r1, r2] = meeting.radius;
    let slip = (meeting.slip[0] - meeting.spin[0] * r1) - (meeting.slip[1] + meeting.spin[1] * r2);
    let along = -slip.signum() * interaction.dynamic_friction * normal;
    let got = m1 * (state.velocity[0][0] - meeting.slip[0]);
    bench.judge("tangential impulse", "N s", got, Kind::ClosedForm.relative(along, 5e-3));
    let got = m2 * (state.velocity[1][0] - meeting.slip[1]);
    bench.judge("tangential impulse on the other", "N s", got, Kind::ClosedForm.relative(-along, 5e-3));
    // Moments are the same for both, per arm: I delta omega_y = - R P_t.
    for k in 0..2 {
        let change = state.angular_velocity[k][1] - meeting.spin[k];
        let expected = -2.5 * along / ([m1, m2][k] * meeting.radius[k]);
        bench.judge(format!("change of spin {}", k + 1), "rad/s", change, Kind::ClosedForm.relative(expected, 5e-3));
    }
    Ok(())
}

fn without_moments(bench: &mut Bench) -> Result<(), Fault> {
    let (radius, speed, across, friction) = (0.05, 0.5, 1.8, 0.15);
    let law = Law { damping: Damping::Restitution, ..Law::GNT };
    let interaction = STEEL.with_itself().friction(friction).restitution(0.8).clamped();
    let duration = Hertz::new(&interaction, radius, STEEL.sphere_mass(radius)).duration(speed);
    let mut scene = Scene::new(law, interaction, duration / 4000.0);
    scene.floor();
    scene.moving(radius, STEEL.density, [0.0, 0.0, radius], [across, 0.0, -speed]);
    let state = bench.after(&scene, 8000)?;
    let change = state.velocity[0][0] - across;
    let expected = -friction * (state.velocity[0][2] + speed);
    bench.judge("change of tangential velocity", "m/s", change, Kind::ClosedForm.relative(expected, 5e-3));
    let spin = state.angular_velocity.iter().flatten().fold(0.0, |largest: f64, w| largest.max(w.abs()));
    bench.judge("largest spin", "rad/s", spin, Kind::ClosedForm.within(0.0, 0.0));
    Ok(())
}

fn sticking(bench: &mut Bench) -> Result<(), Fault> {
    let meeting = Meeting { speed: 0.2, slip: [0.02, -0.01], spin: [0.1, 0.05], radius: [0.05, 0.05] };
    let mut interaction = STEEL.with_itself().friction(1e30);
    interaction.tangential_stiffness *= 1e-9;
    let mass = STEEL.sphere_mass(0.05);
    let duration = Hertz::new(&interaction, 0.025, 0.5 * mass).duration(meeting.speed);
    let interaction = interaction.dashpots(0.0, 20.0 / duration);
    let (state, _) = collide(bench, Law::GNTM, &meeting, STEEL.density, interaction)?;
    let slip = (meeting.slip[0] - meeting.spin[0] * 0.05) - (meeting.slip[1] + meeting.spin[1] * 0.05);
    let impulse = -2.0 / 7.0 * 0.5 * mass * slip;
    let got = mass * (state.velocity[0][0] - meeting.slip[0]);
    bench.judge("tangential impulse", "N s", got, Kind::ClosedForm.relative(impulse, 5e-3));
    let change = -2.5 * impulse / (mass * 0.05);
    for k in 0..2 {
        let got = state.angular_velocity[k][1] - meeting.spin[k];
        bench.judge(format!("change of spin {}", k + 1), "rad/s", got, Kind::ClosedForm.relative(change, 5e-3));
    }
    Ok(())
}

fn matched_spins(bench: &mut Bench, material: Solid) -> Result<(), Fault> {
    let radius = 0.1;
    let interaction = material.with_itself().friction(0.4).restitution(0.5);
    let mass = material.sphere_mass(radius);
    let duration = Hertz::new(&interaction, 0.5 * radius, 0.5 * mass).duration(0.4);
    let mut scene = Scene::new(DISPLACEMENT, interaction, duration / 1000.0);
    scene.moving(radius, material.density, [0.0, 0.0, radius], [0.0, 0.0, -0.2]);
    scene.moving(radius, material.density, [0.0, 0.0, -radius], [0.0, 0.0, 0.2]);
    scene.state.angular_velocity[0] = [0.0, 2.3, 0.0];
    scene.state.angular_velocity[1] = [0.0, -2.3, 0.0];
    let state = bench.after(&scene, 2500)?;
    bench.judge("contacts left", "1", state.contacts.len() as f64, Kind::ClosedForm.within(0.0, 0.0));
    bench.judge("tangential velocity", "m/s", state.velocity[0][0], Kind::ClosedForm.within(0.0, 1e-15));
    bench.judge("spin", "rad/s", state.angular_velocity[0][1], Kind::ClosedForm.relative(2.3, 1e-14));
    bench.judge("spin of the other", "rad/s", state.angular_velocity[1][1], Kind::ClosedForm.relative(-2.3, 1e-14));
    bench.judge("rebound", "m/s", state.velocity[0][2], Kind::ClosedForm.relative(0.1, 2e-3));
    Ok(())
}
