//! The command `lookfrom`: files in, pictures out.
//!
//! A front end: it parses arguments, calls the libraries and prints the results. Each subcommand has its own file. Arguments as
//! typed ([`args`]) are kept apart from the session options that they become ([`overrides`]).

mod args;
mod bench;
mod compare;
mod completions;
mod diagnostic;
mod exit;
mod html;
mod info;
mod inspect;
mod interrupt;
mod json;
mod naming;
mod output;
mod overrides;
mod prepare;
mod preview;
mod progress;
mod render;
mod report;
mod values;

use std::process::ExitCode;

use clap::Parser;

use crate::args::{Arguments, Command};

fn main() -> ExitCode {
    let arguments = match Arguments::try_parse() {
        Ok(arguments) => arguments,
        Err(error) => return ExitCode::from(exit::not_parsed(&error)),
    };
    let code = match arguments.command {
        Command::Render(arguments) => render::run(&arguments),
        Command::Info(arguments) => info::run(&arguments),
        Command::Inspect(arguments) => inspect::run(&arguments),
        Command::Compare(arguments) => compare::run(&arguments),
        Command::Bench(arguments) => bench::run(&arguments),
        Command::Completions { shell } => completions::run(shell),
    };
    ExitCode::from(code)
}
