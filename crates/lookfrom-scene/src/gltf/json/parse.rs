//! From the text of a glTF file to its structures, or to what is wrong with it and where.

use serde::Deserialize;

use super::Root;

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

/// Parses the text.
pub(in crate::gltf) fn parse(text: &str) -> Result<Root, Wrong> {
    // First without the path to the error: tracking it costs time and is only needed for a message.
    serde_json::from_str(text).map_err(|error| {
        let mut deserializer = serde_json::Deserializer::from_str(text);
        let path = serde_path_to_error::deserialize::<_, Root>(&mut deserializer).err();
        let message = error.to_string();
        // The message ends with line and column, which are reported separately.
        let message = message.split(" at line ").next().unwrap_or_default();
        // An array that is too long is a syntax error for serde_json, since it should have ended; so is a number too large
        // for f64. Both are valid JSON.
        let is_out_of_range = message == "number out of range";
        let is_too_long = !error.is_data()
            && !is_out_of_range
            && serde_json::from_str::<serde::de::IgnoredAny>(text).is_ok();
        let is_json = error.is_data() || is_too_long || is_out_of_range;
        let pointer = path.filter(|_| is_json).map(|error| pointer(error.path()));
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

fn pointer(path: &serde_path_to_error::Path) -> String {
    use serde_path_to_error::Segment;
    let mut pointer = String::new();
    for segment in path {
        match segment {
            Segment::Seq { index } => pointer.push_str(&format!("/{index}")),
            Segment::Map { key } => {
                pointer.push_str(&format!("/{}", key.replace('~', "~0").replace('/', "~1")));
            }
            Segment::Enum { .. } | Segment::Unknown => {}
        }
    }
    pointer
}
