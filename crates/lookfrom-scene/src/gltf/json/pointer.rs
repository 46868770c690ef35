//! From a position in a JSON text to the value there, as a JSON pointer (RFC 6901).

use std::ops::Range;

/// The pointer of the innermost value that contains a byte of a text, begins there or ends just before it. Up to there,
/// the text must be JSON. Between a key and its value, and between values, it is that of the object or array.
pub(super) fn pointer_at(text: &str, position: usize) -> String {
    let mut containers: Vec<Container> = Vec::new();
    let mut start = 0;
    while let Some(token) = token_from(text, start).filter(|token| token.start <= position) {
        start = token.end;
        let word = &text[token.start..token.end];
        match (word, containers.last_mut()) {
            (":", _) => {}
            (",", Some(container)) => container.advance(),
            (_, Some(Container::Object(key @ None))) if word.starts_with('"') => *key = Some(word),
            _ => {
                if matches!(word, "]" | "}") {
                    containers.pop();
                }
                let opened = match word {
                    "[" => Some(Container::Array(0)),
                    "{" => Some(Container::Object(None)),
                    _ => None,
                };
                let is_reached = token.start == position || (opened.is_none() && token.end >= position);
                if is_reached {
                    return joined(&containers);
                }
                containers.extend(opened);
            }
        }
    }
    containers.pop();
    joined(&containers)
}

/// An array or object that is open, with the index or the quoted key of the value that is read.
enum Container<'a> {
    Array(usize),
    Object(Option<&'a str>),
}

impl Container<'_> {
    /// Goes to the next value.
    fn advance(&mut self) {
        match self {
            Self::Array(index) => *index += 1,
            Self::Object(key) => *key = None,
        }
    }
}

/// The pointer of the value that is read in the last of nested containers.
fn joined(containers: &[Container<'_>]) -> String {
    let segments = containers.iter().map(|container| match container {
        Container::Array(index) => format!("/{index}"),
        Container::Object(key) => {
            let key: String = key.and_then(|key| serde_json::from_str(key).ok()).unwrap_or_default();
            format!("/{}", key.replace('~', "~0").replace('/', "~1"))
        }
    });
    segments.collect()
}

/// The next bracket, comma, colon, string, number or word of a text from a byte on; `None` at its end.
fn token_from(text: &str, start: usize) -> Option<Range<usize>> {
    let bytes = text.as_bytes();
    let start = start + bytes[start..].iter().position(|byte| !byte.is_ascii_whitespace())?;
    let length = match bytes[start] {
        b'[' | b']' | b'{' | b'}' | b',' | b':' => 1,
        b'"' => {
            let mut is_escaped = false;
            let end = bytes[start + 1..].iter().position(|&byte| {
                let is_end = byte == b'"' && !is_escaped;
                is_escaped = byte == b'\\' && !is_escaped;
                is_end
            });
            end? + 2
        }
        _ => {
            let end = bytes[start..].iter().position(|byte| b" \t\r\n[]{},:\"".contains(byte));
            end.unwrap_or(bytes.len() - start)
        }
    };
    Some(start..start + length)
}

#[cfg(test)]
mod tests {
    use super::pointer_at;

    /// Asserts the pointer at the mark `|` of a text.
    fn check(marked: &str, expected: &str) {
        let position = marked.find('|').unwrap();
        assert_eq!(pointer_at(&marked.replace('|', ""), position), expected, "{marked}");
    }

    #[test]
    fn a_value_is_from_its_first_byte_to_the_one_behind_it() {
        check("|[1]", "");
        check(r#"{"a": |10}"#, "/a");
        check(r#"{"a": 1|0}"#, "/a");
        check(r#"{"a": 10|}"#, "/a");
        check(r#"{"a": [10, |20]}"#, "/a/1");
        check(r#"{"a": [10, 20]|, "b": 1}"#, "/a");
        check(r#"{"a": [{}, |{"x": null}]}"#, "/a/1");
        check(r#"{"a": [[], {"x": "]|\""}]}"#, "/a/1/x");
        check("[[|[]]]", "/0/0");
    }

    #[test]
    fn between_values_is_the_object_that_has_them() {
        check(r#"{"b": {"a": 1, "a"|: 2}}"#, "/b");
        check(r#"{"b": {|}}"#, "/b");
        check(r#"{"b": {"a": 1 | }}"#, "/b");
    }

    #[test]
    fn keys_are_escaped() {
        check(r#"{"a/b~c\"d\u0041": |1}"#, "/a~1b~0c\"dA");
    }
}
