//! What a case says of heat, as the engine gets it.

use std::path::Path;
use tdem_case::{Built, load, parse};
use tdem_engine::physics::heat::Path as ContactPath;
use tdem_engine::physics::heat::conduction::{bar, face_centred_bar};
use tdem_engine::physics::heat::surface::Cover;
use tdem_engine::{Around, Course, Exposure, Reading, Simulation, cpu};

const HEAD: &str = r#"
model = "TBPM"
gravity = [0.0, 0.0, 0.0]
[time]
end = 1.0e-2
[domain]
min = [-0.1, -0.1, -0.1]
max = [0.2, 0.2, 0.2]
[material.concrete]
density = 3038.57
young_modulus = 23.2e9
poisson_ratio = 0.2
thermal_conductivity = 1.5
specific_heat = 900.0
thermal_expansion = 1.0e-5
[[interaction]]
between = ["concrete", "concrete"]
static_friction = 0.5
dynamic_friction = 0.5
normal_damping = 0.0
tangential_damping = 0.0
[[bond]]
between = ["concrete", "concrete"]
lattice = { young_modulus = 23.2e9, poisson_ratio = 0.2 }
tensile_strength = "unbreakable"
shear_strength = "unbreakable"
[[particles]]
name = "block"
material = "concrete"
lattice = { kind = "fcc", radius = 0.005, cells = [3, 3, 3], origin = [0.0, 0.0, 0.0] }
"#;

const HEAT: &str = r#"
[heat]
scale = "celsius"
initial_temperature = 20.0
contacts = "bar"
bar_radius = "fcc"
"#;

fn build(tail: &str) -> Built {
    let text = format!("{HEAD}{tail}");
    let loaded = parse("case.toml", &text, Path::new(env!("CARGO_MANIFEST_DIR")), &[]).expect("the text is right");
    loaded.build().expect("the case can be built")
}

/// Lattice constant, m.
fn constant() -> f64 {
    2.0 * std::f64::consts::SQRT_2 * 0.005
}

#[test]
fn particles_begin_as_warm_as_the_case_says() {
    let built = build(&format!("temperature = 120.0\n{HEAT}"));
    assert_eq!(built.state.temperature.len(), built.state.len());
    let heat = built.plan.heat.as_ref().expect("the plan has heat");
    assert!(built.state.temperature.iter().all(|t| (t - 393.15).abs() < 1e-12));
    assert!((heat.reference_temperature - 293.15).abs() < 1e-12);
    assert_eq!(heat.time_scale, 1.0);
    assert_eq!(heat.contacts, ContactPath::Bar);
    // Warmer than where radii are as given by 100 K.
    assert!(built.state.reference_radius.iter().all(|&radius| radius == 0.005));
    assert!(built.state.radius.iter().all(|radius| (radius / 0.005 - 1.001).abs() < 1e-12));
}

#[test]
fn bonds_conduct_like_the_solid() {
    let built = build(&format!("{HEAT}open_sides = [3, 3]\n"));
    let heat = built.plan.heat.as_ref().expect("the plan has heat");
    let conductance = bar(heat.conductor(0, 0), 0.01, 0.01);
    // 4 H / a is the conductivity of the bulk; 1/12 of the bonds are missing at each pair of sides.
    let expected = 1.5 * constant() / 4.0 / (1.0 - 2.0 / 12.0);
    assert!((conductance / expected - 1.0).abs() < 1e-12, "{conductance} {expected}");
    let section = std::f64::consts::FRAC_PI_4 * face_centred_bar(Some([3, 3])) * face_centred_bar(Some([3, 3]));
    assert!((heat.conductor(0, 0).section / section - 1.0).abs() < 1e-12);
    assert_eq!(heat.conductor(0, 1).conductivity, 0.0, "what is rigid conducts nothing");
}

/// The same case with other words in the place of some.
fn build_with(words: &[(&str, &str)], tail: &str) -> Built {
    let text = words.iter().fold(format!("{HEAD}{tail}"), |text, (old, new)| {
        assert!(text.contains(old), "{old}");
        text.replace(old, new)
    });
    let loaded = parse("case.toml", &text, Path::new(env!("CARGO_MANIFEST_DIR")), &[]).expect("the text is right");
    let written =
        parse("written.toml", &loaded.effective_toml(), Path::new("."), &[]).expect("what is written can be read");
    assert_eq!(written.case, loaded.case);
    loaded.build().expect("the case can be built")
}

