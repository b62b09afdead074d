//! Bonds and zones: who is bonded, with what, what that means for the step.

use std::f64::consts::SQRT_2;
use std::path::{Path, PathBuf};
use tdem_case::{Built, Problems, parse};
use tdem_engine::physics::bond::{Damping, Failure, Form, Tension, face_centred};
use tdem_engine::physics::contact::Law;
use tdem_engine::{BondHistory, Breakage, State};

const RADIUS: f64 = 0.005;

/// A block of bonded concrete; a test replaces and adds parts.
const BLOCK: &str = r#"
model = "BPM"
gravity = [0.0, 0.0, 0.0]
domain = { min = [-0.1, -0.1, -0.1], max = [0.2, 0.2, 0.2] }

[time]
end = 1.0e-3

[material.concrete]
density = 3241.0
young_modulus = 30.0e9
poisson_ratio = 0.2

[material.steel]
density = 10601.0
young_modulus = 200.0e9
poisson_ratio = 0.3

[[interaction]]
between = ["concrete", "concrete"]
static_friction = 0.5
dynamic_friction = 0.5
normal_damping = 0.0
tangential_damping = 0.0

[[interaction]]
between = ["concrete", "steel"]
static_friction = 0.5
dynamic_friction = 0.5
normal_damping = 0.0
tangential_damping = 0.0

[[interaction]]
between = ["steel", "steel"]
static_friction = 0.5
dynamic_friction = 0.5
normal_damping = 0.0
tangential_damping = 0.0

[[bond]]
between = ["concrete", "concrete"]
lattice = { young_modulus = 30.0e9, poisson_ratio = 0.2, tensile_strength = 2.9e6, shear_factor = 3.0 }

[[particles]]
material = "concrete"
[particles.lattice]
kind = "fcc"
radius = 0.005
cells = [3, 4, 5]
origin = [0.0, 0.0, 0.0]
"#;

const STEEL: &str = r#"
[[bond]]
between = ["steel", "steel"]
lattice = { young_modulus = 200.0e9, poisson_ratio = 0.3 }
tensile_strength = "unbreakable"
shear_strength = "unbreakable"

[[bond]]
between = ["concrete", "steel"]
series = true
tensile_strength = 0.5e6
shear_strength = 1.0e6

[[zone]]
material = "steel"
cylinder = { axis = "z", radius = 0.012 }
"#;

fn try_build(more: &str, overrides: &[(&str, &str)]) -> Result<Built, Problems> {
    let overrides: Vec<(String, String)> =
        overrides.iter().map(|(key, value)| ((*key).to_owned(), (*value).to_owned())).collect();
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/bad");
    parse("test", &format!("{BLOCK}{more}"), &folder, &overrides).and_then(|loaded| loaded.build())
}

fn build(more: &str, overrides: &[(&str, &str)]) -> Built {
    let built = try_build(more, overrides).unwrap_or_else(|p| panic!("{p}"));
    assert!(built.state.validate(&built.plan).is_ok());
    built
}

fn refused(more: &str, overrides: &[(&str, &str)]) -> &'static str {
    try_build(more, overrides).map_or_else(|p| p.problems[0].code, |_| "built")
}

fn close(found: f64, expected: f64) {
    assert!((found / expected - 1.0).abs() < 1e-9, "{found} for {expected}");
}

/// Bonds of a face-centred block of cells.
fn lattice_bonds([x, y, z]: [usize; 3]) -> usize {
    let [p, q, r] = [x, y, z].map(|n| 2 * n - 1);
    p * q * 2 * z + p * r * 2 * y + q * r * 2 * x
}

#[test]
fn a_lattice_has_as_many_bonds_as_it_should() {
    for cells in [[1, 1, 1], [3, 4, 5], [6, 2, 3]] {
        let built = build("", &[("particles.0.lattice.cells", &format!("{cells:?}"))]);
        assert_eq!(built.state.bonds.len(), lattice_bonds(cells));
        assert!(built.state.bonds.iter().all(|bond| bond.holds() && bond.strength == 1.0));
        assert_eq!(built.state.bonded_position, built.state.position);
    }
}

