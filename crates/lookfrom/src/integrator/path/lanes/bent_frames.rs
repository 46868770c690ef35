//! The shading frames of eight hits on glTF's material: bent by normal maps, and such that reflections stay outside.

use glam::DVec3;
use lookfrom_simd::{Kernel, Simd, f32x8, mask32x8, prelude::*};

use super::vertices::VertexColumns;
use crate::core::lanes::{Columns, load, row, set_row, shade_together};
use crate::core::vector::Vector;
use crate::shading::interaction::ShadingGeometry;
use crate::shading::material::{Bending, frame_about};

/// The directions from which bent frames are made, and the normals of normal maps. Masks have bit i for lane i.
#[derive(Default)]
pub(super) struct BentFrames {
    pub(super) ns: Columns<3>,
    pub(super) dpdu: Columns<3>,
    pub(super) dpdv: Columns<3>,
    /// The derivatives of the surface without smoothing, where a material has a bump map.
    pub(super) derivatives: [Columns<3>; 2],
    /// The normals of normal maps along the tangents and the shading normals, and the lanes that have one.
    local: Columns<3>,
    mapped: u32,
    /// Lanes whose frames are bent together.
    bent: u32,
}

impl BentFrames {
    /// The geometry of a lane, whose frame is bent alone.
    #[inline]
    pub(super) fn geometry(&self, surfaces: &VertexColumns, lane: usize, front: bool) -> ShadingGeometry {
        ShadingGeometry {
            ng: DVec3::from_array(surfaces.ng(lane)).as_vec3(),
            ns: row(&self.ns, lane).into(),
            dpdu: row(&self.dpdu, lane).into(),
            dpdv: row(&self.dpdv, lane).into(),
            derivatives: [0, 1].map(|axis| row(&self.derivatives[axis], lane).into()),
            wo: surfaces.wo(lane).into(),
            front,
        }
    }

    /// Notes a lane to be bent with others, by the normal of a normal map if there is one.
    #[inline]
    pub(super) fn note(&mut self, lane: usize, local: Option<[f32; 3]>) {
        self.bent |= 1 << lane;
        if let Some(local) = local {
            self.mapped |= 1 << lane;
            set_row(&mut self.local, lane, local);
        }
    }

    /// Bends the frames of the lanes that were noted. `front` are the lanes whose ray hit the outside.
    #[inline]
    pub(super) fn bend(&mut self, surfaces: &mut VertexColumns, front: u32) {
        if self.bent != 0 {
            bend(BendKernel { frames: self, surfaces, front });
        }
        (self.bent, self.mapped) = (0, 0);
    }
}

#[inline(never)]
fn bend(kernel: BendKernel<'_>) {
    shade_together(kernel);
}

struct BendKernel<'a> {
    frames: &'a BentFrames,
    surfaces: &'a mut VertexColumns,
    front: u32,
}

impl Kernel for BendKernel<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let Self { frames, surfaces, front } = self;
        let one = f32x8::splat(simd, 1.0);
        let is_front = mask32x8::from_bitmask(simd, front.into());
        let (ng, wo, ns, dpdu) = (
            surfaces.load_ng(simd),
            surfaces.load_wo(simd),
            load(simd, &frames.ns),
            load(simd, &frames.dpdu),
        );
        let bending = Bending {
            ng_facing: ng.negate_where(!is_front),
            facing: is_front.select(one, -one),
            ns,
            dpdu,
            dpdv: load(simd, &frames.dpdv),
            wo,
        };
        let n = match frames.mapped {
            0 => ns,
            mapped => {
                let is_mapped = mask32x8::from_bitmask(simd, mapped.into());
                Vector::select(is_mapped, bending.mapped(load(simd, &frames.local)), ns)
            }
        };
        let n = bending.valid(n);
        let (s, t) = frame_about(n, dpdu);
        surfaces.set_frames(simd, frames.bent, [s, t, n]);
    }
}
