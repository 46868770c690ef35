//! Disjoint spans of an axis with values: the bands of a ledger, and the runs of a band.
//!
//! They are in ascending order and in their one shortest form: none is empty or has the default value, and neighbours that
//! touch differ in their values.

use std::ops::Range;

/// Numbers in a row that have the same value.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Span<T> {
    pub(super) at: Range<u32>,
    pub(super) value: T,
}

/// Appends a span behind others; it becomes one with the last if it continues it.
pub(super) fn push<T: Default + PartialEq>(spans: &mut Vec<Span<T>>, at: Range<u32>, value: T) {
    match spans.last_mut() {
        _ if at.is_empty() || value == T::default() => {}
        Some(last) if last.at.end == at.start && last.value == value => last.at.end = at.end,
        _ => spans.push(Span { at, value }),
    }
}

/// Changes the values of all numbers of a range; the default value is that of numbers without a span.
pub(super) fn update<T: Clone + Default + PartialEq>(
    spans: &mut Vec<Span<T>>,
    range: Range<u32>,
    mut change: impl FnMut(&mut T),
) {
    if range.is_empty() {
        return;
    }
    let mut changed = |mut value: T| {
        change(&mut value);
        value
    };
    // The spans that the range meets are replaced, with one before and one behind that may become one with them.
    let first = spans.partition_point(|span| span.at.end <= range.start).saturating_sub(1);
    let last = spans.partition_point(|span| span.at.start < range.end);
    let met: Vec<Span<T>> = spans.drain(first..(last + 1).min(spans.len())).collect();
    let mut all = Vec::with_capacity(met.len() + 2);
    let mut next = range.start;
    for Span { at, value } in met {
        let common = at.start.clamp(range.start, range.end)..at.end.clamp(range.start, range.end);
        // The numbers in front of this span that had none.
        if next < common.start {
            push(&mut all, next..common.start, changed(T::default()));
        }
        next = next.max(common.end);
        if common.is_empty() {
            push(&mut all, at, value);
            continue;
        }
        let before = (at.start < common.start).then(|| value.clone());
        let behind = (common.end < at.end).then(|| value.clone());
        push(&mut all, at.start..common.start, before.unwrap_or_default());
        push(&mut all, common.clone(), changed(value));
        push(&mut all, common.end..at.end, behind.unwrap_or_default());
    }
    if next < range.end {
        push(&mut all, next..range.end, changed(T::default()));
    }
    spans.splice(first..first, all);
}
