//! What a [[bond]] is made of, in the numbers of the law.

use super::super::Context;
use crate::codes;
use crate::problem::{Problem, number};
use crate::schema::{Joint as Entry, NonNegative, Strength};
use std::f64::consts::SQRT_2;
use tdem_engine::physics::bond::{Cement, Joint, Section, face_centred};

/// How large the bonds of one kind are.
#[derive(Clone, Copy, Debug)]
pub(super) struct Extent {
    /// Smallest and largest radius of their particles, m.
    radius: [f64; 2],
    /// Smallest and largest length, m.
    length: [f64; 2],
}

impl Default for Extent {
    fn default() -> Self {
        let none = [f64::INFINITY, 0.0];
        Extent { radius: none, length: none }
    }
}

impl Extent {
    pub(super) fn add(&mut self, radii: [f64; 2], length: f64) {
        let widen = |[low, high]: &mut [f64; 2], value: f64| (*low, *high) = (low.min(value), high.max(value));
        for radius in radii {
            widen(&mut self.radius, radius);
        }
        widen(&mut self.length, length);
    }
    fn is_empty(&self) -> bool {
        self.length[1] == 0.0
    }
    /// Whether all bonds are alike, but for rounding.
    fn is_uniform(&self) -> bool {
        [self.radius, self.length].iter().all(|[low, high]| high - low <= 1e-6 * low)
    }
}

/// Stiffness of bonds, as for [`Joint`].
#[derive(Clone, Copy, Debug)]
struct Stiffness {
    per_area: f64,
    young_modulus: f64,
    ratio: f64,
}

impl Stiffness {
    /// Half a bond of each, one after the other, in a section of the given radius multiplier.
    fn in_series([first, second]: [(Stiffness, f64); 2], multiplier: f64) -> Self {
        let between = |a: f64, b: f64| if a + b > 0.0 { 2.0 * a * b / (a + b) } else { 0.0 };
        // Areas are as the squares of the multipliers.
        let pick = |of: fn(&Stiffness) -> f64| {
            let [a, b] = [first, second].map(|(stiffness, multiplier)| of(&stiffness) * multiplier * multiplier);
            between(a, b) / (multiplier * multiplier)
        };
        let normal = [pick(|s| s.per_area), pick(|s| s.young_modulus)];
        let shear = [pick(|s| s.per_area * s.ratio), pick(|s| s.young_modulus * s.ratio)];
        let which = usize::from(normal[0] == 0.0);
        Stiffness { per_area: normal[0], young_modulus: normal[1], ratio: shear[which] / normal[which] }
    }
}

/// The joint of an entry of the case, given how large the bonds of all entries are.
pub(super) fn of(context: &Context<'_>, entry: usize, extents: &[Extent]) -> Result<Joint<f64>, Problem> {
    let given = &context.loaded.case.bond[entry];
    let extent = &extents[entry];
    let [a, b] = &given.between;
    if extent.is_empty() {
        return Err(Problem::new(
            codes::BOND_UNUSED,
            match (&context.loaded.case.bonds.file, given.gap_length) {
                (Some(_), _) => format!("the file of bonds holds none of `{a}` and `{b}`"),
                (None, Some(length)) => format!(
                    "no particles of `{a}` and `{b}` are bonded: none have surfaces within {} m",
                    number(length.get())
                ),
                (None, None) => format!(
                    "no particles of `{a}` and `{b}` are bonded: none have surfaces within {} of their mean radius",
                    number(given.gap.get())
                ),
            },
        )
        .at(context.loaded.tree.place(&["bond", &entry.to_string(), "between"]), "joins nothing")
        .help("raise the gap, place the particles closer together, or remove this [[bond]]"));
    }
    let stiffness = stiffness(context, entry, extent)?;
    let multiplier = given.radius_multiplier.get();
    let solid_strength = given.lattice.as_ref().and_then(|solid| {
        let tensile = solid.tensile_strength?.get();
        let shear = face_centred::shear_stress(tensile, stiffness.ratio, multiplier);
        Some([
            face_centred::tensile_stress(tensile, stiffness.ratio, multiplier),
            solid.shear_factor.map_or(f64::INFINITY, |factor| factor.get() * shear),
        ])
    });
    let [tensile, shear] = solid_strength.unwrap_or([f64::INFINITY; 2]);
    Ok(Joint {
        cement: Cement {
            stiffness_ratio: stiffness.ratio,
            radius_multiplier: multiplier,
            tensile_strength: given.tensile_strength.map_or(tensile, Strength::get),
            shear_strength: given.shear_strength.map_or(shear, Strength::get),
            internal_friction: libm::tan(given.friction_angle_deg.get().to_radians()),
            moment_contribution: NonNegative::get(given.moment_contribution),
            damping_ratio: given.damping_ratio.get(),
        },
        stiffness_per_area: stiffness.per_area,
        young_modulus: stiffness.young_modulus,
    })
}

