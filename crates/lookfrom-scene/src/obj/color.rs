//! Colours of vertices in OBJ files, an extension that many programs write: `v x y z r g b`, `v x y z w r g b` or
//! `v x y z r g b a`, from 0 to 1 or from 0 to 255.

use crate::error::Location;
use crate::files::LoadContext;
use crate::image::linear_from_srgb;
use crate::model::colors::{Range, range};

/// A vertex without a colour.
const NONE: [f32; 4] = [f32::NAN; 4];

/// The numbers behind the coordinates of vertices.
#[derive(Default)]
pub(super) struct Colors {
    /// Four numbers for each of the first vertices; of three, the first is 1.
    written: Vec<[f32; 4]>,
    /// Whether some have three numbers.
    has_three: bool,
    /// Whether some have four, of which the first is not 1; the same of the last, where 255 is 1, too.
    is_first_other: bool,
    is_last_other: bool,
}

impl Colors {
    /// The number of vertices up to the last that has a colour.
    pub(super) fn count(&self) -> usize {
        self.written.len()
    }

    /// Adds the numbers of a vertex, which has a colour if there are three or four of them.
    pub(super) fn add(&mut self, vertex: usize, numbers: &[f64]) {
        let color = match *numbers {
            [r, g, b] => {
                self.has_three = true;
                [1.0, r, g, b]
            }
            [a, b, c, d] => {
                self.is_first_other |= a != 1.0;
                self.is_last_other |= d != 1.0 && d != 255.0;
                [a, b, c, d]
            }
            _ => return,
        };
        self.written.resize(vertex, NONE);
        self.written.push(color.map(|value| value as f32));
    }

    /// The linear colours: those of MeshLab, ZBrush and Blender are sRGB-encoded. White where there is none.
    pub(super) fn linear(self, file: &Location, context: &mut LoadContext<'_>) -> Vec<[f32; 3]> {
        // Opacity comes last, the weight of a rational vertex first; one of them is 1 everywhere.
        let has_opacity = !self.has_three && self.is_first_other && !self.is_last_other;
        let color = |&[a, b, c, d]: &[f32; 4]| if has_opacity { [a, b, c] } else { [b, c, d] };
        let range = range(self.written.iter().flat_map(color), "they are taken to be 1", file, context);
        let white = if range == Range::Bytes { 255.0 } else { 1.0 };
        let linear = |value: f32| match value.is_finite() {
            true => linear_from_srgb((value / white).clamp(0.0, 1.0)),
            false => 1.0,
        };
        self.written.iter().map(color).map(|color| color.map(linear)).collect()
    }
}
