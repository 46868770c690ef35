//! Diagnostics for a terminal: message, location, source line, help.
//!
//! All have the form of compiler errors: `error: …`, then the location as `--> file:line:column`, which terminals make
//! clickable, the source line with carets, and `help: …`. Errors about the command line have the same form and end with a
//! pointer to `--help`. Colours are clap's; the printer removes them where they are not wanted.

use std::fmt::Write;
use std::path::Path;

use clap::builder::Styles;
use clap::builder::styling::{AnsiColor, Style};
use lookfrom_scene::excerpt::{Excerpt, Excerpts, printable};
use lookfrom_scene::load::PIPE;
use lookfrom_scene::{Error, Files, Result, WarningKind};

use crate::pipe::Piped;

/// Last line of an error about the command line, as clap has it.
const TO_HELP: &str = "\n\nFor more information, try '--help'.";

/// The frame around a line of a file.
const FRAME: Style = AnsiColor::Blue.on_default().bold();

/// A part of a message as it is printed: names in it may have any characters, and any length.
fn told(part: &str) -> String {
    const LONGEST: usize = 1 << 13;
    let end = part.char_indices().nth(LONGEST).map(|(end, _)| end);
    printable(&part[..end.unwrap_or(part.len())]) + if end.is_some() { "…" } else { "" }
}

/// An error without a location.
pub(crate) fn plain(message: &str) -> String {
    let error = *Styles::styled().get_error();
    format!("{error}error:{error:#} {}", told(message))
}

/// A warning or note.
pub(crate) fn of_warning(kind: WarningKind, message: &str) -> String {
    let (word, color) = match kind == WarningKind::Warning {
        true => ("warning", AnsiColor::Yellow),
        false => ("note", AnsiColor::Green),
    };
    let style = color.on_default().bold();
    format!("{style}{word}:{style:#} {}", told(message))
}

/// An error about the command line that only the scene reveals.
pub(crate) fn of_usage(message: &str) -> String {
    plain(message) + TO_HELP
}

/// An error of clap about the command line. Its `tip:` becomes `help:`, as everywhere else.
pub(crate) fn of_clap(error: &clap::Error) -> String {
    let valid = *Styles::styled().get_valid();
    let [tip, help] = ["tip:", "help:"].map(|word| format!("{valid}{word}{valid:#}"));
    error.render().ansi().to_string().replace(&tip, &help)
}

/// Errors in files, with the lines that they point at.
pub(crate) fn of_files(error: &Error) -> String {
    let mut excerpts = Excerpts::new(&Regular);
    let (few, left) = error.first_few();
    let mut text = few.map(|error| of_file(error, excerpts.of(&error.at))).collect::<Vec<_>>().join("\n\n");
    if left > 0 {
        let _ = write!(text, "\n\n… and {left} more");
    }
    text
}

fn of_file(error: &Error, excerpt: Option<Excerpt>) -> String {
    let styles = Styles::styled();
    let (red, green) = (*styles.get_error(), *styles.get_valid());
    let at = &error.at;
    let place = told(&at.to_string());
    // An error about a file as a whole has the file's name in its message.
    let mut text = match at.line {
        0 => plain(&format!("{at}: {}", error.message)),
        _ => plain(&error.message),
    };
    let gutter = if excerpt.is_some() { at.line.to_string().len() } else { 1 };
    let indent = " ".repeat(gutter);
    if at.line > 0 {
        let _ = write!(text, "\n{indent}{FRAME}-->{FRAME:#} {place}");
    }
    if let Some(Excerpt { text: line, mark }) = excerpt {
        let bar = format!("{FRAME}|{FRAME:#}");
        let (space, carets) = (" ".repeat(mark.start), "^".repeat(mark.len()));
        let _ = write!(text, "\n{indent} {bar}");
        let _ = write!(text, "\n{FRAME}{}{FRAME:#} {bar} {}", at.line, line.trim_end());
        let _ = write!(text, "\n{indent} {bar} {space}{red}{carets}{red:#}");
    }
    if let Some(hint) = &error.hint {
        let hint = told(&hint.to_string());
        let _ = write!(text, "\n{indent} {FRAME}={FRAME:#} {green}help:{green:#} {hint}");
    }
    text
}

/// Regular files on disk. Pipes and devices, which may block or can be read only once, are refused.
struct Regular;

impl Files for Regular {
    fn read(&self, path: &Path, limit: u64) -> Result<Vec<u8>> {
        if path == Path::new(PIPE) || path.is_file() {
            return Piped.read(path, limit);
        }
        Err(Error::new(lookfrom_scene::ErrorKind::Io, &lookfrom_scene::Location::file(path), "not a file"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use lookfrom_scene::Location;

    fn without_color(text: &str) -> String {
        anstream::adapter::strip_str(text).to_string()
    }

    #[test]
    fn names_are_no_commands_to_a_terminal() {
        let evil = "a\u{1b}]0;b\u{7}\u{9b}\r";
        let at = Location::file(Path::new(evil));
        let texts = [
            of_file(&Error::invalid(&at, evil).hint(evil), None),
            of_file(&Error::invalid(&at.at(1, 1), evil), None),
            of_warning(WarningKind::Warning, evil),
            of_usage(evil),
        ];
        for text in texts {
            // What is left of them when the colours are gone.
            let bare = text.replace("\u{1b}[", "");
            assert!(!bare.contains(['\u{1b}', '\u{7}', '\u{9b}', '\r']), "{text:?}");
        }
        let long = plain(&"é".repeat(1_000_000));
        assert!(long.ends_with("é…") && long.len() < 20_000);
    }

    #[test]
    fn errors_have_one_form() {
        let at = Location::file(Path::new("scene.toml")).at(12, 3);
        let error = Error::invalid(&at, "unknown key `color`").hint("did you mean `reflectance`?");
        let excerpt = Excerpt { text: "  color = 1".to_owned(), mark: 2..7 };
        assert_eq!(
            without_color(&of_file(&error, Some(excerpt))),
            "error: unknown key `color`\n  --> scene.toml:12:3\n   |\n12 |   color = 1\n   |   ^^^^^\n   = help: did you mean `reflectance`?"
        );
        assert_eq!(
            without_color(&of_file(&error, None)),
            "error: unknown key `color`\n --> scene.toml:12:3\n  = help: did you mean `reflectance`?"
        );
        let gone =
            Error::invalid(&Location::file(Path::new("a.toml")), "no such file").hint("check the name");
        assert_eq!(without_color(&of_files(&gone)), "error: a.toml: no such file\n  = help: check the name");
        assert!(of_usage("no").starts_with("\u{1b}[1m\u{1b}[31merror:\u{1b}[0m no\n\nFor more information"));
    }
}
