//! `lookfrom man`: manual pages.

use clap_mangen::Man;
use lookfrom_scene::suggest::nearest;

use crate::exit::{DONE, Failure, answer_bytes};
use crate::help;

/// Prints the page of the whole command, or of one of its subcommands, in roff.
pub(crate) fn run(of: Option<&str>) -> u8 {
    page(of).map_or_else(|failure| failure.report(), |()| DONE)
}

fn page(of: Option<&str>) -> Result<(), Failure> {
    let mut command = help::command();
    command.build();
    let found = match of {
        None => command,
        Some(name) => {
            let found = command.find_subcommand(name).ok_or_else(|| {
                let known: Vec<&str> = command.get_subcommands().map(clap::Command::get_name).collect();
                let meant = nearest(name, known.iter().copied()).map(|near| format!("did you mean {near}? "));
                let meant = meant.unwrap_or_default();
                Failure::Usage(format!(
                    "there is no command {name}\n  help: {meant}they are {}",
                    known.join(", ")
                ))
            })?;
            help::explained(found)
        }
    };
    let mut text = Vec::new();
    // Writing to memory does not fail.
    let _ = Man::new(found).render(&mut text);
    answer_bytes(&text)
}
