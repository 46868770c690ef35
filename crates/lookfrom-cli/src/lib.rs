//! The command `lookfrom`: files in, pictures out.
//!
//! A front end: it parses arguments, calls the libraries and prints the results. Each subcommand has its own file. Arguments as
//! typed (`args`) are kept apart from the session options that they become (`overrides`). A library, so that the Python package
//! is the command, too, and has its options by their names ([`keywords`]).

// Doc comments of arguments are help texts: what looks like a tag or a link there is typed.
#![allow(rustdoc::invalid_html_tags, rustdoc::broken_intra_doc_links)]

mod args;
mod bench;
mod compare;
mod completions;
mod convert;
mod develop;
mod diagnostic;
mod exit;
mod farm;
mod files;
mod film;
mod help;
mod info;
mod inspect;
mod interrupt;
pub mod keywords;
mod man;
mod merge;
mod naming;
mod output;
mod overrides;
mod picture;
mod pipe;
mod prepare;
mod preview;
mod progress;
mod remedy;
mod render;
mod report;
mod resume;
mod scenes;
mod terminal;
mod values;
#[cfg(feature = "view")]
mod view;

use std::ffi::OsString;

use clap::FromArgMatches;

use crate::args::{Arguments, Command};

/// Runs the command with its arguments, of which the first is its own name, and returns the exit code.
pub fn run(arguments: impl IntoIterator<Item = OsString>) -> u8 {
    let matches = help::command().try_get_matches_from(arguments);
    let parsed = matches.and_then(|matches| Ok((Arguments::from_arg_matches(&matches)?, matches)));
    let (arguments, matches) = match parsed {
        Ok(parsed) => parsed,
        Err(error) => return exit::not_parsed(&error),
    };
    if let Ok(word) = std::env::var("LOOKFROM_SIMD")
        && !word.is_empty()
        && lookfrom::choose_level(&word).is_err()
    {
        exit::say(&format!(
            "warning: LOOKFROM_SIMD={word} names no level of this machine (sse2, avx2, avx512): its best is used"
        ));
    }
    match arguments.command {
        Command::Render(arguments) => {
            let typed = matches.subcommand_matches("render").map(film::arguments).unwrap_or_default();
            render::run(&arguments, &typed)
        }
        Command::Resume(arguments) => resume::run(&arguments),
        Command::Merge(arguments) => merge::run(&arguments),
        Command::Develop(arguments) => develop::run(&arguments),
        Command::Files(arguments) => files::run(&arguments),
        Command::Farm(arguments) => {
            let typed = matches.subcommand_matches("farm").unwrap_or(&matches);
            farm::run(&arguments, typed)
        }
        Command::Convert(arguments) => convert::run(&arguments),
        Command::Info(arguments) => info::run(&arguments),
        Command::Inspect(arguments) => {
            let typed = matches.subcommand_matches("inspect").map(film::arguments).unwrap_or_default();
            inspect::run(&arguments, &typed)
        }
        #[cfg(feature = "view")]
        Command::View(arguments) => {
            let typed = matches.subcommand_matches("view").map(film::arguments).unwrap_or_default();
            view::run(&arguments, &typed)
        }
        Command::Compare(arguments) => compare::run(&arguments),
        Command::Bench(arguments) => bench::run(&arguments),
        Command::Man { command } => man::run(command.as_deref()),
        Command::Completions { shell } => completions::run(shell),
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    #[test]
    fn json_is_written_where_all_json_is_written() {
        fn search(folder: &Path) {
            let forbidden = ["serde", "json"].join("_");
            for entry in std::fs::read_dir(folder).expect("the sources are there") {
                let path = entry.expect("it can be read").path();
                if path.is_dir() {
                    search(&path);
                } else {
                    let text = std::fs::read_to_string(&path).expect("it is a text");
                    assert!(!text.contains(&forbidden), "{}: use lookfrom_scene::json", path.display());
                }
            }
        }
        search(&Path::new(env!("CARGO_MANIFEST_DIR")).join("src"));
    }
}