fn stiffness(context: &Context<'_>, entry: usize, extent: &Extent) -> Result<Stiffness, Problem> {
    let bonds = &context.loaded.case.bond;
    let given = &bonds[entry];
    if !given.series {
        return single(context, entry, given, extent);
    }
    let own = |name: &String| {
        // The checks have found it.
        let of = bonds.iter().find(|other| other.between.iter().all(|n| n == name)).unwrap_or(given);
        single(context, entry, of, extent).map(|stiffness| (stiffness, of.radius_multiplier.get()))
    };
    let halves = [own(&given.between[0])?, own(&given.between[1])?];
    if (halves[0].0.per_area > 0.0) != (halves[1].0.per_area > 0.0) {
        return Err(Problem::new(
            codes::BOND_SERIES,
            "one half of these bonds has a Young's modulus, the other a stiffness that is the same for all lengths",
        )
        .at(context.loaded.tree.place(&["bond", &entry.to_string(), "series"]), "cannot combine them")
        .help("say how stiff these bonds are with `micro`"));
    }
    Ok(Stiffness::in_series(halves, given.radius_multiplier.get()))
}

/// Stiffness that an entry gives bonds of a size; `blamed` is the entry that has these bonds.
fn single(context: &Context<'_>, blamed: usize, given: &Entry, extent: &Extent) -> Result<Stiffness, Problem> {
    let place = |key: &str| context.loaded.tree.place(&["bond", &blamed.to_string(), key]);
    if let Some(micro) = &given.micro {
        return Ok(Stiffness {
            per_area: micro.stiffness_per_area.map_or(0.0, crate::schema::Positive::get),
            young_modulus: micro.young_modulus.map_or(0.0, crate::schema::Positive::get),
            ratio: micro.stiffness_ratio.get(),
        });
    }
    let Some(solid) = &given.lattice else {
        return Ok(Stiffness { per_area: 0.0, young_modulus: 0.0, ratio: 0.0 });
    };
    let ([small, large], [short, long]) = (extent.radius, extent.length);
    if !extent.is_uniform() {
        return Err(Problem::new(
            codes::BOND_LATTICE,
            format!(
                "a solid's stiffness is known for equal spheres on a lattice only, but these bonds are {} to {} m long, \
                 between radii of {} to {} m",
                number(short),
                number(long),
                number(small),
                number(large)
            ),
        )
        .at(place(if context.loaded.case.bond[blamed].series { "series" } else { "lattice" }), "needs equal bonds")
        .help("say how stiff bonds are with `micro = { young_modulus = ..., stiffness_ratio = ... }`"));
    }
    let ratio = face_centred::stiffness_ratio(solid.poisson_ratio.get()).map_err(|error| {
        Problem::new(codes::POISSON_UNREACHABLE, error.to_string()).at(place("lattice"), "out of range")
    })?;
    let area = Section::between(given.radius_multiplier.get(), small, small).area;
    let normal = face_centred::normal_stiffness(solid.young_modulus.get(), ratio, SQRT_2 * short);
    Ok(Stiffness { per_area: normal / area, young_modulus: 0.0, ratio })
}
