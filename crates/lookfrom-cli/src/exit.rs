//! Failures of a run and their exit codes.

use std::fmt;
use std::io::{IsTerminal, Write};
use std::path::Path;

use lookfrom::session::OPTIONS;
use lookfrom_scene::{Error, ErrorKind, Location, Warning, WarningGroup, WarningKind};

use crate::diagnostic;

/// All that was asked is done.
pub(crate) const DONE: u8 = 0;
/// A scene could not be read or is invalid.
pub(crate) const BAD_SCENE: u8 = 1;
/// The command line does not make sense, by itself or for this scene.
pub(crate) const BAD_USAGE: u8 = 2;
/// The output could not be written.
pub(crate) const BAD_OUTPUT: u8 = 3;
/// Stopped by Ctrl-C or SIGTERM.
pub(crate) const INTERRUPTED: u8 = 130;

/// More kinds of warnings than this about one scene are only counted.
const MOST_WARNINGS: usize = 20;

/// Why a subcommand cannot go on.
#[derive(Debug)]
pub(crate) enum Failure {
    /// A scene could not be read or is invalid.
    Scene(Error),
    /// Warnings that are not harmless where `--strict` allows none.
    Strict(Vec<Warning>),
    /// The command line does not make sense, by itself or for this scene.
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

    /// Says it on stderr, in the way of [`diagnostic`], and gives back the exit code.
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
                write!(f, "warnings, which --strict makes errors:\n  {}", lines.join("\n  "))
            }
            Self::Usage(message) | Self::Output(message) => message.fmt(f),
        }
    }
}

impl From<Error> for Failure {
    fn from(error: Error) -> Self {
        match error.kind {
            ErrorKind::Request => Self::Usage(error.message),
            _ => Self::Scene(error),
        }
    }
}

/// What is wrong with a scene; where no place is known, its file is the place.
pub(crate) fn in_scene(path: &Path) -> impl Fn(Error) -> Failure {
    move |mut error| {
        for at in std::iter::once(&mut error.at).chain(error.more.iter_mut().map(|error| &mut error.at)) {
            if at.file.is_empty() {
                *at = Location::file(path);
            } else if *at.file == *OPTIONS {
                at.file = "the command line".into();
            }
        }
        error.into()
    }
}

/// Says what was wrong with the command line, or the help that it asks for, and gives back the exit code.
pub(crate) fn not_parsed(error: &clap::Error) -> u8 {
    if error.use_stderr() {
        say_in_color(diagnostic::of_clap(error).trim_end());
    } else {
        // Where nobody listens any more, nothing is lost.
        let _ = error.print();
    }
    u8::try_from(error.exit_code()).unwrap_or(BAD_USAGE)
}

/// Whether `--strict` allows none of them: one is not harmless.
pub(crate) fn is_bad(warnings: &[Warning]) -> bool {
    warnings.iter().any(|warning| warning.kind == WarningKind::Warning)
}

/// Warnings of a kind, in one line those that say the same of several places.
pub(crate) fn lines(warnings: &[Warning], kind: WarningKind) -> Vec<String> {
    let groups = WarningGroup::of(warnings);
    groups.iter().filter(|group| group.kind() == kind).map(ToString::to_string).collect()
}

/// The first few of those lines, and how many more there are.
fn listed(warnings: &[Warning], kind: WarningKind) -> Vec<String> {
    let mut lines = lines(warnings, kind);
    if lines.len() > MOST_WARNINGS {
        let left = lines.len() - MOST_WARNINGS;
        lines.truncate(MOST_WARNINGS);
        lines.push(format!("… and {left} more"));
    }
    lines
}

/// Says warnings on stderr: those that matter for the picture, then the harmless ones.
pub(crate) fn say_warnings(warnings: &[Warning]) {
    for (kind, word) in [(WarningKind::Warning, "warning"), (WarningKind::Notice, "note")] {
        listed(warnings, kind).iter().for_each(|line| say(&format!("{word}: {line}")));
    }
}

/// Writes a line to stderr. Where nobody listens any more, nothing is lost.
pub(crate) fn say(line: &str) {
    let _ = writeln!(std::io::stderr(), "{line}");
}

/// Writes lines with colours to stderr, or without where it is no terminal that shows them, or nobody wants them.
fn say_in_color(lines: &str) {
    let _ = writeln!(anstream::stderr(), "{lines}");
}

/// Writes a line to stdout. A reader that has closed the pipe (`| head`) has read enough.
///
/// # Errors
/// `Output` where it cannot be written for another reason.
pub(crate) fn answer(line: &str) -> Result<(), Failure> {
    let mut stdout = std::io::stdout().lock();
    match writeln!(stdout, "{line}").and_then(|()| stdout.flush()) {
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => {
            Err(Failure::Output(format!("cannot write to stdout: {error}")))
        }
        _ => Ok(()),
    }
}

/// Whether a person looks at stderr.
pub(crate) fn stderr_is_terminal() -> bool {
    std::io::stderr().is_terminal()
}
