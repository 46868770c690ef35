//! The windows of an OpenEXR file ("Technical Introduction", openexr.com): the display window is the picture; the data window
//! is the rectangle whose pixels are in the file. A cropped picture has a smaller data window, an overscanned one a larger.

use ::exr::math::Vec2;
use ::exr::meta::attribute::IntegerBounds;

use crate::error::Location;
use crate::files::LoadContext;

/// The window that is the picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::image) enum Windows {
    /// The display window: the file format's rule.
    Display,
    /// The data window of the first part: pbrt-v4's rule.
    Data,
}

/// A rectangle of pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Window {
    left: i64,
    top: i64,
    pub(super) width: u64,
    pub(super) height: u64,
}

impl Windows {
    /// The window of the picture. A display window that shows nothing of the data gives way to the data window, with a
    /// warning.
    pub(super) fn picture(
        self,
        display: Window,
        mut data: impl Iterator<Item = Window> + Clone,
        at: &Location,
        context: &mut LoadContext<'_>,
    ) -> Window {
        let first = data.clone().next().unwrap_or(display);
        if self == Self::Data {
            return first;
        }
        if data.any(|data| data.meets(display)) {
            return display;
        }
        context.warn(at, "the display window shows none of the pixels; the picture is the data window");
        first
    }
}

impl Window {
    pub(super) fn new(position: Vec2<i32>, size: Vec2<usize>) -> Self {
        Self { left: position.0.into(), top: position.1.into(), width: size.0 as u64, height: size.1 as u64 }
    }

    pub(super) fn of(bounds: IntegerBounds) -> Self {
        Self::new(bounds.position, bounds.size)
    }

    /// One past the last column and row. Sizes come from 32-bit corners.
    fn end(self) -> [i64; 2] {
        [self.left + self.width as i64, self.top + self.height as i64]
    }

    fn meets(self, other: Self) -> bool {
        let ([right, bottom], [other_right, other_bottom]) = (self.end(), other.end());
        self.left < other_right && other.left < right && self.top < other_bottom && other.top < bottom
    }

    /// The values of this window's pixels, in a picture that is another window: 0 where there are none.
    pub(super) fn placed(self, values: Vec<f32>, picture: Self) -> Vec<f32> {
        if self == picture {
            return values;
        }
        let [width, height] = [picture.width as usize, picture.height as usize];
        let mut placed = vec![0.0; width * height];
        let ([right, bottom], [last_column, last_row]) = (self.end(), picture.end());
        let columns = self.left.max(picture.left)..right.min(last_column);
        let count = (columns.end - columns.start).max(0) as usize;
        if count == 0 {
            return placed;
        }
        for row in self.top.max(picture.top)..bottom.min(last_row) {
            let from = (row - self.top) as usize * self.width as usize + (columns.start - self.left) as usize;
            let to = (row - picture.top) as usize * width + (columns.start - picture.left) as usize;
            placed[to..to + count].copy_from_slice(&values[from..from + count]);
        }
        placed
    }
}
