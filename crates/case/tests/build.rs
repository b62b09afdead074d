//! What a case becomes: places, motion, constraints, materials, limits, schedule.

use std::path::Path;
use tdem_case::{Built, Loaded, Problems, parse};
use tdem_engine::{Constraint, Contact, Measure, State, physics::contact::Law};

/// A case of which a test replaces the particles and adds to the rest.
const REST: &str = r#"
model = "GNTM"
gravity = [0.0, 0.0, 0.0]
domain = { min = [0.0, 0.0, 0.0], max = [1.0, 1.0, 1.0] }

[time]
end = 1.0

[material.a]
density = 1000.0
young_modulus = 1.0e7
poisson_ratio = 0.25

[material.b]
density = 2000.0
young_modulus = 2.0e7
poisson_ratio = 0.3
"#;

fn interaction(a: &str, b: &str) -> String {
    format!(
        "\n[[interaction]]\nbetween = [\"{a}\", \"{b}\"]\nstatic_friction = 0.5\ndynamic_friction = 0.4\n\
         normal_damping = 100.0\ntangential_damping = 10.0\nrestitution = 0.5\n"
    )
}

fn loaded(particles: &str, overrides: &[(&str, &str)]) -> Result<Loaded, Problems> {
    let text = format!("{REST}{}{particles}", interaction("a", "a"));
    let overrides: Vec<(String, String)> =
        overrides.iter().map(|(key, value)| ((*key).to_owned(), (*value).to_owned())).collect();
    parse("test", &text, Path::new(""), &overrides)
}

fn build(particles: &str, overrides: &[(&str, &str)]) -> Built {
    let built = loaded(particles, overrides).and_then(|l| l.build()).unwrap_or_else(|p| panic!("{p}"));
    assert!(built.state.validate(&built.plan).is_ok());
    built
}

fn refused(particles: &str, overrides: &[(&str, &str)]) -> &'static str {
    match loaded(particles, overrides).and_then(|l| l.build()) {
        Err(problems) => problems.problems[0].code,
        Ok(_) => "built",
    }
}

const LATTICE: &str = "[[particles]]\nmaterial = 'a'\n[particles.lattice]\nkind = 'sc'\nradius = 0.1\n";
const RANDOM: &str = "[[particles]]\nmaterial = 'a'\n[particles.random]\nradius = 0.05\ncount = 200\n";
const ONE: &str = "[[particles]]\nmaterial = 'a'\n[particles.list]\nradius = 0.1\npositions = [[0.5, 0.5, 0.5]]\n";

#[test]
fn a_lattice_fills_its_region_and_stands_where_it_should() {
    let built = build(LATTICE, &[]);
    assert_eq!(built.state.len(), 125);
    let built = build(LATTICE, &[("particles.0.lattice.cells", "[2, 2, 2]")]);
    assert!((built.state.position[0][0] - 0.4).abs() < 1e-15, "centred");
    let built = build(
        LATTICE,
        &[("particles.0.lattice.cells", "[2, 2, 2]"), ("particles.0.lattice.align", "['min', 'max', 'center']")],
    );
    let [x, y, z] = built.state.position[0];
    assert!((x - 0.1).abs() < 1e-15 && (y - 0.7).abs() < 1e-15 && (z - 0.4).abs() < 1e-15);
    let built = build(
        LATTICE,
        &[("particles.0.lattice.cells", "[1, 1, 2]"), ("particles.0.lattice.origin", "[0.2, 0.3, 0.4]")],
    );
    assert_eq!(built.state.position[0], [0.2, 0.3, 0.4]);
    assert!((built.state.position[1][2] - 0.6).abs() < 1e-15);
}

#[test]
fn a_lattice_in_a_repeating_domain_meets_itself() {
    let set = [("domain.periodic", "[true, true, true]"), ("particles.0.lattice.kind", "fcc")];
    let radius = 0.25 / 2.0_f64.sqrt() / 2.0;
    let built = build(LATTICE, &[&set[..], &[("particles.0.lattice.radius", &format!("{radius:?}"))]].concat());
    assert_eq!(built.state.len(), 4 * 4 * 4 * 4);
    assert!(built.state.position.iter().flatten().all(|c| (0.0..1.0).contains(c)));
}

