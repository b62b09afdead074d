//! Transfer of contact histories: friction springs of another run, by the ids of its particles and the names of its walls.

use super::Context;
use crate::codes;
use crate::problem::Problem;
use crate::schema::RunContacts;
use std::collections::{BTreeMap, HashSet};
use tdem_engine::physics::contact::{Friction, Interaction};
use tdem_engine::{Contact, Evaluated, Plan, State, WallContact};

/// Contact histories of the particles that a group takes from another run.
#[derive(Clone, Debug, Default)]
pub(super) struct Histories {
    pub(super) pairs: Vec<Contact>,
    /// Their walls are those of that run.
    pub(super) walls: Vec<WallContact>,
    /// Names of the walls of that run.
    pub(super) names: Vec<String>,
    /// Contacts of which the group takes one particle: another group may take the other.
    halves: Vec<Half>,
}

/// A contact of which a group takes one particle.
#[derive(Clone, Copy, Debug)]
struct Half {
    /// Ids in that run, the lower first.
    pair: [u32; 2],
    /// Which of them the group takes: 0 or 1.
    end: usize,
    /// Its id here.
    id: u32,
    displacement: [f64; 3],
}

impl Histories {
    pub(super) fn new(pairs: Vec<Contact>, walls: Vec<WallContact>, names: Vec<String>) -> Self {
        Histories { pairs, walls, names, halves: Vec::new() }
    }

    /// Those between particles that are left, and of these with walls.
    pub(super) fn kept(mut self, left: &HashSet<u32>) -> Self {
        self.halves.retain(|half| left.contains(&half.id));
        for contact in &self.pairs {
            let pair = [contact.first, contact.second];
            let end = match pair.map(|id| left.contains(&id)) {
                [true, false] => 0,
                [false, true] => 1,
                _ => continue,
            };
            self.halves.push(Half { pair, end, id: pair[end], displacement: contact.displacement });
        }
        self.pairs.retain(|contact| left.contains(&contact.first) && left.contains(&contact.second));
        self.walls.retain(|contact| left.contains(&contact.particle));
        self
    }

    /// The same with other ids.
    pub(super) fn renumbered(mut self, new: impl Fn(u32) -> u32) -> Self {
        for contact in &mut self.pairs {
            (contact.first, contact.second) = (new(contact.first), new(contact.second));
        }
        self.walls.iter_mut().for_each(|contact| contact.particle = new(contact.particle));
        self.halves.iter_mut().for_each(|half| half.id = new(half.id));
        self
    }
}

/// Whether a friction spring is stretched.
pub(super) fn loaded(displacement: [f64; 3]) -> bool {
    displacement != [0.0; 3]
}

/// Gives a state, in the order of its ids, the histories that go on in each group; returns what is dropped.
pub(super) fn transfer(
    context: &Context<'_>,
    groups: Vec<(u16, Histories)>,
    plan: &Plan,
    state: &mut State,
) -> Vec<Problem> {
    if plan.law.friction == Friction::Off {
        return Vec::new();
    }
    let mut problems = Vec::new();
    let mut halves: BTreeMap<(String, [u64; 3], [u32; 2]), Half> = BTreeMap::new();
    for (group, mut histories) in groups {
        let group = usize::from(group);
        if let Some(run) = context.loaded.case.particles[group].run.as_ref() {
            for half in std::mem::take(&mut histories.halves) {
                let key = (run.directory.clone(), run.offset.map(f64::to_bits), half.pair);
                if let Some(other) = halves.insert(key, half).filter(|other| other.end != half.end) {
                    histories.pairs.push(joined(half, other));
                }
            }
        }
        match context.loaded.case.particles[group].run.as_ref().and_then(|run| run.contacts) {
            Some(RunContacts::Anew) => {}
            None => problems.extend(forgotten(context, group, &histories)),
            Some(RunContacts::Carry) => problems.extend(carry(context, group, histories, plan, state)),
        }
    }
    state.contacts.sort_unstable_by_key(|contact| (contact.first, contact.second));
    state.wall_contacts.sort_unstable_by_key(|contact| (contact.particle, contact.wall));
    problems
}

