//! `tdem`, the command: runs cases, goes on with runs, and looks at what they left.

mod bench;
mod bench_case;
mod bench_figures;
mod bench_stages;
mod calibrate;
mod cases;
mod check;
mod codes;
mod command;
mod console;
mod device;
mod explain;
mod export;
mod files;
mod info;
mod json;
mod kernels;
mod ladder;
mod ladder_table;
mod machine;
mod memory;
mod new;
mod pack;
mod picture;
mod progress;
mod render;
mod report;
mod resume;
mod run;
mod shell;
mod signals;
mod summary;
mod units;
mod verify;
mod work;

use std::process::ExitCode;

fn main() -> ExitCode {
    command::main()
}
