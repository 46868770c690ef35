//! The text of a document: tables of keys and values, in the order in which they were put.
//!
//! Numbers have the fewest digits that are read back to the same bits.

use std::fmt::Write;

use glam::{DMat4, DVec3, Vec2, Vec3};

/// The longest line of a list in characters.
const LONGEST: usize = 100;

/// A value.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Item {
    /// A number or a truth, as it is written.
    Word(String),
    Text(String),
    List(Vec<Item>),
    Table(Fields),
}

/// Keys and values.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Fields(pub(super) Vec<(String, Item)>);

impl Fields {
    pub(super) fn put(&mut self, key: &str, item: impl Into<Item>) {
        self.0.push((key.to_owned(), item.into()));
    }

    /// A value that is not the default.
    pub(super) fn put_unless<T: Copy + PartialEq + Into<Item>>(&mut self, key: &str, value: T, default: T) {
        if value != default {
            self.put(key, value);
        }
    }

    /// A table of one key.
    pub(super) fn one(key: &str, item: impl Into<Item>) -> Self {
        Self(vec![(key.to_owned(), item.into())])
    }

    pub(super) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }
}

impl Item {
    pub(super) fn list<T: Into<Self>>(items: impl IntoIterator<Item = T>) -> Self {
        Self::List(items.into_iter().map(Into::into).collect())
    }

    /// A number of single precision whose own value is read, not only what it is rounded to.
    pub(super) fn exact(number: f32) -> Self {
        f64::from(number).into()
    }

    fn is_plain(&self) -> bool {
        matches!(self, Self::Word(_) | Self::Text(_))
    }

    /// The value on one line.
    fn short(&self) -> String {
        match self {
            Self::Word(word) => word.clone(),
            Self::Text(text) => quoted(text),
            Self::List(items) => {
                let items: Vec<String> = items.iter().map(Self::short).collect();
                format!("[{}]", items.join(", "))
            }
            Self::Table(Fields(fields)) if fields.is_empty() => "{}".to_owned(),
            Self::Table(Fields(fields)) => {
                let fields = fields.iter().map(|(name, item)| format!("{} = {}", key(name), item.short()));
                format!("{{ {} }}", fields.collect::<Vec<_>>().join(", "))
            }
        }
    }

    /// The value, its lists on lines of their own where they are long.
    fn long(&self, indent: usize) -> String {
        let short = self.short();
        if short.chars().count() + indent <= LONGEST {
            return short;
        }
        match self {
            Self::Word(_) | Self::Text(_) => short,
            Self::List(items) => {
                let inner = indent + 4;
                let mut text = "[\n".to_owned();
                if items.iter().all(Self::is_plain) {
                    // Matrices are read by rows.
                    let row = if items.len() == 16 { 4 } else { 8 };
                    for items in items.chunks(row) {
                        let items: Vec<String> = items.iter().map(Self::short).collect();
                        let _ = writeln!(text, "{:inner$}{},", "", items.join(", "));
                    }
                } else {
                    for item in items {
                        let _ = writeln!(text, "{:inner$}{},", "", item.long(inner));
                    }
                }
                let _ = write!(text, "{:indent$}]", "");
                text
            }
            Self::Table(Fields(fields)) => {
                // A table within a line has no lines of its own, but lists in it have.
                let fields =
                    fields.iter().map(|(name, item)| format!("{} = {}", key(name), item.long(indent)));
                format!("{{ {} }}", fields.collect::<Vec<_>>().join(", "))
            }
        }
    }
}

impl From<f64> for Item {
    fn from(number: f64) -> Self {
        Self::Word(shortest(format!("{number:?}")))
    }
}

impl From<f32> for Item {
    fn from(number: f32) -> Self {
        let text = format!("{number:?}");
        // It is read in double precision and rounded, which could round twice.
        let is_same = text.parse::<f64>().is_ok_and(|read| (read as f32).to_bits() == number.to_bits());
        if is_same { Self::Word(shortest(text)) } else { f64::from(number).into() }
    }
}

/// Whole numbers without a fraction; but −0 would lose its sign as one.
fn shortest(text: String) -> String {
    match text.strip_suffix(".0") {
        Some(whole) if whole != "-0" => whole.to_owned(),
        _ => text,
    }
}

impl From<u32> for Item {
    fn from(number: u32) -> Self {
        Self::Word(number.to_string())
    }
}

