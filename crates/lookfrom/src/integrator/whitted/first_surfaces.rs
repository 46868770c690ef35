//! Bare surfaces that camera rays meet, left to AOVs.

use lookfrom_simd::LaneMask;

use super::coefficients::texture_point;
use super::step::BareEight;
use crate::core::lanes::{by_lane, row, set_row};
use crate::integrator::{FirstSurfaceColumns, FirstSurfaces, Path, SpectralModes};
use crate::shading::material::{self, MaterialKind};
use crate::shading::texture::SpectralMode;
use crate::world::World;

/// Surfaces that are left to AOVs.
pub(super) struct Left<'a> {
    /// Room for the surfaces.
    pub(super) first: &'a mut FirstSurfaceColumns,
    /// Bit i for lane i: whether the albedo is not that of Whitted's coefficients.
    has_other_albedo: u32,
}

impl BareEight<'_> {
    /// Room for those of the first `count` surfaces that are left, if any are: where camera rays meet a material that leaves normals as
    /// they are, and that nothing is seen through.
    #[inline]
    pub(super) fn left<'a>(
        &self,
        world: &World,
        count: usize,
        modes: &SpectralModes,
        first_surfaces: &'a mut FirstSurfaces,
    ) -> Option<Left<'a>> {
        if !first_surfaces.are_wanted() {
            return None;
        }
        let (mut lanes, mut has_other_albedo) = (0, 0);
        for lane in 0..count {
            let material = &world.materials[self.materials[lane] as usize];
            let is_first = self.paths[lane].address == Path::ROOT;
            let is_other = matches!(material.kind, MaterialKind::Mix { .. } | MaterialKind::Interface);
            lanes |= u32::from(is_first && !is_other && !material.has_bumps()) << lane;
            has_other_albedo |= u32::from(!material.has_albedo_of_coefficients()) << lane;
        }
        if lanes == 0 {
            return None;
        }
        if !matches!(modes.of_all(), Some(SpectralMode::Rgb)) {
            has_other_albedo = lanes;
        }
        let first = first_surfaces.next();
        (first.lanes, first.slots) = (lanes, by_lane!(lane => self.paths[lane].slot));
        Some(Left { first, has_other_albedo })
    }
}

impl Left<'_> {
    /// Replaces the albedos that are not those of Whitted's coefficients.
    #[inline]
    pub(super) fn set_other_albedos(self, world: &World, eight: &BareEight<'_>) {
        let Self { first, has_other_albedo } = self;
        let World { materials, textures, .. } = world;
        for lane in LaneMask(has_other_albedo & first.lanes) {
            let material = &materials[eight.materials[lane] as usize];
            let albedo = material.even_albedo().unwrap_or_else(|| {
                let (position, ng) = (row(&first.position, lane), row(&first.ng, lane));
                let point = texture_point(world, eight.bare.hits[lane], position, ng);
                material::albedo(materials, textures, material, &point)
            });
            set_row(&mut first.albedo, lane, albedo);
        }
    }
}
