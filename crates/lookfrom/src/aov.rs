//! AOVs: data of the surfaces that camera rays meet first (a G-buffer), for layers of pictures and for the denoiser.
//!
//! The whole way from a step to the film. Steps leave the surfaces that they have at hand, and others are found again after the batch
//! (`first_surfaces`, in the `columns` of eight). In camera space (`camera_space`) they are AOVs, of which eight pixels are summed side by
//! side (`accumulator`). The film keeps the `sums`. What covers a ray in part is told one by one (`coverage`), for AOVs and for Cryptomattes
//! (`cryptomatte`).

mod accumulator;
mod camera_space;
mod columns;
mod coverage;
mod cryptomatte;
mod first_surfaces;
mod sums;

pub(crate) use accumulator::AovAccumulator;
pub(crate) use camera_space::CameraSpace;
pub(crate) use columns::{AovColumns, FirstSurfaceColumns};
pub(crate) use coverage::Cover;
pub use cryptomatte::Cryptomatte;
pub(crate) use cryptomatte::{ATTRIBUTES as CRYPTOMATTE_ATTRIBUTES, CryptomatteId, PixelMatte};
pub use first_surfaces::FirstSurfaces;
pub(crate) use first_surfaces::RayHit;
pub(crate) use sums::{AovSums, LayerSums};
pub use sums::{DenoiserFeatures, FEATURE_SAMPLES};

/// The first hit of one sample, or a mean over samples.
///
/// Directions and positions are in camera space: x to the right, y up, z forward, in the scene's unit; the origin is
/// lookfrom.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Aovs {
    /// Albedo: 0 … 1 in linear Rec. 709. Base colours, as in Cycles and Open Image Denoise, not an integral over
    /// directions: 1 for glass, the colour at normal incidence for a metal.
    pub albedo: [f32; 3],
    /// Geometric normal on the viewer's side, of unit length.
    pub ng: [f32; 3],
    /// Shading normal (interpolated, with bump and normal maps) on the viewer's side, of unit length.
    pub ns: [f32; 3],
    /// Position. Its z is the depth: the distance from the camera along the view axis.
    pub position: [f32; 3],
    /// Texture coordinates.
    pub uv: [f32; 2],
}

impl Aovs {
    /// Albedo, geometric normal, shading normal, position, depth, texture coordinates.
    pub fn to_array(&self) -> [f32; 15] {
        let Self { albedo: [r, g, b], ng: [gx, gy, gz], ns: [sx, sy, sz], position: [x, y, z], uv: [u, v] } =
            *self;
        [r, g, b, gx, gy, gz, sx, sy, sz, x, y, z, z, u, v]
    }

    fn is_finite(&self) -> bool {
        self.to_array().into_iter().all(f32::is_finite)
    }
}
