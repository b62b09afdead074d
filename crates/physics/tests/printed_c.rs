//! The printed C computes the bits of the law it was printed from, and so do the lanes: every law, in all variants,
//! over random and extreme numbers. Needs a C compiler (`cc`, or the one that `CC` names).

use std::fmt::Write as _;
use std::fs;
use std::io::{ErrorKind, Read, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use tdem_physics::bond::{
    self, Advance, Bond, Cement, History, Joint, Modes, Posture, Reaction, Rest, Section, Tension,
};
use tdem_physics::contact::{
    Damping, Friction, Interaction, Kick, Law, Period, Response, Sphere, Touch, touch_spheres, touch_wall,
};
use tdem_physics::heat::{Conductor, Dissipation, Exchange, Link, Outside, Path as HeatPath};
use tdem_physics::motion::gear::Trajectory;
use tdem_physics::motion::orientation::Quaternion;
use tdem_physics::print::{self, Formula, Parameter, Parameters};
use tdem_physics::real::{Lanes, Symbol, WIDTH};
use tdem_physics::{Vec3, vec3};

/// Inputs per contact law; together more than a million for each variant.
const SPHERE_PAIRS: usize = 650_000;
const WALL_PAIRS: usize = 400_000;
/// Inputs for each of the laws without variants.
const OTHERS: usize = 200_000;
/// Inputs that travel together; a multiple of [`WIDTH`].
const CHUNK: usize = 4096;

#[test]
fn contacts_of_spheres_have_the_bits_of_the_law() {
    let formulas = laws().map(|law| print::ContactOfSpheres { law });
    let mut outcomes = Outcomes::default();
    let draw = |rng: &mut Rng| {
        let first = rng.sphere();
        let mut second = rng.sphere();
        if rng.one_in(4) {
            (second.radius, second.mass) = (first.radius, first.mass);
        }
        if rng.one_in(8) {
            second.velocity = first.velocity;
        }
        let radius_sum = first.radius + second.radius;
        let overlap = rng.overlap(first.radius);
        let normal = rng.direction();
        let touch = touch_spheres(normal * (radius_sum - overlap), radius_sum);
        let touch = if rng.one_in(16) { Touch { overlap: 0.0, ..touch } } else { touch };
        (first, second, touch, rng.displacement(normal), rng.interaction(), rng.dt(), rng.lead())
    };
    compare(&formulas, SPHERE_PAIRS, draw, |formula, (response,)| outcomes.count(formula.law, response));
    outcomes.are_mixed();
}

#[test]
fn contacts_with_a_wall_have_the_bits_of_the_law() {
    let formulas = laws().map(|law| print::ContactWithWall { law });
    let mut outcomes = Outcomes::default();
    let draw = |rng: &mut Rng| {
        let mut sphere = rng.sphere();
        let wall_normal = rng.direction();
        let wall_point = rng.vector(-3, 3);
        sphere.position = wall_point + wall_normal * (sphere.radius - rng.overlap(sphere.radius));
        let wall_velocity = if rng.one_in(2) { Vec3::zero() } else { rng.vector(-10, 3) };
        if rng.one_in(8) {
            sphere.velocity = wall_velocity;
        }
        let touch = touch_wall(sphere.position, sphere.radius, wall_point, wall_normal);
        (
            sphere,
            touch,
            wall_normal,
            wall_velocity,
            rng.displacement(wall_normal),
            rng.interaction(),
            rng.dt(),
            rng.lead(),
        )
    };
    compare(&formulas, WALL_PAIRS, draw, |formula, (response,)| outcomes.count(formula.law, response));
    outcomes.are_mixed();
}

#[test]
fn what_a_ledger_adds_has_the_bits_of_the_law() {
    let kick = |rng: &mut Rng| Kick { velocity: rng.vector(-20, 0), rolling: rng.vector(-20, 0) };
    let spheres = |rng: &mut Rng| {
        let (first, second) = (rng.sphere(), rng.sphere());
        let radius_sum = first.radius + second.radius;
        let normal = rng.direction();
        let touch = touch_spheres(normal * (radius_sum - rng.overlap(first.radius)), radius_sum);
        (first, second, touch, rng.displacement(normal), rng.interaction(), rng.dt(), rng.lead())
    };
    let wall = |rng: &mut Rng| {
        let mut sphere = rng.sphere();
        let (normal, point) = (rng.direction(), rng.vector(-3, 3));
        sphere.position = point + normal * (sphere.radius - rng.overlap(sphere.radius));
        let touch = touch_wall(sphere.position, sphere.radius, point, normal);
        (sphere, touch, normal, rng.vector(-10, 3), rng.displacement(normal), rng.interaction(), rng.dt(), rng.lead())
    };
    let settled = |rng: &mut Rng| {
        let (first, second, touch, displacement, pair, dt, lead) = spheres(rng);
        (first, second, touch, kick(rng), kick(rng), displacement, pair, dt, lead)
    };
    let settled_at_wall = |rng: &mut Rng| {
        let (sphere, touch, normal, velocity, displacement, pair, dt, lead) = wall(rng);
        (sphere, touch, normal, velocity, kick(rng), displacement, pair, dt, lead)
    };
    compare(&laws().map(|law| print::SettledContactOfSpheres { law }), OTHERS, settled, |_, _| {});
    compare(&laws().map(|law| print::SettledContactWithWall { law }), OTHERS, settled_at_wall, |_, _| {});
    compare(&laws().map(|law| print::ReleasedBySpheres { law }), OTHERS, spheres, |_, _| {});
    compare(&laws().map(|law| print::ReleasedByWall { law }), OTHERS, wall, |_, _| {});
}

#[test]
fn laws_without_variants_have_the_bits_of_the_law() {
    alone(print::NearestImage, |rng| {
        let [x, y, z] = [0; 3].map(|_| if rng.one_in(3) { None } else { Some(rng.size(-3, 3)) });
        let period = Period::new([x, y, z]);
        // Offsets of exactly half a period stay where they are.
        let offset = if rng.one_in(8) { -period.half } else { rng.vector(-4, 4) };
        (period, offset)
    });
    alone(print::TouchOfSpheres, |rng| (rng.vector(-6, 0), rng.size(-6, 0)));
    alone(print::TouchOfWall, |rng| (rng.vector(-3, 3), rng.size(-6, 0), rng.vector(-3, 3), rng.direction()));
    alone(print::LeverArm, |rng| (rng.size(-9, -2), rng.size(-30, -4)));
    alone(print::StoredEnergy, |rng| (rng.size(-9, -2), rng.size(-30, -4), rng.vector(-30, -12), rng.interaction()));
    alone(print::SphereInertia, |rng| (rng.size(-9, 3), rng.size(-9, -2)));
    alone(print::Kick, |rng| (rng.vector(-10, 3), rng.vector(-20, 20), rng.size(-9, 3), rng.dt()));
    alone(print::Drift, |rng| (rng.vector(-3, 3), rng.vector(-10, 3), rng.dt()));
    alone(print::RampLine, |rng| {
        let start = rng.size(-12, 2);
        (start, rng.number(-9, 9), start + rng.size(-12, 2), rng.number(-9, 9), rng.size(-12, 4))
    });
    alone(print::GearPredict, |rng| (rng.trajectory(), rng.dt()));
    alone(print::GearCorrect, |rng| (rng.trajectory(), rng.vector(-20, 20), rng.size(-9, 3), rng.dt()));
}

#[test]
fn bonds_in_total_form_have_the_bits_of_the_law() {
    let formulas = DAMPINGS.map(|damping| print::BondTotal { damping });
    let mut ends = Ends::default();
    let draw = |rng: &mut Rng| {
        let (first, second, offset) = rng.bonded_spheres();
        let posture = Posture {
            bonded_offset: offset + rng.vector(-20, -12) * offset.x,
            first_orientation: rng.orientation(),
            second_orientation: rng.orientation(),
            free_strain: if rng.one_in(2) { 0.0 } else { rng.number(-16, -6) },
        };
        (first, second, offset, posture, rng.bond(), rng.lead())
    };
    compare(&formulas, SPHERE_PAIRS, draw, |_, (reaction,)| ends.count(reaction));
    ends.are_mixed();
}

#[test]
fn bonds_in_incremental_form_have_the_bits_of_the_law() {
    let formulas = [Tension::FromLength, Tension::Stored]
        .map(|tension| DAMPINGS.map(|damping| print::BondIncremental { tension, damping }))
        .concat();
    let mut ends = Ends::default();
    let draw = |rng: &mut Rng| {
        let (first, second, offset) = rng.bonded_spheres();
        let length = offset.dot(offset).sqrt();
        let turned = offset * (1.0 / length) + rng.vector(-12, -2);
        let earlier = History { normal: turned * (1.0 / turned.dot(turned).sqrt()), ..rng.history() };
        let rest = Rest { length: length * (1.0 + rng.number(-20, -8)), growth: length * rng.number(-30, -20) };
        (first, second, offset, Advance { earlier, rest, step: rng.dt() }, rng.bond(), rng.lead())
    };
    compare(&formulas, SPHERE_PAIRS, draw, |_, (_, reaction)| ends.count(reaction));
    ends.are_mixed();
}

#[test]
fn what_bonds_need_has_the_bits_of_the_law() {
    compare(
        &DAMPINGS.map(|damping| print::BondBetween { damping }),
        OTHERS,
        |rng| {
            let joint =
                Joint { cement: rng.cement(), stiffness_per_area: rng.size(30, 50), young_modulus: rng.size(20, 40) };
            (joint, rng.sphere(), rng.sphere(), rng.size(-12, -2), rng.size(-2, 2))
        },
        |_, _| {},
    );
    alone(print::BondTempered, |rng| (rng.bond(), rng.size(-8, 2), rng.size(-8, 2)));
    alone(print::BondRest, |rng| (rng.size(-12, -2), rng.number(-16, -6), rng.number(-16, -6)));
    alone(print::ReversedHistory, |rng| (rng.history(),));
    alone(print::BondLoss, |rng| {
        let (first, second, offset) = rng.bonded_spheres();
        (first, second, rng.sphere(), rng.sphere(), offset, rng.bond(), rng.dt(), rng.lead())
    });
    alone(print::BondEnergy, |rng| (rng.load(), rng.bond()));
    alone(print::BondRelease, |rng| {
        let (first, second, offset) = rng.bonded_spheres();
        (first, second, offset, rng.load(), rng.bond(), rng.dt(), rng.lead())
    });
    alone(print::ContactBegun, |rng| {
        let (first, second) = (rng.sphere(), rng.sphere());
        let radius_sum = first.radius + second.radius;
        let touch = touch_spheres(rng.direction() * (radius_sum - rng.overlap(first.radius)), radius_sum);
        (first, second, touch, rng.interaction(), rng.dt(), rng.lead())
    });
    alone(print::TurnOrientation, |rng| (rng.orientation(), rng.vector(-6, 8), rng.dt()));
    alone(print::LocalDamping, |rng| {
        let velocity = if rng.one_in(4) { rng.displacement(Vec3::zero()) } else { rng.vector(-10, 3) };
        (rng.vector(-10, 10), velocity, rng.size(-3, 0))
    });
}

#[test]
fn heat_has_the_bits_of_the_law() {
    let paths = [HeatPath::Closed, HeatPath::Bar, HeatPath::Circle];
    let touching = |rng: &mut Rng, radius_sum: f64| {
        let overlap = rng.overlap(radius_sum);
        touch_spheres(rng.direction() * (radius_sum - overlap), radius_sum)
    };
    compare(
        &paths.map(|path| print::BetweenSpheres { path }),
        OTHERS,
        |rng| {
            let [first, second] = [rng.size(-9, -2), rng.size(-9, -2)];
            (rng.conductor(), first, second, touching(rng, first + second))
        },
        |_, _| {},
    );
    compare(
        &paths.map(|path| print::AtWall { path }),
        OTHERS,
        |rng| {
            let radius = rng.size(-9, -2);
            (rng.conductor(), radius, touching(rng, radius))
        },
        |_, _| {},
    );
    alone(print::HeatFlow, |rng| (rng.size(-20, 4), rng.size(7, 11), rng.size(7, 11)));
    alone(print::TemperedConductance, |rng| (rng.size(-20, 4), rng.size(-8, 8), rng.size(-8, 8)));
    alone(print::MeanTemperature, |rng| (rng.size(7, 11), rng.size(7, 11)));
    alone(print::TakenIn, |rng| (rng.number(-20, 12), rng.size(-12, 4), rng.size(-24, 2)));
    // Specific heats of two points, and where a body is between them.
    let piece = |rng: &mut Rng| (rng.size(7, 9), rng.size(7, 12), rng.size(10, 11), rng.size(7, 12), rng.size(9, 10));
    alone(print::TableSlope, |rng| {
        let (start, low, end, high, _) = piece(rng);
        (start, low, end, high)
    });
    alone(print::HeatAlong, |rng| {
        let (start, low, end, high, from) = piece(rng);
        (start, low, end, high, from, rng.size(9, 10))
    });
    alone(print::HeatRise, |rng| {
        let (start, low, end, high, from) = piece(rng);
        (start, low, end, high, from, rng.number(-4, 12))
    });
    alone(print::LinkBetween, |rng| {
        let (radii, expansions) = ([rng.size(-9, -2), rng.size(-9, -2)], [rng.size(-20, -10), rng.size(-20, -10)]);
        (rng.conductor(), radii, expansions)
    });
    alone(print::LinkWithinSide, |rng| (rng.link(),));
    alone(print::LinkConductance, |rng| (rng.link(), rng.size(-8, -2)));
    alone(print::FreeStrain, |rng| (rng.link(), rng.number(-3, 11), rng.number(-3, 11)));
    let exchange = |rng: &mut Rng| {
        let [flux_area, conductance, radiation, resistance] =
            [(-20, -6), (-20, 4), (-44, -30), (-3, 12)].map(|(low, high)| match rng.below(3) {
                0 => 0.0,
                _ => rng.size(low, high),
            });
        Exchange { flux_area, conductance, radiation, resistance }
    };
    let surroundings = |rng: &mut Rng| {
        let outside = Outside { flux: rng.number(-3, 20), fluid: rng.size(7, 11), surroundings: rng.size(7, 11) };
        (exchange(rng), rng.size(7, 11), outside)
    };
    alone(print::SurfaceHeat, surroundings);
    alone(print::SurfaceSensitivity, surroundings);
    alone(print::TemperedExchange, |rng| (exchange(rng), rng.size(-8, 8)));
    alone(print::Warmed, |rng| (rng.size(7, 11), rng.number(-20, 12), rng.size(-12, 4), rng.size(-24, 2)));
    alone(print::Grown, |rng| (rng.size(-9, -2), rng.number(-20, -10), rng.number(-3, 11)));
}

#[test]
fn implicit_heat_has_the_bits_of_the_law() {
    alone(print::LongestStep, |rng| (rng.size(-12, 4), if rng.one_in(4) { 0.0 } else { rng.size(-20, 4) }));
    alone(print::ImplicitHeld, |rng| (rng.size(-12, 4), rng.size(-24, 12), rng.size(-20, 4)));
    alone(print::ImplicitBalance, |rng| (rng.size(-24, 12), rng.number(-60, 11), rng.number(-60, 12)));
    alone(print::ForeignAtEnd, |rng| (rng.number(-20, 12), rng.size(-20, 4), rng.number(-60, 11)));
    alone(print::ThermalSquare, |rng| (rng.size(-12, 4), rng.number(-60, 11)));
    alone(print::ResidualSquares, |rng| (rng.number(-60, 12), rng.size(-24, 12), rng.size(-12, 4), rng.size(-24, 12)));
}

#[test]
fn heat_of_motion_has_the_bits_of_the_law() {
    alone(print::DissipatedHeat, |rng| {
        let dissipation = Dissipation { friction: rng.size(-3, 0), damping: rng.size(-3, 0) };
        (dissipation, rng.size(-30, 2), rng.number(-30, 2))
    });
    alone(print::HeatRateOfMotion, |rng| (rng.number(-30, 2), rng.size(-24, 2)));
    alone(print::ElasticBetweenSpheres, |rng| {
        let [first, second] = [rng.size(-9, -2), rng.size(-9, -2)];
        (first, second, rng.overlap(first + second), rng.interaction())
    });
    alone(print::ElasticAtWall, |rng| {
        let radius = rng.size(-9, -2);
        (radius, rng.overlap(radius), rng.interaction())
    });
    alone(print::ExpansionWorkOfBond, |rng| (rng.number(-20, -10), rng.number(-10, 20), rng.size(-9, -2)));
    alone(print::ExpansionWorkOfContacts, |rng| (rng.size(-10, 20), rng.number(-20, -10), rng.size(-9, -2)));
    alone(print::SofteningWork, |rng| (rng.number(-30, 2), rng.size(-8, 2), rng.number(-20, -2)));
    alone(print::HalfStepOfWork, |rng| (rng.number(-30, 2), rng.number(-20, 4)));
}

/// Whether bonds have dashpots.
const DAMPINGS: [bond::Damping; 2] = [bond::Damping::Off, bond::Damping::Viscous];

/// How bonds ended: held, torn, sheared off.
#[derive(Default, Debug)]
struct Ends([usize; 3]);

impl Ends {
    fn count(&mut self, reaction: &Reaction<f64>) {
        self.0[reaction.failure as usize] += 1;
    }
    fn are_mixed(&self) {
        let all: usize = self.0.iter().sum();
        assert!(self.0.iter().all(|&count| count > all / 20), "{self:?}");
    }
}

/// Compares a law without variants.
fn alone<F: Formula + std::fmt::Debug>(formula: F, draw: impl Fn(&mut Rng) -> F::Input<f64>) {
    compare(&[formula], OTHERS, draw, |_, _| {});
}

/// Every variant of the contact law.
fn laws() -> [Law; 12] {
    std::array::from_fn(|variant| Law {
        damping: [Damping::Viscous, Damping::Restitution][variant % 2],
        friction: [Friction::Off, Friction::Displacement, Friction::Rescaled][variant / 2 % 3],
        moments: variant / 6 == 1,
    })
}

/// Splitmix64.
struct Rng(u64);

impl Rng {
    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }
    fn below(&mut self, limit: u64) -> u64 {
        ((self.bits() >> 32) * limit) >> 32
    }
    fn one_in(&mut self, many: u64) -> bool {
        self.below(many) == 0
    }
    /// Positive, all binary exponents from `low` to below `high` alike.
    fn size(&mut self, low: i64, high: i64) -> f64 {
        let exponent = 1023 + low + self.below((high - low) as u64) as i64;
        f64::from_bits((exponent as u64) << 52 | self.bits() >> 12)
    }
    /// Either sign.
    fn number(&mut self, low: i64, high: i64) -> f64 {
        self.size(low, high).copysign(self.bits() as i64 as f64)
    }
    fn vector(&mut self, low: i64, high: i64) -> Vec3<f64> {
        let scale = self.size(low, high);
        vec3(self.number(-3, 0) * scale, self.number(-3, 0) * scale, self.number(-3, 0) * scale)
    }
    /// A unit vector, often along an axis.
    fn direction(&mut self) -> Vec3<f64> {
        let v = match self.below(12) {
            0 => vec3(1.0, 0.0, 0.0),
            1 => vec3(0.0, -1.0, 0.0),
            2 => vec3(-0.0, -0.0, -1.0),
            _ => self.vector(0, 1),
        };
        v * (1.0 / v.dot(v).sqrt())
    }
    fn overlap(&mut self, radius: f64) -> f64 {
        radius * self.size(-30, -3)
    }
    fn dt(&mut self) -> f64 {
        if self.one_in(12) { 0.0 } else { self.size(-24, -8) }
    }
    fn lead(&mut self) -> f64 {
        if self.one_in(4) { 0.0 } else { self.size(-25, -9) }
    }
    fn displacement(&mut self, normal: Vec3<f64>) -> Vec3<f64> {
        match self.below(8) {
            0 => Vec3::zero(),
            1 => vec3(-0.0, 0.0, -0.0),
            // Nothing is left of this one in the plane of contact, or only rounding.
            2 => normal * self.size(-24, -12),
            _ => self.vector(-30, -12),
        }
    }
    fn sphere(&mut self) -> Sphere<f64> {
        Sphere {
            position: self.vector(-3, 3),
            radius: self.size(-9, -2),
            velocity: self.vector(-10, 3),
            mass: self.size(-12, 3),
            angular_velocity: if self.one_in(4) { Vec3::zero() } else { self.vector(-6, 8) },
        }
    }
    fn interaction(&mut self) -> Interaction<f64> {
        let static_friction = [0.0, f64::INFINITY, 1e300, 1.0, 0.5, 0.25, 0.1, 1e-3][self.below(8) as usize];
        let least_normal_force = [f64::NEG_INFINITY, -self.size(-3, 10), -0.0, 0.0, 0.0][self.below(5) as usize];
        Interaction {
            normal_stiffness: self.size(14, 35),
            tangential_stiffness: if self.one_in(16) { 0.0 } else { self.size(14, 35) },
            normal_damping: if self.one_in(8) { 0.0 } else { self.size(-3, 12) },
            tangential_damping: if self.one_in(8) { 0.0 } else { self.size(-3, 10) },
            static_friction,
            dynamic_friction: if self.one_in(2) { static_friction } else { static_friction.min(0.05) },
            least_normal_force,
        }
    }
    fn bonded_spheres(&mut self) -> (Sphere<f64>, Sphere<f64>, Vec3<f64>) {
        let (first, second) = (self.sphere(), self.sphere());
        let length = (first.radius + second.radius) * (1.0 + self.number(-20, -3));
        (first, second, self.direction() * length)
    }
    fn orientation(&mut self) -> Quaternion<f64> {
        if self.one_in(8) {
            return Quaternion::identity();
        }
        let (vector, scalar) = (self.vector(-12, 0), self.number(-1, 0));
        let inverse = 1.0 / (vector.dot(vector) + scalar * scalar).sqrt();
        Quaternion { vector: vector * inverse, scalar: scalar * inverse }
    }
    fn load(&mut self) -> Modes<f64> {
        Modes {
            normal: self.number(-10, 10),
            shear: self.vector(-10, 10),
            torsion: self.number(-20, 0),
            bending: self.vector(-20, 0),
        }
    }
    fn cement(&mut self) -> Cement<f64> {
        let strength = |rng: &mut Rng| if rng.one_in(3) { f64::INFINITY } else { rng.size(12, 40) };
        Cement {
            stiffness_ratio: if self.one_in(8) { 0.0 } else { self.size(-4, 1) },
            radius_multiplier: self.size(-2, 1),
            tensile_strength: strength(self),
            shear_strength: strength(self),
            internal_friction: if self.one_in(2) { 0.0 } else { self.size(-2, 1) },
            moment_contribution: [0.0, 0.5, 1.0][self.below(3) as usize],
            damping_ratio: if self.one_in(4) { 0.0 } else { self.size(-8, 0) },
        }
    }
    fn bond(&mut self) -> Bond<f64> {
        let cement = self.cement();
        let section = Section::between(cement.radius_multiplier, self.size(-9, -2), self.size(-9, -2));
        let bond = Bond::new(&cement, &section, self.size(30, 50));
        let (first, second) = (self.sphere(), self.sphere());
        Bond { damping: bond::damping::coefficients(cement.damping_ratio, &bond.stiffness, &first, &second), ..bond }
    }
    fn conductor(&mut self) -> Conductor<f64> {
        let conductivity = if self.one_in(8) { 0.0 } else { self.size(-8, 8) };
        Conductor { conductivity, section: self.size(-4, 1) }
    }
    fn link(&mut self) -> Link<f64> {
        let [first_growth, second_growth] = [self.size(-20, -10), self.size(-20, -10)];
        Link { conductance_length: self.size(-30, -4), first_growth, second_growth }
    }
    fn history(&mut self) -> History<f64> {
        History {
            normal: self.direction(),
            tension: self.number(-10, 20),
            shear: if self.one_in(4) { Vec3::zero() } else { self.vector(-10, 20) },
            couple: if self.one_in(4) { Vec3::zero() } else { self.vector(-20, 10) },
        }
    }
    fn trajectory(&mut self) -> Trajectory<f64> {
        Trajectory {
            position: self.vector(-3, 3),
            velocity: self.vector(-10, 3),
            derivatives: [self.vector(-20, -10), self.vector(-25, -15), self.vector(-30, -20), self.vector(-40, -25)],
        }
    }

    /// Puts extreme numbers into a quarter of all rows: zeros of both signs, infinities, NaN, the least and the greatest
    /// numbers, any bits at all.
    fn disturb(&mut self, row: &mut [f64]) {
        const EXTREMES: [f64; 16] = [
            0.0,
            -0.0,
            0.0,
            -0.0,
            1.0,
            -1.0,
            f64::INFINITY,
            f64::NEG_INFINITY,
            f64::NAN,
            f64::MAX,
            f64::MIN,
            5e-324,
            -5e-324,
            f64::MIN_POSITIVE,
            1e160,
            -1e-160,
        ];
        if !self.one_in(4) {
            return;
        }
        for _ in 0..=self.below(3) {
            let place = self.below(row.len() as u64) as usize;
            let extreme = EXTREMES[self.below(16) as usize];
            row[place] = if self.one_in(8) { f64::from_bits(self.bits()) } else { extreme };
        }
        // A whole row of another magnitude, and one of nothing but noise.
        match self.below(32) {
            0 => row.iter_mut().for_each(|number| *number *= 1e150),
            1 => row.iter_mut().for_each(|number| *number *= 1e-150),
            2 => row.iter_mut().for_each(|number| *number = f64::from_bits(self.bits())),
            _ => {}
        }
    }
}