/// The smallest gap between two spheres over the sum of their radii, images included.
fn smallest_gap(built: &Built) -> f64 {
    let (state, period) = (&built.state, built.plan.domain.period());
    let mut smallest = f64::INFINITY;
    for i in 0..state.len() {
        for j in 0..i {
            let offset: [f64; 3] = std::array::from_fn(|k| state.position[j][k] - state.position[i][k]);
            let offset = period.nearest(offset.into());
            let reach = state.radius[i] + state.radius[j];
            smallest = smallest.min(offset.dot(offset).sqrt() / reach - 1.0);
        }
    }
    smallest
}

#[test]
fn random_spheres_do_not_overlap() {
    let built = build(RANDOM, &[]);
    assert_eq!(built.state.len(), 200);
    assert!(smallest_gap(&built) >= -1e-15);
    assert!(built.state.position.iter().flatten().all(|&c| (0.05..=0.95).contains(&c)), "inside the region");
}

#[test]
fn random_spheres_do_not_overlap_across_the_seam() {
    let polydisperse = "{ min = 0.02, max = 0.1, distribution = 'volume' }";
    let built = build(
        RANDOM,
        &[
            ("domain.periodic", "[true, true, true]"),
            ("particles.0.random.radius", polydisperse),
            ("particles.0.random.count", "1000"),
        ],
    );
    assert!(smallest_gap(&built) >= -1e-15);
    assert!(built.state.position.iter().flatten().any(|&c| !(0.02..=0.98).contains(&c)), "the seam is used");
    assert!(built.state.radius.iter().all(|r| (0.02..=0.1).contains(r)));
    // Uniform by volume: small ones abound. The median radius solves 1/r^2 = (1/0.02^2 + 1/0.1^2)/2.
    let small = built.state.radius.iter().filter(|&&r| r < 0.027_735).count();
    assert!((430..570).contains(&small), "{small}");
}

#[test]
fn random_spheres_keep_clear_of_walls_and_earlier_groups() {
    let wall = "[[wall]]\nname = 'tilted'\npoint = [0.3, 0.0, 0.3]\nnormal = [1.0, 0.0, 1.0]\nmaterial = 'a'\n";
    let built = build(&format!("{wall}{ONE}{}", RANDOM.replace("200", "100")), &[]);
    assert_eq!(built.state.len(), 101);
    assert!(smallest_gap(&built) >= -1e-15);
    assert!(built.state.position.iter().all(|p| (p[0] + p[2] - 0.6) / 2.0_f64.sqrt() >= 0.05));
}

#[test]
fn a_volume_fraction_is_reached_and_not_exceeded() {
    let random = "[[particles]]\nmaterial = 'a'\n[particles.random]\nradius = 0.05\nvolume_fraction = 0.2\n";
    let built = build(random, &[]);
    let volume = 4.0 / 3.0 * std::f64::consts::PI * 0.05 * 0.05 * 0.05;
    assert_eq!(built.state.len(), (0.2 / volume) as usize);
}

#[test]
fn a_particle_keeps_its_random_numbers_when_others_come() {
    let few = build(RANDOM, &[("particles.0.random.count", "50"), ("particles.0.random_speed", "[1.0, 2.0]")]);
    let many = build(RANDOM, &[("particles.0.random.count", "80"), ("particles.0.random_speed", "[1.0, 2.0]")]);
    assert_eq!(few.state.velocity[..50], many.state.velocity[..50]);
    assert_eq!(few.state.position[..50], many.state.position[..50]);
}

#[test]
fn masses_and_ids() {
    let built = build(&format!("{ONE}{}", ONE.replace("0.5, 0.5, 0.5", "0.2, 0.2, 0.2")), &[]);
    assert_eq!(built.state.id, [0, 1]);
    let mass = 4.0 / 3.0 * std::f64::consts::PI * 1e-3 * 1000.0;
    assert!((built.state.mass[0] / mass - 1.0).abs() < 1e-14);
    assert!(!built.state.forces_known && built.state.accounts.len() == 2 && built.state.derivatives.is_empty());
    let gear = build(ONE, &[("time.integrator", "gear"), ("output.ledger", "false")]);
    assert!(gear.state.derivatives.len() == 1 && gear.state.accounts.is_empty() && !gear.plan.ledger);
}

