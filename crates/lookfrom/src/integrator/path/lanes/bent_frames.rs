//! The shading frames of eight hits, bent by normal maps, and such that reflections stay outside.

use glam::DVec3;
use lookfrom_simd::{Kernel, LaneMask, Simd, f32x8, mask32x8, prelude::*};

use super::vertices::VertexColumns;
use crate::core::lanes::{Columns, LANES, load, row, set_row, shade_together};
use crate::core::vector::Vector;
use crate::shading::interaction::ShadingGeometry;
use crate::shading::material::{Bending, Guard, LocalNormal, NormalLimit, frame_about};

/// The directions from which bent frames are made, and the normals of normal maps. Masks have bit i for lane i.
#[derive(Default)]
pub(super) struct BentFrames {
    pub(super) ns: Columns<3>,
    pub(super) dpdu: Columns<3>,
    pub(super) dpdv: Columns<3>,
    /// The derivatives of the surface without smoothing, where a material has a bump map.
    pub(super) derivatives: [Columns<3>; 2],
    /// The normals of normal maps along the tangents and the shading normals.
    local: Columns<3>,
    /// The lanes whose frames are bent together.
    bent: BentLanes,
    limits: [NormalLimit; LANES],
}

/// Lanes whose frames are bent together, as masks.
#[derive(Clone, Copy, Default)]
struct BentLanes {
    all: u32,
    /// Lanes with a normal map.
    mapped: u32,
    /// Lanes whose second tangent is on the side of ∂p/∂v.
    following_dpdv: u32,
    /// Lanes with [`NormalLimit::Valid`].
    valid: u32,
    /// Lanes with [`NormalLimit::turns`].
    turning: u32,
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
    pub(super) fn note(&mut self, lane: usize, local: Option<LocalNormal>, limit: NormalLimit) {
        let (bent, bit) = (&mut self.bent, 1 << lane);
        bent.all |= bit;
        if let Some(LocalNormal { n, follows_dpdv }) = local {
            bent.mapped |= bit;
            bent.following_dpdv |= u32::from(follows_dpdv) << lane;
            set_row(&mut self.local, lane, n);
        }
        bent.valid |= u32::from(limit.keeps_valid()) << lane;
        bent.turning |= u32::from(limit.turns()) << lane;
        self.limits[lane] = limit;
    }

    /// Bends the frames of the lanes that were noted. `front` are the lanes whose ray hit the outside.
    #[inline]
    pub(super) fn bend(&mut self, surfaces: &mut VertexColumns, front: u32) {
        if self.bent.all == 0 {
            return;
        }
        bend(BendKernel { frames: self, surfaces, front });
        for lane in LaneMask(self.bent.all & !self.bent.valid) {
            if let NormalLimit::Guarded(guard) = self.limits[lane] {
                let guard = Guard::of(guard, row(&self.ns, lane).into(), surfaces.ns(lane).into());
                surfaces.set_guard(lane, Some(&guard));
            }
        }
        self.bent = BentLanes::default();
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
        let is_in = |lanes: u32| mask32x8::from_bitmask(simd, lanes.into());
        let BentLanes { all, mapped, following_dpdv, valid, turning } = frames.bent;
        let bent = match mapped {
            0 => ns,
            mapped => {
                let mapped_n = bending.mapped(load(simd, &frames.local), is_in(following_dpdv));
                Vector::select(is_in(mapped), mapped_n, ns)
            }
        };
        let n = bending.limited(bent, is_in(valid), is_in(turning));
        let (s, t) = frame_about(n, dpdu);
        surfaces.set_frames(simd, all, [s, t, n]);
    }
}
