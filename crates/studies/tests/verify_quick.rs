//! The quick tier of the verification catalogue on every back end, and proof that it can fail.

use std::collections::BTreeSet;
use tdem_engine::Plan;
use tdem_engine::gpu::Api;
use tdem_studies::verify::{Backend, Outcome, Tier, catalogue, markdown, run, run_altered, table};

fn spec(backend: Backend) -> Vec<Outcome> {
    let outcomes: Vec<Outcome> =
        catalogue().iter().filter(|case| case.tier == Tier::Quick).map(|case| run(case, backend)).collect();
    let failed: Vec<Outcome> = outcomes.iter().filter(|outcome| !outcome.passed()).cloned().collect();
    assert!(failed.is_empty(), "\n{}", table(&failed));
    outcomes
}

#[test]
fn quick_tier_passes_with_equal_bits_on_every_back_end() {
    let reference = spec(Backend::CpuScalar);
    print!("{}", table(&reference));
    // A machine without OpenCL fails here.
    for backend in [Backend::CpuPortable, Backend::CpuLanes, Backend::Gpu { api: Api::OpenCl, index: 0 }] {
        for (outcome, expected) in spec(backend).iter().zip(&reference) {
            assert!(outcome.hash.is_some(), "{} keeps no state", outcome.case.name);
            assert_eq!(outcome.hash, expected.hash, "{} has other bits on {}", outcome.case.name, backend.name());
        }
    }
}

/// Every pair's parameters changed by a function.
macro_rules! wrong {
    ($field:ident $op:tt $value:expr) => {
        |plan: &mut Plan| plan.interactions.iter_mut().for_each(|i| i.$field $op $value)
    };
}

#[test]
fn a_wrong_law_is_caught() {
    type Wrong = (&'static str, fn(&mut Plan));
    let wrong: [Wrong; 16] = [
        ("contact/chung-ooi-1-glass", wrong!(normal_stiffness *= 1.001)),
        ("contact/chung-ooi-2-aluminium-alloy", wrong!(normal_damping = 1.0)),
        ("contact/chung-ooi-3-cast-iron", wrong!(normal_damping *= 1.001)),
        ("contact/restitution-clamped", wrong!(least_normal_force = f64::NEG_INFINITY)),
        ("contact/viscous-damping", wrong!(least_normal_force = 0.0)),
        ("contact/chung-ooi-4-aluminium-oxide", wrong!(tangential_stiffness *= 2.0 / 3.0)),
        ("contact/chung-ooi-4-aluminium-oxide", |plan| {
            plan.law.friction = tdem_engine::physics::contact::Friction::Rescaled;
        }),
        ("contact/sliding-impulse", wrong!(dynamic_friction *= 1.01)),
        ("contact/sliding-impulse", |plan| plan.law.moments = false),
        ("plane/static-rest", |plan| plan.gravity[2] *= 1.0001),
        ("plane/incline-static-friction", wrong!(static_friction *= 1.002)),
        ("spring/loading-loop-of-a-pair", wrong!(dynamic_friction *= 0.999_999)),
        ("conservation/energy-elastic", wrong!(normal_damping = 1.0)),
        ("integrators/order-verlet", wrong!(normal_damping = 10.0)),
        ("stability/oscillator-verlet", |plan| plan.dt *= 1.01),
        ("search/all-pairs", |plan| plan.domain.periodic = [false; 3]),
    ];
    let cases = catalogue();
    for (name, alter) in wrong {
        let case = cases.iter().find(|case| case.name == name).unwrap();
        let outcome = run_altered(case, Backend::CpuLanes, alter);
        assert!(!outcome.passed(), "{name} passes with a wrong law:\n{}", table(&[outcome]));
        assert!(table(std::slice::from_ref(&outcome)).contains("FAILED"));
    }
}

#[test]
fn names_are_unique_and_grouped() {
    let cases = catalogue();
    let names: BTreeSet<&str> = cases.iter().map(|case| case.name).collect();
    assert_eq!(names.len(), cases.len());
    assert!(cases.iter().all(|case| case.name.split('/').count() == 2 && !case.source.is_empty()));
    assert!(cases.is_sorted_by(|a, b| a.tier <= b.tier || a.group() != b.group()));
}

#[test]
fn markdown_has_one_row_per_check() {
    let cases = catalogue();
    let case = cases.iter().find(|case| case.name == "plane/free-fall").unwrap();
    let outcome = run(case, Backend::CpuLanes);
    let text = markdown(std::slice::from_ref(&outcome));
    assert!(text.starts_with("### plane/free-fall\n"));
    assert_eq!(text.lines().filter(|line| line.ends_with("| ok |")).count(), outcome.checks.len());
}
