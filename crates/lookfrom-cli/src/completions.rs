//! `lookfrom completions`: completion scripts for shells.

use std::io::Write;

use clap_complete::Shell;

use crate::exit::{DONE, Failure};
use crate::help;

/// Prints the script for a shell.
pub(crate) fn run(shell: Shell) -> u8 {
    let mut script = Vec::new();
    clap_complete::generate(shell, &mut help::command(), "lookfrom", &mut script);
    match std::io::stdout().write_all(&script) {
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => {
            Failure::Output(format!("cannot write to stdout: {error}")).report()
        }
        _ => DONE,
    }
}
