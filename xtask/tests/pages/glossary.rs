//! `docs/glossary.md`: the words of case files and results, with symbols, units and the names that other programs have for them.
//!
//! Names of outputs and keys of the case file are compared with the program: each must exist, units of outputs must agree,
//! and all outputs and all physical keys must be in the glossary.

mod terms;

use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;
use tdem_results::glossary::{Entry, Place};
use terms::SECTIONS;

/// A word of the glossary.
struct Term {
    word: &'static str,
    /// Mathematical symbol, as in `docs/physics.md`; empty without.
    symbol: &'static str,
    unit: &'static str,
    /// Keys of the case file (`interaction.static_friction`) and outputs (`contacts:overlap`).
    names: &'static [&'static str],
    meaning: &'static str,
    /// Names in LAMMPS, PFC and LIGGGHTS; empty where there is none, or none is known for certain.
    elsewhere: [&'static str; 3],
}

/// Tables of the case file by the path that a case has for them, with their definitions in the schema, and whether the glossary
/// has all of their keys.
const TABLES: &[(&str, &str, bool)] = &[
    ("bond", "Joint", true),
    ("bond.lattice", "Solid", true),
    ("bond.micro", "Micro", true),
    ("bond.scatter", "Scatter", true),
    ("bonds", "Bonds", true),
    ("contact", "Contact", true),
    ("domain", "Domain", true),
    ("heat", "Heat", true),
    ("heat.relaxation", "Relaxation", true),
    ("interaction", "Interaction", true),
    ("material", "Material", true),
    ("output", "Output", false),
    ("particles", "Particles", false),
    ("search", "Search", true),
    ("surface", "Surface", true),
    ("surface.convection", "Convection", true),
    ("surface.radiation", "Radiation", true),
    ("symmetry", "Symmetry", true),
    ("time", "Time", true),
    ("wall", "Wall", true),
];

/// Keys that name other entries or files, or hold a table that has words of its own.
const WITHOUT_A_TERM: &[&str] = &[
    "bond.between",
    "bond.micro",
    "bond.scatter",
    "bonds.file",
    "heat.relaxation",
    "interaction.between",
    "surface.convection",
    "surface.name",
    "surface.of",
    "surface.radiation",
    "wall.material",
    "wall.name",
];

#[test]
fn the_glossary_is_up_to_date() {
    super::up_to_date("glossary.md", &page());
}

#[test]
fn every_name_of_the_glossary_exists() {
    let (keys, outputs) = (keys(|_| true), outputs());
    for term in all() {
        for name in term.names {
            let known = match outputs.get(*name) {
                Some(unit) => {
                    assert_eq!(*unit, term.unit, "unit of {name}, under {}", term.word);
                    true
                }
                None => keys.contains(*name),
            };
            assert!(known, "{name}, under {}, is neither an output nor a key", term.word);
        }
    }
}

#[test]
fn every_output_and_every_physical_key_is_in_the_glossary() {
    let named: BTreeSet<&str> = all().flat_map(|term| term.names.iter().copied()).collect();
    let outputs = outputs().into_keys();
    let physical = keys(|complete| complete).into_iter().filter(|key| !WITHOUT_A_TERM.contains(&key.as_str()));
    let missing: Vec<String> = outputs.chain(physical).filter(|name| !named.contains(name.as_str())).collect();
    assert!(missing.is_empty(), "the glossary lacks {missing:?}");
}

#[test]
fn no_name_and_no_word_is_in_the_glossary_twice() {
    let (mut words, mut names) = (BTreeSet::new(), BTreeSet::new());
    for term in all() {
        assert!(words.insert(term.word), "the word {} stands twice", term.word);
        for name in term.names {
            assert!(names.insert(name), "the name {name} stands twice");
        }
    }
}

fn all() -> impl Iterator<Item = &'static Term> {
    SECTIONS.iter().flat_map(|(_, terms)| terms.iter())
}

/// Keys of the case file by path; of tables whose keys the glossary has all, or of all of [`TABLES`] and the top level.
fn keys(wanted: impl Fn(bool) -> bool) -> BTreeSet<String> {
    let schema = tdem_case::json_schema();
    let properties = |definition: &Value| -> Vec<String> {
        let properties = definition["properties"].as_object().expect("a table has properties");
        properties.keys().cloned().collect()
    };
    let mut keys = BTreeSet::new();
    for (path, definition, complete) in TABLES {
        if wanted(*complete) {
            keys.extend(properties(&schema["$defs"][*definition]).iter().map(|key| format!("{path}.{key}")));
        }
    }
    if wanted(false) {
        keys.extend(properties(&schema));
    }
    keys
}

/// Outputs as `place:name`, with their units.
fn outputs() -> BTreeMap<String, &'static str> {
    let mut outputs = BTreeMap::new();
    for place in Place::ALL {
        let of_gauges = place.of_gauges().concat();
        let entries = place.entries().into_iter().chain(place.with_bonds()).chain(place.with_heat()).chain(of_gauges);
        outputs.extend(entries.map(|Entry { name, unit, .. }| (format!("{}:{name}", place.name()), unit)));
    }
    outputs
}

fn page() -> String {
    let mut page = String::from(
        "# Glossary\n\n\
         <!-- Generated by `cargo xtask docs` from xtask/tests/pages/glossary/terms.rs. -->\n\n\
         Words of case files and results with symbol, SI unit and meaning, and their names in LAMMPS (package GRANULAR, \
         `pair_style granular`, and package BPM), PFC (6 and later) and LIGGGHTS (public version 3). Unit 1 is a pure number. The column \
         *here* has keys of the case file, such as `interaction.restitution` for the key `restitution` of `[[interaction]]`, and \
         outputs with the block in which they are written, such as `overlap` (contacts). An empty cell means that there is no \
         counterpart, or none that is known for certain. [physics.md](physics.md) has the formulas and where laws differ, \
         [case-file.md](case-file.md) all keys, [outputs.md](outputs.md) all outputs.\n",
    );
    for (title, terms) in SECTIONS {
        let _ = write!(page, "\n## {title}\n\n");
        page +=
            "| word | symbol | unit | meaning | here | LAMMPS | PFC | LIGGGHTS |\n|---|---|---|---|---|---|---|---|\n";
        for Term { word, symbol, unit, names, meaning, elsewhere: [lammps, pfc, liggghts] } in *terms {
            let here: Vec<String> = names.iter().map(|name| shown(name)).collect();
            let here = here.join(", ");
            let _ =
                writeln!(page, "| {word} | {symbol} | {unit} | {meaning} | {here} | {lammps} | {pfc} | {liggghts} |");
        }
    }
    page
}

/// A key as it is, an output with its block.
fn shown(name: &str) -> String {
    match name.split_once(':') {
        Some((place, output)) => format!("`{output}` ({place})"),
        None => format!("`{name}`"),
    }
}
