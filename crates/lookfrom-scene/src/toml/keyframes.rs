//! Keyframes: a value that changes with time.

use super::evaluate::{modulo, numbers};
use super::function::eased;
use super::quantity::Quantity;
use super::scope::Scope;
use super::table::Table;
use super::value::Value;
use crate::error::Result;

/// The key that makes a table one of keyframes.
pub(super) const KEYFRAMES: &str = "keyframes";

/// The keys of the table.
pub(super) const KEYS: &[&str] = &[KEYFRAMES, "interpolation", "repeat"];

/// Times of keyframes that repeat are alike if they differ by no more than this fraction of the period.
const ROUNDING: f64 = 1e-9;

/// The interpolation between two keyframes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Interpolation {
    /// A straight line.
    Linear,
    /// The value of the earlier one.
    Step,
    /// A line that rests at each of them.
    Smooth,
    /// A curve through all of them, whose direction at each is that from its neighbour before to that after (Catmull & Rom
    /// 1974); it rests at the ends.
    Cubic,
}

pub(super) const INTERPOLATIONS: &[(&str, Interpolation)] = &[
    ("linear", Interpolation::Linear),
    ("step", Interpolation::Step),
    ("smooth", Interpolation::Smooth),
    ("cubic", Interpolation::Cubic),
];

/// A keyframe: where it is written, its time in seconds, its value.
struct Keyframe<'a> {
    item: Value<'a>,
    time: f64,
    value: Quantity,
}

/// The value of a table of keyframes at the scene's time. Before the first keyframe it is that of the first, after the
/// last that of the last, unless they repeat.
pub(super) fn at_time(table: &Table<'_>, scope: &Scope<'_>) -> Result<Quantity> {
    table.allow(&[KEYS]);
    let interpolation =
        table.or("interpolation", Interpolation::Linear, |value| value.choice(INTERPOLATIONS));
    let repeats = table.or("repeat", false, Value::boolean);
    let Some(list) = table.find(KEYFRAMES) else { return Err(table.missing(KEYFRAMES, "[[0, 1], [2, 3]]")) };
    let frames = read(list, scope)?;
    table.sound(&["interpolation", "repeat"])?;
    let (Some(first), Some(last)) = (frames.first(), frames.last()) else {
        return Err(list.error("there are no keyframes").hint("write [[0, 1], [2, 3]]: times and values"));
    };
    // Told at any time, not only between two of them.
    if interpolation != Interpolation::Step {
        frames.windows(2).try_for_each(|pair| check(&pair[0], &pair[1]))?;
    }
    let now = scope.now(last.time);
    let length = last.time - first.time;
    let repeats = repeats && length > 0.0;
    let now = if repeats { first.time + modulo(now - first.time, length) } else { now };
    // The remainder is rounded: 0.7 s of a period of 0.3 s is just before the keyframe at 0.1 s, and has to be at it.
    let rounding = if repeats { ROUNDING * length } else { 0.0 };
    let now = if repeats && last.time - now <= rounding { first.time } else { now };
    let index = frames.partition_point(|frame| frame.time <= now + rounding).saturating_sub(1);
    let Some(next) = frames.get(index + 1) else { return Ok(last.value.clone()) };
    let frame = &frames[index];
    if now <= frame.time || interpolation == Interpolation::Step {
        return Ok(frame.value.clone());
    }
    let span = next.time - frame.time;
    let u = (now - frame.time) / span;
    let mixed = match interpolation {
        Interpolation::Cubic => {
            let [before, after] = neighbours(&frames, index, repeats);
            let values =
                [before.1, &frame.value, &next.value, after.1, &first.value, &last.value].map(Clone::clone);
            // Of a curve that repeats, neighbours beyond an end are as far from it as they are from the other end.
            let wraps = [before.2, after.2];
            let spans = [span + before.0, span + after.0].map(|width| span / width);
            numbers(&values, "cubic", 0, &|x| {
                let shift = x[5] - x[4];
                let start = if before.0 > 0.0 { (x[2] - x[0] + wraps[0] * shift) * spans[0] } else { 0.0 };
                let end = if after.0 > 0.0 { (x[3] - x[1] + wraps[1] * shift) * spans[1] } else { 0.0 };
                hermite(x[1], x[2], [start, end], u)
            })
        }
        _ => {
            let u = if interpolation == Interpolation::Smooth { eased(u) } else { u };
            let values = [&frame.value, &next.value].map(Clone::clone);
            numbers(&values, "", 0, &|x| x[0] + (x[1] - x[0]) * u)
        }
    };
    mixed.map_err(|_| next.item.error(format!("the value at {now} s is not a finite number")))
}

/// Whether there is something between two keyframes.
fn check(one: &Keyframe<'_>, other: &Keyframe<'_>) -> Result<()> {
    let between = numbers(&[one.value.clone(), other.value.clone()], "", 0, &|_| 0.0);
    between.map(|_| ()).map_err(|_| {
        let (one, other_value) = (one.value.what(), other.value.what());
        let message = format!(
            "there is nothing between {one} and {other_value}; expected numbers, or lists of numbers of the same length"
        );
        other.item.error(message).hint("`interpolation = \"step\"` changes from one to the next")
    })
}

/// A keyframe beside two others: how long before or after them it is (0 if there is none), its value, and by how many
/// whole rounds that is shifted.
type Neighbour<'a> = (f64, &'a Quantity, f64);

/// The keyframes before and after the two from an index on.
fn neighbours<'a>(frames: &'a [Keyframe<'_>], index: usize, repeats: bool) -> [Neighbour<'a>; 2] {
    let gap = |a: usize, b: usize| frames[b].time - frames[a].time;
    let last = frames.len() - 1;
    let before = match index {
        0 if repeats => (gap(last - 1, last), &frames[last - 1].value, 1.0),
        0 => (0.0, &frames[0].value, 0.0),
        _ => (gap(index - 1, index), &frames[index - 1].value, 0.0),
    };
    let after = match index + 2 {
        next if next <= last => (gap(index + 1, next), &frames[next].value, 0.0),
        _ if repeats => (gap(0, 1), &frames[1].value, 1.0),
        _ => (0.0, &frames[last].value, 0.0),
    };
    [before, after]
}

/// The cubic from `a` to `b` with these slopes, for u from 0 to 1.
fn hermite(a: f64, b: f64, [start, end]: [f64; 2], u: f64) -> f64 {
    let rise = b - a;
    a + u * (start + u * (3.0 * rise - 2.0 * start - end + u * (start + end - 2.0 * rise)))
}

fn read<'a>(list: Value<'a>, scope: &Scope<'_>) -> Result<Vec<Keyframe<'a>>> {
    const EXPECTED: &str = "a list of keyframes, [[time, value], …]";
    let mut frames: Vec<Keyframe<'a>> = Vec::new();
    for item in list.list(EXPECTED)? {
        let [time, value] = item.list_of::<2>("a keyframe, [time in seconds, value]")?;
        let Quantity::Number(seconds) = scope.quantity(time)? else {
            return Err(time.wrong("the time of a keyframe in seconds"));
        };
        if let Some(before) = frames.last().filter(|before| before.time >= seconds) {
            return Err(time
                .error(format!("the keyframe at {seconds} s comes after that at {} s", before.time))
                .hint("write keyframes in the order of their times, each time once"));
        }
        frames.push(Keyframe { item: value, time: seconds, value: scope.quantity(value)? });
    }
    Ok(frames)
}