/// How often a law let the surfaces stick and slide, told by the friction loss.
#[derive(Clone, Copy, Default)]
struct Outcome {
    stuck: usize,
    slid: usize,
}

/// The outcomes of every law with friction.
#[derive(Default)]
struct Outcomes([Outcome; 12]);

impl Outcomes {
    fn count(&mut self, law: Law, response: &Response<f64>) {
        let outcome = &mut self.0[laws().iter().position(|&other| other == law).expect("all laws are listed")];
        outcome.stuck += usize::from(response.losses.friction == 0.0);
        outcome.slid += usize::from(response.losses.friction > 0.0);
    }
    /// Proves that the comparison went through both branches.
    fn are_mixed(&self) {
        for (law, Outcome { stuck, slid }) in laws().into_iter().zip(self.0) {
            let tenth = (stuck + slid) / 10;
            let mixed = law.friction == Friction::Off || stuck.min(slid) > tenth;
            assert!(mixed, "{law:?}: {stuck} stuck, {slid} slid");
        }
    }
}

/// Calls the C, the `f64` law and the lanes of every formula with the same inputs and compares bits; `watch` sees what
/// the `f64` law returns.
fn compare<F: Formula + std::fmt::Debug>(
    formulas: &[F],
    count: usize,
    draw: impl Fn(&mut Rng) -> F::Input<f64>,
    mut watch: impl FnMut(&F, &F::Output<f64>),
) {
    let inputs = F::Input::<Symbol>::described(F::INPUTS);
    let outputs = F::Output::<Symbol>::described(F::OUTPUTS);
    let numbers = |parameters: &[Parameter]| parameters.iter().map(|p| p.members.len()).sum::<usize>();
    let (numbers_in, numbers_out) = (numbers(&inputs), numbers(&outputs));
    let mut program = Program::compile(F::NAME, &c_program(formulas, &inputs, &outputs));
    let mut rng = Rng(1);

    let mut rows = Vec::with_capacity(CHUNK * numbers_in);
    let mut done = 0;
    while done < count {
        rows.clear();
        for _ in 0..CHUNK {
            let start = rows.len();
            draw(&mut rng).write(&mut |number| rows.push(number));
            rng.disturb(&mut rows[start..]);
        }
        program.send(&rows);
        for formula in formulas {
            let scalar = scalar(formula, &rows, numbers_in, &mut watch);
            let lanes = lanes(formula, &rows, numbers_in, numbers_out);
            let printed = program.receive(CHUNK * numbers_out);
            let report = |place: usize, kind: &str, got: f64| -> ! {
                let row = &rows[place / numbers_out * numbers_in..][..numbers_in];
                let names = inputs.iter().flat_map(|p| &p.members);
                let given: String = names.zip(row).fold(String::new(), |mut text, (name, number)| {
                    let _ = write!(text, "\n  {name} = {number:?}");
                    text
                });
                let output = outputs.iter().flat_map(|p| &p.members).nth(place % numbers_out).expect("in range");
                panic!("{formula:?}: {output} is {:?} from f64, {got:?} from {kind}, for{given}", scalar[place]);
            };
            for place in 0..scalar.len() {
                if !same(scalar[place], printed[place]) {
                    report(place, "C", printed[place]);
                }
                if !same(scalar[place], lanes[place]) {
                    report(place, "lanes", lanes[place]);
                }
            }
        }
        done += CHUNK;
    }
}

