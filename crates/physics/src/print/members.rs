//! What the structs of the laws are made of: one table per struct gives its typedef in C, the names by which printed
//! code reaches its numbers, and its numbers as a flat row.

use crate::bond::{Advance, Bond, Cement, Coefficients, History, Joint, Modes, Posture, Reaction, Rest, Stress};
use crate::contact::{Interaction, Kick, Losses, Period, Response, Sphere, Touch};
use crate::heat::{Conductor, Dissipation, Exchange, Link, Outside};
use crate::motion::gear::Trajectory;
use crate::motion::orientation::Quaternion;
use crate::{Real, Vec3};

/// A bundle whose numbers can be walked through in the order in which C lays them out.
pub trait Members<R>: Sized {
    /// As a parameter or member of C with the given name: `Sphere first`.
    fn declaration(name: &str) -> String;
    /// Adds the expression for each number of a bundle that is reached by `path`.
    fn paths(path: &str, to: &mut Vec<String>);
    /// Builds the bundle from its numbers.
    fn read(next: &mut impl FnMut() -> R) -> Self;
    /// Hands out its numbers.
    fn write(&self, each: &mut impl FnMut(R));
}

/// The parameters of a printed function: a tuple of bundles.
pub trait Parameters<R>: Sized {
    /// How C declares and uses them under the given names.
    fn described(names: &[&str]) -> Vec<Parameter>;
    /// Builds the tuple from the numbers of all its elements.
    fn read(next: &mut impl FnMut() -> R) -> Self;
    /// Hands out the numbers of all its elements.
    fn write(&self, each: &mut impl FnMut(R));
}

/// A parameter of a printed function.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Parameter {
    /// Its name: `touch`.
    pub name: String,
    /// By value: `Touch touch`.
    pub value: String,
    /// By address: `Touch *touch`.
    pub pointer: String,
    /// Its numbers where it is a value: `touch.overlap`.
    pub members: Vec<String>,
    /// Its numbers where it is a pointer: `touch->overlap`.
    pub pointed: Vec<String>,
}

impl Parameter {
    fn of<R, M: Members<R>>(name: &str) -> Parameter {
        let mut members = Vec::new();
        M::paths(name, &mut members);
        let pointed = members.iter().map(|member| match member.strip_prefix(name) {
            Some("") | None => format!("*{name}"),
            Some(rest) => format!("{name}->{}", rest.trim_start_matches('.')),
        });
        Parameter {
            name: name.to_owned(),
            value: M::declaration(name),
            pointer: M::declaration(&format!("*{name}")),
            pointed: pointed.collect(),
            members,
        }
    }
}

impl<R: Real> Members<R> for R {
    fn declaration(name: &str) -> String {
        format!("real {name}")
    }
    fn paths(path: &str, to: &mut Vec<String>) {
        to.push(path.to_owned());
    }
    #[inline(always)]
    fn read(next: &mut impl FnMut() -> R) -> R {
        next()
    }
    #[inline(always)]
    fn write(&self, each: &mut impl FnMut(R)) {
        each(*self);
    }
}

impl<R: Real, M: Members<R>, const N: usize> Members<R> for [M; N] {
    fn declaration(name: &str) -> String {
        format!("{}[{N}]", M::declaration(name))
    }
    fn paths(path: &str, to: &mut Vec<String>) {
        for index in 0..N {
            M::paths(&format!("{path}[{index}]"), to);
        }
    }
    #[inline(always)]
    fn read(next: &mut impl FnMut() -> R) -> Self {
        std::array::from_fn(|_| M::read(next))
    }
    #[inline(always)]
    fn write(&self, each: &mut impl FnMut(R)) {
        for member in self {
            member.write(each);
        }
    }
}

/// The name of a member in C: its own, or another where OpenCL has taken it.
macro_rules! name_in_c {
    ($field:ident) => {
        stringify!($field)
    };
    ($field:ident $other:ident) => {
        stringify!($other)
    };
}

/// Members of a struct, in the order of the typedef; a missing or misspelt one does not compile.
macro_rules! members {
    ($struct:ident { $($field:ident $(as $other:ident)?: $type:ty),* $(,)? }) => {
        impl<R: Real> Members<R> for $struct<R> {
            fn declaration(name: &str) -> String {
                format!(concat!(stringify!($struct), " {}"), name)
            }
            fn paths(path: &str, to: &mut Vec<String>) {
                $(<$type as Members<R>>::paths(&format!("{path}.{}", name_in_c!($field $($other)?)), to);)*
            }
            #[inline(always)]
            fn read(next: &mut impl FnMut() -> R) -> Self {
                // Evaluated in the order written here, whatever the order of the declaration.
                $struct { $($field: <$type as Members<R>>::read(next)),* }
            }
            #[inline(always)]
            fn write(&self, each: &mut impl FnMut(R)) {
                $(self.$field.write(each);)*
            }
        }
        impl<R: Real> $struct<R> {
            /// The struct as a typedef of C.
            pub(super) fn definition() -> String {
                let mut text = "typedef struct {\n".to_owned();
                $(text += &format!("    {};\n", <$type as Members<R>>::declaration(name_in_c!($field $($other)?)));)*
                text + "} " + stringify!($struct) + ";\n"
            }
        }
    };
}

