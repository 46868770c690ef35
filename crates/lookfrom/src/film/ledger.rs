//! The ledger of a film: which samples of which pixels it holds.
//!
//! A film's sums do not tell what was added to them. The ledger does, so that no sample is added twice, a stopped render
//! goes on with what is missing, and films of different parts are known to make a whole. It is kept in its one shortest
//! form, bands of rows with runs of columns, so that equal films have equal ledgers, however they came about.

mod text;

use std::ops::Range;

use lookfrom_scene::settings::PixelBounds;

/// The samples that a film holds, by pixel.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct SampleLedger {
    /// In ascending order, disjoint; neighbours that touch differ in their runs.
    bands: Vec<Band>,
}

/// Rows with the same samples in the same columns.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Band {
    rows: Range<u32>,
    /// In ascending order, disjoint, none empty; neighbours that touch differ in their entries.
    runs: Vec<Run>,
}

/// Columns with the same samples.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Run {
    columns: Range<u32>,
    entry: Entry,
}

/// The samples of a pixel.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
struct Entry {
    /// In ascending order; none empty, none touching the next.
    samples: Vec<Range<u32>>,
    /// Whether adaptive sampling has found the pixel clean enough to get no more.
    is_clean: bool,
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
                mine.is_clean |= entry.is_clean;
            });
        }
        Ok(())
    }

    /// The parts of `wanted` that pixels of an area lack and that adaptive sampling has not found clean, as disjoint
    /// rectangles from the top left.
    pub fn missing(&self, area: PixelBounds, wanted: &Range<u32>) -> Vec<(PixelBounds, Range<u32>)> {
        let mut missing = Vec::new();
        self.in_area(area, |part, entry| {
            let Some(entry) = entry else {
                missing.push((part, wanted.clone()));
                return;
            };
            if entry.is_clean {
                return;
            }
            let mut start = wanted.start;
            for samples in &entry.samples {
                let end = samples.start.min(wanted.end);
                if start < end {
                    missing.push((part, start..end));
                }
                start = start.max(samples.end);
            }
            if start < wanted.end {
                missing.push((part, start..wanted.end));
            }
        });
        missing.retain(|(_, samples)| !samples.is_empty());
        missing
    }

    /// Marks the pixels of an area as clean enough for adaptive sampling: nothing of them is missing any more.
    pub(crate) fn mark_clean(&mut self, area: PixelBounds) {
        self.update(area, |entry| entry.is_clean = true);
    }

    /// Takes back what [`Self::mark_clean`] did.
    pub(crate) fn forget_clean(&mut self) {
        for (area, _) in self.clone().entries() {
            self.update(area, |entry| entry.is_clean = false);
        }
    }

    /// Whether all pixels of an area are marked as clean.
    pub(crate) fn is_clean(&self, area: PixelBounds) -> bool {
        let mut clean = true;
        self.in_area(area, |_, entry| clean &= entry.is_some_and(|entry| entry.is_clean));
        clean
    }

    /// Number of samples of all pixels together.
    pub fn total(&self) -> u64 {
        self.entries().map(|(area, entry)| pixels(area) * u64::from(entry.count())).sum()
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
        self.entries().map(|(area, _)| area).reduce(|a, b| PixelBounds {
            x0: a.x0.min(b.x0),
            y0: a.y0.min(b.y0),
            x1: a.x1.max(b.x1),
            y1: a.y1.max(b.y1),
        })
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
            band.runs.iter().map(|run| {
                let area = PixelBounds {
                    x0: run.columns.start,
                    y0: band.rows.start,
                    x1: run.columns.end,
                    y1: band.rows.end,
                };
                (area, &run.entry)
            })
        })
    }

    /// Calls `visit` with rectangles that together make `area`, and their entry if they have one.
    fn in_area(&self, area: PixelBounds, mut visit: impl FnMut(PixelBounds, Option<&Entry>)) {
        let mut row = area.y0;
        let first = self.bands.partition_point(|band| band.rows.end <= area.y0);
        for band in &self.bands[first..] {
            let rows = band.rows.start.max(area.y0)..band.rows.end.min(area.y1);
            if rows.is_empty() {
                break;
            }
            if row < rows.start {
                visit(PixelBounds { y0: row, y1: rows.start, ..area }, None);
            }
            let mut column = area.x0;
            let of_rows = |x0, x1| PixelBounds { x0, y0: rows.start, x1, y1: rows.end };
            for run in &band.runs {
                let columns = run.columns.start.max(area.x0)..run.columns.end.min(area.x1);
                if columns.is_empty() {
                    continue;
                }
                if column < columns.start {
                    visit(of_rows(column, columns.start), None);
                }
                visit(of_rows(columns.start, columns.end), Some(&run.entry));
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
        if area.x0 >= area.x1 || area.y0 >= area.y1 {
            return;
        }
        // The bands that the area meets, and its rows between them, are replaced.
        let first = self.bands.partition_point(|band| band.rows.end <= area.y0);
        let last = self.bands.partition_point(|band| band.rows.start < area.y1);
        let met: Vec<Band> = self.bands.drain(first..last).collect();
        let mut bands = Vec::with_capacity(met.len() + 2);
        let mut row = area.y0;
        let mut changed = |rows: Range<u32>, runs: &[Run]| {
            let runs = updated(runs, area.x0..area.x1, &mut change);
            Band { rows, runs }
        };
        for Band { rows, runs } in met {
            if rows.start < area.y0 {
                bands.push(Band { rows: rows.start..area.y0, runs: runs.clone() });
            }
            let common = rows.start.max(area.y0)..rows.end.min(area.y1);
            if row < common.start {
                bands.push(changed(row..common.start, &[]));
            }
            bands.push(changed(common.clone(), &runs));
            row = common.end;
            if rows.end > area.y1 {
                bands.push(Band { rows: area.y1..rows.end, runs });
            }
        }
        if row < area.y1 {
            bands.push(changed(row..area.y1, &[]));
        }
        bands.retain(|band| !band.runs.is_empty());
        // Neighbours with the same runs become one, together with the bands before and behind.
        let start = first.saturating_sub(1);
        let end = (first + 1).min(self.bands.len());
        let before = self.bands.get(start..first).unwrap_or_default().to_vec();
        let behind = self.bands.get(first..end).unwrap_or_default().to_vec();
        let mut joined: Vec<Band> = Vec::with_capacity(bands.len() + 2);
        for band in before.into_iter().chain(bands).chain(behind) {
            match joined.last_mut() {
                Some(last) if last.rows.end == band.rows.start && last.runs == band.runs => {
                    last.rows.end = band.rows.end;
                }
                _ => joined.push(band),
            }
        }
        self.bands.splice(start..end, joined);
    }
}

/// The runs of a band after a change in some of its columns.
fn updated(runs: &[Run], columns: Range<u32>, change: &mut impl FnMut(&mut Entry)) -> Vec<Run> {
    let mut all: Vec<Run> = Vec::with_capacity(runs.len() + 2);
    let mut push = |columns: Range<u32>, entry: Entry| {
        if columns.is_empty() || entry == Entry::default() {
            return;
        }
        match all.last_mut() {
            Some(last) if last.columns.end == columns.start && last.entry == entry => {
                last.columns.end = columns.end;
            }
            _ => all.push(Run { columns, entry }),
        }
    };
    let mut column = columns.start;
    let mut changed = |entry: &Entry| {
        let mut entry = entry.clone();
        change(&mut entry);
        entry
    };
    for run in runs {
        let Run { columns: mine, entry } = run;
        if mine.end <= columns.start {
            push(mine.clone(), entry.clone());
            continue;
        }
        if mine.start < columns.start {
            push(mine.start..columns.start, entry.clone());
        }
        // The columns in front of this run that had no entry.
        let common = mine.start.clamp(columns.start, columns.end)..mine.end.clamp(columns.start, columns.end);
        if column < common.start {
            push(column..common.start, changed(&Entry::default()));
        }
        push(common.clone(), changed(entry));
        column = column.max(common.end);
        push(mine.start.max(columns.end)..mine.end.max(columns.end), entry.clone());
    }
    if column < columns.end {
        // Behind the last run that begins in front of the end; runs behind the end have been handled by their clamps.
        push(column..columns.end, changed(&Entry::default()));
    }
    all
}

impl Entry {
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

fn pixels(area: PixelBounds) -> u64 {
    u64::from(area.x1 - area.x0) * u64::from(area.y1 - area.y0)
}

#[cfg(test)]
mod tests;
