//! From a file to a checked case.

use crate::build::Built;
use crate::check;
use crate::codes;
use crate::courses;
use crate::overrides;
use crate::problem::{Problem, Problems, Source};
use crate::schema::{Case, Model, OutOfRange, Positive, Step, json_schema};
use crate::structure;
use crate::table;
use crate::tree::Node;
use std::path::{Path, PathBuf};

/// A case that was read and makes sense as far as its text goes.
#[derive(Clone, Debug)]
pub struct Loaded {
    /// What the case says.
    pub case: Case,
    /// The text it says it with, preset and overrides applied.
    pub source: Source,
    /// The folder that files named in the case are relative to.
    pub base_dir: PathBuf,
    pub(crate) tree: Node,
}

/// Reads a case file. An override is a path of keys and a value, as `--set key.path=value` gives them.
///
/// # Errors
/// All problems that the text shows.
pub fn load(path: &Path, overrides: &[(String, String)]) -> Result<Loaded, Problems> {
    let name = path.display().to_string();
    let text = table::read(path).map_err(|e| {
        let help = match e.kind() {
            std::io::ErrorKind::NotFound => "`tdem new NAME` writes a starter case",
            std::io::ErrorKind::InvalidData => "a case is UTF-8 text",
            _ => "check the path and its permissions",
        };
        let source = Source { name: name.clone(), text: String::new() };
        Problems::new(&source, vec![Problem::new(codes::UNREADABLE, format!("cannot read {name}: {e}")).help(help)])
    })?;
    let base_dir = path.parent().unwrap_or(Path::new("")).to_owned();
    parse(&name, &text, &base_dir, overrides)
}

/// Reads a case from text; `name` is for messages, `base_dir` for files that the case names.
///
/// # Errors
/// All problems that the text shows.
pub fn parse(name: &str, text: &str, base_dir: &Path, overrides: &[(String, String)]) -> Result<Loaded, Problems> {
    let source_of = |text: &str| Source { name: name.to_owned(), text: text.to_owned() };
    let effective = overrides::apply(text, overrides).map_err(|p| Problems::new(&source_of(text), p))?;
    let source = source_of(&effective);
    let fail = |problems| Problems::new(&source, problems);

    let tree = Node::parse(&effective).map_err(fail)?;
    let (mut structural, repairs) = structure::check(&tree, &json_schema());
    if !structural.is_empty() {
        // What else is wrong is told together with it, as far as that can be seen.
        let mended = repairs.applied(&tree, &effective).and_then(|value| value.try_into::<Case>().ok());
        if let Some(mut case) = mended {
            let mut others = courses::settle(&mut case, &tree, base_dir);
            others.extend(check::check(&case, &tree));
            structural.extend(repairs.not_of_repairs(others));
        }
        return Err(fail(structural));
    }
    let mut case: Case = toml::from_str(&effective).map_err(|e| {
        // The schema let it pass, so this is rare: a number that only the type refuses.
        fail(vec![
            Problem::new(codes::INVALID, "the case cannot be read")
                .at(e.span().unwrap_or(0..0), e.message().to_owned()),
        ])
    })?;
    let mut problems = courses::settle(&mut case, &tree, base_dir);
    problems.extend(check::check(&case, &tree));
    if !problems.is_empty() {
        return Err(fail(problems));
    }
    Ok(Loaded { case, source, base_dir: base_dir.to_owned(), tree })
}

impl Loaded {
    /// The case with every default written out and files by their full paths: what a run keeps. Reading it gives the
    /// same run, wherever it lies.
    #[must_use]
    pub fn effective_toml(&self) -> String {
        let case = self.whole();
        let size = case.size.as_ref().map_or(String::new(), |size| format!("# Preset applied: {size}\n"));
        // All types serialise; if one did not, the text as read would still be the case.
        let body = toml::to_string(&case).unwrap_or_else(|_| self.source.text.clone());
        format!("# Every default written out.\n{size}{body}")
    }

    /// The case with every default and with files by their full paths.
    pub(crate) fn whole(&self) -> Case {
        let mut case = self.case.clone();
        for group in &mut case.particles {
            if let Some(csv) = &mut group.csv {
                csv.file = self.absolute(&csv.file);
            }
            if let Some(run) = &mut group.run {
                run.directory = self.absolute(&run.directory);
            }
        }
        if let Some(file) = &mut case.bonds.file {
            *file = self.absolute(file);
        }
        case
    }

    /// The same with the steps that were chosen, so that reading it takes those, whatever happens to the files that the case
    /// names. Where heat advances by itself, its step is another than that of the motion.
    ///
    /// # Errors
    /// If a step is none.
    pub fn kept(&self, built: &Built) -> Result<String, OutOfRange> {
        let mut kept = self.clone();
        kept.case.time.step = Step::Seconds(Positive::try_from(built.limits.step)?);
        let mut chosen = String::new();
        if built.limits.auto {
            chosen += "# time.step was \"auto\"; this is the step that was chosen.\n";
        }
        let alone = built.plan.heat.as_ref().is_some_and(|heat| heat.motion.takes_turns());
        if let Some(heat) = kept.case.heat.as_mut().filter(|_| alone) {
            if heat.step.is_none() {
                chosen += "# heat.step was left out; this is the step that was chosen.\n";
            }
            heat.step = Some(Positive::try_from(built.plan.dt)?);
        }
        Ok(chosen + &kept.effective_toml())
    }

    /// The same case without heat: TBPM becomes BPM. What only heat has goes with it: surfaces, temperatures, tables of bonds,
    /// gauges of surfaces, and all curves, which may show them.
    #[must_use]
    pub fn without_heat(&self) -> Loaded {
        let mut without = self.clone();
        let case = &mut without.case;
        if case.model == Model::TBPM {
            case.model = Model::BPM;
        }
        (case.heat, case.surface, case.curve) = (None, Vec::new(), Vec::new());
        case.wall.iter_mut().for_each(|wall| wall.temperature = None);
        case.boxes.iter_mut().for_each(|of| of.temperature = None);
        case.particles.iter_mut().for_each(|group| group.temperature = None);
        for joint in &mut case.bond {
            (joint.stiffness_over_temperature, joint.strength_over_temperature) = (None, None);
        }
        case.gauge.retain(|gauge| gauge.surface.is_none());
        without
    }

    /// Path of a file that the case names.
    pub(crate) fn file(&self, name: &str) -> PathBuf {
        self.base_dir.join(name)
    }

    fn absolute(&self, name: &str) -> String {
        let path = self.file(name);
        std::path::absolute(&path).unwrap_or(path).display().to_string()
    }
}