members!(Vec3 { x: R, y: R, z: R });
members!(Period { length: Vec3<R>, half as half_length: Vec3<R> });
members!(Sphere { position: Vec3<R>, radius: R, velocity: Vec3<R>, mass: R, angular_velocity: Vec3<R> });
members!(Kick { velocity: Vec3<R>, rolling: Vec3<R> });
members!(Touch { offset: Vec3<R>, distance: R, overlap: R });
members!(Interaction {
    normal_stiffness: R,
    tangential_stiffness: R,
    normal_damping: R,
    tangential_damping: R,
    static_friction: R,
    dynamic_friction: R,
    least_normal_force: R,
});
members!(Losses { friction: R, damping: R, stiffening: R });
members!(Response { force: Vec3<R>, moment_per_arm: Vec3<R>, displacement: Vec3<R>, losses: Losses<R> });
members!(Trajectory { position: Vec3<R>, velocity: Vec3<R>, derivatives: [Vec3<R>; 4] });

members!(Quaternion { vector: Vec3<R>, scalar: R });
members!(Modes { normal: R, shear: Vec3<R>, torsion: R, bending: Vec3<R> });
members!(Coefficients { normal: R, shear: R, torsion: R, bending: R });
members!(Cement {
    stiffness_ratio: R,
    radius_multiplier: R,
    tensile_strength: R,
    shear_strength: R,
    internal_friction: R,
    moment_contribution: R,
    damping_ratio: R,
});
members!(Joint { cement: Cement<R>, stiffness_per_area: R, young_modulus: R });
members!(Bond {
    stiffness: Coefficients<R>,
    damping: Coefficients<R>,
    stress_per_force: R,
    stress_per_torsion: R,
    stress_per_bending: R,
    tensile_strength: R,
    shear_strength: R,
    internal_friction: R,
});
members!(Posture {
    bonded_offset: Vec3<R>,
    first_orientation: Quaternion<R>,
    second_orientation: Quaternion<R>,
    free_strain: R,
});
members!(Rest { length: R, growth: R });
members!(History { normal: Vec3<R>, tension: R, shear: Vec3<R>, couple: Vec3<R> });
members!(Advance { earlier: History<R>, rest: Rest<R>, step as dt: R });
members!(Stress { axial: R, tensile: R, shear: R });
members!(Reaction {
    force: Vec3<R>,
    first_moment: Vec3<R>,
    second_moment: Vec3<R>,
    load: Modes<R>,
    stress: Stress<R>,
    failure: R,
});

members!(Conductor { conductivity: R, section: R });
members!(Dissipation { friction: R, damping: R });
members!(Link { conductance_length: R, first_growth: R, second_growth: R });
members!(Exchange { flux_area: R, conductance: R, radiation: R, resistance: R });
members!(Outside { flux: R, fluid: R, surroundings: R });

macro_rules! parameters {
    ($($letter:ident $index:tt),*) => {
        impl<R: Real, $($letter: Members<R>),*> Parameters<R> for ($($letter,)*) {
            fn described(names: &[&str]) -> Vec<Parameter> {
                let parameters = vec![$(Parameter::of::<R, $letter>(names[$index])),*];
                assert_eq!(parameters.len(), names.len(), "one name for each element, not {names:?}");
                parameters
            }
            #[inline(always)]
            fn read(next: &mut impl FnMut() -> R) -> Self {
                ($($letter::read(next),)*)
            }
            #[inline(always)]
            fn write(&self, each: &mut impl FnMut(R)) {
                $(self.$index.write(each);)*
            }
        }
    };
}
parameters!(A 0);
parameters!(A 0, B 1);
parameters!(A 0, B 1, C 2);
parameters!(A 0, B 1, C 2, D 3);
parameters!(A 0, B 1, C 2, D 3, E 4);
parameters!(A 0, B 1, C 2, D 3, E 4, F 5);
parameters!(A 0, B 1, C 2, D 3, E 4, F 5, G 6);
parameters!(A 0, B 1, C 2, D 3, E 4, F 5, G 6, H 7);
parameters!(A 0, B 1, C 2, D 3, E 4, F 5, G 6, H 7, I 8);
