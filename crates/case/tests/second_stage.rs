//! Second stages: what goes on of the contacts of another run.

use std::path::{Path, PathBuf};
use tdem_case::{Built, Loaded, parse};
use tdem_engine::{Simulation, State, cpu};

/// A run of a case that was taken to some step, with the case that it keeps.
struct Stage {
    directory: PathBuf,
    state: State,
}

fn loaded(text: &str) -> Loaded {
    parse("case.toml", text, Path::new("/"), &[]).unwrap_or_else(|problems| panic!("{problems}"))
}

fn after(built: &Built, steps: u64) -> State {
    let mut simulation =
        Simulation::new(built.state.clone(), built.plan.clone(), cpu::Options::default()).expect("it starts");
    simulation.advance(steps).expect("it runs");
    simulation.state().expect("it has a state")
}

impl Stage {
    /// Takes a case to a step and keeps it in a folder of this name.
    fn new(name: &str, text: &str, steps: u64) -> Stage {
        let case = loaded(text);
        let built = case.build().unwrap_or_else(|problems| panic!("{problems}"));
        let directory = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
        std::fs::create_dir_all(&directory).expect("there is a folder");
        let kept = case.kept(&built).expect("the step is a number");
        std::fs::write(directory.join("case.toml"), kept).expect("the case is kept");
        Stage { directory, state: after(&built, steps) }
    }

    /// Builds a case whose `RUN` is this run.
    fn next(&self, text: &str) -> Built {
        let text = text.replace("RUN", &self.directory.display().to_string());
        let state = |_: &Path| Ok(self.state.clone());
        loaded(&text).build_with(&state).unwrap_or_else(|problems| panic!("{problems}"))
    }
}

/// Codes of warnings; that the soft sphere might fall from far is not looked at.
fn codes(built: &Built) -> Vec<&'static str> {
    let codes = built.warnings.problems.iter().map(|problem| problem.code);
    codes.filter(|code| *code != "tdem::case::impact-deep").collect()
}

const SLOPE: &str = r#"
model = "GNT"
gravity = [2.539014973, 0.0, -9.475732466] # 15 degrees
domain = { min = [-1.0, -1.0, -1.0], max = [1.0, 1.0, 1.0] }
[time]
step = 2e-4
end = 1.0
[material.a]
density = 2500.0
young_modulus = 1.0e6
poisson_ratio = 0.3
[[interaction]]
between = ["a", "rigid"]
static_friction = 0.5
dynamic_friction = 0.5
normal_damping = 60.0
tangential_damping = 60.0
"#;
const SLOPE_WALL: &str =
    "[[wall]]\nname = \"slope\"\npoint = [0.0, 0.0, 0.0]\nnormal = [0.0, 0.0, 1.0]\nmaterial = \"rigid\"\n";
const GATE: &str =
    "[[wall]]\nname = \"gate\"\npoint = [0.0, 0.5, 0.0]\nnormal = [0.0, -1.0, 0.0]\nmaterial = \"rigid\"\n";
const SPHERE: &str = "[[particles]]\nmaterial = \"a\"\nlist = { radius = 0.05, positions = [[0.0, 0.0, 0.05]] }\n";
const NEXT: &str = "[[particles]]\nallow_overlap = true\nrun = { directory = \"RUN\", contacts = \"carry\" }\n";

#[test]
fn a_sphere_held_by_friction_does_not_slip_in_the_second_stage() {
    let first = Stage::new("held-on-slope", &format!("{SLOPE}{SLOPE_WALL}{SPHERE}"), 7500);
    let start = first.state.position[0];
    let weight = first.state.mass[0] * 9.81;
    // A wall before it in the file has taken its number.
    for (walls, number) in [(SLOPE_WALL.to_owned(), 0), (format!("{GATE}{SLOPE_WALL}"), 1)] {
        let second = first.next(&format!("{SLOPE}{walls}{NEXT}"));
        assert!(codes(&second).is_empty(), "{}", second.warnings);
        assert_eq!(second.state.wall_contacts[0].wall, number);
        for steps in [0, 1, 5000] {
            let state = after(&second, steps);
            let found = state.evaluate_at_wall(&second.plan, &state.wall_contacts[0]).expect("there is a contact");
            let expected = -weight * libm::sin(f64::to_radians(15.0));
            assert!((found.force.x / expected - 1.0).abs() < 1e-3, "{steps}: {} N, not {expected} N", found.force.x);
            let way = (0..3).map(|k| (state.position[0][k] - start[k]).abs()).fold(0.0, f64::max);
            assert!(way < 1e-9, "{way} m after {steps} steps");
        }
    }
}

