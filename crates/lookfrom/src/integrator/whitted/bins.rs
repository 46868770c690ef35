//! Plain hits that wait for others of their kind, so that eight that are shaded side by side have one kind of shape, and
//! mostly one material.

use crate::core::lanes::LANES;
use crate::world::Plain;

/// Number of places where hits wait. Materials share them where there are more.
const PLACES: usize = 64;

/// Hits that wait, by shape and material: memory that is reused.
#[derive(Debug, Default)]
pub(super) struct Bins {
    /// On spheres at odd places.
    places: Vec<Place>,
    /// Bit i for place i: whether it has had hits.
    used: u64,
}

/// Hits of one kind of shape.
#[derive(Clone, Copy, Debug, Default)]
struct Place {
    /// Indices of their paths.
    paths: [u32; LANES],
    materials: [u32; LANES],
    count: usize,
}

/// Up to eight hits on one kind of shape.
pub(super) struct Chosen<'a> {
    /// Indices of their paths.
    pub(super) paths: &'a [u32],
    /// Indices into the world's materials.
    pub(super) materials: &'a [u32],
    /// Whether they are on spheres, not on triangles.
    pub(super) are_on_spheres: bool,
}

impl Place {
    #[inline(always)]
    fn push(&mut self, path: u32, material: u32) {
        let lane = self.count % LANES;
        (self.paths[lane], self.materials[lane]) = (path, material);
        self.count += 1;
    }

    /// Calls `shade` for all, and removes them.
    #[inline(always)]
    fn empty(&mut self, are_on_spheres: bool, shade: impl FnOnce(&Chosen<'_>)) {
        let (paths, materials) = (&self.paths[..self.count], &self.materials[..self.count]);
        shade(&Chosen { paths, materials, are_on_spheres });
        self.count = 0;
    }
}

impl Bins {
    /// Adds the hit of a path, and calls `shade` for eight of them where they fill the lanes.
    #[inline(always)]
    pub(super) fn push(&mut self, plain: Plain, path: u32, shade: impl FnOnce(&Chosen<'_>)) {
        if self.places.is_empty() {
            self.places.resize(PLACES, Place::default());
        }
        let number = (2 * plain.material as usize + usize::from(plain.is_sphere)) % PLACES;
        let place = &mut self.places[number];
        place.push(path, plain.material);
        self.used |= 1 << number;
        if place.count == LANES {
            place.empty(plain.is_sphere, shade);
        }
    }

    /// Calls `shade` for the hits that are left, up to eight of one kind of shape at a time.
    pub(super) fn flush(&mut self, mut shade: impl FnMut(&Chosen<'_>)) {
        const TRIANGLES: u64 = 0x5555_5555_5555_5555;
        for (of_shape, are_on_spheres) in [(TRIANGLES, false), (!TRIANGLES, true)] {
            let mut rest = Place::default();
            let mut used = self.used & of_shape;
            while used != 0 {
                let place = &mut self.places[used.trailing_zeros() as usize];
                used &= used - 1;
                for lane in 0..place.count {
                    rest.push(place.paths[lane], place.materials[lane]);
                    if rest.count == LANES {
                        rest.empty(are_on_spheres, &mut shade);
                    }
                }
                place.count = 0;
            }
            if rest.count > 0 {
                rest.empty(are_on_spheres, &mut shade);
            }
        }
        self.used = 0;
    }
}
