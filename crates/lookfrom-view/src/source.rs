//! The text of a scene's file.

use std::ops::Range;
use std::path::Path;

use lookfrom_scene::files::SharedFiles;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// The longest text, in bytes.
const LONGEST: u64 = 1 << 20;

/// The text of a scene's file, if it is one.
pub(crate) fn of(scene: &Path, files: &SharedFiles) -> Option<String> {
    String::from_utf8(files.read(scene, LONGEST).ok()?).ok().filter(|text| !text.contains('\0'))
}

/// The text of a scene in our own format.
pub(crate) fn of_toml(scene: &Path, files: &SharedFiles) -> Option<String> {
    let is_ours = scene.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("toml"));
    if is_ours { of(scene, files) } else { None }
}

/// A text of TOML without some of its outermost tables; `None` where it cannot be read. No two values share a line with a third, so whole
/// lines go.
pub(crate) fn without(text: &str, tables: &[&str]) -> Option<String> {
    let parsed = DeTable::parse(text).ok()?;
    let mut spans = Vec::new();
    for (key, value) in parsed.get_ref().iter().filter(|(key, _)| tables.contains(&key.get_ref().as_ref())) {
        spans.push(key.span());
        add(value, &mut spans);
    }
    let mut kept = String::new();
    let mut start = 0;
    for line in text.split_inclusive('\n') {
        let end = start + line.len();
        if !spans.iter().any(|span| span.start < end && span.end > start) {
            kept.push_str(line);
        }
        start = end;
    }
    Some(kept)
}

/// A key of an outermost table of a text of TOML, with its value, as they are written.
pub(crate) fn line_of(text: &str, table: &str, key: &str) -> Option<String> {
    let parsed = DeTable::parse(text).ok()?;
    let (_, table) = parsed.get_ref().iter().find(|(name, _)| name.get_ref() == table)?;
    let (_, value) = table.get_ref().as_table()?.iter().find(|(name, _)| name.get_ref() == key)?;
    Some(format!("{key} = {}", text.get(value.span())?))
}

/// Adds the places of a value and of all within it. That of a table is its braces or its header; a table that only others name has none.
fn add(value: &Spanned<DeValue<'_>>, spans: &mut Vec<Range<usize>>) {
    spans.push(value.span());
    if let DeValue::Table(table) = value.get_ref() {
        for (key, value) in table {
            spans.push(key.span());
            add(value, spans);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_go_however_they_are_written() {
        let text = "\
# A scene.
image = { width = 3 }
render.samples = 4
import = \"a.toml\"
[camera]
lookfrom = [
    0, 1, 5, # the eye
]

[[light]]
type = \"point\"
[camera.window]
x = [0, 1]
[materials.camera]
image = 3
[render.camera]
depth = 3 # [camera]
";
        let kept = without(text, &["camera", "image", "render"]).expect("a text");
        let expected = "\
# A scene.
import = \"a.toml\"

[[light]]
type = \"point\"
[materials.camera]
image = 3
";
        assert_eq!(kept, expected);
        assert_eq!(without("a = ", &["a"]), None);
        assert_eq!(without("[camera]\nfov = 3", &["image"]).as_deref(), Some("[camera]\nfov = 3"));
    }
}