#[test]
fn bonds_go_through_faces_that_repeat() {
    let side = 4.0 * 2.0 * SQRT_2 * RADIUS;
    let built = build(
        "",
        &[
            (
                "domain",
                &format!("{{ min = [0, 0, 0], max = [{side:?}, {side:?}, {side:?}], periodic = [true, true, true] }}"),
            ),
            ("particles.0.lattice.cells", "[4, 4, 4]"),
        ],
    );
    assert_eq!(built.state.bonds.len(), 6 * built.state.len());
}

#[test]
fn a_solid_becomes_bonds() {
    let built = build("", &[("bond.0.radius_multiplier", "0.8"), ("bond.0.friction_angle_deg", "45")]);
    let joint = built.plan.joint(0, 0).unwrap();
    let bond = joint.bond(RADIUS, RADIUS, 2.0 * RADIUS, 1.0);
    close(joint.cement.stiffness_ratio, 1.0 / 3.0);
    close(bond.stiffness.normal, 30e9 * 2.0 * SQRT_2 * RADIUS / 2.4);
    close(joint.cement.tensile_strength, face_centred::tensile_stress(2.9e6, 1.0 / 3.0, 0.8));
    close(joint.cement.shear_strength, 3.0 * face_centred::shear_stress(2.9e6, 1.0 / 3.0, 0.8));
    close(joint.cement.internal_friction, 1.0);
    assert!(built.plan.law == Law::GNTM && built.plan.joint(0, 1).is_none());
}

#[test]
fn bonds_themselves_can_be_described() {
    let micro =
        [("bond.0.micro", "{ young_modulus = 20e9, stiffness_ratio = 0.4 }"), ("bond.0.tensile_strength", "1e6")];
    let text = BLOCK.replace(
        "lattice = { young_modulus = 30.0e9, poisson_ratio = 0.2, tensile_strength = 2.9e6, shear_factor = 3.0 }",
        "shear_strength = \"unbreakable\"",
    );
    let overrides: Vec<(String, String)> = micro.iter().map(|(k, v)| ((*k).to_owned(), (*v).to_owned())).collect();
    let built = parse("test", &text, Path::new(""), &overrides).unwrap().build().unwrap_or_else(|p| panic!("{p}"));
    let joint = built.plan.joint(0, 0).unwrap();
    assert_eq!((joint.young_modulus, joint.stiffness_per_area), (20e9, 0.0));
    assert_eq!((joint.cement.tensile_strength, joint.cement.shear_strength), (1e6, f64::INFINITY));
}

#[test]
fn halves_in_series_give_an_interface() {
    let built = build(STEEL, &[]);
    let normal = |a, b| {
        let joint = built.plan.joint(a, b).unwrap();
        let bond = joint.bond(RADIUS, RADIUS, 2.0 * RADIUS, 1.0);
        [bond.stiffness.normal, bond.stiffness.shear]
    };
    let (concrete, steel, interface) = (normal(0, 0), normal(1, 1), normal(0, 1));
    for k in 0..2 {
        close(interface[k], 2.0 * concrete[k] * steel[k] / (concrete[k] + steel[k]));
    }
    let joint = built.plan.joint(1, 0).unwrap();
    assert_eq!(joint.cement.tensile_strength, 0.5e6);
    assert_eq!(built.state.bonds.len(), lattice_bonds([3, 4, 5]));
}

#[test]
fn a_zone_makes_particles_of_another_material() {
    let built = build(STEEL, &[]);
    let mut steel = 0;
    for (k, [x, y, _]) in built.state.position.iter().enumerate() {
        let inside = x * x + y * y < 0.012 * 0.012;
        assert_eq!(built.state.material[k] == 1, inside);
        let density = if inside { 10601.0 } else { 3241.0 };
        close(built.state.mass[k], 4.0 / 3.0 * std::f64::consts::PI * RADIUS * RADIUS * RADIUS * density);
        steel += usize::from(inside);
    }
    assert!(steel > 10);
}

#[test]
fn a_zone_grips_particles_of_one_material() {
    let grip =
        "[[zone]]\nonly = 'steel'\nbox = { min = [-1.0, -1.0, 0.06] }\nfixed = ['x']\nprescribed = { z = 0.1 }\n";
    let built = build(&format!("{STEEL}{grip}\n[[symmetry]]\naxis = 'y'\nat = 0.0\n"), &[]);
    let mut gripped = 0;
    for (k, [_, y, z]) in built.state.position.iter().enumerate() {
        let constraint = built.plan.constraints[usize::from(built.state.constraint[k])];
        let held = built.state.material[k] == 1 && *z >= 0.06;
        assert_eq!(constraint.velocity[2], held.then_some(0.1));
        assert_eq!(constraint.velocity[1], (*y == 0.0).then_some(0.0));
        gripped += usize::from(held);
    }
    assert_eq!(gripped, 2);
}