/// A contact of two groups that take one particle each.
fn joined(one: Half, other: Half) -> Contact {
    let [first, second] = if one.end == 0 { [one.id, other.id] } else { [other.id, one.id] };
    if first < second {
        return Contact { first, second, displacement: one.displacement };
    }
    // Seen from its other side.
    Contact { first: second, second: first, displacement: one.displacement.map(|x| -x) }
}

/// The histories that a group loses because it does not say what becomes of them.
fn forgotten(context: &Context<'_>, group: usize, histories: &Histories) -> Option<Problem> {
    let pairs = histories.pairs.iter().filter(|contact| loaded(contact.displacement)).count();
    let walls = histories.walls.iter().filter(|contact| loaded(contact.displacement)).count();
    let message = format!(
        "{} of that run dropped, {pairs} between particles and {walls} with walls: what friction held starts to slip",
        counted_histories(pairs + walls)
    );
    (pairs + walls > 0).then(|| {
        Problem::new(codes::RUN_HISTORIES, message)
            .at(context.place(group, &["run"]), "does not say what becomes of them")
            .help("add contacts = \"carry\" to transfer them, or contacts = \"anew\" to start without them")
    })
}

/// Adds the histories of contacts that are closed here and have friction; returns what is dropped.
fn carry(context: &Context<'_>, group: usize, histories: Histories, plan: &Plan, state: &mut State) -> Option<Problem> {
    let rubs = |of: &Interaction<f64>| of.static_friction > 0.0 || of.dynamic_friction > 0.0;
    let mut opened = 0;
    let mut goes_on = |found: Option<Evaluated<'_>>, displacement: [f64; 3]| {
        let Some(found) = found.filter(|found| rubs(found.interaction)) else { return false };
        opened += usize::from(!found.touches() && loaded(displacement));
        found.touches()
    };
    let Histories { mut pairs, walls, names, .. } = histories;
    pairs.retain(|contact| goes_on(state.evaluate(plan, contact), contact.displacement));
    // The number of each wall of that run here.
    let here: Vec<Option<u32>> = names
        .iter()
        .map(|name| plan.walls.iter().position(|wall| wall.name == *name).map(|wall| wall as u32))
        .collect();
    let mut gone = vec![0_usize; names.len()];
    let mut at_walls = Vec::new();
    for contact in walls {
        let Some(wall) = here.get(contact.wall as usize).copied().flatten() else {
            if let Some(gone) = gone.get_mut(contact.wall as usize) {
                *gone += usize::from(loaded(contact.displacement));
            }
            continue;
        };
        let contact = WallContact { wall, ..contact };
        if goes_on(state.evaluate_at_wall(plan, &contact), contact.displacement) {
            at_walls.push(contact);
        }
    }
    state.contacts.extend(pairs);
    state.wall_contacts.extend(at_walls);

    let mut lost: Vec<String> = (names.iter().zip(&gone))
        .filter(|&(_, &count)| count > 0)
        .map(|(name, count)| format!("{count} at wall `{name}`, which this case does not have"))
        .collect();
    if opened > 0 {
        lost.push(format!("{opened} of contacts that are open here"));
    }
    let dropped = opened + gone.iter().sum::<usize>();
    (dropped > 0).then(|| {
        Problem::new(
            codes::RUN_HISTORIES,
            format!("{} of that run dropped: {}", counted_histories(dropped), lost.join(", ")),
        )
        .at(context.place(group, &["run", "contacts"]), "transfers the others")
        .help("walls are matched by name, and a wall that had moved must stand where that run left it")
    })
}

fn counted_histories(count: usize) -> String {
    if count == 1 { "1 contact history".to_owned() } else { format!("{count} contact histories") }
}
