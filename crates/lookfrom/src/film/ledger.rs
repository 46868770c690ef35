//! The ledger of a film: which samples of which pixels it holds.
//!
//! A film's sums do not tell what was added to them. The ledger does, so that no sample is added twice, a stopped render
//! goes on with what is missing, and films of different parts are known to make a whole. It is kept in its one shortest
//! form, bands of rows with runs of columns, so that equal films have equal ledgers, however they came about.

mod spans;
mod text;

use std::ops::Range;

use lookfrom_scene::settings::PixelBounds;

use self::spans::Span;

/// The samples that a film holds, by pixel.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct SampleLedger {
    bands: Vec<Band>,
}

/// Rows with the same samples in the same columns.
type Band = Span<Vec<Run>>;

/// Columns with the same samples.
type Run = Span<Entry>;

/// The samples of a pixel.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
struct Entry {
    /// In ascending order; none empty, none touching the next.
    samples: Vec<Range<u32>>,
    /// Number of samples that adaptive sampling gives the pixel, once it has decided.
    goal: Option<u32>,
}

/// Samples that would be added twice.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Overlap {
    /// The first pixel, from the top left.
    pub pixel: [u32; 2],
    /// Its samples that are there twice.
    pub samples: Range<u32>,
}

impl SampleLedger {
    /// Adds samples of all pixels of an area.
    ///
    /// # Errors
    /// The first samples that it has already; then nothing has changed.
    pub fn add(&mut self, area: PixelBounds, samples: Range<u32>) -> Result<(), Overlap> {
        if samples.is_empty() {
            return Ok(());
        }
        if let Some(overlap) = self.overlap(area, &samples) {
            return Err(overlap);
        }
        self.update(area, |entry| insert(&mut entry.samples, samples.clone()));
        Ok(())
    }

    /// Adds everything that another ledger has.
    ///
    /// # Errors
    /// The first samples that both have; then nothing has changed.
    pub fn merge(&mut self, other: &Self) -> Result<(), Overlap> {
        let entries = || other.entries();
        let ranges =
            entries().flat_map(|(area, entry)| entry.samples.iter().map(move |samples| (area, samples)));
        let overlaps = ranges.filter_map(|(area, samples)| self.overlap(area, samples));
        if let Some(overlap) = overlaps.min_by_key(|overlap| (overlap.pixel[1], overlap.pixel[0])) {
            return Err(overlap);
        }
        for (area, entry) in entries() {
            self.update(area, |mine| {
                entry.samples.iter().for_each(|samples| insert(&mut mine.samples, samples.clone()));
                mine.goal = mine.goal.max(entry.goal);
            });
        }
        Ok(())
    }

    /// The parts of `wanted` that pixels of an area lack, up to the goals of adaptive sampling, as disjoint rectangles from the
    /// top left.
    pub fn missing(&self, area: PixelBounds, wanted: &Range<u32>) -> Vec<(PixelBounds, Range<u32>)> {
        let mut missing = Vec::new();
        self.in_area(area, |part, entry| {
            let Some(entry) = entry else {
                if !wanted.is_empty() {
                    missing.push((part, wanted.clone()));
                }
                return;
            };
            let end = entry.goal.map_or(wanted.end, |goal| goal.min(wanted.end));
            missing.extend(entry.missing(wanted.start..end).map(|samples| (part, samples)));
        });
        missing
    }

    /// Whether the pixels of an area have all samples of `wanted`, or of as many as their goals say.
    pub fn is_complete(&self, area: PixelBounds, wanted: &Range<u32>) -> bool {
        let mut is_complete = true;
        self.in_area(area, |_, entry| {
            let end = |entry: &Entry| entry.goal.unwrap_or(wanted.end);
            is_complete &=
                entry.is_some_and(|entry| entry.missing(wanted.start..end(entry)).next().is_none());
        });
        is_complete
    }

