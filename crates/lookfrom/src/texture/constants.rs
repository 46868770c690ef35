//! The colours of a scene that are the same everywhere, lifted to spectra once: a path asks for them at every bounce.

use crate::color::{Sigmoid, Unbounded};
use crate::hash;

/// Lifted colours by their three primaries: a hash table that is never more than half full.
#[derive(Clone, Debug, Default)]
pub(super) struct Constants {
    entries: Vec<Option<([u32; 3], Lifts)>>,
}

/// What a colour is for each usage.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lifts {
    pub(super) albedo: Sigmoid,
    pub(super) unbounded: Unbounded,
}

impl Constants {
    /// A table of these colours.
    pub(super) fn new(colors: &[[f32; 3]]) -> Self {
        let size = (2 * colors.len()).next_power_of_two();
        let mut table = Self { entries: vec![None; size] };
        for rgb in colors {
            let key = rgb.map(f32::to_bits);
            let place = table.place(key);
            table.entries[place] =
                Some((key, Lifts { albedo: Sigmoid::from_rgb(*rgb), unbounded: Unbounded::from_rgb(*rgb) }));
        }
        table
    }

    /// The colour, if it is one of those.
    #[inline]
    pub(super) fn find(&self, rgb: [f32; 3]) -> Option<&Lifts> {
        if self.entries.is_empty() {
            return None;
        }
        self.entries[self.place(rgb.map(f32::to_bits))].as_ref().map(|(_, lifts)| lifts)
    }

    /// Where a colour is, or would be.
    #[inline]
    fn place(&self, key @ [r, g, b]: [u32; 3]) -> usize {
        let mask = self.entries.len() - 1;
        let mut place = hash::mix(u64::from(r) << 32 ^ u64::from(g) << 16 ^ u64::from(b)) as usize & mask;
        while self.entries[place].as_ref().is_some_and(|(other, _)| *other != key) {
            place = (place + 1) & mask;
        }
        place
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_are_found_and_others_are_not() {
        let colors: Vec<[f32; 3]> = (0..300).map(|k| [k as f32 / 300.0, 0.5, 0.25]).collect();
        let table = Constants::new(&[colors.clone(), colors.clone()].concat());
        for rgb in colors {
            assert_eq!(table.find(rgb).unwrap().albedo, Sigmoid::from_rgb(rgb));
            assert!(table.find([rgb[0], 0.5, 0.125]).is_none());
        }
        assert!(Constants::default().find([0.5; 3]).is_none());
    }
}
