//! The contract of profiles: the bits of a plain run, every stage and kernel as often as it is due, the bytes that can be
//! counted by hand. How long anything takes is not tested. The device is chosen as in `gpu.rs`.

mod common;

use common::heated::{EXPANSION, heated};
use common::{DENSITY, plan, scene, spheres};
use tdem_engine::cpu::{List, Options, Width};
use tdem_engine::gpu::Api;
use tdem_engine::physics::contact::Law;
use tdem_engine::{Device, Integrator, Part, Plan, Profile, STAGES, Simulation, State};

const STEPS: u64 = 300;

fn gpu() -> Device {
    let cuda = std::env::var("TDEM_TEST_DEVICE").as_deref() == Ok("cuda");
    Device::Gpu { api: if cuda { Api::Cuda } else { Api::OpenCl }, index: 0 }
}

fn processors() -> Vec<Device> {
    let few = Options { threads: Some(2), ..Options::default() };
    vec![few.into(), Options { width: Width::One, list: List::Full, ..few }.into()]
}

/// Both integrators, with and without a ledger, lists that last and lists that do not.
fn scenes() -> Vec<(State, Plan)> {
    let kinds = [
        (Law::GN, Integrator::VelocityVerlet, false, false),
        (Law::GNTM, Integrator::VelocityVerlet, false, false),
        (Law::GNTM, Integrator::VelocityVerlet, true, false),
        (Law::GNT, Integrator::Gear, false, false),
        (Law::GNTM, Integrator::VelocityVerlet, false, true),
    ];
    let made = kinds.map(|(law, integrator, ledger, every_step)| {
        let (state, mut plan) = scene(law, integrator, 1.0);
        plan.ledger = ledger;
        plan.search.every_step = every_step;
        (state, plan)
    });
    made.into()
}

/// A profile between two pieces of a run: the profile, and the end.
fn profiled(state: &State, plan: &Plan, device: Device) -> (Profile, State) {
    let mut simulation = Simulation::new(state.clone(), plan.clone(), device).expect("the scene is sound");
    simulation.advance(50).expect("the scene runs through");
    let profile = simulation.profile(STEPS).expect("the scene runs through");
    assert_eq!(simulation.step(), 50 + STEPS);
    simulation.advance(50).expect("the scene runs through");
    (profile, simulation.state().expect("the device answers"))
}

fn calls(parts: &[Part], name: &str) -> Option<u64> {
    parts.iter().find(|part| part.name == name).map(|part| part.calls)
}

#[test]
fn a_profile_changes_no_bit() {
    for (state, plan) in scenes() {
        let mut plain = Simulation::new(state.clone(), plan.clone(), gpu()).expect("the scene is sound");
        plain.advance(100 + STEPS).expect("the scene runs through");
        let expected = plain.state().expect("the device answers");
        for device in processors().into_iter().chain([gpu()]) {
            let (profile, end) = profiled(&state, &plan, device);
            assert_eq!(end.hash(), expected.hash(), "{:?} {:?} {device:?}", plan.law, plan.integrator);
            assert_eq!(profile.steps, STEPS);
            assert!(profile.searches > 1, "the scene must list anew, or it shows nothing: {profile:?}");
        }
    }
}

#[test]
fn every_stage_is_called_once_per_step_and_a_search_when_it_is_due() {
    for (state, plan) in scenes() {
        for device in processors() {
            let (profile, _) = profiled(&state, &plan, device);
            assert_eq!(profile.parts, profile.stages());
            for stage in STAGES.into_iter().filter(|&stage| stage != "bond") {
                let due = if stage == "search" { profile.searches } else { STEPS };
                assert_eq!(calls(&profile.parts, stage), Some(due), "{stage}");
            }
        }
        let (profile, _) = profiled(&state, &plan, gpu());
        let stages = profile.stages();
        assert_eq!(stages.iter().map(|s| s.name).collect::<Vec<_>>(), ["predict", "search", "contact", "correct"]);
        // What was launched behind a halt is no step.
        for (kernel, due) in [("predict", STEPS), ("contact", STEPS), ("correct", 1)] {
            assert_eq!(calls(&profile.parts, kernel), Some(due), "{kernel}");
        }
        for kernel in ["cells", "rows_count", "rows_fill"] {
            assert_eq!(calls(&profile.parts, kernel), Some(profile.searches), "{kernel}");
        }
        assert_eq!(calls(&stages, "search"), Some(profile.searches));
        let carried = (plan.law != Law::GN).then_some(profile.searches);
        assert_eq!(calls(&profile.parts, "history_write"), carried);
        let sum = |parts: &[Part]| (parts.iter().map(|p| p.bytes).sum::<u64>(), parts.len());
        assert_eq!(sum(&stages).0, sum(&profile.parts).0);
        assert!(profile.parts.iter().all(|part| part.seconds > 0.0 && part.bytes > 0), "{profile:?}");
        assert!(profile.seconds_of_parts() > 0.0 && profile.seconds > 0.0);
    }
}