#[test]
fn what_is_pulled_may_start_stretching() {
    let built = build("", &[("particles.0.strain_rate", "[0.0, 2.0, -0.5]")]);
    for ([_, y, z], v) in built.state.position.iter().zip(&built.state.velocity) {
        assert_eq!(*v, [0.0, 2.0 * y, -0.5 * z]);
    }
}

#[test]
fn forms_of_the_law() {
    for (form, expected) in [
        ("total", Form::Total),
        ("incremental", Form::Incremental(Tension::FromLength)),
        ("incremental-stored", Form::Incremental(Tension::Stored)),
    ] {
        let built = build("", &[("bonds.form", form), ("bonds.local_damping", "0.7")]);
        let bonds = built.plan.bonds.as_ref().unwrap();
        assert_eq!((bonds.law.form, bonds.law.damping), (expected, Damping::Off));
        assert!(bonds.local_damping == 0.7 && !bonds.contact_in_bonded_pairs);
    }
    let damped = build("", &[("bond.0.damping_ratio", "0.1")]);
    assert_eq!(damped.plan.bonds.unwrap().law.damping, Damping::Viscous);
}

#[test]
fn strengths_scatter_about_what_was_given() {
    let set = [("bond.0.scatter", "{ weibull_shape = 4.0 }"), ("particles.0.lattice.cells", "[8, 8, 8]")];
    let built = build("", &set);
    let count = built.state.bonds.len() as f64;
    let mean = built.state.bonds.iter().map(|bond| bond.strength).sum::<f64>() / count;
    assert!((mean - 1.0).abs() < 3.0 * 0.28 / count.sqrt(), "{mean}");
    assert_eq!(built.state.hash(), build("", &set).state.hash());
    assert_ne!(built.state.hash(), build("", &[set[0], set[1], ("seed", "2")]).state.hash());
}

#[test]
fn loose_particles_are_not_bonded() {
    let ball = "[[particles]]\nmaterial = 'concrete'\nloose = true\n[particles.list]\nradius = 0.005\n\
                positions = [[0.0, 0.0, -0.01]]\n";
    let built = build(ball, &[]);
    assert_eq!(built.state.bonds.len(), lattice_bonds([3, 4, 5]));
    let bonded = build(&ball.replace("true", "false"), &[]);
    assert_eq!(bonded.state.bonds.len(), lattice_bonds([3, 4, 5]) + 1);
}

#[test]
fn the_step_is_that_of_the_lattice() {
    let built = build("", &[("particles.0.lattice.cells", "[6, 6, 6]")]);
    let limit = |name: &str| built.limits.limits.iter().find(|limit| limit.name == name).unwrap();
    let mass = 4.0 / 3.0 * std::f64::consts::PI * RADIUS * RADIUS * RADIUS * 3241.0;
    let unit = (mass / (30e9 * 2.0 * SQRT_2 * RADIUS / 2.4)).sqrt();
    // The true limit of this lattice is 0.5026 units; the bound is 1.30 times as careful.
    let bonds = limit("bonds");
    assert!((0.37..0.5026).contains(&(bonds.seconds / unit)) && !bonds.proven, "{}", bonds.seconds / unit);
    // One particle in twelve bonds: 4 (K_n + 2 K_s) in each direction.
    let one = limit("the bonds of one particle");
    close(one.seconds, 2.0 * unit / (4.0 * (1.0 + 2.0 / 3.0_f64)).sqrt());
    assert!(one.proven);
    assert!(built.plan.dt <= 0.8 * bonds.seconds);
    assert_eq!(refused("", &[("time.step", &format!("{:e}", 1.01 * one.seconds))]), "tdem::case::step-unstable");
    let gear = build("", &[("time.integrator", "gear"), ("particles.0.lattice.cells", "[6, 6, 6]")]);
    let gear = gear.limits.limits.iter().find(|limit| limit.name == "bonds").unwrap().seconds;
    close(bonds.seconds / gear, 2.0 / 0.312);
}