#[test]
fn fixed_and_prescribed_components_share_constraints() {
    let moving = ONE.replace(
        "[particles.list]",
        "velocity = [1.0, 1.0, 1.0]\nfixed = ['x', 'ry']\nprescribed = { z = 2.0 }\n[particles.list]",
    );
    let other = ONE.replace("0.5, 0.5, 0.5", "0.2, 0.2, 0.2");
    let built = build(&format!("{moving}{other}{}", moving.replace("0.5, 0.5, 0.5", "0.8, 0.8, 0.8")), &[]);
    assert_eq!(built.state.constraint, [1, 0, 1]);
    assert_eq!(built.plan.constraints[0], Constraint::FREE);
    assert_eq!(built.plan.constraints[1].velocity, [Some(0.0), None, Some(2.0)]);
    assert_eq!(built.plan.constraints[1].angular_velocity, [None, Some(0.0), None]);
    assert_eq!(built.state.velocity[0], [0.0, 1.0, 2.0]);
}

#[test]
fn ramps_and_forces_of_groups_and_zones() {
    let two = ONE.replace("[[0.5, 0.5, 0.5]]", "[[0.2, 0.5, 0.5], [0.8, 0.5, 0.5]]").replace(
        "[particles.list]",
        "name = 'both'\nprescribed = { x = [[0.0, 0.5], [0.25, 1.5]] }\nforce = { y = 6.0 }\n[particles.list]",
    );
    // The second zone orders what is ordered already.
    let zones = "[[zone]]\nname = 'right'\nbox = { min = [0.5, 0.0, 0.0] }\nforce = { y = [[0.0, 0.0], [0.5, -1.0]] }\n\
                 [[zone]]\nbox = {}\nprescribed = { x = [[0.0, 0.5], [0.25, 1.5]] }\n\
                 [[gauge]]\nname = 'apart'\nbetween = ['both', 'right']\n[[gauge]]\nname = 'end'\nof = 'right'\n";
    let built = build(&format!("{two}{zones}"), &[]);
    let Built { state, plan, .. } = &built;
    assert_eq!((state.constraint[0], state.constraint[1]), (1, 2));
    assert_eq!(state.velocity[0], [0.5, 0.0, 0.0], "they start as the ramp does");
    assert_eq!(plan.constraints[1].force, [0.0, 3.0, 0.0], "both particles share the force of the group");
    let at = |time: f64, constraint: u16| plan.constraints_at(time)[usize::from(constraint)];
    assert_eq!(
        at(0.125, 1),
        Constraint { velocity: [Some(1.0), None, None], force: [0.0, 3.0, 0.0], ..Constraint::FREE }
    );
    assert_eq!(at(0.25, 2).force, [0.0, 2.5, 0.0], "forces add up");
    assert_eq!((at(9.0, 2).force[1], at(9.0, 2).velocity[0]), (2.0, Some(1.5)));
    assert_eq!(plan.ramps.len(), 3);
    let [Measure::Between([both, right]), Measure::Of(end)] = [&plan.gauges[0].measure, &plan.gauges[1].measure] else {
        panic!("{:?}", plan.gauges)
    };
    assert_eq!((&both.members[..], both.start), (&[0, 1][..], [0.5; 3]));
    assert_eq!((&right.members[..], right.start), (&[1][..], [0.8, 0.5, 0.5]));
    assert_eq!(end, right);
}

#[test]
fn what_is_said_twice_must_agree() {
    let moved = |zone: &str| {
        let group = ONE.replace("[particles.list]", "fixed = ['x']\nprescribed = { y = 1.0 }\n[particles.list]");
        refused(&format!("{group}[[zone]]\nbox = {{}}\n{zone}\n"), &[])
    };
    assert_eq!(moved("fixed = ['x']"), "built");
    assert_eq!(moved("prescribed = { x = 0.0, y = [[0.0, 1.0], [0.5, 1.0]] }"), "built");
    assert_eq!(moved("prescribed = { x = 0.1 }"), "tdem::case::contradictory-motion");
    assert_eq!(moved("prescribed = { y = [[0.0, 1.0], [0.5, 1.1]] }"), "tdem::case::contradictory-motion");
    assert_eq!(moved("force = { z = 1.0 }"), "built");
    assert_eq!(moved("force = { y = 1.0 }"), "tdem::case::force-on-prescribed");
    assert_eq!(moved("name = 'idle'"), "tdem::case::zone-idle");
    assert_eq!(moved("name = 'watched'\n[[gauge]]\nname = 'a'\nof = 'watched'"), "built");
}

