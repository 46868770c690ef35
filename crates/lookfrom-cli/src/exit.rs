//! Failures of a run and their exit codes.

use std::fmt;
use std::io::{IsTerminal, Write};
use std::path::Path;

use lookfrom::session::OPTIONS;
use lookfrom_scene::excerpt::printable;
use lookfrom_scene::{Error, ErrorKind, Location, Warning, WarningGroup, WarningKind};

use crate::{diagnostic, remedy};

/// Success.
pub(crate) const DONE: u8 = 0;
/// A scene could not be read or is invalid.
pub(crate) const BAD_SCENE: u8 = 1;
/// The command line is invalid, by itself or for this scene.
pub(crate) const BAD_USAGE: u8 = 2;
/// The output could not be written.
pub(crate) const BAD_OUTPUT: u8 = 3;
/// Stopped by Ctrl-C or SIGTERM.
pub(crate) const INTERRUPTED: u8 = 130;

/// Lines of warnings (and of notes) shown for one scene; the rest is only counted.
const MOST_WARNINGS: usize = 20;

/// Reason why a subcommand fails.
#[derive(Debug)]
pub(crate) enum Failure {
    /// A scene could not be read or is invalid.
    Scene(Error),
    /// Warnings other than notes, under `--strict`.
    Strict(Vec<Warning>),
    /// The command line is invalid, by itself or for this scene.
    Usage(String),
    /// The output could not be written.
    Output(String),
}

impl Failure {
    /// The exit code it leads to.
    pub(crate) fn code(&self) -> u8 {
        match self {
            Self::Scene(_) | Self::Strict(_) => BAD_SCENE,
            Self::Usage(_) => BAD_USAGE,
            Self::Output(_) => BAD_OUTPUT,
        }
    }

    /// Prints it on stderr as a [`diagnostic`] and returns the exit code.
    pub(crate) fn report(&self) -> u8 {
        say_in_color(&match self {
            Self::Scene(error) => diagnostic::of_files(error),
            Self::Usage(message) => diagnostic::of_usage(message),
            Self::Strict(_) | Self::Output(_) => diagnostic::plain(&self.to_string()),
        });
        self.code()
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Scene(error) => error.fmt(f),
            Self::Strict(warnings) => {
                let lines = listed(warnings, WarningKind::Warning);
                write!(f, "warnings, which are errors under --strict:\n  {}", lines.join("\n  "))
            }
            Self::Usage(message) | Self::Output(message) => message.fmt(f),
        }
    }
}

impl From<Error> for Failure {
    fn from(error: Error) -> Self {
        let error = error.worded(remedy::in_flags);
        match error.kind {
            ErrorKind::Request => {
                // Where a file has a list of what may be chosen.
                let place = match error.at.pointer.is_empty() {
                    true => String::new(),
                    false => format!("{}: ", error.at),
                };
                let hint = error.hint.map(|hint| format!("\n  help: {hint}")).unwrap_or_default();
                Self::Usage(format!("{place}{}{hint}", error.message))
            }
            _ => Self::Scene(error),
        }
    }
}

/// Turns an error into a failure of the scene at `path`; an error without a location gets the file as its location.
pub(crate) fn in_scene(path: &Path) -> impl Fn(Error) -> Failure {
    move |mut error| {
        let mut is_usage = false;
        for at in std::iter::once(&mut error.at).chain(error.more.iter_mut().map(|error| &mut error.at)) {
            if at.file.is_empty() {
                *at = Location::file(path);
            } else if *at.file == *OPTIONS {
                at.file = "the command line".into();
                is_usage = true;
            } else if at.file.starts_with("--") {
                is_usage = true;
            }
        }
        match is_usage {
            true => Failure::Usage(error.to_string()),
            false => error.into(),
        }
    }
}

/// Prints clap's error about the command line, or the requested help, and returns the exit code.
pub(crate) fn not_parsed(error: &clap::Error) -> u8 {
    if error.use_stderr() {
        say_in_color(diagnostic::of_clap(error).trim_end());
    } else {
        // A closed stdout is not an error.
        let _ = error.print();
    }
    u8::try_from(error.exit_code()).unwrap_or(BAD_USAGE)
}

/// Whether `--strict` makes these warnings an error: one of them is not a note.
pub(crate) fn is_bad(warnings: &[Warning]) -> bool {
    warnings.iter().any(|warning| warning.kind == WarningKind::Warning)
}

/// Warnings of a kind; those with the same message at several locations are one line.
pub(crate) fn lines(warnings: &[Warning], kind: WarningKind) -> Vec<String> {
    let worded = |warning: &Warning| warning.clone().worded(remedy::in_flags);
    let groups = WarningGroup::of(&warnings.iter().map(worded).collect::<Vec<_>>());
    groups.iter().filter(|group| group.kind() == kind).map(ToString::to_string).collect()
}

/// The first [`MOST_WARNINGS`] of those lines, and the number of the others.
fn listed(warnings: &[Warning], kind: WarningKind) -> Vec<String> {
    let mut lines = lines(warnings, kind);
    if lines.len() > MOST_WARNINGS {
        let left = lines.len() - MOST_WARNINGS;
        lines.truncate(MOST_WARNINGS);
        lines.push(format!("… and {left} more"));
    }
    lines
}

/// Prints warnings on stderr: first those that matter for the picture, then the harmless ones (notes).
pub(crate) fn say_warnings(warnings: &[Warning]) {
    for kind in [WarningKind::Warning, WarningKind::Notice] {
        listed(warnings, kind).iter().for_each(|line| say_in_color(&diagnostic::of_warning(kind, line)));
    }
}

/// Writes a line to stderr, without what names in it would command a terminal. A closed stderr is not an error.
pub(crate) fn say(line: &str) {
    let _ = writeln!(std::io::stderr(), "{}", printable(line));
}

/// Writes a drawing to stderr: commands to a terminal.
pub(crate) fn show(drawing: &str) {
    let _ = writeln!(std::io::stderr(), "{drawing}");
}

/// Writes lines to stderr, in colour where the terminal and the user's settings allow it.
fn say_in_color(lines: &str) {
    let _ = writeln!(anstream::stderr(), "{lines}");
}

/// Writes a line to stdout; to a terminal, without what names in it would command it. A closed pipe (`| head`) is not an
/// error.
///
/// # Errors
/// `Output` where it cannot be written for another reason.
pub(crate) fn answer(line: &str) -> Result<(), Failure> {
    match std::io::stdout().is_terminal() {
        true => answer_bytes(format!("{}\n", printable(line)).as_bytes()),
        false => answer_bytes(format!("{line}\n").as_bytes()),
    }
}

/// As [`answer`], bytes as they are.
///
/// # Errors
/// As [`answer`].
pub(crate) fn answer_bytes(bytes: &[u8]) -> Result<(), Failure> {
    let mut stdout = std::io::stdout().lock();
    match stdout.write_all(bytes).and_then(|()| stdout.flush()) {
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => {
            Err(Failure::Output(format!("cannot write to stdout: {error}")))
        }
        _ => Ok(()),
    }
}

/// Whether stderr is a terminal.
pub(crate) fn stderr_is_terminal() -> bool {
    std::io::stderr().is_terminal()
}
