//! `lookfrom completions`: completion scripts for shells.

use clap_complete::Shell;

use crate::exit::{DONE, answer_bytes};
use crate::help;

/// Prints the script for a shell.
pub(crate) fn run(shell: Shell) -> u8 {
    let mut script = Vec::new();
    clap_complete::generate(shell, &mut help::command(), "lookfrom", &mut script);
    answer_bytes(&script).map_or_else(|failure| failure.report(), |()| DONE)
}
