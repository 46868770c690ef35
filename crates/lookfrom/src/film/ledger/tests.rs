//! Tests of the ledger: what was added pixel by pixel.

use super::*;
use crate::core::hash;
use std::collections::BTreeMap;

/// The samples of each pixel, one by one.
type Plain = BTreeMap<[u32; 2], Vec<u32>>;

const WHOLE: PixelBounds = PixelBounds { x0: 0, y0: 0, x1: 12, y1: 10 };

fn plain(ledger: &SampleLedger) -> Plain {
    let mut plain = Plain::new();
    for (area, entry) in ledger.entries() {
        for y in area.y0..area.y1 {
            for x in area.x0..area.x1 {
                let samples = entry.samples.iter().flat_map(Clone::clone).collect();
                assert!(plain.insert([x, y], samples).is_none(), "({x}, {y}) is there twice");
            }
        }
    }
    plain.retain(|_, samples: &mut Vec<u32>| !samples.is_empty());
    plain
}

/// Random additions, with those that were refused left out.
fn random(seed: u64) -> (SampleLedger, Plain) {
    let number = |k: u64, below: u64| (hash::pair(seed, k) >> 8) % below;
    let (mut ledger, mut slow) = (SampleLedger::default(), Plain::new());
    for k in (0..240).step_by(6) {
        let (x0, y0) = (number(k, 12) as u32, number(k + 1, 10) as u32);
        let (x1, y1) = (
            x0 + 1 + number(k + 2, 12 - u64::from(x0)) as u32,
            y0 + 1 + number(k + 3, 10 - u64::from(y0)) as u32,
        );
        let first = number(k + 4, 9) as u32;
        let samples = first..first + 1 + number(k + 5, 3) as u32;
        let area = PixelBounds { x0, y0, x1, y1 };
        let inside = |[x, y]: [u32; 2]| (x0..x1).contains(&x) && (y0..y1).contains(&y);
        let is_twice =
            slow.iter().any(|(at, known)| inside(*at) && known.iter().any(|s| samples.contains(s)));
        let before = ledger.clone();
        assert_eq!(ledger.add(area, samples.clone()).is_err(), is_twice);
        if is_twice {
            assert_eq!(ledger, before);
            continue;
        }
        for y in y0..y1 {
            for x in x0..x1 {
                let known = slow.entry([x, y]).or_default();
                known.extend(samples.clone());
                known.sort_unstable();
            }
        }
        assert_eq!(plain(&ledger), slow);
    }
    (ledger, slow)
}

#[test]
fn it_is_what_was_added_pixel_by_pixel() {
    for seed in 0..40 {
        let (ledger, slow) = random(seed);
        assert_eq!(ledger.total(), slow.values().map(|samples| samples.len() as u64).sum::<u64>());
        assert_eq!(ledger.to_string().parse(), Ok(ledger.clone()), "{ledger}");
        // What is missing makes it whole, and the one shortest form does not depend on the order.
        let wanted = 2..11;
        let mut whole = ledger.clone();
        for (area, samples) in ledger.missing(WHOLE, &wanted) {
            whole.add(area, samples).unwrap();
        }
        assert!(whole.missing(WHOLE, &wanted).is_empty());
        let mut again = SampleLedger::default();
        for (at, samples) in plain(&whole).into_iter().rev() {
            let area = PixelBounds { x0: at[0], y0: at[1], x1: at[0] + 1, y1: at[1] + 1 };
            samples.into_iter().rev().for_each(|s| again.add(area, s..s + 1).unwrap());
        }
        assert_eq!(again, whole);
        // Merged of two parts.
        let mut merged = SampleLedger::default();
        for (area, entry) in whole.entries() {
            if area.x0 % 2 == 1 {
                entry.samples.iter().for_each(|s| merged.add(area, s.clone()).unwrap());
            }
        }
        let mut rest = SampleLedger::default();
        for (area, entry) in whole.entries().filter(|(area, _)| area.x0 % 2 == 0) {
            entry.samples.iter().for_each(|s| rest.add(area, s.clone()).unwrap());
        }
        merged.merge(&rest).unwrap();
        assert_eq!(merged, whole);
        assert!(rest.total() == 0 || merged.merge(&rest).is_err());
    }
}

