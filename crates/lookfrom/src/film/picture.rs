//! A picture in linear light, as films, denoiser and compositing have it in common.

/// Linear light, row by row from the top left.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// `width` × `height` pixels: red, green, blue.
    pub pixels: Vec<[f32; 3]>,
    /// Alpha of each pixel, 0 … 1 up to noise; the colours are premultiplied by it. Empty if the picture has none.
    pub alpha: Vec<f32>,
}

impl Picture {
    /// Replaces a part of this picture, with its upper left corner at column `x0` and row `y0`, by a smaller picture.
    /// Pixels outside are left out.
    pub fn replace(&mut self, x0: u32, y0: u32, part: &Self) {
        let (width, columns) = (self.width as usize, part.width.min(self.width.saturating_sub(x0)) as usize);
        if columns == 0 {
            return;
        }
        if !part.alpha.is_empty() && self.alpha.is_empty() {
            self.alpha = vec![0.0; self.pixels.len()];
        }
        for row in 0..part.height.min(self.height.saturating_sub(y0)) as usize {
            let (to, from) = ((y0 as usize + row) * width + x0 as usize, row * part.width as usize);
            self.pixels[to..to + columns].copy_from_slice(&part.pixels[from..from + columns]);
            if !part.alpha.is_empty() {
                self.alpha[to..to + columns].copy_from_slice(&part.alpha[from..from + columns]);
            }
        }
    }

    /// The picture composited by its alpha over a background of linear light; one without alpha stays the same.
    pub fn before(mut self, background: [f32; 3]) -> Self {
        for (pixel, alpha) in self.pixels.iter_mut().zip(std::mem::take(&mut self.alpha)) {
            *pixel = composited(*pixel, alpha, background);
        }
        self
    }
}

/// Light, premultiplied by alpha, over a background.
pub(crate) fn composited(light: [f32; 3], alpha: f32, background: [f32; 3]) -> [f32; 3] {
    let share = 1.0 - alpha.clamp(0.0, 1.0);
    std::array::from_fn(|c| light[c] + share * background[c])
}
