//! `tdem report`: a page about a run.

use crate::cases;
use crate::console::data;
use crate::render::Reports;
use crate::units::{argument, short};
use crate::work;
use clap::Args;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use tdem_case::Loaded;
use tdem_results::report::{Subject, write};
use tdem_results::{Error, restore_masters};

#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Arguments {
    /// The directory of the run
    #[arg(value_name = "DIR")]
    run: PathBuf,
    /// The file [default: DIR/report.html]
    #[arg(long, value_name = "FILE.html")]
    out: Option<PathBuf>,
}

const EXAMPLES: &str = "\
Examples:
  tdem report runs/packing
  tdem report runs/packing --out packing.html

The page needs nothing but itself: open it in any browser, or send it. A run writes it when it ends; this command makes
it anew from what lies in the directory, also while the run goes on. If no process is at the run, the curves of the case are
drawn anew as well, and what ParaView opens is made again where it is missing.";

pub(crate) fn execute(arguments: &Arguments) -> Result<ExitCode, Reports> {
    let run = &arguments.run;
    let case = run.join("case.toml");
    if !case.exists() {
        return Err(Error::NotARun { path: run.clone() }.into());
    }
    let loaded = tdem_case::load(&case, &[]);
    if restore_masters(run)? && run.join("history.csv").exists() {
        let curves = loaded.as_ref().map_or_else(|_| Vec::new(), |loaded| cases::curves(&loaded.case));
        work::draw(run, &curves);
    }
    // A case that cannot be read any more does not hide what the run holds.
    let subject = loaded.map_or_else(
        |problems| Subject {
            problem: Some(format!(
                "The case cannot be read any more, so that curves are missing: {}",
                first(&problems)
            )),
            ..Subject::default()
        },
        |loaded| subject(&loaded),
    );
    let path = write(run, &subject, arguments.out.as_deref())?;
    data(argument(&path))?;
    Ok(ExitCode::SUCCESS)
}

fn first(problems: &tdem_case::Problems) -> String {
    problems.problems.first().map_or_else(String::new, |problem| problem.message.clone())
}

/// What a case adds to what its run knows.
pub(crate) fn subject(loaded: &Loaded) -> Subject {
    let case = &loaded.case;
    let fact = |name: &str, value: String| (name.to_owned(), value);
    let mut facts =
        vec![fact("model", format!("{:?}", case.model)), fact("duration", format!("{} s", short(case.time.end.get())))];
    if case.time.mass_scaling() != 1.0 {
        facts.push(fact("masses", format!("{} times the true ones where they move", short(case.time.mass_scaling()))));
    }
    Subject {
        title: case.title.clone(),
        facts,
        curves: cases::curves(case),
        materials: case.material.keys().cloned().collect(),
        problem: None,
    }
}

/// Writes the page at the end of a run. The rest of the run is whole without it.
pub(crate) fn at_the_end(run: &Path, loaded: &Loaded) -> Result<PathBuf, Error> {
    write(run, &subject(loaded), None)
}
