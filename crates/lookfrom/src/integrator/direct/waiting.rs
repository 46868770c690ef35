//! Plain hits that wait for others of their kind, so that eight that are shaded side by side have one kind of shape, and
//! mostly one material.

use super::plain::PlainHit;
use crate::core::lanes::LANES;

/// Number of places where hits wait. Materials share them where there are more.
const PLACES: usize = 64;

/// Hits that wait, by shape and material: memory that is reused.
#[derive(Default)]
pub(super) struct Waiting<'a> {
    /// On spheres at odd places.
    places: Vec<Vec<PlainHit<'a>>>,
    /// The places that had hits.
    used: Vec<usize>,
}

impl<'a> Waiting<'a> {
    /// Adds a hit, and calls `shade` for eight of them where they fill the lanes.
    #[inline(always)]
    pub(super) fn push(&mut self, hit: PlainHit<'a>, shade: impl FnOnce(&[PlainHit<'a>])) {
        if self.places.is_empty() {
            self.places.resize_with(PLACES, Vec::new);
        }
        let place = (2 * hit.material as usize + usize::from(hit.is_on_sphere())) % PLACES;
        let hits = &mut self.places[place];
        if hits.is_empty() {
            self.used.push(place);
            hits.reserve_exact(LANES);
        }
        hits.push(hit);
        if hits.len() == LANES {
            shade(hits);
            hits.clear();
        }
    }

    /// Calls `shade` for the hits that are left, up to eight of one kind of shape at a time.
    pub(super) fn flush(&mut self, mut shade: impl FnMut(&[PlainHit<'a>])) {
        for is_on_sphere in [false, true] {
            let mut rest = Vec::with_capacity(LANES);
            for &place in self.used.iter().filter(|&&place| (place % 2 == 1) == is_on_sphere) {
                for hit in self.places[place].drain(..) {
                    rest.push(hit);
                    if rest.len() == LANES {
                        shade(&rest);
                        rest.clear();
                    }
                }
            }
            if !rest.is_empty() {
                shade(&rest);
            }
        }
        self.used.clear();
    }
}
