//! Options of a session by their names, for front ends in other languages: a keyword argument `samples=64` is `--samples 64` of
//! `lookfrom render`. So there is one list of options, one spelling of their values, and one text that explains each.

use std::error::Error as _;
use std::fmt;
use std::path::PathBuf;

use clap::error::{ContextKind, ContextValue, ErrorKind};
use clap::{Arg, Args, Command, FromArgMatches};
use lookfrom::session::Options;
use lookfrom_scene::suggest::nearest;

use crate::args::{Overrides, RenderArguments};
use crate::film;

/// Options of `lookfrom render` that a session has besides those that override its scene.
const OF_SESSION: [&str; 7] = ["film", "fireflies", "memory", "noise", "part", "threads", "time"];

/// A keyword argument.
#[derive(Clone, Debug)]
pub struct Keyword {
    /// The name of an option, with `_` for `-`; `scene_of_file` is `--scene`.
    pub name: String,
    /// Its value as one would type it; `None` for a switch.
    pub value: Option<String>,
}

/// Session options of keyword arguments.
#[derive(Clone, Debug)]
pub struct Asked {
    /// The options of the session, without an environment map.
    pub options: Options,
    /// The file of the environment map.
    pub environment: Option<PathBuf>,
    /// Arguments of `lookfrom render` for the same session.
    pub typed: Vec<String>,
}

/// A keyword that does not exist, or a value that it cannot have.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fault {
    /// The keyword.
    pub name: String,
    /// Fault and expectation.
    pub message: String,
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl std::error::Error for Fault {}

/// An option as its help tells it.
#[derive(Clone, Debug)]
pub struct Described {
    /// The keyword.
    pub name: String,
    /// Help text, one line.
    pub help: String,
    /// Whether it is a switch.
    pub is_switch: bool,
}

/// All keywords, by name.
pub fn all() -> Vec<Described> {
    let command = command();
    let mut all: Vec<Described> = of_session(&command)
        .map(|argument| Described {
            name: argument.get_id().to_string(),
            help: argument.get_help().map(ToString::to_string).unwrap_or_default(),
            is_switch: !argument.get_action().takes_values(),
        })
        .collect();
    all.sort_by(|a, b| a.name.cmp(&b.name));
    all
}

/// The options of a session.
///
/// # Errors
/// A [`Fault`] for a keyword that does not exist, a value that it cannot have, and keywords that exclude each other.
pub fn options(keywords: &[Keyword]) -> Result<Asked, Fault> {
    let command = command();
    let known: Vec<&Arg> = of_session(&command).collect();
    let mut words = vec!["render".to_owned()];
    for Keyword { name, value } in keywords {
        let argument = known.iter().find(|argument| argument.get_id() == name.as_str());
        let argument = argument.ok_or_else(|| unknown(name))?;
        let long = argument.get_long().unwrap_or_default();
        words.push(match value {
            Some(value) => format!("--{long}={value}"),
            None => format!("--{long}"),
        });
    }
    words.extend(["--", "scene"].map(str::to_owned));
    let matches = command.try_get_matches_from(words).map_err(|error| fault(&error))?;
    let arguments = RenderArguments::from_arg_matches(&matches).map_err(|error| fault(&error))?;
    Ok(Asked {
        options: arguments.options(None),
        environment: arguments.overrides.model.environment.clone(),
        typed: film::arguments(&matches),
    })
}

/// The name of an option as a keyword, for `--name <VALUE>`.
fn keyword(option: &str) -> String {
    let long = option.trim_start_matches('-').split([' ', '=']).next().unwrap_or_default();
    let command = command();
    let known = command.get_arguments().find(|argument| argument.get_long() == Some(long));
    known.map_or_else(|| long.replace('-', "_"), |argument| argument.get_id().to_string())
}

fn command() -> Command {
    RenderArguments::augment_args(Command::new("render"))
}

/// The arguments of `render` that are options of a session.
fn of_session(command: &Command) -> impl Iterator<Item = &Arg> {
    let overrides = Overrides::augment_args(Command::new("overrides"));
    command.get_arguments().filter(move |argument| {
        let id = argument.get_id();
        OF_SESSION.contains(&id.as_str()) || overrides.get_arguments().any(|other| other.get_id() == id)
    })
}

