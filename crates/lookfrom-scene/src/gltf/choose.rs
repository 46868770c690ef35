//! Selection of an animation, variant, camera or scene by its name or number.

use super::file::Document;
use crate::error::{Error, ErrorKind, Result};
use crate::suggest::nearest;

/// The index of the item with this name, or else, if the name is a number, of the item with this index, from 0.
///
/// # Errors
/// `Request` if there is no such item; the hint lists the items.
pub(crate) fn choose<'a>(
    document: &Document,
    what: &str,
    list: &str,
    asked: &str,
    names: impl Iterator<Item = Option<&'a str>>,
) -> Result<usize> {
    let names: Vec<Option<&str>> = names.collect();
    if let Some(index) = names.iter().position(|name| *name == Some(asked)) {
        return Ok(index);
    }
    if let Some(index) = asked.parse().ok().filter(|&index: &usize| index < names.len()) {
        return Ok(index);
    }
    let error = document.invalid(list, format!("there is no {what} {asked:?}"));
    let error = Error { kind: ErrorKind::Request, ..error };
    let mut known: Vec<String> = names
        .iter()
        .enumerate()
        .take(12)
        .map(|(index, name)| name.map_or_else(|| index.to_string(), |name| format!("{name:?}")))
        .collect();
    if known.len() < names.len() {
        known.push("…".to_owned());
    }
    if let Some(near) = nearest(asked, names.iter().copied().flatten()) {
        return Err(error.hint(format!("did you mean {near:?}? there are: {}", known.join(", "))));
    }
    Err(match known.len() {
        0 => error.hint("the file has none at all"),
        _ => error.hint(format!("there are: {}; numbers count from 0", known.join(", "))),
    })
}