#[test]
fn histories_that_are_dropped_are_counted() {
    let first = Stage::new("dropped", &format!("{SLOPE}{SLOPE_WALL}{SPHERE}"), 7500);
    let silent = NEXT.replace(", contacts = \"carry\"", "");
    let said = first.next(&format!("{SLOPE}{SLOPE_WALL}{silent}"));
    assert_eq!(codes(&said), ["tdem::case::run-histories"]);
    let message = said.warnings.to_string();
    assert!(message.contains("1 contact history") && message.contains("1 with walls"), "{message}");
    assert!(said.state.wall_contacts.is_empty());

    let anew = first.next(&format!("{SLOPE}{SLOPE_WALL}{}", NEXT.replace("carry", "anew")));
    assert!(codes(&anew).is_empty() && anew.state.wall_contacts.is_empty(), "{}", anew.warnings);

    // The wall is gone, has another name, or stands elsewhere.
    for (walls, part) in [
        (GATE.to_owned(), "1 at wall `slope`"),
        (SLOPE_WALL.replace("slope", "floor"), "1 at wall `slope`"),
        (SLOPE_WALL.replace("[0.0, 0.0, 0.0]", "[0.0, 0.0, -0.1]"), "1 of contacts that are open here"),
    ] {
        let built = first.next(&format!("{SLOPE}{walls}{NEXT}"));
        assert_eq!(codes(&built), ["tdem::case::run-histories"]);
        assert!(built.warnings.to_string().contains(part), "{}", built.warnings);
        assert!(built.state.wall_contacts.is_empty());
        after(&built, 10);
    }

    // Without friction there is nothing to lose.
    let smooth = SLOPE.replace("friction = 0.5", "friction = 0.0");
    for head in [SLOPE.replace("GNT", "GN"), smooth] {
        for next in [NEXT, &silent] {
            let built = first.next(&format!("{head}{SLOPE_WALL}{next}"));
            assert!(built.state.wall_contacts.is_empty());
            let lost = head.contains("GNT") && next == silent;
            assert_eq!(codes(&built).is_empty(), !lost, "{}", built.warnings);
        }
    }
}

/// Spheres thrown together in the corner of a box, without dashpots.
const CROWD: &str = r#"
model = "MODEL"
gravity = [-3.0, -2.0, -9.81]
domain = { min = [-9.0, -9.0, -9.0], max = [9.0, 9.0, 9.0] }
[time]
step = 1e-4
end = 1.0
[material.a]
density = 2500.0
young_modulus = 1.0e7
poisson_ratio = 0.3
[material.b]
density = 1500.0
young_modulus = 2.0e7
poisson_ratio = 0.2
"#;

/// Interactions of two materials and rigid walls.
fn rubbing() -> String {
    let pairs = [("a", "a"), ("a", "b"), ("b", "b"), ("a", "rigid"), ("b", "rigid")];
    let one = |(a, b)| {
        format!(
            "[[interaction]]\nbetween = [\"{a}\", \"{b}\"]\nstatic_friction = 0.5\ndynamic_friction = 0.4\n\
             normal_damping = 0.0\ntangential_damping = 0.0\n"
        )
    };
    pairs.map(one).concat()
}

fn container(at: [f64; 3]) -> String {
    let max = at.map(|x| x + 0.5);
    format!("[[box]]\nmin = {at:?}\nmax = {max:?}\nmaterial = \"rigid\"\n")
}

const SPHERES: &str = r#"
[[particles]]
material = "a"
velocity = [-2.0, -1.0, -1.5]
angular_velocity = [3.0, 2.0, 1.0]
[particles.lattice]
kind = "sc"
radius = 0.05
gap = 0.02
cells = [3, 3, 3]
min = [0.0, 0.0, 0.0]
max = [0.5, 0.5, 0.5]
align = ["min", "min", "min"]
[[particles]]
material = "b"
list = { radius = 0.03, positions = [[0.4, 0.4, 0.4], [0.4, 0.4, 0.3]] }
"#;

/// The largest difference of places from those of an uninterrupted run, m.
fn apart(state: &State, whole: &State, offset: [f64; 3]) -> f64 {
    let of = |(a, b): (&[f64; 3], &[f64; 3])| (0..3).map(|k| (a[k] - offset[k] - b[k]).abs()).fold(0.0, f64::max);
    state.position.iter().zip(&whole.position).map(of).fold(0.0, f64::max)
}

