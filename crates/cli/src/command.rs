//! What stands on the command line, and who answers it.

use crate::{
    bench, calibrate, check, explain, export, info, json, kernels, ladder, new, pack, picture, render, report, resume,
    run, shell, signals, verify,
};
use clap::{Parser, Subcommand};
use std::process::ExitCode;
use tdem_results::words::plain;

/// Exit code of a case or a run that failed. Wrong usage is 2, from clap.
const FAILED: u8 = 1;

#[derive(Debug, Parser)]
#[command(name = "tdem", version = env!("TDEM_VERSION"), about, long_about = LONG_ABOUT, after_help = ending(), max_term_width = 100)]
pub(crate) struct Cli {
    #[command(subcommand)]
    command: Command,
}

const LONG_ABOUT: &str = "\
Discrete element simulations of spheres that collide, rub and roll.

A case is a TOML file; a run is a directory with frames for ParaView, a history as CSV, and checkpoints. \
The same case gives the same result to the last bit on any number of threads, on a CPU or a GPU, and when it is stopped \
and resumed.";

const EXAMPLES: &str = "\
Examples:
  tdem new silo                    write a commented starter case, silo.toml
  tdem check silo.toml             what is wrong with it, what limits its time step, what it costs
  tdem run silo.toml               run it into runs/silo
  tdem resume runs/silo            go on after an interruption, exactly
  tdem picture runs/silo           a quick look without ParaView
  tdem report runs/silo            a page about it: pictures, histories, warnings
  tdem explain through-wall        what the code of an error means, and what to do";

/// How the program ends.
pub(crate) const EXIT_CODES: [(&str, &str); 4] =
    [("0", "done"), ("1", "the case or the run failed"), ("2", "wrong usage"), ("128 + signal", "interrupted")];

/// What stands below the help.
fn ending() -> String {
    let exits = EXIT_CODES.map(|(exit, what)| format!("{exit} {what}"));
    format!("{EXAMPLES}\n\nExit codes: {}.", exits.join(", "))
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Run a case
    Run(run::Arguments),
    /// Go on from the last good checkpoint of a run, exactly
    Resume(resume::Arguments),
    /// Show all that is wrong with a case, or what limits its time step and what it costs
    Check(check::Arguments),
    /// Show the devices of this machine, or what a run holds
    Info(info::Arguments),
    /// Write a commented starter case
    New(new::Arguments),
    /// Copy all frames of a run into one self-contained file per block, for sending
    Pack(pack::Arguments),
    /// Write particles of a run for OVITO, LAMMPS, VTK or a spreadsheet
    Export(export::Arguments),
    /// Draw the last state of a run as a PNG file
    Picture(picture::Arguments),
    /// Write a page about a run that any browser shows: pictures, histories, curves, warnings
    Report(report::Arguments),
    /// Compare the engine with closed forms and published values
    Verify(verify::Arguments),
    /// Find the bonds that give the packing of a case a modulus, a Poisson's ratio, a strength
    Calibrate(calibrate::Arguments),
    /// Run a case with heat at S, S/2 and S/4 times the pace of its motion, and compare: the price of acceleration
    Ladder(ladder::Arguments),
    /// Measure how fast this machine is
    Bench(bench::Arguments),
    /// Tell what the code of an error or a warning means, and what to do
    Explain(explain::Arguments),
    /// Print the kernels of a case: the laws and what calls them, as OpenCL and CUDA compile them
    Kernels(kernels::Arguments),
    /// Print the JSON schema of case files, for editors
    Schema,
    /// Print completions for a shell
    Completions(shell::Completions),
    /// Print the manual page, or write one for each command
    Man(shell::Man),
}

impl Command {
    /// The name of a command that was asked for JSON.
    fn for_programs(&self) -> Option<&'static str> {
        let asked = match self {
            Command::Run(arguments) => (arguments.work.json, "run"),
            Command::Resume(arguments) => (arguments.work.json, "resume"),
            Command::Check(arguments) => (arguments.json, "check"),
            Command::Info(arguments) => (arguments.json, "info"),
            Command::Verify(arguments) => (arguments.json, "verify"),
            Command::Calibrate(arguments) => (arguments.json, "calibrate"),
            Command::Ladder(arguments) => (arguments.json, "ladder"),
            _ => return None,
        };
        asked.0.json.then_some(asked.1)
    }
}

/// The command line, or clap's own end of the program, which repeats no argument that would act on a terminal.
fn parse() -> Cli {
    Cli::try_parse().unwrap_or_else(|error| {
        let shown = std::env::args_os().map(|argument| plain(&argument.to_string_lossy()).into_owned());
        Cli::try_parse_from(shown).err().unwrap_or(error).exit()
    })
}

/// Answers the command line.
pub(crate) fn main() -> ExitCode {
    signals::outlive_limits();
    let command = parse().command;
    let for_programs = command.for_programs();
    let outcome = match command {
        Command::Run(arguments) => run::execute(&arguments),
        Command::Resume(arguments) => resume::execute(&arguments),
        Command::Check(arguments) => check::execute(&arguments),
        Command::Info(arguments) => info::execute(&arguments),
        Command::New(arguments) => new::execute(&arguments),
        Command::Pack(arguments) => pack::execute(&arguments),
        Command::Export(arguments) => export::execute(&arguments),
        Command::Picture(arguments) => picture::execute(&arguments),
        Command::Report(arguments) => report::execute(&arguments),
        Command::Verify(arguments) => verify::execute(&arguments),
        Command::Calibrate(arguments) => calibrate::execute(&arguments),
        Command::Ladder(arguments) => ladder::execute(&arguments),
        Command::Bench(arguments) => bench::execute(&arguments),
        Command::Explain(arguments) => explain::execute(&arguments),
        Command::Kernels(arguments) => kernels::execute(&arguments),
        Command::Schema => shell::schema(),
        Command::Completions(arguments) => shell::completions(&arguments),
        Command::Man(arguments) => shell::man(&arguments),
    };
    outcome.unwrap_or_else(|reports| {
        render::tell(&reports);
        // A standard output that takes nothing was told of already.
        let _ = for_programs.map(|command| json::fail(command, &reports));
        ExitCode::from(FAILED)
    })
}
