//! The quick tier of the verification catalogue on every back end, and proof that it can fail.

use std::collections::BTreeSet;
use tdem_engine::gpu::Api;
use tdem_engine::physics::bond::{Form, Tension};
use tdem_engine::physics::heat::{Exchange, Path};
use tdem_engine::{Around, BondPlan, HeatPlan, Integrator, Plan};
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
    stand_on_the_page(&reference);
    // A machine without OpenCL fails here.
    for backend in [Backend::CpuPortable, Backend::CpuLanes, Backend::Gpu { api: Api::OpenCl, index: 0 }] {
        for (outcome, expected) in spec(backend).iter().zip(&reference) {
            assert!(outcome.hash.is_some(), "{} keeps no state", outcome.case.name);
            assert_eq!(outcome.hash, expected.hash, "{} has other bits on {}", outcome.case.name, backend.name());
        }
    }
}

/// The page on verification shows what is computed today, to the last digit.
fn stand_on_the_page(outcomes: &[Outcome]) {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/verification.md");
    let page = std::fs::read_to_string(path).expect("the page on verification").replace("\r\n", "\n");
    for outcome in outcomes {
        let shown = markdown(std::slice::from_ref(outcome));
        let rows: Vec<&str> = shown.lines().filter(|line| line.starts_with('|')).collect();
        let rows = rows.join("\n");
        let name = outcome.case.name;
        assert!(
            page.contains(&rows),
            "docs/verification.md has other values: run `cargo xtask verification`\n{name}\n{rows}"
        );
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

/// Every bond's joint changed by a function.
macro_rules! wrong_bond {
    (|$joint:ident| $change:expr) => {
        |plan: &mut Plan| {
            let joints = plan.bonds.iter_mut().flat_map(|bonds| bonds.joints.iter_mut().flatten());
            joints.for_each(|$joint| $change);
        }
    };
}

#[test]
fn a_wrong_bond_is_caught() {
    type Wrong = (&'static str, fn(&mut Plan));
    let stiffer: fn(&mut Plan) = wrong_bond!(|joint| joint.stiffness_per_area *= 1.003);
    let thicker: fn(&mut Plan) = wrong_bond!(|joint| joint.cement.radius_multiplier *= 1.003);
    let sheared: fn(&mut Plan) = wrong_bond!(|joint| joint.cement.stiffness_ratio *= 1.003);
    let incremental: fn(&mut Plan) = |plan| {
        if let Some(bonds) = &mut plan.bonds {
            bonds.law.form = Form::Incremental(Tension::FromLength);
        }
    };
    let damped: fn(&mut Plan) = |plan| {
        if let Some(bonds) = &mut plan.bonds {
            bonds.local_damping = 1e-3;
        }
    };
    let wrong: [Wrong; 67] = [
        ("bond/vibration-verlet", stiffer),
        ("bond/vibration-gear", stiffer),
        ("bond/vibration-gear", damped),
        ("bond/modes", stiffer),
        ("bond/modes", sheared),
        ("bond/modes", thicker),
        ("bond/damped-vibration", wrong_bond!(|joint| joint.cement.damping_ratio *= 1.003)),
        ("bond/damped-vibration", thicker),
        ("bond/unequal-spheres", wrong_bond!(|joint| joint.young_modulus *= 1.003)),
        ("bond/unequal-spheres", thicker),
        ("bond/turned-assembly", incremental),
        ("bond/turning-pair", stiffer),
        ("bond/strength", stiffer),
        ("bond/strength", thicker),
        ("bond/strength", sheared),
        ("bond/strength", wrong_bond!(|joint| joint.cement.tensile_strength *= 1.003)),
        ("bond/strength", wrong_bond!(|joint| joint.cement.shear_strength *= 1.003)),
        ("bond/strength", wrong_bond!(|joint| joint.cement.moment_contribution = 1.0)),
        ("bond/mohr-coulomb", wrong_bond!(|joint| joint.cement.internal_friction *= 1.03)),
        ("bond/mohr-coulomb", wrong_bond!(|joint| joint.cement.shear_strength *= 1.003)),
        ("bond/weibull", wrong_bond!(|joint| joint.cement.tensile_strength *= 1.1)),
        ("bond/contact-takes-over", wrong!(normal_stiffness *= 1.001)),
        ("bond/contact-takes-over", wrong_bond!(|joint| joint.cement.tensile_strength *= 1.003)),
        ("chain/tension", stiffer),
        ("chain/shear", sheared),
        ("chain/torsion", sheared),
        ("chain/torsion", thicker),
        ("chain/pure-bending", thicker),
        ("chain/pure-bending", stiffer),
        ("chain/cantilever", sheared),
        ("chain/cantilever", thicker),
        ("chain/cantilever-under-its-weight", sheared),
        ("chain/cantilever-under-its-weight", |plan| plan.gravity[1] *= 1.003),
        ("chain/step-load", stiffer),
        ("chain/step-load", damped),
        ("chain/step-force", stiffer),
        ("chain/step-force", |plan| plan.constraints[2].force[0] *= 1.003),
        ("chain/ramped-force", stiffer),
        ("chain/ramped-force", |plan| plan.ramps[0].points[1][0] *= 1.01),
        ("integrators/prescribed-ramp", |plan| plan.ramps[0].points[1][1] *= 1.003),
        ("integrators/prescribed-ramp", |plan| plan.ramps[1].points[3][0] += plan.dt),
        ("chain/axial-vibration", stiffer),
        ("chain/wave-speed", stiffer),
        ("chain/bending-vibration", wrong_bond!(|joint| joint.cement.radius_multiplier *= 1.01)),
        ("chain/bending-vibration", wrong_bond!(|joint| joint.stiffness_per_area *= 1.01)),
        ("chain/energy", damped),
        ("chain/energy", incremental),
        ("chain/forms-agree", |plan| {
            // One of the two only.
            if plan.bonds.as_ref().is_some_and(BondPlan::remembers) {
                plan.dt *= 1.003;
            }
        }),
        ("chain/ledger-closes-when-it-breaks", wrong_bond!(|joint| joint.cement.tensile_strength *= 100.0)),
        ("block/elastic-constants", stiffer),
        ("block/elastic-constants", sheared),
        ("block/bond-forces", sheared),
        ("block/tension-3", stiffer),
        ("block/tension-3", wrong_bond!(|joint| joint.cement.stiffness_ratio *= 1.01)),
        ("block/plane-wave", stiffer),
        ("block/plane-wave", sheared),
        ("block/critical-step", |plan| plan.dt *= 1.01),
        ("block/critical-step", |plan| plan.dt *= 0.99),
        ("block/critical-step-gear", |plan| plan.dt *= 1.01),
        ("block/spinning-and-breaking", damped),
        ("block/spinning-gear", |plan| plan.integrator = Integrator::VelocityVerlet),
        ("statics/stiffness", sheared),
        ("statics/chain", thicker),
        ("statics/block", stiffer),
        ("prism/stiffness-by-area", stiffer),
        ("strength/lattice-elasticity", stiffer),
        ("prism/initial-stiffness-6", wrong_bond!(|joint| joint.stiffness_per_area *= 1.02)),
    ];
    let cases = catalogue();
    for (name, alter) in wrong {
        let case = cases.iter().find(|case| case.name == name).unwrap();
        let outcome = run_altered(case, Backend::CpuLanes, alter);
        assert!(!outcome.passed(), "{name} passes with a wrong bond:\n{}", table(&[outcome]));
    }
    let bonded =
        cases.iter().filter(|case| ["bond", "chain", "block", "statics", "prism", "strength"].contains(&case.group()));
    for case in bonded.filter(|case| case.tier == Tier::Quick) {
        assert!(wrong.iter().any(|(name, _)| *name == case.name), "{} is not shown to fail", case.name);
    }
}

/// Numbers of the heat changed by a function.
macro_rules! wrong_heat {
    (|$heat:ident| $change:expr) => {
        |plan: &mut Plan| {
            if let Some($heat) = &mut plan.heat {
                $change
            }
        }
    };
}

/// Takes a film off each exchange that radiates, and puts one of the same conductance beside it.
fn two_surfaces(heat: &mut HeatPlan) {
    for exposure in &mut heat.exposures {
        let radiating = exposure.exchanges.iter().filter(|(exchange, _)| exchange.radiation > 0.0);
        let films: Vec<_> = radiating
            .map(|(exchange, around)| {
                let film = Exchange { flux_area: 0.0, radiation: 0.0, ..*exchange };
                (film, Around { fluid: around.fluid.clone(), ..Around::default() })
            })
            .collect();
        for (exchange, around) in exposure.exchanges.iter_mut().filter(|(exchange, _)| exchange.radiation > 0.0) {
            (exchange.conductance, around.fluid) = (0.0, None);
        }
        exposure.exchanges.extend(films);
    }
}

/// Surfaces whose films conduct half again as much.
fn deeper(plan: &mut Plan) {
    let exposures = plan.heat.iter_mut().flat_map(|heat| &mut heat.exposures);
    for (exchange, _) in exposures.flat_map(|exposure| &mut exposure.exchanges) {
        exchange.conductance *= 1.5;
    }
}

#[test]
fn wrong_heat_is_caught() {
    type Wrong = (&'static str, fn(&mut Plan));
    let conducts: fn(&mut Plan) = wrong_heat!(|heat| heat.conductors.iter_mut().for_each(|c| c.conductivity *= 1.01));
    let grows: fn(&mut Plan) = wrong_heat!(|heat| heat.materials.iter_mut().for_each(|m| m.expansion *= 1.01));
    let stores: fn(&mut Plan) = wrong_heat!(|heat| heat.materials.iter_mut().for_each(|m| m.specific_heat *= 1.01));
    let exchanges: fn(&mut Plan) = wrong_heat!(|heat| {
        for (exchange, _) in heat.exposures.iter_mut().flat_map(|exposure| &mut exposure.exchanges) {
            exchange.conductance *= 1.01;
            exchange.radiation *= 1.01;
        }
    });
    let stiffer: fn(&mut Plan) = |plan| plan.interactions.iter_mut().for_each(|i| i.normal_stiffness *= 1.01);
    let thicker: fn(&mut Plan) = wrong_heat!(|heat| heat.conductors.iter_mut().for_each(|c| c.section *= 1.01));
    let flows_in: fn(&mut Plan) = wrong_heat!(|heat| {
        let exchanges = heat.exposures.iter_mut().flat_map(|exposure| &mut exposure.exchanges);
        exchanges.for_each(|(exchange, _)| exchange.flux_area *= 1.01);
    });
    let softer: fn(&mut Plan) = wrong_bond!(|joint| joint.stiffness_per_area *= 0.99);
    let table_of_bonds: fn(&mut Plan) = |plan| {
        let tables = plan.bonds.iter_mut().map(|bonds| &mut bonds.tables);
        for table in tables.flat_map(|tables| tables.stiffness.iter_mut().chain(&mut tables.strength)) {
            table.0[1][1] *= 1.01;
        }
    };
    let wrong: [Wrong; 60] = [
        (
            "thermal/conductivity-table",
            wrong_heat!(|heat| heat.tables.conductivity.iter_mut().for_each(|table| table.0[0][1] *= 1.01)),
        ),
        (
            "thermal/specific-heat-table",
            wrong_heat!(|heat| heat.tables.specific_heat.iter_mut().for_each(|table| table.0[1][1] *= 1.001)),
        ),
        ("thermal/specific-heat-table", flows_in),
        ("thermal/stiffness-table", table_of_bonds),
        ("thermal/strength-table", table_of_bonds),
        ("thermal/two-particles", conducts),
        ("thermal/two-particles", stores),
        ("thermal/chain-steady", conducts),
        ("thermal/chain-transient", conducts),
        ("thermal/chain-transient", stores),
        ("thermal/lattice-conductivity", conducts),
        ("thermal/lattice-conductivity", thicker),
        ("thermal/open-sides", conducts),
        ("thermal/open-sides", thicker),
        ("thermal/open-sides", wrong_heat!(|heat| heat.sides.clear())),
        ("thermal/mass-scaling", stores),
        ("thermal/mass-scaling", softer),
        ("thermal/mass-scaling", |plan| plan.gravity[2] *= 1.01),
        ("thermal/unlike", conducts),
        ("thermal/unlike", wrong_heat!(|heat| heat.conductors[1].conductivity *= 1.01)),
        ("thermal/broken-bond", conducts),
        ("thermal/broken-bond", wrong_bond!(|joint| joint.cement.tensile_strength = f64::INFINITY)),
        ("thermal/broken-bond", wrong_heat!(|heat| heat.contacts = Path::Closed)),
        ("thermal/contact-circle", conducts),
        ("thermal/softened", stiffer),
        ("thermal/contact-circle", wrong_heat!(|heat| heat.contacts = Path::Bar)),
        ("thermal/lumped-cooling", exchanges),
        ("thermal/lumped-cooling", flows_in),
        ("thermal/lumped-cooling", stores),
        ("thermal/radiation", exchanges),
        ("thermal/radiation", stores),
        ("thermal/one-surface", conducts),
        ("thermal/one-surface", exchanges),
        ("thermal/one-surface", flows_in),
        // The fluid at a surface of its own, as if it did not cool the one that radiates.
        ("thermal/one-surface", wrong_heat!(|heat| two_surfaces(heat))),
        ("thermal/semi-infinite", conducts),
        // The surface a third of a layer above the first layer instead of half of one.
        ("thermal/semi-infinite", deeper),
        ("thermal/slab", conducts),
        ("thermal/slab", exchanges),
        ("thermal/slab", stores),
        ("thermal/free-expansion", grows),
        ("thermal/constrained", grows),
        ("thermal/constrained", softer),
        ("thermal/uniaxially-constrained", grows),
        ("thermal/uniaxially-constrained", softer),
        ("thermal/mismatch-series", grows),
        ("thermal/mismatch-series", softer),
        ("thermal/mismatch-parallel", grows),
        ("thermal/mismatch-parallel", wrong_heat!(|heat| heat.materials[1].expansion *= 1.01)),
        ("thermal/restrained-plate", grows),
        ("thermal/free-plate", grows),
        ("thermal/free-plate", softer),
        ("thermal/time-scale", wrong_heat!(|heat| heat.materials.iter_mut().for_each(|m| m.expansion *= 1.02))),
        ("thermal/time-scale", wrong_bond!(|joint| joint.stiffness_per_area *= 0.98)),
        ("thermal/sliding-block", stores),
        ("thermal/sliding-block", wrong_heat!(|heat| heat.dissipation.friction *= 0.99)),
        ("thermal/heat-of-collisions", wrong_heat!(|heat| heat.dissipation.damping *= 0.98)),
        ("thermal/expansion-work", grows),
        ("thermal/balance", stores),
        ("thermal/balance", |plan| plan.ledger = false),
    ];
    let cases = catalogue();
    for (name, alter) in wrong {
        let case = cases.iter().find(|case| case.name == name).unwrap();
        let outcome = run_altered(case, Backend::CpuLanes, alter);
        assert!(!outcome.passed(), "{name} passes with wrong heat:\n{}", table(&[outcome]));
    }
    for case in cases.iter().filter(|case| case.group() == "thermal" && case.tier == Tier::Quick) {
        assert!(wrong.iter().any(|(name, _)| *name == case.name), "{} is not shown to fail", case.name);
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
