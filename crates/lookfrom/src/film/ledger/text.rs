//! The text of a ledger, for the file of its film.

use std::fmt;
use std::ops::Range;
use std::str::FromStr;

use super::{Band, Entry, Run, SampleLedger};

/// A band a line, `Y0..Y1: X0..X1 S0..S1,S2..S3; X1..X2 …`, where `!` or `!N` is the goal of a run: what it has,
/// or N samples.
impl fmt::Display for SampleLedger {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, Band { at: rows, value: runs }) in self.bands.iter().enumerate() {
            let line = if index == 0 { "" } else { "\n" };
            write!(f, "{line}{}..{}:", rows.start, rows.end)?;
            for (index, Run { at: columns, value: entry }) in runs.iter().enumerate() {
                let samples: Vec<String> = entry
                    .samples
                    .iter()
                    .map(|samples| format!("{}..{}", samples.start, samples.end))
                    .collect();
                let separator = if index == 0 { "" } else { ";" };
                write!(f, "{separator} {}..{} {}", columns.start, columns.end, samples.join(","))?;
                match entry.goal {
                    None => {}
                    Some(goal) if goal == end(&entry.samples) => write!(f, "!")?,
                    Some(goal) => write!(f, "!{goal}")?,
                }
            }
        }
        Ok(())
    }
}

/// The text of [`Display`](fmt::Display). The error is what could not be understood.
impl FromStr for SampleLedger {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let bands: Option<Vec<Band>> = text.lines().map(band).collect();
        let ledger = bands.map(|bands| Self { bands }).filter(Self::is_in_order);
        ledger.ok_or_else(|| "the ledger of its samples is damaged".to_owned())
    }
}

impl SampleLedger {
    /// Whether everything that the fields promise is true.
    fn is_in_order(&self) -> bool {
        fn ascend<'a, T>(
            all: &'a [T],
            range: impl Fn(&'a T) -> &'a Range<u32>,
            may_touch: impl Fn(&'a T, &'a T) -> bool,
        ) -> bool {
            all.iter().all(|one| !range(one).is_empty())
                && all.windows(2).all(|pair| {
                    let (end, start) = (range(&pair[0]).end, range(&pair[1]).start);
                    end < start || end == start && may_touch(&pair[0], &pair[1])
                })
        }
        ascend(&self.bands, |band| &band.at, |a, b| a.value != b.value)
            && self.bands.iter().all(|Band { value: runs, .. }| {
                !runs.is_empty() && ascend(runs, |run| &run.at, |a, b| a.value != b.value)
            })
            && self.entries().all(|(_, entry)| {
                *entry != Entry::default() && ascend(&entry.samples, |samples| samples, |_, _| false)
            })
    }
}

/// A line of a ledger's text.
fn band(line: &str) -> Option<Band> {
    let (rows, runs) = line.split_once(": ")?;
    let runs = runs.split("; ").map(|run| {
        let (columns, samples) = run.split_once(' ')?;
        let (samples, goal) =
            samples.split_once('!').map_or((samples, None), |(left, goal)| (left, Some(goal)));
        let samples = samples.split(',').filter(|samples| !samples.is_empty());
        let samples = samples.map(range).collect::<Option<Vec<_>>>()?;
        let goal = match goal {
            Some("") => Some(end(&samples)),
            Some(goal) => Some(goal.parse().ok()?),
            None => None,
        };
        Some(Run { at: range(columns)?, value: Entry { samples, goal } })
    });
    Some(Band { at: range(rows)?, value: runs.collect::<Option<_>>()? })
}

/// One more than the last sample.
fn end(samples: &[Range<u32>]) -> u32 {
    samples.last().map_or(0, |samples| samples.end)
}

fn range(text: &str) -> Option<Range<u32>> {
    let (start, end) = text.split_once("..")?;
    Some(start.parse().ok()?..end.parse().ok()?)
}
