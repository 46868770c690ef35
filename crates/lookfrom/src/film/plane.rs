//! Sums of the pixels of a picture, in blocks of 32 × 32 pixels that are packed: see [`packed`](super::packed). Pixels without sums
//! take no memory.

use std::marker::PhantomData;
use std::ops::Range;

use lookfrom_scene::Result;
use lookfrom_scene::settings::PixelBounds;

use super::packed::{Packed, pack, replace, unpack};
use super::stored::Sums;
use super::tile::room;

/// Side of a block: that of the parts of a picture which threads render.
pub(super) const SIDE: u32 = 32;

/// Sums of one kind of all pixels of a picture; or of no kind, if the film has none of it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Plane<T> {
    width: u32,
    height: u32,
    /// Row by row; one without bytes has only pixels without sums.
    blocks: Vec<Box<[u8]>>,
    of: PhantomData<T>,
}

impl<T: Sums> Plane<T> {
    /// No sums.
    pub(super) fn none() -> Self {
        Self { width: 0, height: 0, blocks: Vec::new(), of: PhantomData }
    }

    /// Zeros for a picture of this size.
    ///
    /// # Errors
    /// `Limit` if there is no memory for it.
    pub(super) fn new(width: u32, height: u32) -> Result<Self> {
        let count = u64::from(width.div_ceil(SIDE)) * u64::from(height.div_ceil(SIDE));
        let mut blocks = room(count)?;
        blocks.resize_with(count as usize, Box::default);
        Ok(Self { width, height, blocks, of: PhantomData })
    }

    /// Whether there are no sums of this kind.
    pub(super) fn is_empty(&self) -> bool {
        self.blocks.is_empty()
    }

    /// The sums of a pixel of the picture; `None` if there are none of this kind.
    pub(super) fn get(&self, x: u32, y: u32) -> Option<T> {
        let block = self.blocks.get(index(self.width, [x / SIDE, y / SIDE]))?;
        let columns = SIDE.min(self.width - x / SIDE * SIDE);
        Some(Packed::of(block).get((y % SIDE * columns + x % SIDE) as usize))
    }

    /// Calls `each` with the sums of the pixels of columns `x0` to `x1` (exclusive) of a row.
    pub(super) fn row(&self, y: u32, x0: u32, x1: u32, mut each: impl FnMut(T)) {
        let mut x = x0;
        while x < x1 {
            let left = x / SIDE * SIDE;
            let columns = SIDE.min(self.width - left);
            let packed = Packed::of(&self.blocks[index(self.width, [x / SIDE, y / SIDE])]);
            let end = x1.min(left + columns);
            (x..end).for_each(|x| each(packed.get((y % SIDE * columns + x - left) as usize)));
            x = end;
        }
    }

    /// Moves the blocks that an area touches out of the plane, row by row: their pixels have no sums in it.
    pub(super) fn take(&mut self, area: PixelBounds) -> impl Iterator<Item = Box<[u8]>> {
        let touched = (!self.is_empty()).then(|| touched(area));
        touched.into_iter().flatten().map(|place| std::mem::take(&mut self.blocks[index(self.width, place)]))
    }

    /// Adds the sums of such blocks. Where the plane has none, as after [`Plane::take`], they are moved.
    pub(super) fn put(&mut self, area: PixelBounds, blocks: &mut impl Iterator<Item = Box<[u8]>>) {
        if self.is_empty() {
            return;
        }
        for (place, block) in touched(area).zip(blocks) {
            let mine = &mut self.blocks[index(self.width, place)];
            match mine.is_empty() {
                true => *mine = block,
                false => merge::<T>(mine, &block, inside([self.width, self.height], place).pixels() as usize),
            }
        }
    }

    /// Adds the sums of another plane of the same picture.
    pub(super) fn merge(&mut self, other: &Self) {
        let columns = self.width.div_ceil(SIDE);
        let size = [self.width, self.height];
        for ((number, mine), theirs) in (0..).zip(&mut self.blocks).zip(&other.blocks) {
            merge::<T>(mine, theirs, inside(size, [number % columns, number / columns]).pixels() as usize);
        }
    }

    /// Makes the pixels of blocks that end within these rows pixels without sums.
    pub(super) fn forget(&mut self, rows: &Range<u32>) {
        let blocks = index(self.width, [0, rows.start / SIDE])..index(self.width, [0, rows.end / SIDE]);
        for block in self.blocks.get_mut(blocks).unwrap_or_default() {
            *block = Box::default();
        }
    }
}