#[test]
fn materials_may_depend_on_temperature() {
    let numbers = build(HEAT);
    let same = [
        ("thermal_conductivity = 1.5", "thermal_conductivity = [[20.0, 1.5], [500.0, 1.5]]"),
        ("specific_heat = 900.0", "specific_heat = [[0.0, 900.0]]"),
    ];
    assert_eq!(build_with(&same, HEAT).plan, numbers.plan, "a table of one value is a number");

    let tables = [
        ("thermal_conductivity = 1.5", "thermal_conductivity = [[20.0, 2.0], [500.0, 3.0], [600.0, 1.0]]"),
        (
            "specific_heat = 900.0",
            "specific_heat = { file = \"tests/bad/property.csv\", temperature = \"T\", value = \"c\" }",
        ),
        ("shear_strength =", "stiffness_over_temperature = [[20.0, 1.0], [500.0, 4.0]]\nshear_strength ="),
        ("tensile_strength =", "strength_over_temperature = [[20.0, 1.0], [500.0, 0.0]]\ntensile_strength ="),
    ];
    let built = build_with(&tables, HEAT);
    let heat = built.plan.heat.as_ref().expect("the plan has heat");
    let close = |found: f64, expected: f64| assert!((found - expected).abs() < 1e-9, "{found} {expected}");
    close(heat.tables.conductivity[0].value(260.0 + 273.15), 2.5);
    close(heat.tables.specific_heat[0].value(310.0 + 273.15), 1000.0);
    close(heat.tables.conductivity[1].value(300.0), 0.0);
    assert_eq!(heat.conductor(0, 0).conductivity, 1.0);
    let bonds = built.plan.bonds.as_ref().expect("the plan has bonds");
    close(bonds.tables.stiffness[0].value(260.0 + 273.15), 2.5);
    close(bonds.tables.strength[0].value(260.0 + 273.15), 0.5);

    // Steps are those of the stiffest bonds, the best conductor and the least heat.
    let limit = |built: &Built, name: &str| {
        built.limits.limits.iter().find(|limit| limit.name == name).map(|limit| limit.seconds).expect("there is one")
    };
    for (name, expected) in [
        ("bonds", 0.5),
        ("the bonds of one particle", 1.0),
        ("conduction of heat", 0.5),
        ("the heat of one particle", 1.5 * 11.0 / 9.0),
    ] {
        close(limit(&built, name) / limit(&numbers, name), expected);
    }
}

#[test]
fn time_of_heat_is_scaled_or_lasts() {
    let scale = |tail: &str| build(&format!("{HEAT}{tail}")).plan.heat.expect("the plan has heat").time_scale;
    assert_eq!(scale("time_scale = 3.0\n"), 3.0);
    assert!((scale("duration = 0.5\n") / 50.0 - 1.0).abs() < 1e-14);
}

#[test]
fn a_face_of_a_lattice_needs_no_area_and_no_depth() {
    let built = build(&format!(
        "{HEAT}[[surface]]\nface = \"+z\"\ntemperature = [[0.0, 20.0], [100.0, 900.0]]\n\
         [[surface]]\nface = \"-z\"\nconvection = {{ coefficient = 10.0, temperature = 20.0 }}\n"
    ));
    let (state, heat) = (&built.state, built.plan.heat.as_ref().expect("the plan has heat"));
    let highest = state.position.iter().map(|p| p[2]).fold(0.0, f64::max);
    let (area, depth) = (0.5 * constant() * constant(), 0.25 * constant());
    let mut counts = [0; 2];
    for (k, place) in state.position.iter().enumerate() {
        let exposure = &heat.exposures[usize::from(state.exposure[k])];
        assert!(exposure.temperature.is_none(), "the surface is held, not the particle");
        if place[2] > highest - 1e-6 {
            counts[0] += 1;
            let [(exchange, outside)] = exposure.exchanges.as_slice() else { panic!("one exchange") };
            assert!((exchange.conductance / (area * 1.5 / depth) - 1.0).abs() < 1e-12);
            assert_eq!(outside, &Around::fluid(Course(vec![[0.0, 293.15], [100.0, 1173.15]])));
        } else if place[2] < 1e-6 {
            counts[1] += 1;
            let [(exchange, _)] = exposure.exchanges.as_slice() else { panic!("one exchange") };
            assert!((exchange.conductance / (area / (depth / 1.5 + 0.1)) - 1.0).abs() < 1e-12);
        } else {
            assert_eq!(state.exposure[k], 0, "insulated");
        }
    }
    assert_eq!(counts, [18, 18]);
}