impl From<u64> for Item {
    fn from(number: u64) -> Self {
        Self::Word(number.to_string())
    }
}

impl From<bool> for Item {
    fn from(truth: bool) -> Self {
        Self::Word(truth.to_string())
    }
}

impl From<&str> for Item {
    fn from(text: &str) -> Self {
        Self::Text(text.to_owned())
    }
}

impl From<String> for Item {
    fn from(text: String) -> Self {
        Self::Text(text)
    }
}

impl From<Fields> for Item {
    fn from(fields: Fields) -> Self {
        Self::Table(fields)
    }
}

impl<T: Into<Item>, const N: usize> From<[T; N]> for Item {
    fn from(items: [T; N]) -> Self {
        Self::list(items)
    }
}

impl From<DVec3> for Item {
    fn from(vector: DVec3) -> Self {
        vector.to_array().into()
    }
}

impl From<Vec3> for Item {
    fn from(vector: Vec3) -> Self {
        vector.to_array().into()
    }
}

impl From<Vec2> for Item {
    fn from(vector: Vec2) -> Self {
        vector.to_array().into()
    }
}

/// 16 numbers, row by row.
impl From<&DMat4> for Item {
    fn from(matrix: &DMat4) -> Self {
        matrix.transpose().to_cols_array().into()
    }
}

/// The text so far.
#[derive(Default)]
pub(super) struct Text(pub(super) String);

impl Text {
    /// Adds `[a.b]`; nothing for a table without keys that `is_needed` does not ask for.
    pub(super) fn table(&mut self, path: &[&str], fields: &Fields) {
        self.section("[", path, "]", fields);
    }

    /// Adds one `[[a.b]]`.
    pub(super) fn array(&mut self, path: &[&str], fields: &Fields) {
        self.section("[[", path, "]]", fields);
    }

    fn section(&mut self, open: &str, path: &[&str], close: &str, Fields(fields): &Fields) {
        if !self.0.is_empty() {
            self.0.push('\n');
        }
        let path: Vec<String> = path.iter().map(|part| key(part)).collect();
        // Writing to a string cannot fail.
        let _ = writeln!(self.0, "{open}{}{close}", path.join("."));
        for (name, item) in fields {
            let _ = writeln!(self.0, "{} = {}", key(name), item.long(0));
        }
    }
}

/// A key, in quotes where it needs them.
fn key(name: &str) -> String {
    let is_bare = |byte: u8| byte.is_ascii_alphanumeric() || matches!(byte, b'_' | b'-');
    if !name.is_empty() && name.bytes().all(is_bare) { name.to_owned() } else { quoted(name) }
}

/// A text in quotes.
fn quoted(text: &str) -> String {
    let mut quoted = "\"".to_owned();
    for character in text.chars() {
        match character {
            '"' | '\\' => quoted.extend(['\\', character]),
            '\n' => quoted.push_str("\\n"),
            '\t' => quoted.push_str("\\t"),
            '\r' => quoted.push_str("\\r"),
            control if control.is_control() => {
                let _ = write!(quoted, "\\u{:04X}", u32::from(control));
            }
            other => quoted.push(other),
        }
    }
    quoted.push('"');
    quoted
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_read_back_to_the_same_bits() {
        let mut bits = 0x9e37_79b9_u32;
        for _ in 0..100_000 {
            bits = bits.wrapping_mul(0x85eb_ca6b).wrapping_add(0x27d4_eb2f);
            let number = f32::from_bits(bits);
            if !number.is_finite() {
                continue;
            }
            let Item::Word(text) = Item::from(number) else { panic!() };
            assert_eq!((text.parse::<f64>().unwrap() as f32).to_bits(), number.to_bits(), "{text}");
        }
        for (number, text) in [(1.0, "1"), (-0.0, "-0.0"), (0.1, "0.1"), (1e30, "1e30"), (-2.5e-9, "-2.5e-9")]
        {
            assert_eq!(Item::from(number), Item::Word(text.to_owned()));
        }
    }

    #[test]
    fn names_are_quoted_where_they_have_to_be() {
        assert_eq!(
            [key("a-b_1"), key(""), key("a b"), key("a\"\\\n\u{1}ä")],
            ["a-b_1", "\"\"", "\"a b\"", "\"a\\\"\\\\\\n\\u0001ä\""]
        );
    }
}