/// Equal bits; any NaN equals any other, because machines differ in which one they make.
fn same(a: f64, b: f64) -> bool {
    a.to_bits() == b.to_bits() || a.is_nan() && b.is_nan()
}

fn scalar<F: Formula>(
    formula: &F,
    rows: &[f64],
    numbers_in: usize,
    watch: &mut impl FnMut(&F, &F::Output<f64>),
) -> Vec<f64> {
    let mut results = Vec::new();
    for row in rows.chunks_exact(numbers_in) {
        let mut numbers = row.iter();
        let input = F::Input::<f64>::read(&mut || *numbers.next().expect("a row is complete"));
        let output = formula.apply(input);
        watch(formula, &output);
        output.write(&mut |number| results.push(number));
    }
    results
}

fn lanes<F: Formula>(formula: &F, rows: &[f64], numbers_in: usize, numbers_out: usize) -> Vec<f64> {
    let mut results = vec![0.0; rows.len() / numbers_in * numbers_out];
    let results_of_groups = results.chunks_exact_mut(WIDTH * numbers_out);
    for (group, results) in rows.chunks_exact(WIDTH * numbers_in).zip(results_of_groups) {
        let mut number = 0;
        let input = F::Input::<Lanes>::read(&mut || {
            number += 1;
            Lanes(std::array::from_fn(|lane| group[lane * numbers_in + number - 1]))
        });
        let mut number = 0;
        formula.apply(input).write(&mut |lanes| {
            for lane in 0..WIDTH {
                results[lane * numbers_out + number] = lanes.0[lane];
            }
            number += 1;
        });
    }
    results
}