    /// Sets the number of samples that adaptive sampling gives each pixel that has samples, by column and row.
    pub(crate) fn set_goals(&mut self, goal_of: impl Fn([u32; 2]) -> u32) {
        for Band { at: rows, value: runs } in std::mem::take(&mut self.bands) {
            for row in rows {
                let mut changed = Vec::with_capacity(runs.len());
                for Run { at: columns, value: entry } in &runs {
                    let mut start = columns.start;
                    while start < columns.end {
                        let goal = goal_of([start, row]);
                        let end = (start..columns.end).find(|column| goal_of([*column, row]) != goal);
                        let columns = start..end.unwrap_or(columns.end);
                        start = columns.end;
                        spans::push(&mut changed, columns, Entry { goal: Some(goal), ..entry.clone() });
                    }
                }
                spans::push(&mut self.bands, row..row + 1, changed);
            }
        }
    }

    /// Takes back all goals.
    pub(crate) fn forget_goals(&mut self) {
        for Band { at: rows, value: runs } in std::mem::take(&mut self.bands) {
            let mut changed = Vec::with_capacity(runs.len());
            for Run { at: columns, value: entry } in runs {
                spans::push(&mut changed, columns, Entry { goal: None, ..entry });
            }
            spans::push(&mut self.bands, rows, changed);
        }
    }

    /// Whether all pixels of an area have goals.
    pub(crate) fn has_goals(&self, area: PixelBounds) -> bool {
        let mut has_goals = true;
        self.in_area(area, |_, entry| has_goals &= entry.is_some_and(|entry| entry.goal.is_some()));
        has_goals
    }

    /// The sum of all goals, and the largest; `None` if no pixel has one.
    pub(crate) fn goals(&self) -> Option<(u64, u32)> {
        let goals = self.entries().filter_map(|(area, entry)| Some((area.pixels(), entry.goal?)));
        goals.map(|(pixels, goal)| (pixels * u64::from(goal), goal)).reduce(|a, b| (a.0 + b.0, a.1.max(b.1)))
    }

    /// Number of samples of all pixels together.
    pub fn total(&self) -> u64 {
        self.entries().map(|(area, entry)| area.pixels() * u64::from(entry.count())).sum()
    }

    /// The largest number of samples of a pixel.
    pub fn most(&self) -> u32 {
        self.entries().map(|(_, entry)| entry.count()).max().unwrap_or(0)
    }

    /// From the least number of any sample to one more than the largest; `None` if there are none.
    pub fn range(&self) -> Option<Range<u32>> {
        let ranges = self
            .entries()
            .filter_map(|(_, entry)| Some(entry.samples.first()?.start..entry.samples.last()?.end));
        ranges.reduce(|a, b| a.start.min(b.start)..a.end.max(b.end))
    }

    /// The smallest rectangle around all pixels that have samples; `None` if there are none.
    pub fn bounds(&self) -> Option<PixelBounds> {
        self.entries().map(|(area, _)| area).reduce(PixelBounds::union)
    }

    /// The samples of all pixels of an area if they are the same.
    pub fn uniform(&self, area: PixelBounds) -> Option<Vec<Range<u32>>> {
        let mut all: Option<Vec<Range<u32>>> = None;
        let mut is_uniform = true;
        self.in_area(area, |_, entry| {
            let samples = entry.map_or_else(Vec::new, |entry| entry.samples.clone());
            is_uniform &= all.as_ref().is_none_or(|all| *all == samples);
            all = Some(samples);
        });
        all.filter(|_| is_uniform)
    }

    /// Whether the pixels of an area have all samples from 0 to their last, if any: not those of a part of a render.
    pub fn is_from_start(&self, area: PixelBounds) -> bool {
        let mut whole = true;
        self.in_area(area, |_, entry| {
            let samples = entry.map_or(&[][..], |entry| &entry.samples);
            whole &= matches!(samples, [] | [Range { start: 0, .. }]);
        });
        whole
    }

