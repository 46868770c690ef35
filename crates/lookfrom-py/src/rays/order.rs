//! The order in which rays are cast: for those of a picture, tiles of 8 × 8 neighbours, which the kernel traces together. Each
//! result has its place whatever the order.

use std::ops::Range;

use super::chunk::{CHUNK, Rays};
use super::frame::subtract;

/// Width and height of a tile.
const SIDE: usize = 8;

/// The greatest distance of neighbours in a column, in distances of neighbours in a row.
const STRETCH: f64 = 16.0;

/// Partition of rays among threads, and the order in which a thread casts its share of them.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shares {
    /// Rays in a share.
    pub(super) size: usize,
    /// Rays in a row of a picture; 0 where the order stays.
    width: usize,
}

impl Shares {
    /// In order.
    pub(super) const IN_ORDER: Self = Self { size: CHUNK, width: 0 };

    /// In tiles, if the rays are those of a picture.
    pub(super) fn of(rays: &Rays<'_>) -> Self {
        let (width, count) = (rays.width, rays.directions.len());
        let middle = width * (count / width.max(1) / 2);
        if width >= SIDE && middle + width < count && is_near_below(rays, middle + width / 2) {
            Self { size: SIDE * width, width }
        } else {
            Self::IN_ORDER
        }
    }

    /// The places of the rays of a share, counted from its first, in the order in which they are cast.
    pub(super) fn order(&self, share: &Range<usize>, places: &mut Vec<u32>) {
        places.clear();
        if self.width == 0 {
            places.extend(0..share.len() as u32);
            return;
        }
        for left in (0..self.width).step_by(SIDE) {
            for row in (0..share.len()).step_by(self.width) {
                let end = share.len().min(row + self.width);
                places.extend((row + left..end.min(row + left + SIDE)).map(|place| place as u32));
            }
        }
    }
}

/// True if a ray is about as near to that below it as to that beside it.
fn is_near_below(rays: &Rays<'_>, number: usize) -> bool {
    let distance = |other: usize| {
        let size = |v: [f64; 3]| v.iter().map(|x| x.abs()).sum::<f64>();
        [rays.origins, rays.directions]
            .map(|rows| size(subtract(rows.row(other), rows.row(number))))
            .iter()
            .sum::<f64>()
    };
    let beside = if number.is_multiple_of(rays.width) { number + 1 } else { number - 1 };
    distance(number + rays.width) <= STRETCH * distance(beside)
}