/// A program that reads the number of rows and the rows, and answers with the results of every formula in turn.
fn c_program<F: Formula>(formulas: &[F], inputs: &[Parameter], outputs: &[Parameter]) -> String {
    let mut text = format!("{}#include <stdio.h>\n#include <stdlib.h>\n#include <string.h>\n", print::HOST_PRELUDE);
    text += &(print::types() + &print::bond_types() + &print::heat_types());
    let name = F::NAME;
    for (variant, formula) in formulas.iter().enumerate() {
        let function = print::function(formula).text;
        let _ = write!(text, "\n#define {name} {name}_{variant}\n{function}");
        let _ = write!(text, "static void run_{variant}(const double *in, double *out)\n{{\n");
        for parameter in inputs.iter().chain(outputs) {
            let _ = writeln!(text, "    {};", parameter.value);
        }
        let mut at = 0;
        for Parameter { name, members, .. } in inputs {
            let _ = writeln!(text, "    memcpy(&{name}, in + {at}, sizeof {name});");
            at += members.len();
        }
        let by_value = inputs.iter().map(|p| p.name.clone());
        let arguments: Vec<String> = by_value.chain(outputs.iter().map(|p| format!("&{}", p.name))).collect();
        let _ = writeln!(text, "    {name}({});", arguments.join(", "));
        at = 0;
        for Parameter { name, members, .. } in outputs {
            let _ = writeln!(text, "    memcpy(out + {at}, &{name}, sizeof {name});");
            at += members.len();
        }
        let _ = write!(text, "}}\n#undef {name}\n");
    }
    let numbers = |parameters: &[Parameter]| parameters.iter().map(|p| p.members.len()).sum::<usize>();
    let (numbers_in, numbers_out) = (numbers(inputs), numbers(outputs));
    let table: Vec<String> = (0..formulas.len()).map(|variant| format!("run_{variant}")).collect();
    let _ = write!(
        text,
        "
static void (*const run[])(const double *, double *) = {{{}}};
int main(void)
{{
    double *in = malloc({CHUNK} * {numbers_in} * sizeof(double)), *out = malloc({CHUNK} * {numbers_out} * sizeof(double));
    while (fread(in, {numbers_in} * sizeof(double), {CHUNK}, stdin) == {CHUNK})
        for (size_t k = 0; k < sizeof run / sizeof *run; ++k) {{
            for (size_t i = 0; i < {CHUNK}; ++i)
                run[k](in + i * {numbers_in}, out + i * {numbers_out});
            fwrite(out, {numbers_out} * sizeof(double), {CHUNK}, stdout);
            fflush(stdout);
        }}
    return 0;
}}
",
        table.join(", ")
    );
    text
}

