//! The command `lookfrom`: files in, pictures out.
//!
//! A door: it parses what a person asks, calls the libraries and shows the answer. One file a subcommand. What was typed
//! ([`args`]) is kept apart from what it changes in a scene ([`overrides`]).

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
