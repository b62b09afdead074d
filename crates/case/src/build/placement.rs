//! Whether particles are where they may be: inside the domain, in front of the walls, clear of each other.

use super::Context;
use super::draft::Draft;
use crate::codes;
use crate::grid::Grid;
use crate::limits::Found;
use crate::problem::{Problem, counted, number};
use rayon::prelude::*;
use std::collections::BTreeMap;
use tdem_engine::physics::Vec3;
use tdem_engine::{Bond, Domain, Plan, State};

/// Overlap at the start that counts as touching, as a fraction of the smaller radius.
const TOUCHING: f64 = 1e-6;

/// A point of a domain, taken back into it in directions that repeat.
pub(super) fn wrapped(domain: &Domain, point: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|k| {
        if !domain.periodic[k] {
            return point[k];
        }
        let length = domain.max[k] - domain.min[k];
        let inside = point[k] - length * ((point[k] - domain.min[k]) / length).floor();
        // Rounding may put a point just below the lower face on the upper one, which belongs to the next image.
        if inside >= domain.max[k] { domain.min[k] } else { inside.max(domain.min[k]) }
    })
}

/// Wraps all particles and finds those that are in wrong places.
pub(super) fn check(context: &Context<'_>, draft: &mut Draft) -> Vec<Problem> {
    let domain = &context.domain;
    let points = draft.state.position.iter_mut().chain(&mut draft.state.bonded_position);
    points.for_each(|point| *point = wrapped(domain, *point));
    let mut problems = outside(context, draft);
    if problems.is_empty() {
        problems.extend(walls(context, draft));
        problems.extend(overlaps(context, draft));
    }
    problems
}

/// Particles whose centres are outside the domain, one problem per group.
fn outside(context: &Context<'_>, draft: &Draft) -> Vec<Problem> {
    let domain = &context.domain;
    let mut found: BTreeMap<u16, (usize, usize)> = BTreeMap::new();
    for (k, point) in draft.state.position.iter().enumerate() {
        let inside = (0..3).all(|d| domain.periodic[d] || (domain.min[d] <= point[d] && point[d] <= domain.max[d]));
        if !inside {
            found.entry(draft.group[k]).or_insert((0, k)).0 += 1;
        }
    }
    found
        .into_iter()
        .map(|(group, (count, first))| {
            let [x, y, z] = draft.state.position[first];
            Problem::new(
                codes::OUTSIDE_DOMAIN,
                format!(
                    "{} outside the domain: id {} at [{}, {}, {}] m",
                    counted(count, "particle"),
                    draft.state.id[first],
                    number(x),
                    number(y),
                    number(z)
                ),
            )
            .at(source_place(context, usize::from(group)), "these particles")
            .at(context.loaded.tree.place(&["domain"]), "must be in here")
            .help("move them or enlarge the domain; centres must be inside")
        })
        .collect()
}

/// Particles that reach through a wall, one problem per group and wall.
fn walls(context: &Context<'_>, draft: &Draft) -> Vec<Problem> {
    struct Worst {
        count: usize,
        particle: usize,
        depth: f64,
    }
    let allowed: Vec<bool> =
        context.loaded.case.particles.iter().map(|group| group.allow_overlap || group.run.is_some()).collect();
    let most = context.loaded.case.contact.overlap_limit.get();
    let mut found: BTreeMap<(u16, usize), Worst> = BTreeMap::new();
    for (k, &point) in draft.state.position.iter().enumerate() {
        let radius = draft.state.radius[k];
        for (w, plane) in context.planes.iter().enumerate() {
            let distance = plane.distance(point);
            // Even where overlap is allowed, one beyond the limit would stop the run at its first step.
            let allowed = if allowed[usize::from(draft.group[k])] { most } else { TOUCHING };
            let limit = radius * (1.0 - allowed);
            if distance < limit {
                let depth = radius - distance;
                let worst = found.entry((draft.group[k], w)).or_insert(Worst {
                    count: 0,
                    particle: k,
                    depth: f64::NEG_INFINITY,
                });
                worst.count += 1;
                if depth > worst.depth {
                    (worst.particle, worst.depth) = (k, depth);
                }
            }
        }
    }
    found
        .into_iter()
        .map(|((group, w), worst)| {
            let plane = &context.planes[w];
            let (id, radius) = (draft.state.id[worst.particle], draft.state.radius[worst.particle]);
            Problem::new(
                codes::THROUGH_WALL,
                format!(
                    "{} through wall `{}`: id {id} reaches {} m behind it, {} of its radius",
                    counted(worst.count, "particle"),
                    plane.wall.name,
                    number(worst.depth),
                    number(worst.depth / radius)
                ),
            )
            .at(source_place(context, usize::from(group)), "these particles")
            .at(plane.span.clone(), "this wall")
            .help("move them away, or set allow_overlap = true for the group, which allows as much as contact.overlap_limit")
        })
        .collect()
}