/// Two spheres that touch and stay where they are listed.
fn pair(law: Law) -> (State, Plan) {
    let mut plan = plan(law, [-1.0; 3], [1.0; 3], [false; 3]);
    plan.ledger = false;
    let mut state = spheres(&[([0.0; 3], 0.01), ([0.0199, 0.0, 0.0], 0.01)], DENSITY);
    state.accounts.clear();
    (state, plan)
}

fn bytes_per_call(law: Law, device: Device) -> (Vec<(&'static str, u64)>, f64) {
    bytes_of(pair(law), device)
}

fn bytes_of((state, plan): (State, Plan), device: Device) -> (Vec<(&'static str, u64)>, f64) {
    let mut simulation = Simulation::new(state, plan, device).expect("the scene is sound");
    let profile = simulation.profile(4).expect("the scene runs through");
    assert_eq!(profile.searches, 0);
    let each = profile.parts.iter().filter(|part| part.calls > 0).map(|part| (part.name, part.bytes / part.calls));
    (each.collect(), profile.bytes_per_step)
}

#[test]
fn bytes_of_two_spheres_on_a_device() {
    // Four numbers of a field are 32 B, of two spheres 64 B; the status is read and written, 32 B.
    let field = 64;
    let (status, reference, slice, slots) = (32, 2 * 8, 8, 4 * 32);
    let predict = status + 2 * field + 2 * field + field + reference;
    let contact = status + field + field + field + slice + slots;
    let correct = status + 2 * field + field;
    let fused = status + 2 * field + 2 * field + reference + slice + slots;
    let expected = vec![("predict", predict), ("contact", contact), ("correct", correct)];
    assert_eq!(bytes_per_call(Law::GN, gpu()), (expected, fused as f64));
    // With moments: spin and moment. With friction: three numbers in both rows, read and written.
    let (spin, moment, remembered) = (field, field, 2 * 2 * 24);
    let expected = vec![
        ("predict", predict + 2 * spin + moment),
        ("contact", contact + spin + moment + remembered),
        ("correct", correct + 2 * spin + moment),
    ];
    let fused = fused + 2 * spin + remembered;
    assert_eq!(bytes_per_call(Law::GNTM, gpu()), (expected, fused as f64));
}

#[test]
fn heat_adds_temperatures_and_growth_adds_radii() {
    let cold = bytes_per_call(Law::GN, gpu());
    for expansion in [0.0, EXPANSION] {
        let (mut state, mut plan) = pair(Law::GN);
        heated(&mut state, &mut plan, expansion);
        let (parts, whole) = bytes_of((state, plan), gpu());
        // Temperatures and radii of two spheres are 16 B each, the kind is 8 B, what their material is to heat 16 B.
        let (field, table) = (16, 8 + 16);
        let radii = if expansion == 0.0 { 0 } else { 2 * field };
        let added: Vec<_> = parts.iter().zip(&cold.0).map(|(warm, cold)| (warm.0, warm.1 - cold.1)).collect();
        assert_eq!(added, [("predict", 2 * field + table + radii), ("contact", field), ("correct", 0)]);
        assert_eq!(whole - cold.1, (2 * field + table + radii) as f64);
    }
}

#[test]
fn bytes_of_two_spheres_on_the_processor() {
    let field = 64;
    let (kind, reference, starts, entry, flag) = (4, 48, 12, 4, 1);
    let (spin, sums, displacement, reaction) = (field, 2 * field, 24, 64);
    let expected = [
        ("predict", 2 * (field + field + spin) + sums + kind + reference),
        ("contact", field + field + spin + sums + kind + starts + entry + 2 * (flag + displacement) + reaction),
        ("gather", 2 * sums + starts + entry + flag + reaction),
        ("boundary", 2 * field + field),
        ("correct", 2 * (field + spin) + field + sums + kind),
    ];
    let step: u64 = expected.iter().map(|(_, bytes)| bytes).sum();
    for device in [Options::default(), Options { width: Width::One, ..Options::default() }] {
        assert_eq!(bytes_per_call(Law::GNTM, device.into()), (expected.to_vec(), step as f64));
    }
}

#[test]
fn nothing_takes_no_time_and_a_copy_does() {
    let (_, plan) = pair(Law::GN);
    for device in [Options::default().into(), gpu()] {
        let mut simulation = Simulation::new(State::default(), plan.clone(), device).expect("nothing is sound");
        let profile = simulation.profile(7).expect("nothing can go wrong");
        assert_eq!((profile.steps, simulation.step()), (7, 7));
        let copied = simulation.copy_bandwidth().expect("there is room");
        assert!(copied.is_finite() && copied > 0.0);
    }
}
