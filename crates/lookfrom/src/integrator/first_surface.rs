//! The surfaces that camera rays meet, as far as AOVs and the denoiser need them.
//!
//! Steps leave them, eight side by side or one by one; others are evaluated after the batch.

use glam::{DVec3, Vec2, Vec3};

use crate::core::lanes::{Columns, LANES, set_row};
use crate::shading::interaction::SurfaceInteraction;
use crate::shading::material;
use crate::world::World;

/// A surface, where a camera ray met it. In render space; normals are of unit length, on either side.
#[derive(Clone, Copy, Debug)]
pub struct FirstSurface {
    /// Position.
    pub position: DVec3,
    /// Geometric normal.
    pub ng: Vec3,
    /// Shading normal, with bump and normal maps.
    pub ns: Vec3,
    /// The direction to the camera, of unit length.
    pub wo: Vec3,
    /// Texture coordinates.
    pub uv: Vec2,
    /// Linear Rec. 709: see [`material::albedo`].
    pub albedo: [f32; 3],
}

impl FirstSurface {
    /// That of a surface interaction; with its albedo, where that is known.
    pub(crate) fn of(world: &World, surface: &SurfaceInteraction, albedo: Option<[f32; 3]>) -> Self {
        let point = world.texture_point(surface);
        let World { materials, textures, .. } = world;
        let material = &materials[surface.material as usize];
        Self {
            position: DVec3::from_array(surface.point.position),
            ng: surface.ng.as_vec3(),
            ns: material::normal(materials, world.relief(), surface, &point),
            wo: surface.wo,
            uv: surface.uv,
            albedo: albedo.unwrap_or_else(|| material::albedo(materials, textures, material, &point)),
        }
    }
}

/// Eight surfaces as [`FirstSurface`] has them, by component.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FirstSurfaceColumns {
    /// Bit i for lane i: whether there is a surface. The numbers of others are any.
    pub(crate) lanes: u32,
    /// The slots of the camera rays.
    pub(crate) slots: [u32; LANES],
    pub(crate) position: Columns<3, f64>,
    pub(crate) ng: Columns<3>,
    pub(crate) ns: Columns<3>,
    pub(crate) wo: Columns<3>,
    pub(crate) uv: Columns<2>,
    pub(crate) albedo: Columns<3>,
}

impl FirstSurfaceColumns {
    /// Replaces the surface of a lane.
    fn set(&mut self, lane: usize, slot: u32, surface: &FirstSurface) {
        let FirstSurface { position, ng, ns, wo, uv, albedo } = *surface;
        set_row(&mut self.position, lane, position.to_array());
        set_row(&mut self.ng, lane, ng.to_array());
        set_row(&mut self.ns, lane, ns.to_array());
        set_row(&mut self.wo, lane, wo.to_array());
        set_row(&mut self.uv, lane, uv.to_array());
        set_row(&mut self.albedo, lane, albedo);
        self.slots[lane] = slot;
        self.lanes |= 1 << lane;
    }

    const NONE: Self = Self {
        lanes: 0,
        slots: [0; LANES],
        position: [[0.0; LANES]; 3],
        ng: [[0.0; LANES]; 3],
        ns: [[0.0; LANES]; 3],
        wo: [[0.0; LANES]; 3],
        uv: [[0.0; LANES]; 2],
        albedo: [[0.0; LANES]; 3],
    };
}

/// The surfaces that steps left, in memory that is reused.
#[derive(Debug, Default)]
pub struct FirstSurfaces {
    are_wanted: bool,
    eights: Vec<FirstSurfaceColumns>,
    /// Number of those that count.
    count: usize,
    /// The eight that receives surfaces one by one, and the number of those that it has.
    open: (usize, usize),
}

impl FirstSurfaces {
    /// Removes all. Whether steps are to leave others.
    pub(crate) fn start(&mut self, are_wanted: bool) {
        (self.are_wanted, self.count, self.open) = (are_wanted, 0, (0, LANES));
    }

    /// Whether steps are to leave surfaces.
    #[inline]
    pub(crate) fn are_wanted(&self) -> bool {
        self.are_wanted
    }

    /// The next eight, to be replaced by surfaces, of which there is at most one for each slot.
    #[inline]
    pub(crate) fn next(&mut self) -> &mut FirstSurfaceColumns {
        if self.count == self.eights.len() {
            self.eights.push(FirstSurfaceColumns::NONE);
        }
        self.count += 1;
        &mut self.eights[self.count - 1]
    }

    /// Adds the surface of a slot that has none yet.
    pub(crate) fn push(&mut self, slot: u32, surface: &FirstSurface) {
        if self.open.1 == LANES {
            self.next().lanes = 0;
            self.open = (self.count - 1, 0);
        }
        let (eight, lane) = &mut self.open;
        self.eights[*eight].set(*lane, slot, surface);
        *lane += 1;
    }

    /// Eight by eight.
    pub(crate) fn eights(&self) -> &[FirstSurfaceColumns] {
        &self.eights[..self.count]
    }
}