#[test]
fn memory_counts_bonds() {
    let with = build("", &[]);
    let stored = build("", &[("bonds.form", "incremental")]);
    let (few, many) = (with.memory, stored.memory);
    let histories = with.state.bonds.len() * size_of::<tdem_engine::BondHistory>();
    assert_eq!(many.state_bytes - few.state_bytes, histories as u64);
}

#[test]
fn bonds_from_a_file() {
    let folder: PathBuf = std::env::temp_dir().join(format!("tdem-bonds-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let read = |rows: &str| {
        std::fs::write(folder.join("bonds.csv"), format!("first,second\n{rows}")).unwrap();
        let file = [("bonds.file".to_owned(), "bonds.csv".to_owned())];
        let loaded = parse("test", BLOCK, &folder, &file).unwrap_or_else(|p| panic!("{p}"));
        assert!(loaded.effective_toml().contains(&folder.display().to_string()));
        loaded.build()
    };
    let built = read("1, 0\n# second neighbours too\n0,4\n").map(|built| built.state.bonds);
    // Lengths differ: a solid's stiffness is not known for that.
    assert_eq!(built.unwrap_err().problems[0].code, "tdem::case::bond-lattice");
    let bonds = read("1,0\n0,2\n").unwrap_or_else(|p| panic!("{p}")).state.bonds;
    assert_eq!(bonds.iter().map(|b| [b.first, b.second]).collect::<Vec<_>>(), [[0, 1], [0, 2]]);
    for (rows, code) in [
        ("0,1\n1,0\n", "tdem::case::bond-file"),
        ("0,100000\n", "tdem::case::bond-file"),
        ("3,3\n", "tdem::case::bond-file"),
        ("0,1,2\n", "tdem::case::csv-value"),
        ("0,1\n0,2", "tdem::case::csv-truncated"),
        ("", "tdem::case::bond-unused"),
    ] {
        let problems = read(rows).unwrap_err();
        assert_eq!(problems.problems[0].code, code, "{problems}");
    }
    std::fs::remove_dir_all(&folder).unwrap();
}

#[test]
fn a_missing_interface_is_warned_of() {
    let lone = &STEEL[..STEEL.find("[[bond]]\nbetween = [\"concrete\"").unwrap()];
    let zone = &STEEL[STEEL.find("[[zone]]").unwrap()..];
    let built = build(&format!("{lone}{zone}"), &[]);
    assert_eq!(built.warnings.problems[0].code, "tdem::case::bond-missing");
}

/// Positions of what is cut out of a lattice around a site, with some keys of the group.
fn cut(keys: &str) -> Vec<[f64; 3]> {
    let text = BLOCK.replace("cells = [3, 4, 5]\norigin = [0.0, 0.0, 0.0]", "site = [0.01, 0.02, 0.03]");
    let text = text.replace("[[particles]]", &format!("[[particles]]\n{keys}"));
    let loaded = parse("test", &text, Path::new(""), &[]).unwrap_or_else(|p| panic!("{p}"));
    let built = loaded.build().unwrap_or_else(|p| panic!("{p}"));
    assert!(built.warnings.problems.is_empty(), "{}", built.warnings);
    let again = parse("written", &loaded.effective_toml(), Path::new(""), &[]).unwrap_or_else(|p| panic!("{p}"));
    let again = again.build().unwrap_or_else(|p| panic!("{p}"));
    assert_eq!(again.state.hash(), built.state.hash());
    built.state.position
}

/// Sites of the lattice of [`cut`] that satisfy a condition on their distance from the site, in radii.
fn sites(condition: impl Fn([f64; 3]) -> bool) -> usize {
    let half_cell = SQRT_2;
    let mut count = 0;
    for cell in 0..101_i32.pow(3) {
        let step = [cell % 101 - 50, cell / 101 % 101 - 50, cell / 10_201 - 50];
        count += usize::from(step.iter().sum::<i32>() % 2 == 0 && condition(step.map(|n| f64::from(n) * half_cell)));
    }
    count
}

#[test]
fn bodies_are_cut_out_of_a_lattice() {
    let across = |[x, y, _]: [f64; 3]| x * x + y * y;
    let square = |[x, y, z]: [f64; 3]| x * x + y * y + z * z;
    let through = "through = [0.01, 0.02, 0.03]";
    let cases: [(String, usize); 4] = [
        (
            format!("within = {{ cylinder = {{ axis = 'z', {through}, radius = 0.033, from = -0.02, to = 0.04 }} }}"),
            sites(|p| across(p) < 6.6 * 6.6 && (-4.0..=8.0).contains(&p[2])),
        ),
        (
            "within = { ball = { center = [0.01, 0.02, 0.03], radius = 0.036 } }".to_owned(),
            sites(|p| square(p) < 7.2 * 7.2),
        ),
        (
            format!(
                "within = {{ ball = {{ center = [0.01, 0.02, 0.03], radius = 0.036 }} }}\n\
                 without = [{{ cylinder = {{ axis = 'z', {through}, radius = 0.009 }} }}, {{ box = {{ max = [0.2, 0.2, 0.03] }} }}]"
            ),
            sites(|p| square(p) < 7.2 * 7.2 && across(p) >= 1.8 * 1.8 && p[2] > 0.0),
        ),
        (
            format!(
                "within = {{ revolution = {{ axis = 'z', {through}, profile = [[-0.03, 0.0], [0.0, 0.03], [0.02, 0.03]] }} }}"
            ),
            sites(|p| (-6.0..=4.0).contains(&p[2]) && across(p).sqrt() < f64::min(6.0, p[2] + 6.0)),
        ),
    ];
    for (keys, expected) in cases {
        assert!(expected > 80);
        assert_eq!(cut(&keys).len(), expected, "{keys}");
    }
}

#[test]
fn a_cylinder_about_a_site_is_as_symmetric_as_the_lattice() {
    let keys =
        "within = { cylinder = { axis = 'z', through = [0.01, 0.02, 0.0], radius = 0.033, from = 0.0, to = 0.06 } }";
    let points = cut(keys);
    let steps =
        |[x, y, z]: [f64; 3]| [x - 0.01, y - 0.02, z - 0.03].map(|length| (length / (SQRT_2 * RADIUS)).round() as i32);
    let all: std::collections::BTreeSet<[i32; 3]> = points.iter().map(|&point| steps(point)).collect();
    assert_eq!(all.len(), points.len());
    for [x, y, z] in &all {
        assert!(all.contains(&[-y, *x, *z]) && all.contains(&[-x, *y, *z]) && all.contains(&[*x, *y, -z]));
    }
}

#[test]
fn a_lattice_about_a_site_fills_its_region_and_joins_itself_where_that_repeats() {
    let side = 4.0 * 2.0 * SQRT_2 * RADIUS;
    let domain = format!("{{ min = [0, 0, 0], max = [{side:?}, {side:?}, {side:?}], periodic = [true, true, false] }}");
    let text = BLOCK.replace("cells = [3, 4, 5]\norigin = [0.0, 0.0, 0.0]", "site = [0.03, 0.01, 0.02]");
    let set = [("domain".to_owned(), domain)];
    let built = parse("test", &text, Path::new(""), &set).unwrap().build().unwrap_or_else(|p| panic!("{p}"));
    // Seven layers of 32 spheres fit between the faces that do not repeat.
    assert_eq!(built.state.len(), 7 * 32);
    assert_eq!(built.state.bonds.len(), 7 * 32 * 2 + 6 * 32 * 4);
}

#[test]
fn blocks_of_one_crystal_are_bonded_where_they_meet() {
    let height = 5.0 * 2.0 * SQRT_2 * RADIUS;
    let second = format!(
        "[[particles]]\nmaterial = 'steel'\n[particles.lattice]\nkind = 'fcc'\nradius = 0.005\ncells = [3, 4, 2]\n\
         origin = [0.0, 0.0, {height:?}]\n"
    );
    let joints = &STEEL[..STEEL.find("[[zone]]").unwrap()];
    let built = build(&format!("{joints}{second}"), &[]);
    let of = |id: u32| built.state.material[built.state.index_of(id).unwrap()];
    let mut counts = [0; 3];
    built.state.bonds.iter().for_each(|bond| counts[usize::from(of(bond.first) + of(bond.second))] += 1);
    let [first, last] = [lattice_bonds([3, 4, 5]), lattice_bonds([3, 4, 2])];
    assert_eq!(counts, [first, lattice_bonds([3, 4, 7]) - first - last, last]);
    assert!(counts[1] > 50 && built.warnings.problems.is_empty());
    let missing =
        build(&format!("{}{second}", &joints[..joints.find("[[bond]]\nbetween = [\"concrete\"").unwrap()]), &[]);
    assert_eq!(missing.warnings.problems[0].code, "tdem::case::bond-missing");
}

/// Particles of another run in this case, beside a lattice of its own that touches none of them.
fn from_run(state: &State, run: &str, more: &str) -> Result<Built, Problems> {
    let text = BLOCK.replace(
        "[[particles]]\n",
        &format!("{more}[[particles]]\nname = 'taken'\nmaterial = 'concrete'\nrun = {{ directory = 'other', {run} }}\n\n[[particles]]\n"),
    );
    let text = text.replace("origin = [0.0, 0.0, 0.0]", "origin = [0.0, 0.0, -0.09]");
    let loader = |_: &Path| -> Result<State, String> { Ok(state.clone()) };
    parse("test", &text, Path::new(""), &[]).and_then(|loaded| loaded.build_with(&loader))
}

/// A block that another run has bent a little, with a bond that broke in it.
fn strained() -> Built {
    let mut built = build("", &[("particles.0.lattice.cells", "[2, 2, 2]")]);
    let state = &mut built.state;
    for (k, [x, y, z]) in state.position.iter_mut().enumerate() {
        (*x, *y) = (*x * (1.0 + 1e-3), *y + 2e-3 * *z);
        state.orientation[k] = [0.0, 1e-3, 0.0, (1.0_f64 - 1e-6).sqrt()];
    }
    state.step = 7;
    state.bonds[3].breakage = Some(Breakage { step: 5, failure: Failure::Tension, energy: 1e-6 });
    built
}

#[test]
fn bonds_of_another_run_go_on_as_they_are() {
    let before = strained();
    let mut taken = before.state.clone();
    // The ids of that run are taken here by a group that comes first.
    taken.id.iter_mut().for_each(|id| *id += 3);
    taken.bonds.iter_mut().for_each(|bond| (bond.first, bond.second) = (bond.first + 3, bond.second + 3));
    let first = "[[particles]]\nmaterial = 'concrete'\nlist = { radius = 0.005, positions = [[0.05, 0.1, 0.1], [0.05, 0.15, 0.1], \
                 [0.05, 0.1, 0.15], [0.05, 0.15, 0.15], [0.05, 0.19, 0.19]] }\n";
    let built =
        from_run(&taken, "bonds = 'carry', offset = [0.01, 0.02, 0.0]", first).unwrap_or_else(|p| panic!("{p}"));
    assert!(built.state.validate(&built.plan).is_ok());
    let count = before.state.len();
    let own = lattice_bonds([3, 4, 5]);
    assert_eq!(built.state.bonds.len(), before.state.bonds.len() - 1 + own);
    for k in 0..count {
        // Five ids are taken before; orders are kept.
        let index = built.state.index_of(5 + k as u32).unwrap();
        assert_eq!(built.state.orientation[index], before.state.orientation[k]);
        for (d, shift) in [0.01, 0.02, 0.0].into_iter().enumerate() {
            assert_eq!(built.state.position[index][d], before.state.position[k][d] + shift);
            assert_eq!(built.state.bonded_position[index][d], before.state.bonded_position[k][d] + shift);
        }
    }
    let mut compared = 0;
    for (k, bond) in before.state.bonds.iter().enumerate() {
        let same = [bond.first + 5, bond.second + 5];
        let found = built.state.bonds.iter().position(|other| [other.first, other.second] == same);
        assert_eq!(found.is_some(), bond.holds());
        let Some(found) = found else { continue };
        let [was, is] = [(&before, k), (&built, found)].map(|(built, index)| {
            let reaction = built.state.evaluate_bond(&built.plan, index).unwrap().reaction;
            [reaction.force.x, reaction.force.y, reaction.force.z, reaction.stress.tensile, reaction.stress.shear]
        });
        let scale = was.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
        assert!(scale > 0.0 && was.iter().zip(is).all(|(was, is)| (was - is).abs() < 1e-9 * scale), "{was:?} {is:?}");
        compared += 1;
    }
    assert_eq!(compared, before.state.bonds.len() - 1);
}

#[test]
fn a_run_in_pieces_takes_only_whole_bonds_along() {
    let mut taken = strained().state;
    taken.bonds.truncate(10);
    let within = "within = { box = { max = [0.2, 0.2, 0.01] } }\nrun = { directory";
    let text = BLOCK.replace(
        "[particles.lattice]\nkind = \"fcc\"\nradius = 0.005\ncells = [3, 4, 5]\norigin = [0.0, 0.0, 0.0]",
        &format!("{within} = 'other', bonds = 'carry' }}"),
    );
    let loader = |_: &Path| -> Result<State, String> { Ok(taken.clone()) };
    let built = parse("test", &text, Path::new(""), &[]).and_then(|loaded| loaded.build_with(&loader));
    let built = built.unwrap_or_else(|p| panic!("{p}"));
    assert!(built.state.validate(&built.plan).is_ok());
    let kept = |id: u32| taken.position[id as usize][2] <= 0.01;
    let whole = taken.bonds.iter().filter(|bond| bond.holds() && kept(bond.first) && kept(bond.second)).count();
    assert!(built.state.len() < taken.len() && built.state.bonds.len() == whole && whole > 2);
}

#[test]
fn a_packing_of_another_run_is_bonded_as_it_lies() {
    let before = strained();
    let bonded = |gap: &str| {
        let set = [
            ("bond.0.gap_length".to_owned(), gap.to_owned()),
            ("bond.0.tensile_strength".to_owned(), "1e6".to_owned()),
            ("bond.0.shear_strength".to_owned(), "1e6".to_owned()),
            ("bond.0.micro".to_owned(), "{ young_modulus = 30e9, stiffness_ratio = 0.3 }".to_owned()),
        ];
        let text = BLOCK.replace(
            "lattice = { young_modulus = 30.0e9, poisson_ratio = 0.2, tensile_strength = 2.9e6, shear_factor = 3.0 }",
            "",
        );
        let text = text.replace(
            "[particles.lattice]\nkind = \"fcc\"\nradius = 0.005\ncells = [3, 4, 5]\norigin = [0.0, 0.0, 0.0]",
            "run = { directory = 'other' }",
        );
        let state = before.state.clone();
        let loader = move |_: &Path| -> Result<State, String> { Ok(state.clone()) };
        let built = parse("test", &text, Path::new(""), &set).and_then(|loaded| loaded.build_with(&loader));
        built.unwrap_or_else(|p| panic!("{p}")).state
    };
    let near = |reach: f64| {
        let place = &before.state.position;
        let pairs = (0..place.len()).flat_map(|i| (0..i).map(move |j| (i, j)));
        pairs
            .filter(|&(i, j)| (0..3).map(|d| place[i][d] - place[j][d]).map(|c| c * c).sum::<f64>().sqrt() <= reach)
            .count()
    };
    for gap in [0.0, 8e-6, 2e-5, 5e-3] {
        let state = bonded(&format!("{gap:?}"));
        assert_eq!(state.bonds.len(), near(2.0 * RADIUS + gap), "{gap}");
        assert_eq!(state.bonded_position, before.state.position);
        assert!(state.orientation.iter().all(|q| *q == [0.0, 0.0, 0.0, 1.0]));
    }
    assert!(near(2.0 * RADIUS) < near(2.0 * RADIUS + 8e-6));
}

#[test]
fn bonds_that_cannot_go_on_are_told() {
    let before = strained().state;
    let code = |result: Result<Built, Problems>| result.map_or_else(|p| p.problems[0].code, |_| "built");
    let carry = "bonds = 'carry', offset = [0.01, 0.02, 0.0]";
    assert_eq!(code(from_run(&before, carry, "")), "built");
    assert_eq!(code(from_run(&before, carry, "[bonds]\nform = 'incremental'\n")), "tdem::case::run-bonds");
    let mut without = before.clone();
    without.make_bonds(Vec::new());
    assert_eq!(code(from_run(&without, carry, "")), "tdem::case::run-bonds");
    let mut histories = before;
    histories.bond_histories =
        histories.bonds.iter().map(|_| BondHistory { tension: 3.0, ..BondHistory::default() }).collect();
    let built = from_run(&histories, carry, "[bonds]\nform = 'incremental-stored'\n").unwrap_or_else(|p| panic!("{p}"));
    assert!(built.state.validate(&built.plan).is_ok());
    let loaded = built.state.bond_histories.iter().filter(|history| history.tension == 3.0).count();
    assert_eq!(loaded, histories.bonds.len() - 1);
    let unit = |n: [f64; 3]| (n.iter().map(|c| c * c).sum::<f64>() - 1.0).abs() < 1e-12;
    assert!(built.state.bond_histories.iter().all(|history| history.tension == 3.0 || unit(history.normal)));
}