/// A compiled program that runs until it is dropped.
struct Program {
    child: Child,
    files: [PathBuf; 2],
    bytes: Vec<u8>,
}

impl Program {
    fn compile(name: &str, source: &str) -> Program {
        let compiler = std::env::var("CC").unwrap_or_else(|_| "cc".to_owned());
        // The process id keeps test runs that happen at the same time apart.
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR"));
        let executable = folder.join(format!("{name}_{}{}", std::process::id(), std::env::consts::EXE_SUFFIX));
        let text = folder.join(format!("{name}_{}.c", std::process::id()));
        fs::write(&text, source).expect("the test folder can be written to");
        let flags = ["-O2", "-std=c99", "-ffp-contract=off"];
        let run = Command::new(&compiler).args(flags).arg("-o").args([&executable, &text]).arg("-lm").output();
        let run = run.unwrap_or_else(|error| match error.kind() {
            ErrorKind::NotFound => {
                panic!("this test needs a C compiler: there is no `{compiler}`; install one or set CC")
            }
            _ => panic!("the C compiler `{compiler}` does not start: {error}"),
        });
        assert!(run.status.success(), "{} does not compile:\n{}", text.display(), String::from_utf8_lossy(&run.stderr));
        let child = Command::new(&executable).stdin(Stdio::piped()).stdout(Stdio::piped()).spawn();
        Program { child: child.expect("the program starts"), files: [executable, text], bytes: Vec::new() }
    }

    fn send(&mut self, numbers: &[f64]) {
        self.bytes.clear();
        self.bytes.extend(numbers.iter().flat_map(|number| number.to_ne_bytes()));
        let input = self.child.stdin.as_mut().expect("stdin is piped");
        input.write_all(&self.bytes).and_then(|()| input.flush()).expect("the program reads its input");
    }

    fn receive(&mut self, count: usize) -> Vec<f64> {
        self.bytes.resize(count * size_of::<f64>(), 0);
        let output = self.child.stdout.as_mut().expect("stdout is piped");
        output.read_exact(&mut self.bytes).expect("the program answers");
        self.bytes.as_chunks().0.iter().map(|&number| f64::from_ne_bytes(number)).collect()
    }
}

impl Drop for Program {
    fn drop(&mut self) {
        // The end of its input ends the program; a failed comparison may leave it blocked on its output.
        drop(self.child.stdin.take());
        drop(self.child.stdout.take());
        let _ = self.child.wait();
        for file in &self.files {
            let _ = fs::remove_file(file);
        }
    }
}