    fn entries(&self) -> impl Iterator<Item = (PixelBounds, &Entry)> {
        self.bands.iter().flat_map(|band| {
            band.value.iter().map(|run| {
                let area =
                    PixelBounds { x0: run.at.start, y0: band.at.start, x1: run.at.end, y1: band.at.end };
                (area, &run.value)
            })
        })
    }

    /// Calls `visit` with rectangles that together make `area`, and their entry if they have one.
    fn in_area(&self, area: PixelBounds, mut visit: impl FnMut(PixelBounds, Option<&Entry>)) {
        let mut row = area.y0;
        let first = self.bands.partition_point(|band| band.at.end <= area.y0);
        for band in &self.bands[first..] {
            let rows = band.at.start.max(area.y0)..band.at.end.min(area.y1);
            if rows.is_empty() {
                break;
            }
            if row < rows.start {
                visit(PixelBounds { y0: row, y1: rows.start, ..area }, None);
            }
            let mut column = area.x0;
            let of_rows = |x0, x1| PixelBounds { x0, y0: rows.start, x1, y1: rows.end };
            let first = band.value.partition_point(|run| run.at.end <= area.x0);
            for run in &band.value[first..] {
                let columns = run.at.start.max(area.x0)..run.at.end.min(area.x1);
                if columns.is_empty() {
                    break;
                }
                if column < columns.start {
                    visit(of_rows(column, columns.start), None);
                }
                visit(of_rows(columns.start, columns.end), Some(&run.value));
                column = columns.end;
            }
            if column < area.x1 {
                visit(of_rows(column, area.x1), None);
            }
            row = rows.end;
        }
        if row < area.y1 && area.x0 < area.x1 {
            visit(PixelBounds { y0: row, ..area }, None);
        }
    }

    fn overlap(&self, area: PixelBounds, samples: &Range<u32>) -> Option<Overlap> {
        let mut found = None;
        self.in_area(area, |part, entry| {
            let common = entry.iter().flat_map(|entry| &entry.samples).find_map(|mine| {
                let common = mine.start.max(samples.start)..mine.end.min(samples.end);
                (!common.is_empty()).then_some(common)
            });
            if let (None, Some(samples)) = (&found, common) {
                found = Some(Overlap { pixel: [part.x0, part.y0], samples });
            }
        });
        found
    }

    /// Changes the entries of all pixels of an area.
    fn update(&mut self, area: PixelBounds, mut change: impl FnMut(&mut Entry)) {
        spans::update(&mut self.bands, area.y0..area.y1, |runs| {
            spans::update(runs, area.x0..area.x1, &mut change);
        });
    }
}

impl Entry {
    /// The parts of a range that are not there.
    fn missing(&self, wanted: Range<u32>) -> impl Iterator<Item = Range<u32>> {
        let starts = std::iter::once(0).chain(self.samples.iter().map(|samples| samples.end));
        let ends = self.samples.iter().map(|samples| samples.start).chain([u32::MAX]);
        let gaps = starts.zip(ends).map(move |(start, end)| start.max(wanted.start)..end.min(wanted.end));
        gaps.filter(|gap| !gap.is_empty())
    }

    fn count(&self) -> u32 {
        self.samples.iter().map(|samples| samples.end - samples.start).sum()
    }
}

/// Adds a range to disjoint ones that it does not overlap.
fn insert(all: &mut Vec<Range<u32>>, samples: Range<u32>) {
    let at = all.partition_point(|known| known.start < samples.start);
    all.insert(at, samples);
    let mut joined: Vec<Range<u32>> = Vec::with_capacity(all.len());
    for samples in all.drain(..) {
        match joined.last_mut() {
            Some(last) if last.end >= samples.start => last.end = last.end.max(samples.end),
            _ => joined.push(samples),
        }
    }
    *all = joined;
}

#[cfg(test)]
mod tests;
