//! Helpers shared by several test files of this crate.

use lookfrom_scene::excerpt::Excerpts;
use lookfrom_scene::{Error, Memory};

/// Each of the errors with the line that it points at.
pub(crate) fn shown(error: &Error, files: &Memory) -> String {
    let mut excerpts = Excerpts::new(files);
    let each = error.each().map(|error| {
        let excerpt = excerpts.of(&error.at).map(|excerpt| format!("\n{excerpt}").replace('\n', "\n  | "));
        let hint = error.hint.as_ref().map(|hint| format!("\n  help: {hint}"));
        let [excerpt, hint] = [excerpt, hint].map(Option::unwrap_or_default);
        format!("{}: {}{excerpt}{hint}", error.at, error.message)
    });
    each.collect::<Vec<_>>().join("\n")
}
