//! First hits of eight samples side by side, by component: in render space as steps leave them, and in camera space.

use super::Aovs;
use crate::core::lanes::{Columns, LANES, row, set_row};

/// Surfaces where camera rays met them. In render space; normals are of unit length, on either side.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct FirstSurfaceColumns {
    /// Bit i for lane i: whether there is a surface. The numbers of others are any.
    pub(crate) lanes: u32,
    /// The slots of the camera rays.
    pub(crate) slots: [u32; LANES],
    /// Position.
    pub(crate) position: Columns<3, f64>,
    /// Geometric normal.
    pub(crate) ng: Columns<3>,
    /// Shading normal, with bump and normal maps.
    pub(crate) ns: Columns<3>,
    /// The direction to the camera, of unit length.
    pub(crate) wo: Columns<3>,
    /// Texture coordinates.
    pub(crate) uv: Columns<2>,
    /// Linear Rec. 709: see [`albedo`](crate::shading::material::albedo).
    pub(crate) albedo: Columns<3>,
}

/// [`Aovs`] of eight samples.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct AovColumns {
    pub(crate) albedo: Columns<3>,
    pub(crate) ng: Columns<3>,
    pub(crate) ns: Columns<3>,
    pub(crate) position: Columns<3>,
    pub(crate) uv: Columns<2>,
    /// Bit i for lane i: whether the sample has a hit. The numbers of others are any.
    pub(crate) hits: u32,
}

impl AovColumns {
    /// Replaces the hit of a lane.
    #[inline(always)]
    pub(crate) fn set(&mut self, lane: usize, aovs: &Aovs) {
        let Aovs { albedo, ng, ns, position, uv } = *aovs;
        set_row(&mut self.albedo, lane, albedo);
        set_row(&mut self.ng, lane, ng);
        set_row(&mut self.ns, lane, ns);
        set_row(&mut self.position, lane, position);
        set_row(&mut self.uv, lane, uv);
        self.hits |= 1 << lane;
    }

    /// The hit of a lane that has one.
    #[inline(always)]
    pub(crate) fn of(&self, lane: usize) -> Aovs {
        Aovs {
            albedo: row(&self.albedo, lane),
            ng: row(&self.ng, lane),
            ns: row(&self.ns, lane),
            position: row(&self.position, lane),
            uv: row(&self.uv, lane),
        }
    }
}
