//! Quadrics of many shapes as primitives of the kernel.

use glam::DVec3;
use lookfrom_bvh::{Aabb, Capsule, EightRays, Procedural, ProceduralHit, Ray};
use lookfrom_simd::{Kernel, LaneMask, Simd, f32x8, mask32x8, prelude::*};

use super::{Clip, Meetings, Quadric, TestedRays};
use crate::core::lanes::{LANES, are_shaded_together, shade_together};
use crate::core::vector::Vector;
use crate::primitive::{MaterialBinding, SurfacePoint};

/// Quadrics of many shapes: long and thin ones, surfaces of solids, or others.
#[derive(Clone, Debug, Default)]
pub struct Quadrics {
    /// The quadrics.
    pub quadrics: Vec<Quadric>,
    /// The attributes of each.
    pub bindings: Vec<MaterialBinding>,
    /// The part of each that is left in a solid. Without any, they are whole.
    pub clips: Vec<Clip>,
}

impl Quadrics {
    /// The point of a quadric nearest to one that is on it up to errors. Texture coordinates are 0 where they are not wanted.
    pub(crate) fn point(&self, index: usize, near: DVec3, wants_uv: bool) -> SurfacePoint {
        let quadric = &self.quadrics[index];
        quadric.point_of(quadric.point_in_object(near), self.bindings[index], wants_uv)
    }

    /// The area of what is left of a quadric, in render space.
    pub(crate) fn area(&self, index: usize) -> f64 {
        let quadric = &self.quadrics[index];
        match self.clips.get(index) {
            Some(clip) => quadric.area_of_part(|p| clip.keeps(0.0_f32, p.into())),
            None => quadric.area(),
        }
    }

    /// Whether a solid leaves a point of a quadric, in its object space.
    pub(crate) fn keeps(&self, index: usize, on_surface: DVec3) -> bool {
        self.clips.get(index).is_none_or(|clip| clip.keeps(0.0_f32, on_surface.into()))
    }
}

/// Finds the first meetings of eight rays with a quadric.
struct FirstOfRays<'a> {
    quadric: &'a Quadric,
    clip: Option<&'a Clip>,
    rays: &'a EightRays,
    /// Bit i for ray i.
    wanted: u32,
}

/// Parameters, and the lanes where they exist, and where they are unclear.
struct FirstOfEight {
    t: [f32; LANES],
    exist: u32,
    are_unclear: u32,
}

impl Kernel for FirstOfRays<'_> {
    type Output = FirstOfEight;

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> FirstOfEight {
        let Self { quadric, clip, rays, wanted } = self;
        let origin = vectors(simd, &rays.origin);
        let direction = vectors(simd, &rays.direction);
        let t_min = f32x8::load_array(simd, rays.t_min);
        // Those that are not wanted end before they begin.
        let wanted = mask32x8::from_bitmask(simd, wanted.into());
        let t_max = wanted.select(f32x8::load_array(simd, rays.t_max), f32x8::splat(simd, f32::NEG_INFINITY));
        let Meetings { t, exist, are_unclear } =
            quadric.first_meetings(clip, &TestedRays { origin, direction, t_min, t_max });
        FirstOfEight {
            t: t.into(),
            exist: exist.to_bitmask() as u32,
            are_unclear: are_unclear.to_bitmask() as u32,
        }
    }
}

/// Vectors by their components.
#[inline(always)]
fn vectors<S: Simd>(simd: S, &[x, y, z]: &[[f32; LANES]; 3]) -> Vector<f32x8<S>> {
    Vector::new(f32x8::load_array(simd, x), f32x8::load_array(simd, y), f32x8::load_array(simd, z))
}

impl Procedural for Quadrics {
    fn count(&self) -> u32 {
        self.quadrics.len() as u32
    }

    fn bounds(&self, primitive: u32) -> Aabb {
        let [mut min, mut max] = self.quadrics[primitive as usize].bounds();
        if let Some(Clip { bounds, .. }) = self.clips.get(primitive as usize) {
            (min, max) = (min.max(bounds[0]), max.min(bounds[1]));
        }
        Aabb {
            min: min.to_array().map(|x| (x as f32).next_down()),
            max: max.to_array().map(|x| (x as f32).next_up()),
        }
    }

    fn capsule(&self, primitive: u32) -> Option<Capsule> {
        if self.clips.is_empty() { self.quadrics[primitive as usize].capsule() } else { None }
    }

    fn intersect(&self, primitive: u32, ray: &Ray) -> Option<ProceduralHit> {
        let index = primitive as usize;
        let t = self.quadrics[index].first_meeting(ray, self.clips.get(index));
        t.map(|t| ProceduralHit { t, u: 0.0, v: 0.0 })
    }

    fn intersect_eight(
        &self,
        primitive: u32,
        rays: &EightRays,
        wanted: u32,
    ) -> [Option<ProceduralHit>; LANES] {
        let index = primitive as usize;
        let (quadric, clip) = (&self.quadrics[index], self.clips.get(index));
        let mut found = [None; LANES];
        if !are_shaded_together() {
            LaneMask(wanted).for_each(|lane| found[lane] = self.intersect(primitive, &rays.ray(lane)));
            return found;
        }
        let FirstOfEight { t, exist, are_unclear } =
            shade_together(FirstOfRays { quadric, clip, rays, wanted });
        let hit = |t: f32| ProceduralHit { t, u: 0.0, v: 0.0 };
        LaneMask(exist).for_each(|lane| found[lane] = Some(hit(t[lane])));
        LaneMask(are_unclear & wanted)
            .for_each(|lane| found[lane] = quadric.unclear_meeting(&rays.ray(lane), clip).map(hit));
        found
    }
}
