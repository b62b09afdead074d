//! One bond: exchange of its bodies, rigid motion, beam theory, strength, energy.

use std::f64::consts::PI;
use tdem_physics::bond::{
    self, Advance, Axis, Bond, Cement, Damping, Ends, Failure, History, Modes, Posture, Reaction, Rest, Section,
    Tension, damping, section::stiffness_per_area,
};
use tdem_physics::contact::Sphere;
use tdem_physics::heat::{Conductor, Link};
use tdem_physics::motion::{orientation::Quaternion, sphere_inertia, verlet};
use tdem_physics::{Vec3, vec3};

const EXCHANGES: usize = 200_000;

const CEMENT: Cement<f64> = Cement {
    stiffness_ratio: 0.4,
    radius_multiplier: 0.8,
    tensile_strength: f64::INFINITY,
    shear_strength: f64::INFINITY,
    internal_friction: 0.0,
    moment_contribution: 1.0,
    damping_ratio: 0.0,
};
const YOUNG_MODULUS: f64 = 30e9;
const RADII: [f64; 2] = [1.1e-3, 0.9e-3];
const LENGTH: f64 = 2e-3;

fn bond(cement: &Cement<f64>) -> Bond<f64> {
    let section = Section::between(cement.radius_multiplier, RADII[0], RADII[1]);
    let bond = Bond::new(cement, &section, stiffness_per_area(YOUNG_MODULUS, LENGTH));
    let [first, second] = RADII.map(sphere);
    Bond { damping: damping::coefficients(cement.damping_ratio, &bond.stiffness, &first, &second), ..bond }
}

/// What a bond of these radii and expansions is to heat.
fn link(radii: [f64; 2], expansions: [f64; 2]) -> Link<f64> {
    Link::between(&Conductor { conductivity: 1.5, section: 0.35 }, radii, expansions)
}

fn section() -> Section<f64> {
    Section::between(CEMENT.radius_multiplier, RADII[0], RADII[1])
}

fn sphere(radius: f64) -> Sphere<f64> {
    Sphere {
        position: Vec3::zero(),
        radius,
        velocity: Vec3::zero(),
        mass: 4.0 / 3.0 * PI * radius * radius * radius * 2500.0,
        angular_velocity: Vec3::zero(),
    }
}

fn resting(offset: Vec3<f64>) -> Ends<f64> {
    Ends { first: sphere(RADII[0]), second: sphere(RADII[1]), offset, lead: 0.0 }
}

fn about(axis: Vec3<f64>, angle: f64) -> Quaternion<f64> {
    Quaternion { vector: axis * libm::sin(0.5 * angle), scalar: libm::cos(0.5 * angle) }
}

/// Along x when bonded; the second body displaced and turned.
fn posture(second_orientation: Quaternion<f64>) -> Posture<f64> {
    Posture {
        bonded_offset: vec3(LENGTH, 0.0, 0.0),
        first_orientation: Quaternion::identity(),
        second_orientation,
        free_strain: 0.0,
    }
}

fn respond(offset: Vec3<f64>, second_orientation: Quaternion<f64>, bond: &Bond<f64>) -> Reaction<f64> {
    bond::respond_total(Damping::Off, &resting(offset), &posture(second_orientation), bond)
}

fn size(v: Vec3<f64>) -> f64 {
    v.dot(v).sqrt()
}

fn close(a: f64, b: f64, relative: f64) {
    assert!((a - b).abs() <= relative * b.abs(), "{a} is not {b}");
}

/// Splitmix64.
struct Rng(u64);

