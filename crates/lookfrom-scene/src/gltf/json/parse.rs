//! From the text of a glTF file to its structures, or to what is wrong with it and where.

use std::borrow::Cow;

use serde::Deserialize;
use serde::de::IgnoredAny;

use super::Root;
use super::pointer::pointer_at;

/// The error of a text that is not glTF.
pub(in crate::gltf) struct Wrong {
    /// The message.
    pub(in crate::gltf) message: String,
    /// The location as a JSON pointer, if the text is JSON.
    pub(in crate::gltf) pointer: Option<String>,
    /// The line, from 1.
    pub(in crate::gltf) line: u32,
    /// The column, from 1.
    pub(in crate::gltf) column: u32,
}

/// The text of a file's bytes: without a byte order mark, and without the spaces and zeros at its end.
pub(in crate::gltf) fn text(bytes: &[u8]) -> Cow<'_, str> {
    let bytes = bytes.strip_prefix("\u{feff}".as_bytes()).unwrap_or(bytes);
    let end = bytes.iter().rposition(|byte| !b"\0 \n\r\t".contains(byte)).map_or(0, |last| last + 1);
    String::from_utf8_lossy(&bytes[..end])
}

/// Parses the text.
pub(in crate::gltf) fn parse(text: &str) -> Result<Root, Wrong> {
    serde_json::from_str(text).map_err(|error| {
        let message = error.to_string();
        // The message ends with line and column, which are reported separately.
        let message = message.split(" at line ").next().unwrap_or_default();
        // An array that is too long is a syntax error for serde_json, since it should have ended; so is a number too large
        // for f64. Both are valid JSON.
        let is_out_of_range = message == "number out of range";
        let is_too_long =
            message == "trailing characters" && serde_json::from_str::<IgnoredAny>(text).is_ok();
        let is_json = error.is_data() || is_too_long || is_out_of_range;
        let pointer = is_json.then(|| {
            let position = position(text, &error);
            if is_too_long {
                // The position is one byte into the first value too many.
                let mut pointer = pointer_at(text, position - 1);
                pointer.truncate(pointer.rfind('/').unwrap_or(0));
                pointer
            } else {
                pointer_at(text, position)
            }
        });
        Wrong {
            message: if is_too_long {
                "the array has too many values".to_owned()
            } else if is_out_of_range {
                "the number is too large".to_owned()
            } else {
                in_words_of_json(message)
            },
            pointer,
            line: u32::try_from(error.line()).unwrap_or(0),
            column: u32::try_from(error.column()).unwrap_or(0),
        }
    })
}

/// The byte of a text to which the line and column of an error lead.
fn position(text: &str, error: &serde_json::Error) -> usize {
    let lines_before = text.split_inclusive('\n').take(error.line().saturating_sub(1));
    lines_before.map(str::len).sum::<usize>() + error.column()
}

/// The version in `asset` of a JSON text that does not parse as glTF 2.0; `None` if there is none.
pub(in crate::gltf) fn version(text: &str) -> Option<String> {
    #[derive(Deserialize)]
    struct Versioned {
        asset: AnyAsset,
    }
    // Files of the first version have it as a number, too.
    #[derive(Deserialize)]
    struct AnyAsset {
        version: serde_json::Value,
    }
    match serde_json::from_str::<Versioned>(text).ok()?.asset.version {
        serde_json::Value::String(version) => Some(version),
        serde_json::Value::Number(version) => Some(version.to_string()),
        _ => None,
    }
}

/// The message of serde with JSON's terms instead of the names of our types.
fn in_words_of_json(message: &str) -> String {
    let words = [
        ("f64", "a number"),
        ("a map", "an object"),
        ("a sequence", "an array"),
        ("map", "object"),
        ("sequence", "array"),
    ];
    let message = match message.split_once("expected struct ") {
        Some((found, _)) => format!("{found}expected an object"),
        None => message.to_owned(),
    };
    words.into_iter().fold(message, |message, (word, meant)| message.replace(word, meant))
}
