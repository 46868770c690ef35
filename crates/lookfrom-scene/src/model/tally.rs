//! Counted warnings: one warning for all occurrences, with the location of the first.

use crate::error::Location;
use crate::files::LoadContext;
use crate::warning::{Warning, WarningKind};

/// A counter for one kind of warning.
#[derive(Clone, Copy, Default)]
pub(crate) struct Tally {
    count: u64,
    first: u32,
}

impl Tally {
    /// Counts one occurrence at a line (0 if unknown).
    pub(crate) fn add(&mut self, line: u32) {
        self.add_many(1, line);
    }

    /// Counts several occurrences at a line.
    pub(crate) fn add_many(&mut self, count: u64, line: u32) {
        if count > 0 && self.count == 0 {
            self.first = line;
        }
        self.count += count;
    }

    /// The count.
    pub(crate) fn count(self) -> u64 {
        self.count
    }

    /// The line of the first.
    pub(crate) fn first_line(self) -> u32 {
        self.first
    }

    /// Warns if there were any: "3 triangles `what`".
    pub(crate) fn warn(self, noun: &str, what: &str, file: &Location, context: &mut LoadContext<'_>) {
        self.tell(WarningKind::Warning, noun, what, file, context);
    }

    /// Tells the count as a note: the image is as intended.
    pub(crate) fn notice(self, noun: &str, what: &str, file: &Location, context: &mut LoadContext<'_>) {
        self.tell(WarningKind::Notice, noun, what, file, context);
    }

    fn tell(self, kind: WarningKind, noun: &str, what: &str, file: &Location, context: &mut LoadContext<'_>) {
        if self.count > 0 {
            let warning = Warning { kind, ..Warning::new(&file.at(self.first, 0), what) };
            context.warnings.push(warning.of(self.count, noun));
        }
    }
}