#[test]
fn a_plane_of_symmetry_holds_what_lies_on_it() {
    let spinning = ONE.replace(
        "[particles.list]",
        "velocity = [1.0, 1.0, 1.0]\nangular_velocity = [1.0, 1.0, 1.0]\n[particles.list]",
    );
    let built = build(&format!("{spinning}\n[[symmetry]]\naxis = 'x'\nat = 0.5\n"), &[]);
    assert_eq!(built.state.velocity[0], [0.0, 1.0, 1.0]);
    assert_eq!(built.state.angular_velocity[0], [1.0, 0.0, 0.0]);
    let constraint = built.plan.constraints[usize::from(built.state.constraint[0])];
    assert_eq!(constraint.velocity, [Some(0.0), None, None]);
    assert_eq!(constraint.angular_velocity, [None, Some(0.0), Some(0.0)]);
}

#[test]
fn positions_are_wrapped() {
    let built = build(&ONE.replace("0.5, 0.5, 0.5", "1.0, -0.25, 7.5"), &[("domain.periodic", "[true, true, true]")]);
    assert_eq!(built.state.position[0], [0.0, 0.75, 0.5]);
    assert_eq!(built.state.image[0], [0, 0, 0]);
}

#[test]
fn overlap_is_allowed_where_the_case_says_so() {
    let two = ONE.replace("[[0.5, 0.5, 0.5]]", "[[0.5, 0.5, 0.5], [0.66, 0.5, 0.5]]");
    assert_eq!(refused(&two, &[]), "tdem::case::overlap");
    assert_eq!(build(&two, &[("particles.0.allow_overlap", "true")]).state.len(), 2);
}

#[test]
fn laws_follow_the_case() {
    assert_eq!(build(ONE, &[]).plan.law, Law::GNTM);
    assert_eq!(build(ONE, &[("model", "GN")]).plan.law, Law::GN);
    assert_eq!(build(ONE, &[("model", "GNT")]).plan.law, Law::GNT);
    let plan = build(ONE, &[("contact.tangential_coefficient", "\"16/3\""), ("contact.clamp", "false")]).plan;
    let a = plan.interaction(0, 0);
    let (modulus, shear) = (1.0e7 / (2.0 * (1.0 - 0.0625)), 1.0e7 / 2.5 / (2.0 * 1.75));
    assert!((a.normal_stiffness / (4.0 / 3.0 * modulus) - 1.0).abs() < 1e-14);
    assert!((a.tangential_stiffness / (16.0 / 3.0 * shear) - 1.0).abs() < 1e-14);
    assert_eq!((a.static_friction, a.dynamic_friction, a.least_normal_force), (0.5, 0.4, f64::NEG_INFINITY));
    let tsuji = build(ONE, &[("contact.damping", "restitution")]).plan;
    assert!((tsuji.interaction(0, 0).normal_damping - 0.39336).abs() < 1e-5);
}

#[test]
fn only_pairs_that_can_meet_need_an_interaction() {
    // `b` has no particles; a lone particle of it meets only `a`, not itself.
    let b = ONE.replace("'a'", "'b'").replace("0.5, 0.5, 0.5", "0.2, 0.2, 0.2");
    assert_eq!(refused(&format!("{ONE}{b}"), &[]), "tdem::case::missing-interaction");
    let built = build(&format!("{}{ONE}{b}", interaction("b", "a")), &[]);
    assert_eq!(built.plan.interaction(0, 1), built.plan.interaction(1, 0));
    assert_eq!(built.state.material, [0, 1]);
}

#[test]
fn boxes_leave_faces_out_and_turn_inward() {
    let container = "[[box]]\nmaterial = 'rigid'\nopen = ['+z']\nvelocity = [0.0, 0.0, 0.5]\n";
    let built = build(&format!("{container}{}{ONE}", interaction("a", "rigid")), &[]);
    let names: Vec<&str> = built.plan.walls.iter().map(|wall| wall.name.as_str()).collect();
    assert_eq!(names, ["box -x", "box +x", "box -y", "box +y", "box -z"]);
    assert_eq!(built.plan.walls[1].normal, [-1.0, 0.0, 0.0]);
    assert_eq!(built.state.wall_position[1], [1.0, 1.0, 1.0]);
    assert_eq!(built.plan.walls[4].velocity, [0.0, 0.0, 0.5]);
}

