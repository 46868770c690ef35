//! The results of tracing: the light of each sample, and the numbers of rays.

use crate::core::spectrum::Spectrum;
use crate::shading::texture::SpectralMode;

/// Numbers of rays traced.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Rays {
    /// Camera rays.
    pub camera: u64,
    /// Further rays of paths and trees.
    pub secondary: u64,
    /// Shadow rays.
    pub shadow: u64,
}

impl Rays {
    /// The sum of all.
    pub fn total(self) -> u64 {
        self.camera + self.secondary + self.shadow
    }
}

impl std::ops::AddAssign for Rays {
    fn add_assign(&mut self, other: Self) {
        self.camera += other.camera;
        self.secondary += other.secondary;
        self.shadow += other.shadow;
    }
}

/// A sample's light, before and after the sensor and the filter weight.
#[derive(Clone, Copy, Debug)]
pub struct Traced {
    /// The value for the film: `radiance · weight`.
    pub rgb: [f32; 3],
    /// The sum over the tree of rays.
    pub radiance: Spectrum,
    /// The spectral mode of `radiance`.
    pub mode: SpectralMode,
    /// The filter's weight, which is 1 for filters without negative lobes, times that of a ray through a lens system or from a surface that
    /// is measured.
    pub weight: f32,
    /// The filter's weight alone.
    pub filter_weight: f32,
    /// Alpha, not multiplied by the filter weight.
    pub alpha: f32,
}
