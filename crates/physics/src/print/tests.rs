use super::*;
use crate::real::Operations;

#[test]
fn a_drift_in_c() {
    assert_eq!(
        function(&Drift).text,
        "\
DEVICE void drift(const Vec3 position, const Vec3 velocity, const real dt, Vec3 *drifted)
{
    const real position_x = position.x;
    const real position_y = position.y;
    const real position_z = position.z;
    const real velocity_x = velocity.x;
    const real velocity_y = velocity.y;
    const real velocity_z = velocity.z;
    const real t1 = velocity_x * dt;
    const real t2 = velocity_y * dt;
    const real t3 = velocity_z * dt;
    const real t4 = position_x + t1;
    const real t5 = position_y + t2;
    const real t6 = position_z + t3;
    drifted->x = t4;
    drifted->y = t5;
    drifted->z = t6;
}
"
    );
}

#[test]
fn structs_in_c() {
    let types = types();
    assert!(types.starts_with("typedef struct {\n    real x;\n    real y;\n    real z;\n} Vec3;\n"));
    let response = "\
typedef struct {
    Vec3 force;
    Vec3 moment_per_arm;
    Vec3 displacement;
    Losses losses;
} Response;
";
    assert!(types.contains(response));
    assert!(types.contains("    Vec3 derivatives[4];\n"));
    assert!(types.contains("    Vec3 half_length;\n"), "half is a type of OpenCL");
}

#[test]
fn long_heads_are_wrapped() {
    let head = "\
DEVICE void contact_of_spheres(const Sphere first, const Sphere second, const Touch touch, const Vec3 displacement,
                               const Interaction pair, const real dt, const real lead, Response *response)
{
";
    assert!(function(&ContactOfSpheres { law: Law::GNTM }).text.starts_with(head));
}

/// Regression: what one GNTM contact costs, for the roofline.
#[test]
fn operations_of_a_contact() {
    let contact = function(&ContactOfSpheres { law: Law::GNTM });
    let always = Operations {
        additions: 105,
        multiplications: 151,
        divisions: 5,
        square_roots: 4,
        comparisons: 6,
        selections: 8,
        sign_changes: 1,
    };
    assert_eq!(contact.always, always);
    let sliding = Operations {
        additions: 5,
        multiplications: 12,
        divisions: 2,
        square_roots: 2,
        comparisons: 2,
        selections: 2,
        ..Operations::default()
    };
    assert_eq!(contact.in_branches, sliding);
    assert!(function(&ContactOfSpheres { law: Law::GN }).operations().arithmetic() < contact.always.arithmetic() / 3);
}

#[test]
fn a_law_without_friction_does_not_look_at_its_parameters() {
    let text = function(&ContactOfSpheres { law: Law::GN }).text;
    for unused in ["angular_velocity", "tangential", "_friction", "position"] {
        assert!(!text.contains(unused), "{unused}");
    }
}

#[test]
fn the_source_holds_types_and_every_function_once() {
    let source = source(Law::GNTM);
    for (name, function) in functions(Law::GNTM) {
        assert_eq!(source.matches(&format!(" {name}(")).count(), 1, "{name}");
        assert!(source.contains(&function.text));
    }
}

#[test]
fn numbers_come_back_as_they_went_in() {
    let mut count = 0.0;
    let sphere = Sphere::<f64>::read(&mut || {
        count += 1.0;
        count
    });
    assert_eq!((sphere.position.y, sphere.radius, sphere.mass, sphere.angular_velocity.z), (2.0, 4.0, 8.0, 11.0));
    let mut row = Vec::new();
    sphere.write(&mut |number| row.push(number));
    assert_eq!(row, (1..=11).map(f64::from).collect::<Vec<_>>());
}

#[test]
fn the_source_of_bonds_holds_types_and_every_function_once() {
    let damping = bond::Damping::Viscous;
    for form in [Form::Total, Form::Incremental(bond::Tension::FromLength), Form::Incremental(bond::Tension::Stored)] {
        let law = bond::Law { form, damping };
        let source = bond_source(law);
        let bonds = bond_functions(law);
        for (name, function) in &bonds {
            assert_eq!(source.matches(&format!(" {name}(")).count(), 1, "{name}");
            assert!(source.contains(&function.text));
        }
        let names = functions(Law::GNTM).into_iter().map(|(name, _)| name);
        assert!(names.into_iter().all(|name| bonds.iter().all(|(other, _)| name != *other)), "no name is used twice");
    }
    let reaction = "\
typedef struct {
    Vec3 force;
    Vec3 first_moment;
    Vec3 second_moment;
    Modes load;
    Stress stress;
    real failure;
} Reaction;
";
    assert!(bond_types().contains(reaction));
}

#[test]
fn the_source_of_heat_holds_types_and_every_function_once() {
    for path in [Path::Closed, Path::Bar, Path::Circle] {
        let source = heat_source(path);
        let mechanics = source_of_mechanics();
        for (name, function) in heat_functions(path) {
            assert_eq!(source.matches(&format!(" {name}(")).count(), 1, "{name}");
            assert!(source.contains(&function.text));
            assert!(!mechanics.contains(&format!(" {name}(")), "{name} is used twice");
        }
    }
    assert!(heat_types().starts_with("typedef struct {\n    real conductivity;\n    real section;\n} Conductor;\n"));
}

#[test]
fn the_source_of_heat_alone_needs_no_other() {
    let source = network_source();
    for (name, function) in network_functions() {
        assert_eq!(source.matches(&format!(" {name}(")).count(), 1, "{name}");
        assert!(source.contains(&function.text));
    }
    assert!(source.starts_with("typedef struct {\n    real flux_area;\n"));
}

fn source_of_mechanics() -> String {
    source(Law::GNTM) + &bond_source(bond::Law { form: Form::Total, damping: bond::Damping::Viscous })
}

/// Regression: what heat costs a bond and a contact, for the roofline.
#[test]
fn operations_of_heat() {
    let of_flow = Operations { additions: 1, multiplications: 1, ..Operations::default() };
    assert_eq!(function(&HeatFlow).operations(), of_flow);
    let of_strain = Operations { additions: 1, multiplications: 2, ..Operations::default() };
    assert_eq!(function(&FreeStrain).operations(), of_strain);
    let of_bar = Operations { additions: 1, multiplications: 3, divisions: 1, ..Operations::default() };
    assert_eq!(function(&BetweenSpheres { path: Path::Bar }).operations(), of_bar);
    let of_circle = Operations { additions: 1, multiplications: 4, divisions: 1, square_roots: 1, ..of_bar };
    assert_eq!(function(&BetweenSpheres { path: Path::Circle }).operations(), of_circle);
}

#[test]
fn an_undamped_bond_in_total_form_does_not_look_at_motion() {
    let text = function(&BondTotal { damping: bond::Damping::Off }).text;
    for unused in ["velocity", "mass", "position", "damping"] {
        assert!(!text.contains(unused), "{unused}");
    }
    for kept in ["bond_length", "carried_x", "turn_z", "twist", "normal_force", "bending_moment_y", "tensile_stress"] {
        assert!(text.contains(&format!("const real {kept} = ")), "{kept}\n{text}");
    }
}

/// Regression: what one bond costs, for the roofline.
#[test]
fn operations_of_a_bond() {
    let total = function(&BondTotal { damping: bond::Damping::Off });
    let operations = Operations {
        additions: 80,
        multiplications: 134,
        divisions: 2,
        square_roots: 4,
        comparisons: 5,
        selections: 5,
        sign_changes: 1,
    };
    assert_eq!(total.operations(), operations);
}