/// Columns and rows of the blocks that an area touches, row by row.
fn touched(PixelBounds { x0, y0, x1, y1 }: PixelBounds) -> impl Iterator<Item = [u32; 2]> {
    let rows = if x0 < x1 && y0 < y1 { y0 / SIDE..y1.div_ceil(SIDE) } else { 0..0 };
    rows.flat_map(move |row| (x0 / SIDE..x1.div_ceil(SIDE)).map(move |column| [column, row]))
}

/// The number of a block in a picture of this width.
fn index(width: u32, [column, row]: [u32; 2]) -> usize {
    row as usize * width.div_ceil(SIDE) as usize + column as usize
}

/// The pixels of a block in a picture of this size.
fn inside([width, height]: [u32; 2], [column, row]: [u32; 2]) -> PixelBounds {
    let [x0, y0] = [column * SIDE, row * SIDE];
    PixelBounds { x0, y0, x1: width.min(x0 + SIDE), y1: height.min(y0 + SIDE) }
}

/// The number of blocks that an area touches.
pub(super) fn count_of_blocks(area: PixelBounds) -> usize {
    touched(area).count()
}

/// Changes the sums of the pixels of an area, by their columns and rows, in the blocks that it touches of a picture of this size.
pub(super) fn change<T: Sums>(
    size: [u32; 2],
    area: PixelBounds,
    blocks: &mut [Box<[u8]>],
    mut each: impl FnMut(u32, u32, &mut T),
) {
    let (mut sums, mut bytes) = (Vec::new(), Vec::new());
    for (place, block) in touched(area).zip(blocks) {
        let all = inside(size, place);
        unpack(block, all.pixels() as usize, &mut sums);
        for y in area.y0.max(all.y0)..area.y1.min(all.y1) {
            for x in area.x0.max(all.x0)..area.x1.min(all.x1) {
                each(x, y, &mut sums[all.index(x, y)]);
            }
        }
        pack(&sums, &mut bytes);
        replace(block, &bytes);
    }
}

/// Adds the sums of a block of `count` pixels to those of another.
fn merge<T: Sums>(mine: &mut Box<[u8]>, theirs: &[u8], count: usize) {
    if theirs.is_empty() {
        return;
    }
    let (mut sums, mut others, mut bytes) = (Vec::<T>::new(), Vec::new(), Vec::new());
    unpack(mine, count, &mut sums);
    unpack(theirs, count, &mut others);
    sums.iter_mut().zip(&others).for_each(|(sums, others)| sums.merge(others));
    pack(&sums, &mut bytes);
    replace(mine, &bytes);
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::super::Pixel;
    use super::super::pixel::any_pixel;
    use super::*;

    fn set(plane: &mut Plane<Pixel>, area: PixelBounds, sums_of: impl Fn(u32, u32) -> Pixel) {
        let mut blocks: Vec<_> = plane.take(area).collect();
        change([plane.width, plane.height], area, &mut blocks, |x, y, sums| *sums = sums_of(x, y));
        plane.put(area, &mut blocks.into_iter());
    }

    proptest! {
        #[test]
        fn pixels_stay_where_they_are(
            pixels in prop::collection::vec((0_u32..70, 0_u32..40, any_pixel()), 0..40),
        ) {
            let mut plane = Plane::<Pixel>::new(70, 40).unwrap();
            let mut slow = vec![Pixel::default(); 70 * 40];
            for (x, y, sums) in pixels {
                set(&mut plane, PixelBounds { x0: x, y0: y, x1: x + 1, y1: y + 1 }, |_, _| sums);
                slow[(y * 70 + x) as usize] = sums;
            }
            for y in 0..40 {
                let mut row = Vec::new();
                plane.row(y, 3, 69, |pixel| row.push(pixel));
                prop_assert_eq!(&row[..], &slow[y as usize * 70 + 3..][..66]);
                prop_assert_eq!(plane.get(69, y), Some(slow[y as usize * 70 + 69]));
            }
            // The same sums have the same bytes, however they came.
            let mut anew = Plane::<Pixel>::new(70, 40).unwrap();
            let all = PixelBounds { x0: 0, y0: 0, x1: 70, y1: 40 };
            set(&mut anew, all, |x, y| slow[(y * 70 + x) as usize]);
            prop_assert_eq!(anew, plane);
        }
    }
}
