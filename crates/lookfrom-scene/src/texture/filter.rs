//! Filters of textures: how many texels, or how much of a pattern, one look-up averages.
//!
//! A footprint is the part of a surface that a pixel shows: as far as texture coordinates change from one pixel to the next. Textures that are
//! averaged over it have less noise where they are far away, and none of its detail that is smaller.

/// The selection and interpolation of texels.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum TexelFilter {
    /// Bilinear interpolation of the four nearest texels, however far away they are.
    #[default]
    Bilinear,
    /// The nearest texel.
    Nearest,
    /// Texels of a MIP map (Williams 1983), by the footprint.
    Mip {
        /// The texels that are blended.
        filter: MipFilter,
        /// The width that is averaged, in pixels: > 0.
        footprint: f32,
    },
}

/// The texels of a MIP map that are blended: those of pbrt-v4's filters of the same names.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MipFilter {
    /// The nearest one, of the level whose texels are just smaller than the footprint. pbrt's `point`.
    Nearest,
    /// The four nearest ones of that level.
    Bilinear,
    /// The texels of the two levels whose texels are just smaller and just larger, interpolated.
    Trilinear,
    /// The texels in an ellipse, with the weights of a Gaussian (Heckbert 1989: elliptical weighted average).
    Ewa {
        /// The greatest ratio of the ellipse's axes; longer ones are widened: 1 to [`MipFilter::MOST_ANISOTROPY`].
        anisotropy: f32,
    },
}

impl MipFilter {
    /// The greatest ratio of an ellipse's axes where a file does not set it: pbrt-v4's.
    pub const ANISOTROPY: f32 = 8.0;
    /// The greatest ratio that a file may set: the number of texels in an ellipse grows with it.
    pub const MOST_ANISOTROPY: f32 = 64.0;
}

impl TexelFilter {
    /// The width that is averaged where a file of our own does not set it, in pixels.
    pub const FOOTPRINT: f32 = 0.25;
    /// pbrt-v4's for 64 and more samples per pixel: the distance of samples.
    pub const PBRT_FOOTPRINT: f32 = 0.125;

    /// Whether it takes texels of a MIP map.
    pub fn takes_levels(self) -> bool {
        matches!(self, Self::Mip { .. })
    }
}