#[test]
fn the_state_of_another_run_goes_on() {
    let first = build(&RANDOM.replace("200", "3"), &[]);
    let mut state: State = first.state.clone();
    state.id = vec![2, 5, 9];
    state.contacts = vec![Contact { first: 2, second: 9, displacement: [1e-6, 0.0, 0.0] }];
    state.position[0] = [0.58, 0.58, 0.5];
    state.position[1] = [0.5; 3];
    state.position[2] = [0.58, 0.5, 0.5];
    let run = "[[particles]]\nmaterial = 'a'\n[particles.run]\ndirectory = 'earlier'\ncontacts = 'carry'\n";
    let loader = |directory: &Path| {
        assert_eq!(directory, Path::new("earlier"));
        Ok(state.clone())
    };
    let more = ONE.replace("0.5, 0.5, 0.5", "0.5, 0.5, 0.8");
    let built = loaded(&format!("{run}{more}"), &[]).unwrap().build_with(&loader).unwrap();
    assert_eq!(built.state.id, [2, 5, 9, 10], "particles of a run may overlap each other; others get the next ids");
    assert_eq!(built.state.contacts, state.contacts);
    let nameless = run.replace("material = 'a'\n", "");
    let built = loaded(&nameless, &[]).unwrap().build_with(&loader);
    assert_eq!(built.unwrap_err().problems[0].code, "tdem::case::run-materials");
    let by_name = run.replace("material = 'a'\n", "").replace("'earlier'", "'earlier'\nmaterials = ['b']");
    let built = loaded(&by_name, &[]).unwrap().build_with(&loader);
    assert_eq!(built.unwrap_err().problems[0].code, "tdem::case::missing-interaction");
}

type Harm = fn(&mut State);

#[test]
fn a_state_that_no_run_leaves_is_refused_with_its_field() {
    let first = build(&RANDOM.replace("200", "3"), &[]);
    let run = "[[particles]]\nmaterial = 'a'\n[particles.run]\ndirectory = 'earlier'\n";
    let harms: [(&str, Harm); 5] = [
        ("velocity", |state| state.velocity.truncate(1)),
        ("position", |state| state.position[2][0] = f64::NAN),
        ("radius", |state| state.radius[0] = f64::INFINITY),
        ("temperature", |state| state.temperature = vec![300.0]),
        ("contacts.pair", |state| state.contacts = vec![Contact { first: 0, second: 3, displacement: [0.0; 3] }]),
    ];
    for (field, harm) in harms {
        let mut state = first.state.clone();
        harm(&mut state);
        let loader = |_: &Path| Ok(state.clone());
        let problem = loaded(run, &[]).unwrap().build_with(&loader).unwrap_err().problems.remove(0);
        assert_eq!(problem.code, "tdem::case::run-unreadable");
        assert!(problem.message.contains(&format!("`{field}`")), "{}", problem.message);
    }
}