#[test]
fn surfaces_add_up_where_they_meet() {
    let built = build(&format!(
        "{HEAT}[[surface]]\nof = \"block\"\nface = \"+z\"\narea = 1.8e-3\ndepth = 0.0\nflux = 1000.0\n\
         [[surface]]\nface = \"+x\"\nradiation = {{ emissivity = 0.9, temperature = 900.0 }}\n"
    ));
    let (state, heat) = (&built.state, built.plan.heat.as_ref().expect("the plan has heat"));
    let corner = (0..state.len()).max_by(|&a, &b| {
        let height = |k: usize| state.position[k][0] + state.position[k][2];
        height(a).total_cmp(&height(b))
    });
    let exposure = &heat.exposures[usize::from(state.exposure[corner.expect("there are particles")])];
    let [(flux, entering), (radiation, outside)] = exposure.exchanges.as_slice() else { panic!("two exchanges") };
    assert!((flux.flux_area / 1e-4 - 1.0).abs() < 1e-12, "18 particles share 1.8e-3 m²");
    assert_eq!(entering, &Around::flux(Course(vec![[0.0, 1000.0]])));
    let area = 0.5 * constant() * constant();
    assert!((radiation.radiation / (0.9 * 5.670_374_419e-8 * area) - 1.0).abs() < 1e-12);
    assert!((radiation.resistance / (0.25 * constant() / (1.5 * area)) - 1.0).abs() < 1e-12);
    assert_eq!(outside, &Around::surroundings(Course(vec![[0.0, 1173.15]])));
}

#[test]
fn all_that_acts_on_a_surface_is_one_exchange() {
    let built = build(&format!(
        "{HEAT}[[surface]]\nface = \"+z\"\nflux = 1000.0\nconvection = {{ coefficient = 10.0, temperature = 20.0 }}\n\
         radiation = {{ emissivity = 0.9, temperature = 900.0 }}\n"
    ));
    let heat = built.plan.heat.as_ref().expect("the plan has heat");
    assert_eq!(heat.exposures.len(), 2, "insulated, and the surface");
    let [(exchange, around)] = heat.exposures[1].exchanges.as_slice() else { panic!("one exchange") };
    let constant_at = |value| Some(Course(vec![[0.0, value]]));
    let expected = Around { flux: constant_at(1000.0), fluid: constant_at(293.15), surroundings: constant_at(1173.15) };
    assert_eq!(around, &expected);
    let cover = Cover {
        area: 0.5 * constant() * constant(),
        depth: 0.25 * constant(),
        conductivity: 1.5,
        film: 10.0,
        emissivity: 0.9,
    };
    for (got, expected) in [
        (exchange.flux_area, cover.exchange().flux_area),
        (exchange.conductance, cover.exchange().conductance),
        (exchange.radiation, cover.exchange().radiation),
        (exchange.resistance, cover.exchange().resistance),
    ] {
        assert!((got / expected - 1.0).abs() < 1e-12, "{got} {expected}");
    }
}

#[test]
fn particles_may_be_held_as_the_paper_does() {
    let built = build(&format!("{HEAT}[[surface]]\nface = \"+z\"\ndepth = 0.0\ntemperature = 900.0\n"));
    let heat = built.plan.heat.expect("the plan has heat");
    let held = heat.exposures.iter().find_map(|exposure| exposure.temperature.clone());
    assert_eq!(held, Some(Course(vec![[0.0, 1173.15]])));
}

#[test]
fn what_was_measured_is_read_from_a_table() {
    let tail = "[[surface]]\nface = \"+z\"\n\
                temperature = { file = \"tests/bad/measured.csv\", time = \"t\", value = \"temperature\", time_factor = 60.0 }\n";
    let built = build(&format!("{HEAT}{tail}"));
    let heat = built.plan.heat.expect("the plan has heat");
    let courses: Vec<_> = heat.exposures.iter().flat_map(Exposure::courses).collect();
    assert_eq!(courses, [&Course(vec![[0.0, 293.15], [600.0, 303.15]])]);
}