#[test]
fn a_whole_film_is_one_line() {
    let mut ledger = SampleLedger::default();
    let tiles = [(0, 0, 5, 5), (5, 5, 12, 10), (5, 0, 12, 5), (0, 5, 5, 10)];
    for (x0, y0, x1, y1) in tiles {
        ledger.add(PixelBounds { x0, y0, x1, y1 }, 4..8).unwrap();
        assert!(!ledger.is_from_start(WHOLE));
    }
    assert_eq!(ledger.to_string(), "0..10: 0..12 4..8");
    assert_eq!((ledger.most(), ledger.range(), ledger.total()), (4, Some(4..8), 480));
    ledger.add(WHOLE, 0..4).unwrap();
    assert!(ledger.is_from_start(WHOLE) && ledger.bounds() == Some(WHOLE));
    let has_eight = |[x, y]: [u32; 2]| (3..5).contains(&x) && (2..4).contains(&y);
    ledger.set_goals(|pixel| if has_eight(pixel) { 8 } else { 9 });
    let text = "0..2: 0..12 0..8!9\n2..4: 0..3 0..8!9; 3..5 0..8!; 5..12 0..8!9\n4..10: 0..12 0..8!9";
    assert_eq!(ledger.to_string(), text);
    assert_eq!(text.parse(), Ok(ledger.clone()));
    assert_eq!(ledger.missing(PixelBounds { x0: 3, y0: 3, x1: 6, y1: 4 }, &(0..9)).len(), 1);
    ledger.forget_goals();
    assert_eq!(ledger.uniform(WHOLE).as_deref(), Some(std::slice::from_ref(&(0..8))));
    for wrong in
        ["x", "0..1", "0..1:", "0..1: 0..1", "0..1: 1..0 0..1", "0..1: 0..1 0..2,1..3", "1..0: 0..1 0..1"]
    {
        assert!(wrong.parse::<SampleLedger>().is_err(), "{wrong}");
    }
}

/// Of each pixel what its goal says is missing, and nothing else, whatever it has already.
#[test]
fn goals_of_pixels_are_met_one_by_one() {
    for seed in 0..20 {
        let (mut ledger, slow) = random(seed);
        let goal = |[x, y]: [u32; 2]| (hash::pair(seed, u64::from(x + 12 * y)) % 4 * 5) as u32;
        ledger.set_goals(goal);
        assert!(slow.keys().all(|&[x, y]| ledger.has_goals(PixelBounds {
            x0: x,
            y0: y,
            x1: x + 1,
            y1: y + 1
        })));
        let sum = slow.keys().map(|at| u64::from(goal(*at))).sum();
        assert_eq!(ledger.goals(), Some((sum, slow.keys().map(|at| goal(*at)).max().unwrap())));
        assert_eq!(ledger.to_string().parse(), Ok(ledger.clone()), "{ledger}");
        let mut met = ledger.clone();
        for samples in [0..4, 4..9, 9..20] {
            for (area, samples) in met.missing(WHOLE, &samples) {
                met.add(area, samples).unwrap();
            }
        }
        assert!(met.is_complete(WHOLE, &(0..20)) && met.missing(WHOLE, &(0..20)).is_empty());
        for (at, samples) in plain(&met) {
            let known = slow.get(&at);
            // Pixels that had no samples have no goals.
            let goal = if known.is_some() { goal(at) } else { 20 };
            let mut all: Vec<u32> = (0..goal).chain(known.into_iter().flatten().copied()).collect();
            all.sort_unstable();
            all.dedup();
            assert_eq!(samples, all, "{at:?}");
        }
        ledger.forget_goals();
        assert_eq!((ledger.goals(), plain(&ledger)), (None, slow));
    }
}