impl Rng {
    /// Evenly from -1 to 1.
    fn number(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
    fn vector(&mut self, scale: f64) -> Vec3<f64> {
        vec3(self.number(), self.number(), self.number()) * scale
    }
    fn orientation(&mut self) -> Quaternion<f64> {
        let q = Quaternion { vector: self.vector(1.0), scalar: self.number() };
        let inverse = 1.0 / (q.vector.dot(q.vector) + q.scalar * q.scalar).sqrt();
        Quaternion { vector: q.vector * inverse, scalar: q.scalar * inverse }
    }
    fn sphere(&mut self) -> Sphere<f64> {
        Sphere {
            position: Vec3::zero(),
            radius: 1.5 + self.number(),
            velocity: self.vector(3.0),
            mass: 2.5 + self.number(),
            angular_velocity: self.vector(3.0),
        }
    }
    fn bond(&mut self) -> Bond<f64> {
        let cement = Cement {
            stiffness_ratio: 1.0 + self.number(),
            radius_multiplier: 1.5 + self.number(),
            tensile_strength: 2.0 + self.number(),
            shear_strength: 2.0 + self.number(),
            internal_friction: 1.0 + self.number(),
            moment_contribution: 1.0 + self.number(),
            damping_ratio: 1.0 + self.number(),
        };
        let bond = Bond::new(&cement, &Section::between(cement.radius_multiplier, 1.0, 1.2), 1.5 + self.number());
        let (first, second) = (self.sphere(), self.sphere());
        Bond { damping: damping::coefficients(cement.damping_ratio, &bond.stiffness, &first, &second), ..bond }
    }
}

/// Equal bits, but for the sign of a zero.
fn same(a: f64, b: f64) -> bool {
    a.to_bits() == b.to_bits() || (a == 0.0 && b == 0.0)
}
fn same_vectors(a: Vec3<f64>, b: Vec3<f64>) -> bool {
    same(a.x, b.x) && same(a.y, b.y) && same(a.z, b.z)
}

/// What the second body calls the same reaction.
fn from_other_side(r: &Reaction<f64>) -> Reaction<f64> {
    Reaction {
        force: -r.force,
        first_moment: r.second_moment,
        second_moment: r.first_moment,
        load: Modes { shear: -r.load.shear, bending: -r.load.bending, ..r.load },
        ..*r
    }
}

fn same_reactions(a: &Reaction<f64>, b: &Reaction<f64>) -> bool {
    same_vectors(a.force, b.force)
        && same_vectors(a.first_moment, b.first_moment)
        && same_vectors(a.second_moment, b.second_moment)
        && same(a.load.normal, b.load.normal)
        && same_vectors(a.load.shear, b.load.shear)
        && same(a.load.torsion, b.load.torsion)
        && same_vectors(a.load.bending, b.load.bending)
        && same(a.stress.axial, b.stress.axial)
        && same(a.stress.tensile, b.stress.tensile)
        && same(a.stress.shear, b.stress.shear)
        && same(a.failure, b.failure)
}

#[test]
fn exchange_of_the_bodies_changes_only_signs() {
    let mut rng = Rng(1);
    let mut failures = [0; 3];
    for _ in 0..EXCHANGES {
        let there = Ends { first: rng.sphere(), second: rng.sphere(), offset: rng.vector(3.0), lead: 0.1 };
        let back = Ends { first: there.second, second: there.first, offset: -there.offset, lead: 0.1 };
        let bond = rng.bond();
        let posture = Posture {
            bonded_offset: there.offset + rng.vector(0.5),
            first_orientation: rng.orientation(),
            second_orientation: rng.orientation(),
            free_strain: 0.1 * rng.number(),
        };
        let reversed = Posture {
            bonded_offset: -posture.bonded_offset,
            first_orientation: posture.second_orientation,
            second_orientation: posture.first_orientation,
            ..posture
        };
        let normal = rng.vector(1.0);
        let earlier = History {
            normal: normal * (1.0 / size(normal)),
            tension: rng.number(),
            shear: rng.vector(1.0),
            couple: rng.vector(1.0),
        };
        let rest = Rest { length: 1.0 + rng.number(), growth: rng.number() };
        let advance = Advance { earlier, rest, step: rng.number() };
        let advance_back = Advance { earlier: earlier.reversed(), ..advance };
        for damping in [Damping::Off, Damping::Viscous] {
            let reaction = bond::respond_total(damping, &there, &posture, &bond);
            let other = bond::respond_total(damping, &back, &reversed, &bond);
            assert!(same_reactions(&from_other_side(&reaction), &other), "{reaction:?}\n{other:?}");
            failures[reaction.failure as usize] += 1;
            for tension in [Tension::FromLength, Tension::Stored] {
                let (history, reaction) = bond::respond_incremental(tension, damping, &there, &advance, &bond);
                let (history_back, other) = bond::respond_incremental(tension, damping, &back, &advance_back, &bond);
                assert!(same_reactions(&from_other_side(&reaction), &other), "{reaction:?}\n{other:?}");
                let history_back = history_back.reversed();
                assert!(
                    same_vectors(history.normal, history_back.normal)
                        && same(history.tension, history_back.tension)
                        && same_vectors(history.shear, history_back.shear)
                        && same_vectors(history.couple, history_back.couple)
                );
            }
        }
        let (forth, again) = (damping::loss(&there, &there, &bond, 0.5), damping::loss(&back, &back, &bond, 0.5));
        let settled = Ends { lead: 0.0, ..there };
        assert!(same(forth, again) && damping::loss(&settled, &settled, &bond, 0.5) >= 0.0);
    }
    assert!(failures.iter().all(|&count| count > EXCHANGES / 50), "{failures:?}");
}

#[test]
fn strains_and_sections_do_not_know_the_order_of_the_bodies() {
    let mut rng = Rng(2);
    for _ in 0..10_000 {
        let (r1, r2, e1, e2) = (1.5 + rng.number(), 1.5 + rng.number(), rng.number(), rng.number());
        let strain = |radii, growths| link(radii, growths).free_strain(1.0, 1.0);
        assert!(same(strain([r1, r2], [e1, e2]), strain([r2, r1], [e2, e1])));
        assert_eq!(Section::between(0.7, r1, r2), Section::between(0.7, r2, r1));
    }
}

#[test]
fn signs_of_the_conventions() {
    let bond = bond(&CEMENT);
    let u = 1e-7;
    let none = Quaternion::identity();
    // Pulled apart: tension is positive, and draws the first body to the second.
    let pulled = respond(vec3(LENGTH + u, 0.0, 0.0), none, &bond);
    assert!(pulled.load.normal > 0.0 && pulled.force.x > 0.0 && pulled.stress.tensile > 0.0);
    // The second body shifted along y drags the first along, and turns both from x towards y.
    let sheared = respond(vec3(LENGTH, u, 0.0), none, &bond);
    assert!(sheared.force.y > 0.0 && sheared.first_moment.z > 0.0 && sheared.second_moment.z > 0.0);
    // The second body turned about x, or y, turns the first along and is turned back.
    let twisted = respond(vec3(LENGTH, 0.0, 0.0), about(vec3(1.0, 0.0, 0.0), 1e-4), &bond);
    assert!(twisted.load.torsion > 0.0 && twisted.first_moment.x > 0.0 && twisted.second_moment.x < 0.0);
    let bent = respond(vec3(LENGTH, 0.0, 0.0), about(vec3(0.0, 1.0, 0.0), 1e-4), &bond);
    assert!(bent.load.bending.y > 0.0 && bent.second_moment.y < 0.0);
}

/// Verification: beam theory for a bond of length l, $EA/l$, $GA/l$, $GJ/l$, $EI/l$ with $G = \kappa E$.
#[test]
fn one_bond_is_a_beam() {
    let bond = bond(&CEMENT);
    let (e, g, section) = (YOUNG_MODULUS, CEMENT.stiffness_ratio * YOUNG_MODULUS, section());
    let u = 1e-6 * LENGTH;
    let pulled = respond(vec3(LENGTH + u, 0.0, 0.0), Quaternion::identity(), &bond);
    close(pulled.force.x, e * section.area / LENGTH * u, 1e-9);
    close(pulled.stress.tensile, e * u / LENGTH, 1e-9);

    // Parallel translation: exact at any size.
    let u = 0.3 * LENGTH;
    let sheared = respond(vec3(LENGTH, u, 0.0), Quaternion::identity(), &bond);
    close(size(sheared.load.shear), g * section.area / LENGTH * u, 1e-14);
    close(sheared.stress.shear, g * u / LENGTH, 1e-14);

    let angle = 1e-3;
    let twisted = respond(vec3(LENGTH, 0.0, 0.0), about(vec3(1.0, 0.0, 0.0), angle), &bond);
    close(twisted.first_moment.x, g * section.polar_moment / LENGTH * angle, angle * angle / 20.0);
    close(twisted.stress.shear, g * section.radius * angle / LENGTH, angle * angle / 20.0);
    assert_eq!(twisted.force, Vec3::zero());

    // Pure bending: the chord turns by half the angle if both arms are equal; here the arms are R_i/(R_i+R_j).
    let part = RADII[1] / (RADII[0] + RADII[1]);
    let chord = vec3(libm::cos(part * angle), libm::sin(part * angle), 0.0) * LENGTH;
    let bent = respond(chord, about(vec3(0.0, 0.0, 1.0), angle), &bond);
    close(bent.load.bending.z, e * section.second_moment / LENGTH * angle, angle * angle / 20.0);
    close(bent.stress.tensile, e * section.radius * angle / LENGTH, 1e-6);
    assert!(size(bent.force) < 1e-6 * bond.stiffness.shear * angle * LENGTH);
    close(bent.first_moment.z, -bent.second_moment.z, 1e-6);
}

#[test]
fn moments_balance_the_force_at_the_lever_arms() {
    let mut rng = Rng(3);
    for _ in 0..1000 {
        let ends = Ends { first: rng.sphere(), second: rng.sphere(), offset: rng.vector(3.0), lead: 0.1 };
        let posture = Posture {
            bonded_offset: rng.vector(3.0),
            first_orientation: rng.orientation(),
            second_orientation: rng.orientation(),
            free_strain: 0.0,
        };
        let r = bond::respond_total(Damping::Viscous, &ends, &posture, &rng.bond());
        // About the first centre: the second body feels -F at the offset.
        let total = r.first_moment + r.second_moment - ends.offset.cross(r.force);
        let scale = size(r.first_moment) + size(r.second_moment) + size(ends.offset) * size(r.force);
        assert!(size(total) < 1e-14 * scale);
    }
}

fn product(a: Quaternion<f64>, b: Quaternion<f64>) -> Quaternion<f64> {
    a.from_earlier(Quaternion { vector: -b.vector, scalar: b.scalar })
}

#[test]
fn the_total_form_does_not_see_rigid_motion() {
    let bond = bond(&CEMENT);
    let mut rng = Rng(4);
    for _ in 0..1000 {
        let offset = vec3(LENGTH, 0.0, 0.0) + rng.vector(1e-4 * LENGTH);
        let (first, second) = (about(vec3(0.6, 0.8, 0.0), 1e-3 * rng.number()), about(vec3(0.0, 0.6, 0.8), 1e-3));
        let posture = Posture { first_orientation: first, ..posture(second) };
        let still = bond::respond_total(Damping::Off, &resting(offset), &posture, &bond);

        let rigid = rng.orientation();
        let moved =
            Posture { first_orientation: product(rigid, first), second_orientation: product(rigid, second), ..posture };
        let turned = bond::respond_total(Damping::Off, &resting(rigid.rotate(offset)), &moved, &bond);
        let force = bond.stiffness.normal * LENGTH;
        assert!(size(turned.force - rigid.rotate(still.force)) < 1e-14 * force);
        let moment = force * LENGTH;
        assert!(size(turned.first_moment - rigid.rotate(still.first_moment)) < 1e-14 * moment);
        close(turned.stress.tensile, still.stress.tensile, 1e-9);
        // Without deformation there is nothing, whatever the rotation.
        let unloaded = Posture { first_orientation: rigid, second_orientation: rigid, ..posture };
        let offset = rigid.rotate(posture.bonded_offset);
        let nothing = bond::respond_total(Damping::Off, &resting(offset), &unloaded, &bond);
        assert!(size(nothing.force) < 2e-15 * force && size(nothing.first_moment) < 2e-15 * moment);
    }
}

/// One revolution of a loaded bond about an oblique axis, with the velocities of rigid rotation.
#[test]
fn the_incremental_form_keeps_the_lengths_of_stored_forces_under_rigid_rotation() {
    let bond = bond(&CEMENT);
    let axis = vec3(0.48, 0.6, 0.64);
    let steps = 1000;
    let (period, angle) = (1.0, 2.0 * PI / f64::from(steps));
    let spin = axis * (2.0 * PI / period);
    let start = vec3(LENGTH, 0.0, 0.0);
    let tension = 30.0;
    let rest = Rest { length: LENGTH - tension / bond.stiffness.normal, growth: 0.0 };
    let stored =
        History { normal: vec3(1.0, 0.0, 0.0), tension, shear: vec3(0.0, 20.0, -10.0), couple: vec3(2e-3, 4e-3, 1e-3) };
    let mut history = stored;
    for k in 1..=steps {
        let offset = about(axis, angle * f64::from(k)).rotate(start);
        let mut ends = resting(offset);
        (ends.first.angular_velocity, ends.second.angular_velocity) = (spin, spin);
        ends.second.velocity = spin.cross(offset);
        let advance = Advance { earlier: history, rest, step: period / f64::from(steps) };
        (history, _) = bond::respond_incremental(Tension::FromLength, Damping::Off, &ends, &advance, &bond);
        close(history.tension, tension, 1e-9);
        close(size(history.shear), size(stored.shear), 1e-9);
        close(size(history.couple), size(stored.couple), 1e-9);
        close(history.couple.dot(history.normal), stored.couple.x, 1e-9);
    }
    // Direction: second order in the step, of Cayley's angle.
    let turn = 2.0 * PI * angle * angle / 12.0;
    assert!(size(history.shear - stored.shear) < 1.5 * turn * size(stored.shear));
    assert!(size(history.couple - stored.couple) < 1.5 * turn * size(stored.couple));
}

/// Velocities of velocity Verlet belong to the chord of a step, and so do its rates: a body that turns rigidly about any axis
/// loads no bond, in steps of any size.
#[test]
fn a_rigid_step_of_velocity_verlet_loads_no_bond() {
    let bond = bond(&CEMENT);
    let step = 1e-3;
    for (axis, angle) in [(vec3(0.0, 0.0, 1.0), 0.02), (vec3(0.48, 0.6, 0.64), 0.02), (vec3(0.48, 0.6, 0.64), 0.7)] {
        // Orientations turn by this angle at this spin, too.
        let spin = axis * (2.0 * libm::tan(0.5 * angle) / step);
        let start = vec3(LENGTH, 0.0, 0.0);
        let offset = about(axis, angle).rotate(start);
        let mut ends = Ends { lead: 0.5 * step, ..resting(offset) };
        (ends.first.angular_velocity, ends.second.angular_velocity) = (spin, spin);
        ends.second.velocity = (offset - start) * (1.0 / step);
        let rest = Rest { length: LENGTH, growth: 0.0 };
        let stored = History { shear: vec3(0.0, 20.0, -10.0), couple: vec3(2e-3, 4e-3, 1e-3), ..start_of(30.0) };
        for (tension, earlier) in [(Tension::Stored, start_of(0.0)), (Tension::Stored, stored)] {
            let advance = Advance { earlier, rest, step };
            let (history, reaction) = bond::respond_incremental(tension, Damping::Viscous, &ends, &advance, &bond);
            let carried = about(axis, angle);
            assert!((history.tension - earlier.tension).abs() < 1e-9, "{history:?}");
            assert!(size(history.shear - carried.rotate(earlier.shear)) < 1e-9, "{history:?}");
            assert!(size(history.couple - carried.rotate(earlier.couple)) < 1e-12, "{history:?}");
            // Dashpots bear nothing either.
            let springs = history.normal * history.tension + history.shear;
            assert!(size(reaction.force - springs) < 1e-8, "{reaction:?}");
        }
    }
}

/// A bond along x under some tension.
fn start_of(tension: f64) -> History<f64> {
    History { tension, ..History::unloaded(vec3(1.0, 0.0, 0.0)) }
}

/// The same way in both forms; what they differ by is second order in the deformation.
#[test]
fn both_forms_agree_to_first_order() {
    let bond = bond(&CEMENT);
    let steps = 200;
    let difference = |amplitude: f64| {
        let (way, first, second) = (vec3(0.3, 0.7, -0.4), vec3(0.5, -0.2, 0.6), vec3(-0.1, 0.4, 0.8));
        let rate = amplitude; // Per unit of time, which the way takes.
        let step = 1.0 / f64::from(steps);
        let start = vec3(LENGTH, 0.0, 0.0);
        let mut history = History::unloaded(vec3(1.0, 0.0, 0.0));
        let mut orientations = [Quaternion::identity(); 2];
        let mut ends = resting(start);
        (ends.first.angular_velocity, ends.second.angular_velocity) = (first * rate, second * rate);
        ends.second.velocity = way * (rate * LENGTH);
        let mut loads = None;
        for k in 1..=steps {
            ends.offset = start + ends.second.velocity * (step * f64::from(k));
            for (orientation, spin) in orientations.iter_mut().zip([first, second]) {
                *orientation = orientation.turned(spin * rate, step);
            }
            let rest = Rest { length: LENGTH, growth: 0.0 };
            let advance = Advance { earlier: history, rest, step };
            let (next, incremental) = bond::respond_incremental(Tension::Stored, Damping::Off, &ends, &advance, &bond);
            history = next;
            let posture = Posture { first_orientation: orientations[0], ..posture(orientations[1]) };
            let total = bond::respond_total(Damping::Off, &ends, &posture, &bond);
            loads = Some((incremental, total));
        }
        let (incremental, total) = loads.unwrap();
        let forces = size(incremental.force - total.force) / size(total.force);
        forces.max(size(incremental.first_moment - total.first_moment) / size(total.first_moment))
    };
    let (small, smaller) = (difference(1e-3), difference(1e-5));
    assert!(small < 2e-3 && smaller < 2e-5, "{small} {smaller}");
    assert!((50.0..200.0).contains(&(small / smaller)), "first order: {small} {smaller}");
}

#[test]
fn a_bond_breaks_just_above_its_strength_and_says_how() {
    let strong = Cement { tensile_strength: 5e6, shear_strength: 8e6, ..CEMENT };
    let section = section();
    let per_area = stiffness_per_area(YOUNG_MODULUS, LENGTH);
    let shear_per_area = strong.stiffness_ratio * per_area;
    let none = Quaternion::identity();
    let along = |u: f64| respond(vec3(LENGTH + u, 0.0, 0.0), none, &bond(&strong));
    let across = |u: f64| respond(vec3(LENGTH, u, 0.0), none, &bond(&strong));
    let twist = |angle: f64| respond(vec3(LENGTH, 0.0, 0.0), about(vec3(1.0, 0.0, 0.0), angle), &bond(&strong));
    let bend = |angle: f64| respond(vec3(LENGTH, 0.0, 0.0), about(vec3(0.0, 1.0, 0.0), angle), &bond(&strong));
    let breaks = |load: &dyn Fn(f64) -> Reaction<f64>, limit: f64, how: Failure| {
        for (factor, expected) in [(1.0 - 1e-4, None), (1.0 + 1e-4, Some(how))] {
            assert_eq!(Failure::of_code(load(limit * factor).failure), expected, "{factor} of {limit}");
        }
    };
    breaks(&along, strong.tensile_strength / per_area, Failure::Tension);
    breaks(&across, strong.shear_strength / shear_per_area, Failure::Shear);
    breaks(&twist, strong.shear_strength / (section.radius * shear_per_area), Failure::Shear);
    // Bending with a fixed chord also shears, by the arm of the second body; strong shear leaves it to tension.
    let strong = Cement { shear_strength: f64::INFINITY, ..strong };
    breaks(&bend, strong.tensile_strength / (section.radius * per_area), Failure::Tension);
    assert_eq!(along(-0.1 * LENGTH).failure, 0.0, "pressure alone breaks nothing");

    // Half the moment's part, twice the angle.
    let softer = Cement { moment_contribution: 0.5, ..strong };
    let bend = |angle: f64| respond(vec3(LENGTH, 0.0, 0.0), about(vec3(0.0, 1.0, 0.0), angle), &bond(&softer));
    breaks(&bend, 2.0 * strong.tensile_strength / (section.radius * per_area), Failure::Tension);

    let weak = bond(&strong).with_strength_times(0.5);
    assert_eq!(weak.tensile_strength, 2.5e6);
}

#[test]
fn pressure_raises_the_shear_strength_of_mohr_and_coulomb() {
    let rubbing = Cement { shear_strength: 2e6, internal_friction: 0.5, ..CEMENT };
    let bond = bond(&rubbing);
    let per_area = stiffness_per_area(YOUNG_MODULUS, LENGTH);
    for axial_stress in [-4e6, -1e6, 0.0, 1e6] {
        let limit = 2e6 - 0.5 * axial_stress;
        for (factor, breaks) in [(0.999, false), (1.001, true)] {
            let shear = factor * limit / (0.4 * per_area);
            // The length that gives the axial stress, sheared at that length.
            let length = LENGTH + axial_stress / per_area;
            let offset = vec3((length * length - shear * shear).sqrt(), shear, 0.0);
            let reaction = respond(offset, Quaternion::identity(), &bond);
            assert!((reaction.stress.axial - axial_stress).abs() < 10.0);
            assert_eq!(Failure::of_code(reaction.failure), breaks.then_some(Failure::Shear), "{axial_stress} {factor}");
        }
    }
}

#[test]
fn heat_moves_the_length_without_force() {
    let bond = bond(&CEMENT);
    let strain = link(RADII, [12e-6, 8e-6]).free_strain(80.0, 120.0);
    let warm = Posture { free_strain: strain, ..posture(Quaternion::identity()) };
    let respond = |length: f64| bond::respond_total(Damping::Off, &resting(vec3(length, 0.0, 0.0)), &warm, &bond);
    let free = respond(LENGTH * (1.0 + strain));
    assert!(free.force.x.abs() < 1e-15 * bond.stiffness.normal * LENGTH);
    // Held: every bond pushes with K_n L_0 alpha dT.
    close(respond(LENGTH).force.x, -bond.stiffness.normal * LENGTH * strain, 1e-12);

    // The stored normal force sees the same.
    let history = History::unloaded(vec3(1.0, 0.0, 0.0));
    let advance = Advance { earlier: history, rest: Rest::of(LENGTH, strain, 0.0), step: 1e-6 };
    let ends = resting(vec3(LENGTH, 0.0, 0.0));
    for tension in [Tension::FromLength, Tension::Stored] {
        let (_, held) = bond::respond_incremental(tension, Damping::Off, &ends, &advance, &bond);
        close(held.force.x, -bond.stiffness.normal * LENGTH * strain, 1e-12);
    }
}

/// Two bodies under velocity Verlet.
struct Pair {
    bodies: [Sphere<f64>; 2],
    orientations: [Quaternion<f64>; 2],
    reaction: Reaction<f64>,
    bond: Bond<f64>,
    damping: Damping,
    lost: f64,
}

impl Pair {
    fn new(bond: Bond<f64>, damping: Damping, motion: [[Vec3<f64>; 2]; 2]) -> Pair {
        let mut bodies = RADII.map(sphere);
        bodies[1].position = vec3(LENGTH, 0.0, 0.0);
        for (body, [velocity, spin]) in bodies.iter_mut().zip(motion) {
            (body.velocity, body.angular_velocity) = (velocity, spin);
        }
        let orientations = [Quaternion::identity(); 2];
        let ends = Ends { first: bodies[0], second: bodies[1], offset: bodies[1].position, lead: 0.0 };
        let reaction = bond::respond_total(damping, &ends, &posture(orientations[1]), &bond);
        Pair { bodies, orientations, reaction, bond, damping, lost: 0.0 }
    }
    fn ends(&self) -> Ends<f64> {
        let [first, second] = self.bodies;
        Ends { first, second, offset: second.position - first.position, lead: 0.0 }
    }
    fn kick(&mut self, half: f64) {
        let r = &self.reaction;
        let forces = [(r.force, r.first_moment), (-r.force, r.second_moment)];
        for (body, (force, moment)) in self.bodies.iter_mut().zip(forces) {
            body.velocity = verlet::kick(body.velocity, force, body.mass, half);
            let inertia = sphere_inertia(body.mass, body.radius);
            body.angular_velocity = verlet::kick(body.angular_velocity, moment, inertia, half);
        }
    }
    fn step(&mut self, dt: f64) {
        self.kick(0.5 * dt);
        for (body, orientation) in self.bodies.iter_mut().zip(&mut self.orientations) {
            body.position = verlet::drift(body.position, body.velocity, dt);
            *orientation = orientation.turned(body.angular_velocity, dt);
        }
        let ends = self.ends();
        let posture = Posture { first_orientation: self.orientations[0], ..posture(self.orientations[1]) };
        self.reaction = bond::respond_total(self.damping, &ends, &posture, &self.bond);
        self.kick(0.5 * dt);
        if self.damping == Damping::Viscous {
            self.lost += damping::loss(&ends, &self.ends(), &self.bond, dt);
        }
    }
    fn energy(&self) -> f64 {
        let kinetic = self.bodies.iter().map(|b| {
            let inertia = sphere_inertia(b.mass, b.radius);
            0.5 * (b.mass * b.velocity.dot(b.velocity) + inertia * b.angular_velocity.dot(b.angular_velocity))
        });
        kinetic.sum::<f64>() + bond::stored_energy(&self.reaction.load, &self.bond)
    }
    fn angular_momentum(&self) -> Vec3<f64> {
        self.bodies.iter().fold(Vec3::zero(), |sum, b| {
            let inertia = sphere_inertia(b.mass, b.radius);
            sum + b.position.cross(b.velocity) * b.mass + b.angular_velocity * inertia
        })
    }
}

#[test]
fn a_pair_vibrates_at_the_root_of_stiffness_over_effective_mass() {
    let bond = bond(&CEMENT);
    let still = [Vec3::zero(); 2];
    let mut pair = Pair::new(bond, Damping::Off, [still, [vec3(1e-3, 0.0, 0.0), Vec3::zero()]]);
    let [m1, m2] = RADII.map(|radius| sphere(radius).mass);
    let omega = (bond.stiffness.normal / (m1 * m2 / (m1 + m2))).sqrt();
    let dt = 2.0 * PI / omega / 1000.0;
    for _ in 0..1000 {
        pair.step(dt);
    }
    // Verlet's period is shorter by (omega dt)^2 / 24.
    assert!(pair.reaction.load.normal.abs() < 1e-3 * bond.stiffness.normal * 1e-3 / omega);
    close(pair.bodies[1].velocity.x - pair.bodies[0].velocity.x, 1e-3, 1e-4);
}

#[test]
fn a_tumbling_pair_keeps_energy_and_angular_momentum() {
    let motion =
        [[vec3(0.02, -0.05, 0.01), vec3(30.0, -20.0, 10.0)], [vec3(-0.01, 0.04, 0.03), vec3(-10.0, 25.0, 40.0)]];
    let run = |damping: Damping, steps: u32| {
        let bond = bond(&Cement { damping_ratio: 0.1, ..CEMENT });
        let mut pair = Pair::new(bond, damping, motion);
        let (energy, momentum) = (pair.energy(), pair.angular_momentum());
        let dt = 2e-4 / f64::from(steps);
        let mut worst = 0.0_f64;
        for _ in 0..steps {
            pair.step(dt);
            worst = worst.max((pair.energy() + pair.lost - energy).abs() / energy);
        }
        assert!(size(pair.angular_momentum() - momentum) < 1e-11 * size(momentum));
        (worst, pair.lost / energy)
    };
    // Elastic: second order in the step.
    let ((coarse, _), (fine, _)) = (run(Damping::Off, 2000), run(Damping::Off, 8000));
    assert!(fine < 2e-4 && (12.0..20.0).contains(&(coarse / fine)), "{coarse} {fine}");
    // Damped: half a step's loss is missing at the start and too much at the end.
    let ((coarse, lost), (fine, _)) = (run(Damping::Viscous, 2000), run(Damping::Viscous, 8000));
    assert!(lost > 0.2, "the relative motion is damped away: {lost}");
    assert!(fine < 3e-3 && (3.5..4.5).contains(&(coarse / fine)), "{coarse} {fine}");
}

#[test]
fn stored_energy_is_the_work_of_loading() {
    let bond = bond(&CEMENT);
    let deformation =
        Modes { normal: 1e-7, shear: vec3(0.0, 2e-7, -1e-7), torsion: 1e-4, bending: vec3(0.0, 3e-5, 1e-5) };
    let load = deformation.times(&bond.stiffness);
    close(bond::stored_energy(&load, &bond), 0.5 * load.dot(&deformation), 1e-14);
    let slack = self::bond(&Cement { stiffness_ratio: 0.0, ..CEMENT });
    let load = deformation.times(&slack.stiffness);
    close(bond::stored_energy(&load, &slack), 0.5 * load.dot(&deformation), 1e-14);
}

#[test]
fn a_pair_alone_has_the_damping_ratio_of_its_bond() {
    let ratio = 0.1;
    let bond = bond(&Cement { damping_ratio: ratio, ..CEMENT });
    let mut ends = resting(vec3(LENGTH, 0.0, 0.0));
    ends.second.velocity = vec3(0.3, 0.0, 0.0);
    ends.second.angular_velocity = vec3(2.0, 0.0, 0.0);
    let load = damping::load(&Axis::of(&ends).motion(&ends), &bond);
    let eff = |a: f64, b: f64| a * b / (a + b);
    let [m1, m2] = [ends.first.mass, ends.second.mass];
    let [i1, i2] = [ends.first, ends.second].map(|s| sphere_inertia(s.mass, s.radius));
    close(load.normal, 2.0 * ratio * (eff(m1, m2) * bond.stiffness.normal).sqrt() * 0.3, 1e-14);
    close(load.torsion, 2.0 * ratio * (eff(i1, i2) * bond.stiffness.torsion).sqrt() * 2.0, 1e-14);
}