fn unknown(name: &str) -> Fault {
    let known: Vec<String> = all().into_iter().map(|described| described.name).collect();
    let message = match nearest(name, known.iter().map(String::as_str)) {
        Some(meant) => format!("there is no option {name}: did you mean {meant}?"),
        None => format!("there is no option {name}; expected one of {}", known.join(", ")),
    };
    Fault { name: name.to_owned(), message }
}

/// An error of the parser, in words of keywords.
fn fault(error: &clap::Error) -> Fault {
    let text = |kind| match error.get(kind) {
        Some(ContextValue::String(text)) => text.clone(),
        Some(ContextValue::Strings(texts)) => texts.join(", "),
        _ => String::new(),
    };
    let name = keyword(&text(ContextKind::InvalidArg));
    let value = text(ContextKind::InvalidValue);
    let message = match error.kind() {
        ErrorKind::ArgumentConflict => {
            let other = keyword(&text(ContextKind::PriorArg));
            format!("{name} and {other} exclude each other: give one of them")
        }
        ErrorKind::InvalidValue if value.is_empty() => format!("{name} needs a value"),
        ErrorKind::InvalidValue => {
            format!("{name} is {value:?}; expected one of {}", text(ContextKind::ValidValue))
        }
        ErrorKind::ValueValidation => {
            let expected = error.source().map(ToString::to_string).unwrap_or_default();
            format!("{name} is {value:?}; {expected}")
        }
        ErrorKind::MissingRequiredArgument => format!("{name} is needed, too"),
        ErrorKind::TooManyValues => format!("{name} is a switch: True or False"),
        _ => error.render().to_string().trim().to_owned(),
    };
    Fault { name, message }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(keywords: &[(&str, Option<&str>)]) -> Result<Asked, Fault> {
        let keyword = |(name, value): &(&str, Option<&str>)| Keyword {
            name: (*name).to_owned(),
            value: value.map(str::to_owned),
        };
        options(&keywords.iter().map(keyword).collect::<Vec<_>>())
    }

    #[test]
    fn keywords_are_the_options_of_the_command() {
        let asked = of(&[
            ("size", Some("320x200")),
            ("samples", Some("16..32")),
            ("lookfrom", Some("-1,2,3")),
            ("floor", None),
            ("denoise", Some("off")),
            ("noise", Some("0.02")),
            ("scene_of_file", Some("1")),
        ]);
        let Asked { options, typed, .. } = asked.unwrap();
        assert_eq!((options.width, options.height, options.samples), (Some(320), Some(200), Some(32)));
        assert_eq!((options.first_sample, options.floor, options.denoise), (16, true, Some(false)));
        assert_eq!((options.stop.noise, options.import.scene.as_deref()), (Some(0.02), Some("1")));
        let other_than_samples =
            ["--size=320x200", "--denoise=off", "--lookfrom=-1,2,3", "--floor", "--scene=1"];
        assert!(other_than_samples.iter().all(|word| typed.iter().any(|typed| typed == word)), "{typed:?}");
    }

    #[test]
    fn faults_name_the_keyword_and_what_is_expected() {
        for (keywords, name, message) in [
            (&[("sampels", Some("4"))][..], "sampels", "there is no option sampels: did you mean samples?"),
            (&[("output", Some("a.png"))], "output", "there is no option output"),
            (&[("samples", Some("none"))], "samples", "samples is \"none\"; expected a whole number"),
            (&[("integrator", Some("paths"))], "integrator", "integrator is \"paths\"; expected one of"),
            (&[("min_contribution", Some("2"))], "min_contribution", "min_contribution is \"2\"; expected"),
            (&[("size", Some("9")), ("width", Some("9"))], "size", "exclude each other"),
            (&[("floor", Some("yes"))], "floor", "floor is"),
            (&[("samples", None)], "samples", "samples needs a value"),
            (&[("scene_of_file", None)], "scene_of_file", "scene_of_file needs a value"),
        ] {
            let fault = of(keywords).unwrap_err();
            assert_eq!(fault.name, name, "{fault}");
            assert!(fault.message.contains(message), "{fault}");
        }
    }

    #[test]
    fn all_keywords_are_described() {
        let all = all();
        assert!(all.iter().all(|described| !described.help.is_empty()));
        let has = |name: &str| all.iter().any(|described| described.name == name);
        assert!(has("samples") && has("time") && has("scene_of_file") && !has("output") && !has("quiet"));
        assert!(all.iter().filter(|described| described.is_switch).count() >= 2);
    }
}
