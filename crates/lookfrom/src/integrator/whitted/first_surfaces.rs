//! Bare surfaces that camera rays meet, left to AOVs.

use lookfrom_simd::LaneMask;

use super::coefficients::texture_point;
use super::step::BareEight;
use crate::aov::{FirstSurfaceColumns, FirstSurfaces};
use crate::core::lanes::{by_lane, row, set_row};
use crate::integrator::{Path, SpectralModes};
use crate::shading::material::{self, MaterialKind};
use crate::shading::texture::SpectralMode;
use crate::world::World;

impl BareEight<'_> {
    /// The columns to fill for AOVs with those of the first `count` surfaces, if there are any, where camera rays meet a material that
    /// leaves normals as they are, and that nothing is seen through.
    #[inline]
    pub(super) fn aov_target<'a>(
        &self,
        world: &World,
        count: usize,
        first_surfaces: &'a mut FirstSurfaces,
    ) -> Option<&'a mut FirstSurfaceColumns> {
        if !first_surfaces.are_wanted() {
            return None;
        }
        let mut lanes = 0;
        for lane in 0..count {
            let material = &world.materials[self.materials[lane] as usize];
            let is_first = self.paths[lane].address == Path::ROOT;
            let is_other = matches!(material.kind, MaterialKind::Mix { .. } | MaterialKind::Interface);
            lanes |= u32::from(is_first && !is_other && !material.has_bumps()) << lane;
        }
        let first = first_surfaces.block();
        (first.lanes, first.slots) = (lanes, by_lane!(lane => self.paths[lane].slot));
        (lanes != 0).then_some(first)
    }

    /// Replaces the albedos that are not those of Whitted's coefficients.
    #[inline]
    pub(super) fn set_other_albedos(
        &self,
        world: &World,
        modes: &SpectralModes,
        first: &mut FirstSurfaceColumns,
    ) {
        let World { materials, textures, .. } = world;
        let is_rgb = matches!(modes.of_all(), Some(SpectralMode::Rgb));
        for lane in LaneMask(first.lanes) {
            let material = &materials[self.materials[lane] as usize];
            if is_rgb && material.has_albedo_of_coefficients() {
                continue;
            }
            let albedo = material.even_albedo().unwrap_or_else(|| {
                let (position, ng) = (row(&first.position, lane), row(&first.ng, lane));
                let point = texture_point(world, &self.bare, lane, (position, ng));
                material::albedo(materials, textures, material, &point)
            });
            set_row(&mut first.albedo, lane, albedo);
        }
    }
}
