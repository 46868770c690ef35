//! Numbers of things in sentences: "1 sample", "2 samples".

use std::fmt;

/// A number of things, displayed with its noun; `noun` is the singular, whose last word gets the plural.
pub fn counted(count: impl TryInto<u64>, noun: &str) -> impl fmt::Display {
    struct Shown<'a>(u64, &'a str);
    impl fmt::Display for Shown<'_> {
        fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
            write!(f, "{} {}", self.0, of_count(self.0, self.1))
        }
    }
    // No number of things is larger than this.
    Shown(count.try_into().unwrap_or(u64::MAX), noun)
}

/// A count with its noun and verb: "1 value is", "2 values are".
pub fn are(count: u64, noun: &str) -> String {
    format!("{} {}", counted(count, noun), be(count))
}

/// "there is 1 vertex", "there are 2 vertices".
pub fn there_are(count: u64, noun: &str) -> String {
    format!("there {} {}", be(count), counted(count, noun))
}

/// The verb for so many things: is, are.
pub fn be(count: u64) -> &'static str {
    if count == 1 { "is" } else { "are" }
}

/// The noun for so many things.
pub fn of_count(count: u64, noun: &str) -> String {
    if count == 1 {
        return noun.to_owned();
    }
    if noun.ends_with("leaf") {
        return format!("{}ves", &noun[..noun.len() - 1]);
    }
    // "vertices", "indices".
    if let Some(stem) = noun.strip_suffix("ex") {
        return format!("{stem}ices");
    }
    let hisses = ["s", "x", "z", "ch", "sh"].iter().any(|end| noun.ends_with(end));
    match noun.strip_suffix('y').filter(|stem| !stem.ends_with(['a', 'e', 'i', 'o', 'u'])) {
        Some(stem) => format!("{stem}ies"),
        None if hisses => format!("{noun}es"),
        None => format!("{noun}s"),
    }
}

#[cfg(test)]
mod tests {
    use super::{are, counted};

    #[test]
    fn one_is_singular() {
        let said = |count: usize, noun| counted(count, noun).to_string();
        assert_eq!(said(1, "sample"), "1 sample");
        assert_eq!(said(0, "sample"), "0 samples");
        assert_eq!(said(2, "control point"), "2 control points");
        assert_eq!(said(3, "vertex"), "3 vertices");
        assert_eq!(said(3, "body"), "3 bodies");
        assert_eq!(said(3, "leaf"), "3 leaves");
        assert_eq!(said(3, "mesh"), "3 meshes");
        assert_eq!(said(3, "key"), "3 keys");
        assert_eq!([are(1, "value"), are(2, "value")], ["1 value is", "2 values are"]);
    }
}