/// A pair that overlaps: by how much of a radius, and its indices.
#[derive(Clone, Copy)]
struct Pair {
    ratio: f64,
    first: usize,
    second: usize,
}

/// Pairs that overlap at the start: how many, and the worst.
fn overlaps(context: &Context<'_>, draft: &Draft) -> Option<Problem> {
    let groups = &context.loaded.case.particles;
    if groups.iter().all(|group| group.allow_overlap) {
        return None;
    }
    let exempt = |a: usize, b: usize| {
        let (a, b) = (usize::from(draft.group[a]), usize::from(draft.group[b]));
        // Particles of one run overlap as they did there, also if several groups take them.
        let run = |group: usize| groups[group].run.as_ref().map(|run| (&run.directory, run.offset));
        groups[a].allow_overlap || groups[b].allow_overlap || (run(a).is_some() && run(a) == run(b))
    };
    let state = &draft.state;
    let ratio = |first: usize, second: usize, overlap: f64| {
        let ratio = overlap / state.radius[first].min(state.radius[second]);
        (ratio > TOUCHING && !exempt(first, second)).then_some(ratio)
    };
    let (pairs, worst) = worst(&context.domain, state, ratio)?;
    let (a, b) = (worst.first, worst.second);
    let depth = worst.ratio * state.radius[a].min(state.radius[b]);
    let message = format!(
        "{} overlapping at the start; the worst, ids {} and {}, by {} m, {} of the smaller radius",
        counted(pairs, "pair"),
        state.id[a],
        state.id[b],
        number(depth),
        number(worst.ratio)
    );
    let problem = Problem::new(codes::OVERLAP, message);
    Some(
        both(context, draft, problem, [a, b])
            .help("move them apart; or set allow_overlap = true for the group and expect them to fly apart"),
    )
}

/// Pairs that would stop the run at its first step: where overlap is allowed, but not so much. `bonds` are all there are.
pub(super) fn beyond_limit(context: &Context<'_>, draft: &Draft, plan: &Plan, bonds: &[Bond]) -> Option<Problem> {
    let groups = &context.loaded.case.particles;
    if groups.iter().all(|group| !group.allow_overlap && group.run.is_none()) {
        return None;
    }
    let state = &draft.state;
    let held: Vec<bool> = (0..plan.constraints.len()).map(|k| plan.holds(k)).collect();
    let is_held = |index: usize| held[usize::from(state.constraint[index])];
    let ratio = |first: usize, second: usize, overlap: f64| {
        let ratio = overlap / state.radius[first].min(state.radius[second]);
        (ratio > plan.overlap_limit && !(is_held(first) && is_held(second))).then_some(ratio)
    };
    let mut found = worst(&context.domain, state, ratio)?;
    if plan.bonds.as_ref().is_some_and(|bonds| !bonds.contact_in_bonded_pairs) {
        // Bonds that hold keep contact off.
        let carried = draft.carried.iter().map(|(bond, _)| bond);
        let mut bonded: Vec<[u32; 2]> = bonds.iter().chain(carried).map(|bond| [bond.first, bond.second]).collect();
        bonded.sort_unstable();
        let free = |first: usize, second: usize| {
            let mut ids = [state.id[first], state.id[second]];
            ids.sort_unstable();
            bonded.binary_search(&ids).is_err()
        };
        found = worst(&context.domain, state, |first, second, overlap| {
            ratio(first, second, overlap).filter(|_| free(first, second))
        })?;
    }
    let (pairs, Pair { ratio, first, second }) = found;
    let limit = number(plan.overlap_limit);
    let message = format!(
        "{} overlapping by more than {limit} of the smaller radius at the start, which stops a run; the worst, ids {} and {}, by {}",
        counted(pairs, "pair"),
        state.id[first],
        state.id[second],
        number(ratio)
    );
    let mut problem = both(context, draft, Problem::new(codes::OVERLAP_LIMIT, message), [first, second]);
    if let Some(limit) = context.loaded.tree.get(&["contact", "overlap_limit"]) {
        problem = problem.at(limit.span.clone(), "the limit");
    }
    Some(problem.help("move them apart; only particles that are all fixed in all components may overlap more"))
}