#[test]
fn scaled_masses_keep_weight_and_heat() {
    let built = |scaling: &str| {
        let text = HEAD.replace("gravity = [0.0, 0.0, 0.0]", "gravity = [0.0, 0.0, -9.81]");
        let text = text.replace("end = 1.0e-2", &format!("end = 1.0e-2\n{scaling}"));
        parse("case.toml", &format!("{text}{HEAT}"), Path::new("."), &[]).expect("the text is right").build()
    };
    let [plain, one, scaled] = ["", "mass_scaling = 1.0", "mass_scaling = 400.0"]
        .map(|scaling| built(scaling).expect("the case can be built"));
    assert_eq!(plain.state, one.state);
    assert_eq!(plain.plan, one.plan);
    let specific_heat = |built: &Built| built.plan.heat.as_ref().expect("the plan has heat").materials[0].specific_heat;
    for (k, &mass) in plain.state.mass.iter().enumerate() {
        let heavier = scaled.state.mass[k];
        assert!((heavier / mass / 400.0 - 1.0).abs() < 1e-14);
        assert!((heavier * scaled.plan.gravity[2] / (mass * plain.plan.gravity[2]) - 1.0).abs() < 1e-14, "weight");
        assert!((heavier * specific_heat(&scaled) / (mass * specific_heat(&plain)) - 1.0).abs() < 1e-14, "capacity");
    }
    // The same vibrations, slower by the root.
    assert!((scaled.plan.dt / plain.plan.dt / 20.0 - 1.0).abs() < 1e-12, "{} {}", scaled.plan.dt, plain.plan.dt);
}

#[test]
fn a_bar_of_scaled_masses_pushes_as_hard() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../cases/restrained-bar.toml");
    let force = |set: &[(&str, &str)]| {
        let set: Vec<(String, String)> = set.iter().map(|(key, value)| ((*key).into(), (*value).into())).collect();
        let built = load(&file, &set).expect("the case is sound").build().expect("it can be built");
        let (steps, dt) = (built.schedule.steps, built.plan.dt);
        let gauge = built.plan.gauges[0].clone();
        let mut simulation =
            Simulation::new(built.state, built.plan, cpu::Options::default()).expect("the scene is sound");
        simulation.advance(steps).expect("it runs through");
        let state = simulation.state().expect("a state can be taken");
        let Reading::Of { force, .. } = gauge.read(&state, simulation.plan()) else { panic!("a group") };
        (force[2], dt, steps)
    };
    let (true_force, true_step, true_steps) = force(&[]);
    let (scaled, step, steps) = force(&[("time.mass_scaling", "100.0")]);
    assert!((step / true_step / 10.0 - 1.0).abs() < 1e-9 && true_steps > 9 * steps, "{step} {true_step}");
    // -E alpha dT on the section, less what the open sides do not bear.
    assert!(
        (true_force / 31.1e3 - 1.0).abs() < 0.01 && (scaled / true_force - 1.0).abs() < 0.01,
        "{scaled} {true_force}"
    );
}

#[test]
fn bonds_within_open_sides_conduct_more() {
    let built = build(&format!("{HEAT}open_sides = [\"-x\", \"+x\", \"-y\", \"+y\"]\n"));
    let (state, heat) = (&built.state, built.plan.heat.as_ref().expect("the plan has heat"));
    let edge = 2.5 * constant();
    let sides = |k: usize| {
        let [x, y, _] = state.position[k];
        [x < 1e-6, x > edge - 1e-6, y < 1e-6, y > edge - 1e-6]
    };
    let (mut within, mut along_edges) = (0, 0);
    for bond in &state.bonds {
        let [i, j] = [bond.first, bond.second].map(|id| state.index_of(id).expect("the particle is there"));
        let both = sides(i).iter().zip(sides(j)).filter(|&(&a, b)| a && b).count();
        assert_eq!(heat.at_one_side([state.exposure[i], state.exposure[j]]), both > 0);
        within += usize::from(both > 0);
        along_edges += usize::from(both > 1);
    }
    // 18 sites in a side, each the middle or the end of 2 planar bonds.
    assert!(within > 60 && along_edges == 0, "{within} {along_edges}");
    let plain = build(HEAT).plan.heat.expect("the plan has heat");
    assert_eq!((plain.sides.len(), plain.exposures.len()), (0, 1));
    assert_eq!(plain.conductors, heat.conductors);
}

#[test]
fn the_step_is_limited_by_conduction() {
    let closed = HEAT.replace("contacts = \"bar\"", "contacts = \"closed\"");
    let built = build(&format!(
        "{closed}time_scale = 1.0e6\n[[surface]]\nface = \"+z\"\ntemperature = [[0.0, 20.0], [1.0e5, 900.0]]\n"
    ));
    let find = |name: &str| built.limits.limits.iter().find(|limit| limit.name == name).map(|limit| limit.seconds);
    let state = &built.state;
    let capacity = state.mass[0] * 900.0;
    let conductance = 1.5 * constant() / 4.0;
    // Particles of the highest layer: 8 bonds, and a face at the temperature of the surface, which counts as 8 more.
    let expected = capacity / (16.0 * conductance) / 1e6;
    let found = find("conduction of heat").expect("the heat limits the step");
    assert!((found / expected - 1.0).abs() < 1e-9, "{found} {expected}");
    assert!((find("the heat of one particle").expect("it does") / (2.0 * expected) - 1.0).abs() < 1e-9);
}