#[test]
fn a_second_stage_goes_on_like_the_run_that_was_not_interrupted() {
    for model in ["GNT", "GNTM"] {
        let head = format!("{}{}", CROWD.replace("MODEL", model), rubbing());
        let text = format!("{head}{}{SPHERES}", container([0.0; 3]));
        let first = Stage::new(&format!("crowd-{model}"), &text, 80);
        let whole = Stage::new(&format!("crowd-whole-{model}"), &text, 140).state;
        let loaded = first.state.contacts.iter().filter(|contact| contact.displacement != [0.0; 3]).count();
        assert!(loaded > 5 && first.state.wall_contacts.len() > 3, "{loaded} springs between particles");
        let offset = [0.25, -0.5, 1.0];
        let next = |contacts: &str, offset: [f64; 3]| {
            // Walls in another order, one more before them.
            let walls = format!("{GATE}{}", container(offset)).replace("0.5, 0.0]\nnormal", "8.5, 0.0]\nnormal");
            let group = format!("run = {{ directory = \"RUN\", contacts = \"{contacts}\", offset = {offset:?} }}\n");
            first.next(&format!("{head}{walls}[[particles]]\n{group}"))
        };
        let built = next("carry", [0.0; 3]);
        assert_eq!(built.state.contacts, first.state.contacts);
        assert!(codes(&built).is_empty(), "{}", built.warnings);
        let way = apart(&after(&built, 60), &whole, [0.0; 3]);
        assert!(way < 1e-12, "{model}: {way} m apart");
        let way = apart(&after(&next("carry", offset), 60), &whole, offset);
        assert!(way < 1e-11, "{model}: {way} m apart, moved as a whole");
        let way = apart(&after(&next("anew", [0.0; 3]), 60), &whole, [0.0; 3]);
        assert!(way > 1e-7, "{model}: springs that are dropped make a difference, but only {way} m");
    }
}

#[test]
fn contacts_of_bonded_particles_go_on_beside_their_bonds() {
    let bond = "[[bond]]\nbetween = [\"a\", \"a\"]\ntensile_strength = \"unbreakable\"\nshear_strength = \"unbreakable\"\n\
                gap = 0.05\nmicro = { stiffness_per_area = 1e7, stiffness_ratio = 0.4 }\n";
    for beside in [true, false] {
        let bonds = format!("[bonds]\ncontact_in_bonded_pairs = {beside}\n");
        let head = format!("{}{bonds}{}{bond}", CROWD.replace("MODEL", "BPM"), rubbing());
        let text = format!("{head}{}{SPHERES}", container([0.0; 3]));
        let first = Stage::new(&format!("bonded-{beside}"), &text, 80);
        let whole = Stage::new(&format!("bonded-whole-{beside}"), &text, 110).state;
        let touching = first.state.contacts.iter().filter(|contact| contact.second < 27).count();
        assert_eq!(touching > 0, beside, "{touching} contacts of bonded particles");
        assert!(first.state.wall_contacts.iter().any(|contact| contact.displacement != [0.0; 3]));
        let group = "[[particles]]\nrun = { directory = \"RUN\", bonds = \"carry\", contacts = \"carry\" }\n";
        let built = first.next(&format!("{head}{}{group}", container([0.0; 3])));
        assert!(codes(&built).is_empty(), "{}", built.warnings);
        assert_eq!(built.state.contacts, first.state.contacts);
        let way = apart(&after(&built, 30), &whole, [0.0; 3]);
        assert!(way < 1e-12, "{way} m apart");
    }
}

#[test]
fn contacts_between_two_groups_of_one_run_go_on() {
    let head = format!("{}{}", CROWD.replace("MODEL", "GNTM"), rubbing());
    let text = format!("{head}{}{SPHERES}", container([0.0; 3]));
    let first = Stage::new("two-groups", &text, 80);
    let part = |key: &str| {
        let cut = "{ box = { min = [-1.0, -1.0, -1.0], max = [1.0, 1.0, 0.12] } }";
        let cut = if key == "without" { format!("[{cut}]") } else { cut.to_owned() };
        format!("[[particles]]\n{key} = {cut}\nrun = {{ directory = \"RUN\", contacts = \"carry\" }}\n")
    };
    // The upper ones come first, so that ids change their order.
    let built = first.next(&format!("{head}{}{}{}", container([0.0; 3]), part("without"), part("within")));
    assert!(codes(&built).is_empty(), "{}", built.warnings);
    let springs = |state: &State| {
        let place = |id: u32| state.position[state.index_of(id).expect("there is a particle")];
        let mut springs: Vec<[f64; 3]> = (state.contacts.iter())
            .map(|contact| {
                // Whichever is first.
                let up = place(contact.first) < place(contact.second);
                contact.displacement.map(|x| if up { x } else { -x } + 0.0)
            })
            .collect();
        springs.sort_by(|a, b| a.partial_cmp(b).expect("numbers"));
        springs
    };
    assert_eq!(springs(&built.state), springs(&first.state));
    assert!(built.state.id.iter().any(|&id| id > 28), "ids are others");
    let mut whole = after(
        &first.next(&format!(
            "{head}{}[[particles]]\nrun = {{ directory = \"RUN\", contacts = \"carry\" }}\n",
            container([0.0; 3])
        )),
        60,
    )
    .position;
    let mut parts = after(&built, 60).position;
    for places in [&mut whole, &mut parts] {
        places.sort_by(|a, b| a.partial_cmp(b).expect("numbers"));
    }
    let way = whole.iter().flatten().zip(parts.iter().flatten()).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(way < 1e-12, "{way} m apart");
}
