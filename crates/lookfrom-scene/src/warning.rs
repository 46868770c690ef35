//! Warnings, their severity, and the grouping of equal ones.

use std::collections::HashMap;
use std::fmt;

use crate::error::Location;
use crate::plural;
use crate::remedy::Remedy;

/// The severity of a warning.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[non_exhaustive]
pub enum WarningKind {
    /// The image may differ from the intended one.
    Warning,
    /// Harmless: the image is as intended.
    Notice,
}

/// A recoverable problem: the image is rendered nevertheless.
#[derive(Clone, Debug, PartialEq)]
pub struct Warning {
    /// The severity.
    pub kind: WarningKind,
    /// The location; of several occurrences in a file, the first.
    pub at: Location,
    /// The message: what was found and what was done instead. If items were [counted](Self::counted), without their
    /// number and noun.
    pub message: String,
    /// The items that the message is about, if they were counted.
    pub counted: Option<Counted>,
    /// A way to have it otherwise, if one is known.
    pub remedy: Option<Remedy>,
}

/// A number of items of one kind.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Counted {
    /// The count: at least 1.
    pub count: u64,
    /// The noun for one item.
    pub noun: String,
}

impl Warning {
    /// A warning that the image may differ from the intended one.
    pub fn new(at: &Location, message: impl Into<String>) -> Self {
        Self {
            kind: WarningKind::Warning,
            at: at.clone(),
            message: message.into(),
            counted: None,
            remedy: None,
        }
    }

    /// A harmless warning.
    pub fn notice(at: &Location, message: impl Into<String>) -> Self {
        Self { kind: WarningKind::Notice, ..Self::new(at, message) }
    }

    /// Adds a way to have it otherwise.
    #[must_use]
    pub fn remedy(mut self, remedy: Remedy) -> Self {
        self.remedy = Some(remedy);
        self
    }

    /// Puts the remedy into the words of a front end.
    #[must_use]
    pub fn worded(mut self, words: impl Fn(&Remedy) -> String) -> Self {
        self.remedy = self.remedy.map(|remedy| Remedy::Words(words(&remedy)));
        self
    }

    /// The message with the items that were counted, and the remedy.
    fn write_message(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(counted) = &self.counted {
            write!(f, "{counted}")?;
        }
        f.write_str(&self.message)?;
        self.remedy.as_ref().map_or(Ok(()), |remedy| write!(f, "; {remedy}"))
    }

    /// Makes it a warning about a number of items.
    #[must_use]
    pub fn of(mut self, count: u64, noun: impl Into<String>) -> Self {
        self.counted = Some(Counted { count, noun: noun.into() });
        self
    }
}

impl fmt::Display for Counted {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { count, noun } = self;
        write!(f, "{} ", plural::counted(*count, noun))
    }
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: ", self.at)?;
        self.write_message(f)?;
        let has_further = self.counted.as_ref().is_some_and(|counted| counted.count > 1);
        if has_further && self.at.line > 0 { f.write_str(" (the first is here)") } else { Ok(()) }
    }
}

/// Maximum number of further locations that a [`WarningGroup`] displays.
const PLACES: usize = 2;

/// Warnings with the same message at several locations.
#[derive(Clone, Debug, PartialEq)]
pub struct WarningGroup {
    /// The first of them, with the total number of items.
    pub first: Warning,
    /// The locations of the others.
    pub further: Vec<Location>,
}

impl WarningGroup {
    /// Groups of warnings with the same message: first those that may change the image, then the harmless ones; otherwise in
    /// the order in which they were found.
    pub fn of(warnings: &[Warning]) -> Vec<Self> {
        let mut groups: Vec<Self> = Vec::new();
        let mut by_what = HashMap::new();
        for warning in warnings {
            let noun = warning.counted.as_ref().map(|counted| &counted.noun);
            let index = *by_what.entry((warning.kind, noun, &warning.message)).or_insert(groups.len());
            let Some(group) = groups.get_mut(index) else {
                groups.push(Self { first: warning.clone(), further: Vec::new() });
                continue;
            };
            if let (Some(sum), Some(add)) = (&mut group.first.counted, &warning.counted) {
                sum.count = sum.count.saturating_add(add.count);
            }
            if *group.further.last().unwrap_or(&group.first.at) != warning.at {
                group.further.push(warning.at.clone());
            }
        }
        groups.sort_by_key(|group| group.first.kind);
        groups
    }

    /// Their severity.
    pub fn kind(&self) -> WarningKind {
        self.first.kind
    }
}

impl fmt::Display for WarningGroup {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { first, further } = self;
        if further.is_empty() {
            return first.fmt(f);
        }
        write!(f, "{}: ", first.at)?;
        first.write_message(f)?;
        f.write_str(" (also at ")?;
        let left = further.len().saturating_sub(PLACES);
        for (index, place) in further.iter().take(PLACES).enumerate() {
            let is_last = left == 0 && index + 1 == further.len();
            let before = match index {
                0 => "",
                _ if is_last => " and ",
                _ => ", ",
            };
            write!(f, "{before}{place}")?;
        }
        match left {
            0 => f.write_str(")"),
            1 => f.write_str(" and one more place)"),
            _ => write!(f, " and {left} more places)"),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;

    fn lines(warnings: &[Warning]) -> Vec<String> {
        WarningGroup::of(warnings).iter().map(ToString::to_string).collect()
    }

    #[test]
    fn what_is_said_often_is_one_line_behind_what_matters() {
        let flat = |name: &str, line: u32, count: u64| {
            let at = Location::file(Path::new(name)).at(line, 0);
            Warning::notice(&at, "left out: without area").of(count, "triangle")
        };
        let other = Warning::new(&Location::file(Path::new("z.obj")), "something real");
        let mut warnings = vec![flat("a.ply", 0, 1), flat("b.ply", 7, 62), other.clone()];
        assert_eq!(
            lines(&warnings),
            ["z.obj: something real", "a.ply: 63 triangles left out: without area (also at b.ply:7)"]
        );
        assert_eq!(lines(&warnings[..1]), ["a.ply: 1 triangle left out: without area"]);
        assert_eq!(
            lines(&warnings[1..2]),
            ["b.ply:7: 62 triangles left out: without area (the first is here)"]
        );
        warnings.push(flat("c.ply", 0, 1));
        assert!(
            lines(&warnings)[1].ends_with("64 triangles left out: without area (also at b.ply:7 and c.ply)")
        );
        warnings.push(flat("d.ply", 0, 1));
        assert!(lines(&warnings)[1].ends_with("(also at b.ply:7, c.ply and one more place)"));
        warnings.extend((0..115).map(|k| flat(&format!("{k}.ply"), 0, 1)));
        assert!(lines(&warnings)[1].ends_with("(also at b.ply:7, c.ply and 116 more places)"));
        // A remedy stands behind the message, in the words of whoever tells it.
        let up = |line| {
            Warning::notice(&Location::file(Path::new("a.stl")).at(line, 0), "z is up")
                .remedy(Remedy::Up("y"))
        };
        assert_eq!(lines(&[up(1)]), ["a.stl:1: z is up; the option `up` = y shows it otherwise"]);
        let typed = [up(1), up(2)].map(|warning| warning.worded(|remedy| format!("{remedy:?}")));
        assert_eq!(lines(&typed), ["a.stl:1: z is up; Up(\"y\") (also at a.stl:2)"]);
        // The same message of another kind is another line, and equal locations are listed once.
        let twice = [other.clone(), Warning { kind: WarningKind::Notice, ..other.clone() }, other];
        assert_eq!(lines(&twice), ["z.obj: something real"; 2]);
    }
}