#[test]
fn a_case_has_the_same_bonds_without_heat() {
    let tail = "temperature = 30.0\n[[surface]]\nname = \"top\"\nface = \"+z\"\ntemperature = 900.0\n\
                [[gauge]]\nname = \"top\"\nsurface = \"top\"\n[[curve]]\nname = \"top\"\nx = \"heat_time\"\ny = \"top_temperature\"\n";
    let (particles, rest) = tail.split_once('\n').expect("two lines");
    let text = format!("{HEAD}{particles}\n{HEAT}{rest}");
    let loaded = parse("case.toml", &text, Path::new("."), &[]).expect("the text is right");
    let without = loaded.without_heat();
    let again = parse("again.toml", &without.effective_toml(), Path::new("."), &[]).expect("and so is the rest");
    let (warm, cold) = (loaded.build().expect("it can be built"), again.build().expect("it can be built"));
    assert!(warm.plan.heat.is_some() && cold.plan.heat.is_none() && cold.plan.gauges.is_empty());
    assert_eq!((warm.state.bonds, warm.state.position), (cold.state.bonds, cold.state.position));
    assert!(cold.state.temperature.is_empty());
}

#[test]
fn who_is_held_at_a_temperature_limits_no_step() {
    let find = |tail: &str| {
        let built = build(&format!("{HEAT}[[surface]]\nface = \"+z\"\n{tail}temperature = 900.0\n"));
        let limits = built.limits.limits;
        limits.into_iter().find(|limit| limit.name == "conduction of heat").map(|limit| limit.seconds)
    };
    // Behind a face at a temperature layers have twice the conductance of those within; held themselves they have none.
    let [behind, held] = ["", "depth = 0.0\n"].map(|tail| find(tail).expect("the heat limits the step"));
    assert!(held > 1.2 * behind, "{held} {behind}");
}

#[test]
fn spots_of_softened_materials_conduct_like_those_of_the_true_one_and_bonds_as_before() {
    let heat_of = |words: &[(&str, &str)]| build_with(words, HEAT).plan.heat.expect("the plan has heat");
    let stated =
        ("young_modulus = 23.2e9\npoisson", "young_modulus = 23.2e6\noriginal_young_modulus = 23.2e9\npoisson");
    let softened = ("young_modulus = 23.2e9\npoisson", "young_modulus = 23.2e6\npoisson");
    let circle = ("contacts = \"bar\"", "contacts = \"circle\"");
    let (before, after) = (heat_of(&[softened, circle]), heat_of(&[stated, circle]));
    let [before, after] = [&before, &after].map(|heat| *heat.conductor(0, 0));
    // A thousandth of the modulus, ten times the contact radius.
    assert!((after.conductivity / before.conductivity - 0.1).abs() < 1e-15);
    let bond = |of: tdem_engine::physics::heat::Conductor<f64>| bar(&of, 0.01, 0.01);
    assert!((bond(after) / bond(before) - 1.0).abs() < 1e-15);
    // Bars have a section of their own.
    assert_eq!(heat_of(&[stated]).conductors, heat_of(&[softened]).conductors);
}

#[test]
fn a_surface_says_how_large_it_is_or_which_face_it_has() {
    let surface = |keys: &str| format!("{HEAT}[[surface]]\nof = \"block\"\n{keys}flux = 1000.0\n");
    let text = format!("{HEAD}{}", surface(""));
    let problems = parse("case.toml", &text, Path::new("."), &[]).expect_err("all of the block is no face");
    assert_eq!(problems.problems[0].code, "tdem::case::missing-key");
    assert!(problems.problems[0].help.as_deref().expect("there is help").contains("area = ... in m²"));
    let extent = |keys: &str| build(&surface(keys)).surfaces[0];
    // A face of 3 by 3 cells has 18 particles, and half the square of the lattice constant of each.
    let face = extent("face = \"+z\"\n");
    assert_eq!(face.particles, 18);
    assert!((face.area / (9.0 * constant() * constant()) - 1.0).abs() < 1e-12, "{}", face.area);
    let given = extent("area = 0.25\ndepth = 0.001\n");
    assert_eq!((given.particles, given.area, given.depth), (108, 0.25, 0.001));
}
