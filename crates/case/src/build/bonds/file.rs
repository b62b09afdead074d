//! Bonds from a table in a file.

use super::super::Context;
use super::super::draft::Draft;
use super::Given;
use crate::codes;
use crate::problem::Problem;
use crate::schema::RunBonds;
use crate::table;
use std::collections::{BTreeMap, HashMap};

/// Problems of one file that are shown.
const SHOWN: usize = 5;

/// Indices of the particles of each bond.
pub(super) fn read(
    context: &Context<'_>,
    draft: &Draft,
    given: &Given,
    file: &str,
) -> Result<Vec<[u32; 2]>, Vec<Problem>> {
    let path = context.loaded.file(file);
    let name = path.display().to_string();
    let here = context.loaded.tree.place(&["bonds", "file"]);
    let problem = |code, message: String, help: &str| {
        Problem::new(code, message).at(here.clone(), "in this file").help(help.to_owned())
    };
    let text = table::read(&path).map_err(|error| {
        let help = "paths are relative to the folder of the case";
        vec![problem(codes::CSV_UNREADABLE, format!("cannot read {name}: {error}"), help)]
    })?;
    let state = &draft.state;
    let index_of: HashMap<u32, u32> = state.id.iter().zip(0..).map(|(&id, index)| (id, index)).collect();
    let mut lines = table::lines(&text);
    let header = lines.next().map_or("", |(_, header)| header);
    if header.split(',').map(str::trim).ne(["first", "second"]) {
        let help = "the first line is first,second; each row after it holds the ids of two particles";
        return Err(vec![problem(codes::CSV_COLUMN, format!("{name}: the header is `{header}`"), help)]);
    }
    let mut seen: BTreeMap<[u32; 2], usize> = BTreeMap::new();
    let mut pairs = Vec::new();
    let mut problems = Vec::new();
    for (line, row) in lines {
        let one = |code, what: String, help: &str| problem(code, format!("{name}:{line}: {what}"), help);
        let ids: Option<Vec<u32>> = row.split(',').map(|field| field.trim().parse().ok()).collect();
        let Some([first, second]) = ids.as_deref() else {
            problems.push(one(codes::CSV_VALUE, format!("`{row}` is not two ids"), "ids are whole numbers"));
            continue;
        };
        let mut ids = [*first, *second];
        ids.sort_unstable();
        if ids[0] == ids[1] {
            let what = format!("particle {first} cannot be bonded to itself");
            problems.push(one(codes::BOND_FILE, what, "name two particles"));
            continue;
        }
        if let Some(earlier) = seen.insert(ids, line) {
            let what = format!("{first} and {second} are bonded twice, first in line {earlier}");
            problems.push(one(codes::BOND_FILE, what, "keep one of the lines"));
            continue;
        }
        let [Some(first), Some(second)] = ids.map(|id| index_of.get(&id).copied()) else {
            let missing: Vec<String> =
                ids.iter().filter(|id| !index_of.contains_key(id)).map(ToString::to_string).collect();
            let what = format!("there is no particle {}", missing.join(" and "));
            problems.push(one(codes::BOND_FILE, what, "ids count from 0, in the order of the groups"));
            continue;
        };
        if given.entry(state, [first as usize, second as usize]).is_none() {
            let [a, b] =
                [first, second].map(|index| &context.materials.names[usize::from(state.material[index as usize])]);
            let help = format!("add a [[bond]] with between = [\"{a}\", \"{b}\"]");
            problems.push(one(codes::MISSING_BOND, format!("nothing says how `{a}` and `{b}` are bonded"), &help));
            continue;
        }
        let carries = |index: u32| {
            let group = &context.loaded.case.particles[usize::from(draft.group[index as usize])];
            group.run.as_ref().is_some_and(|run| run.bonds == RunBonds::Carry)
        };
        if carries(first) || carries(second) {
            let what = format!("{} and {} cannot be bonded: the bonds of another run go on", ids[0], ids[1]);
            let help = "bond them in that run, or take its particles with bonds = \"anew\"";
            problems.push(one(codes::BOND_FILE, what, help));
            continue;
        }
        pairs.push([first, second]);
    }
    if table::is_cut_off(&text) {
        let message = format!("{name} does not end with a line break: its last line may be cut off");
        problems.push(problem(codes::CSV_TRUNCATED, message, "write the file again"));
    }
    let more = problems.len().saturating_sub(SHOWN);
    problems.truncate(SHOWN);
    if let (Some(last), 1..) = (problems.last_mut(), more) {
        last.message = format!("{} (and {more} more problems in this file)", last.message);
    }
    if problems.is_empty() { Ok(pairs) } else { Err(problems) }
}