#[test]
fn files_that_begin_with_a_mark_of_the_order_of_bytes_are_read() {
    let folder = std::env::temp_dir().join(format!("tdem-marked-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.join(name), format!("\u{feff}{text}")).unwrap();
    write("spheres.csv", "x,y,z,radius,id\r\n0.5,0.5,0.5,0.1,4\r\n");
    let csv = "[[particles]]\nmaterial = 'a'\n[particles.csv]\nfile = 'spheres.csv'\n";
    write("case.toml", &format!("{}{}{csv}", REST.trim_start(), interaction("a", "a")));
    let built =
        tdem_case::load(&folder.join("case.toml"), &[]).and_then(|l| l.build()).unwrap_or_else(|p| panic!("{p}"));
    assert_eq!((built.state.id, built.state.position), (vec![4], vec![[0.5; 3]]));
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn limits_agree_with_the_formulas() {
    // Two spheres without gravity: R = 0.1, rho = 1000, E = 1e7, nu = 0.25, at 2 m/s each.
    let two = ONE.replace("[[0.5, 0.5, 0.5]]", "[[0.3, 0.5, 0.5], [0.7, 0.5, 0.5]]");
    let built = build(&two, &[("particles.0.velocity", "[2.0, 0.0, 0.0]")]);
    let limit = |name: &str| built.limits.limits.iter().find(|limit| limit.name == name).unwrap().seconds;
    let close = |got: f64, expected: f64| assert!((got / expected - 1.0).abs() < 1e-6, "{got} {expected}");
    // pi 0.1 sqrt(1000/4e6) / (0.1631*0.25 + 0.8766) = 5.414682e-3 s
    close(limit("Rayleigh waves"), 0.2 * 5.414_682e-3);
    // m* = 2.0943951 kg, R* = 0.05 m, E* = 5.3333e6 Pa, v = 4 m/s
    let collision = 2.868_265_7 * libm::pow(2.094_395_1 * 2.094_395_1 / (0.05 * 5.333_333e6 * 5.333_333e6 * 4.0), 0.2);
    close(limit("impact"), collision / 20.0);
    close(limit("the normal dashpot alone"), 0.02);
    close(limit("the normal dashpots of all contacts"), 1.0 / 200.0);
    close(limit("the tangential dashpots of all contacts"), 1.0 / (2.0 * 35.0));
    close(built.plan.dt, 0.8 * limit("impact").min(limit("Rayleigh waves")));
    assert!(built.limits.auto && built.limits.smallest().is_some_and(|l| !l.proven));

    let gear = build(&two, &[("time.integrator", "gear")]);
    let limit = |name: &str| gear.limits.limits.iter().find(|limit| limit.name == name).unwrap();
    close(limit("the normal dashpot alone").seconds, 1.635e-3);
    assert!(limit("the normal dashpot alone").proven);
    close(limit("Rayleigh waves").seconds, 0.1 * 5.414_682e-3);
}

#[test]
fn limits_of_the_papers_packing() {
    let cases = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../cases/packing.toml");
    let set = |key: &str, value: &str| (key.to_owned(), value.to_owned());
    let loaded = tdem_case::load(&cases, &[set("size", "83k"), set("time.step", "auto")]).unwrap();
    let built = loaded.build().unwrap();
    let limit = |name: &str| built.limits.limits.iter().find(|limit| limit.name == name).unwrap().seconds;
    assert!((limit("Rayleigh waves") / 2.197e-4 - 1.0).abs() < 1e-3);
    assert!((limit("the normal dashpots of all contacts") / (1.0 / 6000.0) - 1.0).abs() < 1e-12);
    // The top of the pile could fall 0.93 m: an impact at 4.3 m/s.
    assert!((limit("impact") / 1.03e-4 - 1.0).abs() < 0.01, "{}", limit("impact"));
    assert_eq!(built.plan.dt, 0.8 * limit("impact"));
}

#[test]
fn a_step_between_estimate_and_bound_is_warned_of() {
    let built = build(ONE, &[("time.step", "0.004")]);
    assert!(built.warnings.problems.iter().all(|p| p.code == "tdem::case::step-large"));
    assert!(!built.warnings.problems.is_empty() && !built.limits.auto);
    let two = ONE.replace("[[0.5, 0.5, 0.5]]", "[[0.3, 0.5, 0.5], [0.7, 0.5, 0.5]]");
    assert_eq!(refused(&two, &[("time.step", "0.021")]), "tdem::case::step-unstable");
}

#[test]
fn schedules_are_in_steps() {
    let built = build(ONE, &[("time.step", "1e-3"), ("output.frames", "4"), ("output.history_interval", "0.01")]);
    assert_eq!((built.schedule.steps, built.schedule.frame_every, built.schedule.history_every), (1000, 250, 10));
    let built = build(ONE, &[("time.step", "1e-3"), ("output.frames", "0"), ("output.checkpoint_interval", "0.1")]);
    assert_eq!((built.schedule.frame_every, built.schedule.checkpoint_every), (0, Some(100)));
    assert_eq!(built.schedule.checkpoint_interval_secs, 300.0);
}

#[test]
fn the_schema_documents_every_key_with_its_unit() {
    let schema = tdem_case::json_schema();
    let mut keys = 0;
    let tables = schema["$defs"].as_object().unwrap().values().chain([&schema]);
    for table in tables {
        for (key, value) in table.get("properties").and_then(|p| p.as_object()).into_iter().flatten() {
            let text = value["description"].as_str().unwrap_or_else(|| panic!("{key} has no description"));
            if let Some(unit) = value.get("x-unit") {
                let unit = unit.as_str().unwrap();
                assert!(text.contains(unit), "{key}: `{text}` lacks {unit}");
            }
            keys += 1;
        }
    }
    assert!(keys > 60, "{keys}");
    assert_eq!(schema["additionalProperties"], false);
    assert_eq!(schema["$defs"]["Material"]["properties"]["density"]["exclusiveMinimum"], 0.0);
}

#[test]
fn whole_numbers_need_no_point() {
    let built = build(ONE, &[("gravity", "[0, 0, -10]"), ("time.end", "2"), ("time.step", "1e-3")]);
    assert_eq!(built.plan.gravity, [0.0, 0.0, -10.0]);
    assert_eq!(built.schedule.steps, 2000);
}

#[test]
fn more_particles_than_there_is_memory_for_are_refused_before_they_are_placed() {
    let many = |source: &str| format!("[[particles]]\nmaterial = 'a'\n{source}\n");
    let sources = [
        "random = { count = 1000000000, radius = 1e-4 }",
        "random = { count = 200000000, radius = 1e-4 }",
        "random = { volume_fraction = 0.3, radius = 7e-4 }",
        "lattice = { kind = 'fcc', radius = 1e-3 }",
        "lattice = { kind = 'sc', radius = 1e-3, site = [0.5, 0.5, 0.5] }",
    ];
    for source in sources {
        let problems = loaded(&many(source), &[])
            .and_then(|case| case.build_within(&tdem_case::NoRuns, Some(16_000_000_000)))
            .unwrap_err();
        let [problem] = problems.problems.as_slice() else { panic!("{problems}") };
        let code = if source.contains("1000000000") { "too-many-particles" } else { "too-little-memory" };
        assert_eq!(problem.code, format!("tdem::case::{code}"), "{source}");
        assert!(problem.message.contains(" GB of memory; "), "{}", problem.message);
        assert!(code != "too-little-memory" || problem.message.ends_with("this machine has 16 GB"));
    }
    // What fits is placed, and groups count together.
    let two = many("lattice = { kind = 'sc', radius = 0.05, max = [1.0, 1.0, 0.5], cells = [9, 9, 4] }")
        + &many("lattice = { kind = 'sc', radius = 0.05, min = [0.0, 0.0, 0.5], cells = [9, 9, 4] }");
    let within = |memory| loaded(&two, &[]).and_then(|case| case.build_within(&tdem_case::NoRuns, Some(memory)));
    let built = within(16_000_000).unwrap();
    let each = built.memory.run_bytes / built.state.len() as u64;
    assert!(within(each * 648 / 40).unwrap_err().problems[0].code == "tdem::case::too-little-memory");
    assert!(within(8 * each * 648).is_ok());
}

#[test]
fn spheres_that_cannot_find_places_are_refused_before_any_is_drawn() {
    let random = |source: &str| format!("[[particles]]\nmaterial = 'a'\nrandom = {{ {source} }}\n");
    // Drawing tens of millions of places would take minutes.
    for source in ["count = 60000000, radius = 0.0012", "volume_fraction = 0.39, radius = 0.0012"] {
        let problems = loaded(&random(source), &[]).and_then(|case| case.build()).unwrap_err();
        assert_eq!(problems.problems[0].code, "tdem::case::no-room");
        assert!(problems.problems[0].message.contains("run out at 0.384"), "{problems}");
    }
    let ranges = "volume_fraction = 0.63, radius = { min = 0.001, max = 0.002, distribution = 'volume' }";
    let problems = loaded(&random(ranges), &[]).and_then(|case| case.build()).unwrap_err();
    assert!(problems.problems[0].message.contains("run out at 0.621"), "{problems}");
    // A single sphere fills more of a box that it just fits into.
    let one = "count = 1, radius = 0.0999, min = [0.0, 0.0, 0.0], max = [0.2, 0.2, 0.2]";
    assert_eq!(build(&random(one), &[]).state.len(), 1);
}

#[test]
fn what_check_lets_pass_does_not_stop_at_the_first_step() {
    let pair = "[[particles]]\nmaterial = 'a'\nallow_overlap = true\nFIXED\n[particles.list]\nradius = 0.1\n\
                positions = [[0.5, 0.5, 0.5], [0.51, 0.5, 0.5]]\n";
    let run = |fixed: &str, model: &str| {
        let built = loaded(&pair.replace("FIXED", fixed), &[("model", model)]).and_then(|case| case.build());
        built.map(|built| {
            let mut simulation =
                tdem_engine::Simulation::new(built.state, built.plan, tdem_engine::cpu::Options::default()).unwrap();
            simulation.advance(3).unwrap();
            simulation.state().unwrap()
        })
    };
    for (fixed, model) in [
        ("", "GNTM"),
        ("fixed = ['x', 'y', 'z']", "GNTM"),
        ("fixed = ['x', 'y']", "GN"),
        ("prescribed = { x = 0.1, y = 0.0, z = 0.0 }", "GN"),
    ] {
        let problems = run(fixed, model).unwrap_err();
        let [problem] = problems.problems.as_slice() else { panic!("{problems}") };
        assert_eq!(problem.code, "tdem::case::overlap-limit", "{fixed}");
        assert!(problem.message.contains("1 pair") && problem.message.contains("by 1.9"), "{}", problem.message);
    }
    for (fixed, model) in [("fixed = ['x', 'y', 'z', 'rx', 'ry', 'rz']", "GNTM"), ("fixed = ['x', 'y', 'z']", "GN")] {
        let state = run(fixed, model).unwrap_or_else(|problems| panic!("{problems}"));
        assert_eq!(state.position[1], [0.51, 0.5, 0.5]);
    }
}

#[test]
fn what_is_wrong_is_told_at_once_whatever_keys_are_unknown() {
    let text = format!(
        "{ONE}[[wall]]\nname = 'floor'\npoint = [0, 0, 0]\nnormal = [0, 0, 0]\nmaterial = 'steel'\nstl = 'a.stl'\n"
    ) + "[[interaction]]\nbetween = ['a', 'b']\nfriction = 0.4\nrolling_friction = 0.1\nstatic_fricton = 0.2\n\
           dynamic_friction = 0.3\nnormal_damping = -1.0\ntangential_damping = 0.0\n";
    let problems = loaded(&text, &[]).unwrap_err();
    let told: Vec<(&str, &str)> = problems
        .problems
        .iter()
        .map(|p| (p.code, problems.source.text.get(p.labels[0].span.clone()).unwrap()))
        .collect();
    for expected in [
        ("tdem::case::unknown-key", "stl"),
        ("tdem::case::unknown-key", "friction"),
        ("tdem::case::unknown-key", "rolling_friction"),
        ("tdem::case::unknown-key", "static_fricton"),
        ("tdem::case::out-of-range", "-1.0"),
        ("tdem::case::unknown-material", "'steel'"),
        ("tdem::case::zero-normal", "[0, 0, 0]"),
        // Of the key that was meant.
        ("tdem::case::friction-order", "0.3"),
    ] {
        assert!(told.contains(&expected), "{expected:?} is not in {told:?}");
    }
    assert_eq!(told.len(), 8, "{problems}");
    let help = |key: &str| {
        let place = told.iter().position(|(_, text)| *text == key).unwrap();
        problems.problems[place].help.clone().unwrap()
    };
    assert!(help("stl").contains("no meshes") && help("rolling_friction").contains("no rolling resistance"));
    assert!(help("friction").contains("static_friction") && help("static_fricton").contains("did you mean"));
}

#[test]
fn a_hundred_thousand_problems_take_no_time_and_are_counted() {
    let keys: Vec<String> = (0..100_000).map(|k| format!("key_number_{k} = {k}\n")).collect();
    let keys = keys.concat();
    let pair = interaction("a", "a");
    let start = std::time::Instant::now();
    let unknown = loaded(&format!("{ONE}[output]\n{keys}"), &[]).unwrap_err();
    let again = loaded(&format!("{ONE}{}", pair.repeat(20_000)), &[]).unwrap_err();
    for (problems, code, count) in
        [(unknown, "tdem::case::unknown-key", 99_980), (again, "tdem::case::duplicate-interaction", 19_980)]
    {
        assert_eq!(problems.problems.len(), 20);
        assert!(problems.problems.iter().all(|problem| problem.code == code));
        assert!(problems.problems[19].message.ends_with(&format!("(and {count} more with this code)")));
        assert!(problems.to_string().len() < 20_000);
    }
    // Ten times as many took a hundred times as long, 11 minutes.
    assert!(start.elapsed().as_secs() < 120, "{:?}", start.elapsed());
}
