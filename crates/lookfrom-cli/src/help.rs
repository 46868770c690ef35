//! The arrangement of the help: options under what people want of them, a short help (`-h`) of those that most people
//! need, and the options of a picture explained once, by `render`, not by every command that takes them.

use clap::builder::StyledStr;
use clap::{Args, Command, CommandFactory};

use crate::args::{Arguments, Overrides};

/// Headings of the help of `render`, with their options.
const GROUPS: &[(&str, &[&str])] = &[
    ("Output", &["output", "format", "quality", "bits", "write_every", "show"]),
    ("Size", &["size", "width", "height", "crop"]),
    ("Samples, time, noise", &["samples", "time", "noise", "allocation", "denoise", "fireflies"]),
    (
        "Camera",
        &["lookfrom", "lookat", "up", "fov", "view", "azimuth", "elevation", "bounds", "turn", "camera"],
    ),
    (
        "Light, background, colours",
        &["environment", "rotate_environment", "background", "floor", "exposure", "tonemap"],
    ),
    (
        "Contents of the scene",
        &[
            "define",
            "at",
            "shutter",
            "fps",
            "animation",
            "variant",
            "scene_of_file",
            "subdivide",
            "instanced_lights",
        ],
    ),
    ("Several pictures of a scene", &["turntable", "views", "frames", "sheet", "skip_existing"]),
    ("Films and parts of pictures", &["film", "checkpoint", "go_on", "part"]),
    (
        "Light transport",
        &[
            "integrator",
            "depth",
            "color",
            "light_sampler",
            "portals",
            "min_contribution",
            "sampler",
            "seed",
            "filter",
        ],
    ),
    ("Layers of an EXR", &["layers", "light_path", "cryptomatte", "spectral_buckets", "wavelengths"]),
    ("The call", &["watch", "quiet", "verbose", "json", "strict", "threads", "memory"]),
];

/// The options of `render` that `-h` explains.
const SHORT: &[&str] = &[
    "output",
    "size",
    "samples",
    "time",
    "noise",
    "denoise",
    "lookfrom",
    "lookat",
    "up",
    "fov",
    "view",
    "environment",
    "background",
    "floor",
    "exposure",
    "define",
    "turntable",
    "frames",
    "film",
    "integrator",
    "watch",
    "quiet",
    "threads",
];

/// Commands that take the options of a picture, with those that change nothing there. They are accepted all the same, so
/// that the words of a render can be repeated.
const BORROWERS: &[(&str, &[&str])] = &[
    ("inspect", &["layers", "light_path", "cryptomatte", "denoise", "exposure", "tonemap", "crop"]),
    ("view", &["layers", "light_path", "cryptomatte"]),
    ("bench", &["cryptomatte", "denoise", "exposure", "tonemap"]),
    ("farm", &[]),
    ("convert", &["turn"]),
];

/// The command with its help arranged.
pub(crate) fn command() -> Command {
    let mut command = Arguments::command().mut_subcommand("render", grouped);
    for (name, idle) in BORROWERS {
        if command.find_subcommand(name).is_some() {
            command = command.mut_subcommand(name, |command| borrowing(command, idle));
        }
    }
    let names: Vec<String> = command.get_subcommands().map(|command| command.get_name().to_owned()).collect();
    names.iter().fold(command, |command, name| command.mut_subcommand(name, with_braces))
}

/// A command with the help of every option, as manual pages show it.
pub(crate) fn explained(command: &Command) -> Command {
    command.clone().mut_args(|argument| argument.hide_short_help(false))
}

/// `render`, by [`GROUPS`] and [`SHORT`].
fn grouped(command: Command) -> Command {
    let options = GROUPS.iter().flat_map(|(heading, options)| options.iter().map(move |id| (*heading, *id)));
    // A changed argument becomes the last one: so these stand in the order of the groups.
    options.enumerate().fold(command, |command, (order, (heading, id))| {
        command.mut_arg(id, |argument| {
            argument.help_heading(heading).display_order(order).hide_short_help(!SHORT.contains(&id))
        })
    })
}

/// A command that names the options of a picture without their explanations.
fn borrowing(command: Command, idle: &[&str]) -> Command {
    let borrowed = Overrides::augment_args(Command::new("picture"));
    let borrowed: Vec<&clap::Arg> = borrowed.get_arguments().collect();
    let ids: Vec<&str> = borrowed.iter().map(|argument| argument.get_id().as_str()).collect();
    let of_groups = GROUPS.iter().flat_map(|(_, options)| *options);
    let names: Vec<String> = of_groups
        .filter(|id| ids.contains(id) && !idle.contains(id))
        .filter_map(|id| borrowed.iter().find(|argument| argument.get_id() == id)?.get_long())
        .map(|name| format!("--{name}"))
        .collect();
    let examples = command.get_after_help().map(ToString::to_string).unwrap_or_default();
    let note = format!(
        "Options of the picture, explained by lookfrom render --help:\n  {}\n\n{examples}",
        names.join(", ")
    );
    ids.iter()
        .fold(command, |command, id| {
            command.mut_arg(id, |argument| argument.hide_short_help(true).hide_long_help(true))
        })
        .after_help(note)
}

/// The `{n}` of patterns, which clap takes for its own mark of a new line: a reset of the style inside hides it from clap
/// and is not seen.
fn with_braces(command: Command) -> Command {
    let shown = |text: &StyledStr| text.ansi().to_string().replace("{n}", "{\u{1b}[0mn}");
    command.mut_args(|argument| match argument.get_long_help().map(shown) {
        Some(text) => argument.long_help(text),
        None => argument,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_option_of_a_render_has_one_place() {
        let listed: Vec<&str> = GROUPS.iter().flat_map(|(_, options)| *options).copied().collect();
        let command = command();
        let render = command.find_subcommand("render").unwrap();
        for argument in render.get_arguments().filter(|argument| argument.get_long().is_some()) {
            let id = argument.get_id().as_str();
            assert_eq!(listed.iter().filter(|other| **other == id).count(), 1, "{id}");
        }
        assert!(SHORT.iter().all(|id| listed.contains(id)));
    }

    #[test]
    fn the_command_is_sound() {
        command().debug_assert();
    }
}