/// A problem of two particles, with the places that they come from.
fn both(context: &Context<'_>, draft: &Draft, problem: Problem, pair: [usize; 2]) -> Problem {
    let [first, second] = pair.map(|index| usize::from(draft.group[index]));
    let problem = problem.at(source_place(context, second), "one of them");
    if first == second { problem } else { problem.at(source_place(context, first), "the other") }
}

/// Pairs that overlap: how many have a ratio, which is asked for indices and overlap in m, and the worst of them.
fn worst(
    domain: &Domain,
    state: &State,
    ratio: impl Fn(usize, usize, f64) -> Option<f64> + Sync,
) -> Option<(usize, Pair)> {
    let count = state.len();
    let mut bounds = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
    for point in &state.position {
        for k in 0..3 {
            bounds[0][k] = bounds[0][k].min(point[k]);
            bounds[1][k] = bounds[1][k].max(point[k]);
        }
    }
    let largest = state.radius.iter().copied().fold(0.0, f64::max);
    let mut grid = Grid::new(domain, bounds[0], bounds[1], 2.0 * largest, count);
    state.position.iter().for_each(|&point| grid.push(point));
    let period = domain.period();
    let of_particle = |first: usize| {
        let here: Vec3<f64> = state.position[first].into();
        let mut found = (0_usize, Pair { ratio: 0.0, first, second: first });
        grid.any_near(state.position[first], |second| {
            if second <= first {
                return false;
            }
            let offset = period.nearest(Vec3::from(state.position[second]) - here);
            let reach = state.radius[first] + state.radius[second];
            let squared = offset.dot(offset);
            if squared < reach * reach
                && let Some(ratio) = ratio(first, second, reach - squared.sqrt())
            {
                found.0 += 1;
                if ratio > found.1.ratio {
                    found.1 = Pair { ratio, first, second };
                }
            }
            false
        });
        found
    };
    // The larger overlap wins, then the earlier pair, so that the message does not depend on threads.
    let worse = |a: Pair, b: Pair| {
        if b.ratio > a.ratio || (b.ratio == a.ratio && (b.first, b.second) < (a.first, a.second)) { b } else { a }
    };
    let (pairs, worst) = (0..count)
        .into_par_iter()
        .with_min_len(1024)
        .map(of_particle)
        .reduce(|| (0, Pair { ratio: 0.0, first: 0, second: 0 }), |a, b| (a.0 + b.0, worse(a.1, b.1)));
    (pairs > 0).then_some((pairs, worst))
}

/// The table that says where particles of a group come from.
fn source_place(context: &Context<'_>, group: usize) -> std::ops::Range<usize> {
    let of = &context.loaded.case.particles[group];
    let key = if of.lattice.is_some() {
        "lattice"
    } else if of.random.is_some() {
        "random"
    } else if of.csv.is_some() {
        "csv"
    } else if of.run.is_some() {
        "run"
    } else {
        "list"
    };
    context.place(group, &[key])
}

/// A particle must not meet another one, nor itself, on both sides at once.
pub(super) fn period_is_wide_enough(context: &Context<'_>, found: &Found, problems: &mut Vec<Problem>) -> bool {
    let skin = context.loaded.case.search.skin.get() * found.smallest_radius();
    let least = 2.0 * (2.0 * found.largest_radius + skin);
    let length = context.domain.length();
    let before = problems.len();
    for (k, axis) in ["x", "y", "z"].into_iter().enumerate() {
        if context.domain.periodic[k] && length[k] < least {
            problems.push(
                Problem::new(
                    codes::PERIOD_TOO_SHORT,
                    format!(
                        "the domain repeats in {axis} after {} m, but must be at least {} m long",
                        length[k],
                        number(least)
                    ),
                )
                .at(context.loaded.tree.place(&["domain", "max"]), format!("too close to min in {axis}"))
                .at(
                    context.radius_place(found.largest_group),
                    format!("radius {} m sets the limit", found.largest_radius),
                )
                .help("a repeating direction holds at least two of the largest diameters and the search's skin twice"),
            );
        }
    }
    problems.len() == before
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_are_taken_back_into_the_domain() {
        let domain = Domain { min: [-1.0, 0.0, 0.0], max: [1.0, 1.0, 1.0], periodic: [true, true, false] };
        assert_eq!(wrapped(&domain, [1.0, 1.5, 7.0]), [-1.0, 0.5, 7.0]);
        assert_eq!(wrapped(&domain, [-1.25, -1e-20, -1.0]), [0.75, 0.0, -1.0]);
    }
}
