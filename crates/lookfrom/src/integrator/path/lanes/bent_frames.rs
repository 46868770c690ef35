//! The shading frames of eight hits, bent by bump and normal maps, and such that reflections stay outside.

use glam::DVec3;
use lookfrom_simd::{Kernel, LaneMask, Simd, f32x8, mask32x8, prelude::*};

use super::class_hits::ClassHit;
use super::vertices::VertexColumns;
use crate::core::lanes::{Columns, LANES, bitmask, by_lane, load, row, set_row, shade_together};
use crate::core::vector::Vector;
use crate::shading::interaction::ShadingGeometry;
use crate::shading::material::{
    Bending, Guard, LocalNormal, Material, Neighbours, NormalLimit, displaced_normal, frame_about,
};
use crate::shading::texture::{TexturePoint, Textures};
use crate::world::World;

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
    bumps: Bumps,
    /// The lanes whose frames are bent together.
    bent: BentLanes,
    limits: [NormalLimit; LANES],
}

/// The heights of bump maps, at points and at their [`Neighbours`].
#[derive(Default)]
struct Bumps {
    uv: Columns<2>,
    steps: Columns<2>,
    heights: Columns<3>,
}

/// Lanes whose frames are bent together, as masks.
#[derive(Clone, Copy, Default)]
struct BentLanes {
    all: u32,
    /// Lanes with a bump map.
    bumped: u32,
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

    /// Notes a lane to be bent with others, with the normal of its normal map if there is one.
    #[inline]
    pub(super) fn note(&mut self, lane: usize, material: &Material, local: Option<LocalNormal>) {
        let (bent, bit, limit) = (&mut self.bent, 1 << lane, material.normal_limit());
        bent.all |= bit;
        bent.bumped |= u32::from(material.heights().is_some()) << lane;
        if let Some(LocalNormal { n, follows_dpdv }) = local {
            bent.mapped |= bit;
            bent.following_dpdv |= u32::from(follows_dpdv) << lane;
            set_row(&mut self.local, lane, n);
        }
        bent.valid |= u32::from(limit.keeps_valid()) << lane;
        bent.turning |= u32::from(limit.turns()) << lane;
        self.limits[lane] = limit;
    }

    /// Looks up the heights of the bump maps of the lanes that were noted.
    #[inline]
    pub(super) fn look_up_heights(
        &mut self,
        world: &World,
        hits: &[ClassHit<'_>; LANES],
        points: &[TexturePoint<'_>; LANES],
        (surfaces, uv): (&VertexColumns, &Columns<2>),
    ) {
        if self.bent.bumped != 0 {
            find_neighbours(NeighboursKernel { world, frames: self, surfaces, uv });
            self.look_up_noted_heights(&world.textures, hits, points);
        }
    }

    #[inline(never)]
    fn look_up_noted_heights(
        &mut self,
        textures: &Textures,
        hits: &[ClassHit<'_>; LANES],
        points: &[TexturePoint<'_>; LANES],
    ) {
        let is_noted = |lane: usize| self.bent.bumped & 1 << lane != 0;
        let maps = by_lane!(lane => hits[lane].material.heights().filter(|_| is_noted(lane)));
        let here = textures.floats(&maps, points);
        let [further_along_u, further_along_v] = [0, 1].map(|axis| {
            let derivatives = [&self.derivatives[axis], [&self.dpdu, &self.dpdv][axis]];
            let neighbours = by_lane!(lane => match is_noted(lane) {
                true => {
                    let (uv, steps) = (row(&self.bumps.uv, lane), row(&self.bumps.steps, lane));
                    let is_smooth = self.limits[lane].takes_smooth_derivatives();
                    let along = row(derivatives[usize::from(is_smooth)], lane).into();
                    Neighbours { uv, steps }.texture_point(axis, &points[lane], along)
                }
                false => TexturePoint::NOWHERE,
            });
            textures.floats(&maps, &neighbours)
        });
        self.bumps.heights = [here, further_along_u, further_along_v];
    }

    /// ∂p/∂u and ∂p/∂v by which heights are compared.
    #[inline(always)]
    fn derivatives_of_heights<S: Simd>(&self, simd: S) -> [Vector<f32x8<S>>; 2] {
        let smooth = bitmask(&by_lane!(lane => self.limits[lane].takes_smooth_derivatives()));
        let is_smooth = mask32x8::from_bitmask(simd, smooth.into());
        let [along_u, along_v] = &self.derivatives;
        [
            Vector::select(is_smooth, load(simd, &self.dpdu), load(simd, along_u)),
            Vector::select(is_smooth, load(simd, &self.dpdv), load(simd, along_v)),
        ]
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
fn find_neighbours(kernel: NeighboursKernel<'_>) {
    shade_together(kernel);
}

struct NeighboursKernel<'a> {
    world: &'a World,
    frames: &'a mut BentFrames,
    surfaces: &'a VertexColumns,
    uv: &'a Columns<2>,
}

impl Kernel for NeighboursKernel<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let Self { world, frames, surfaces, uv } = self;
        let (limits, relief) = (&frames.limits, world.relief());
        let load_f32 = |values: [f32; LANES]| f32x8::load_array(simd, values);
        let seen = frames.bent.bumped & bitmask(&by_lane!(lane => limits[lane].sees_pixels()));
        let zero = f32x8::splat(simd, 0.0);
        let half = match relief.footprint.filter(|_| seen != 0) {
            Some(pixels) => {
                let position = surfaces.load_position(simd);
                let position = Vector::splat(position.x, world.origin.to_array()) + position;
                let (ng, derivatives) = (surfaces.load_ng(simd), frames.derivatives_of_heights(simd));
                let [u, v]: [f32x8<S>; 2] = pixels.half(position, ng, derivatives);
                let is_seen = mask32x8::from_bitmask(simd, seen.into());
                [is_seen.select(u, zero), is_seen.select(v, zero)]
            }
            None => [zero; 2],
        };
        let step = load_f32(by_lane!(lane => limits[lane].step(relief.step)));
        let Neighbours { uv, steps } = Neighbours::new([load_f32(uv[0]), load_f32(uv[1])], half, step);
        frames.bumps.uv = uv.map(Into::into);
        frames.bumps.steps = steps.map(Into::into);
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
        let BentLanes { all, bumped, mapped, following_dpdv, valid, turning } = frames.bent;
        let mut bent = ns;
        if mapped != 0 {
            let n = bending.mapped(load(simd, &frames.local), is_in(following_dpdv));
            bent = Vector::select(is_in(mapped), n, bent);
        }
        if bumped != 0 {
            let load_f32 = |values: &[f32; LANES]| f32x8::load_array(simd, *values);
            let Bumps { steps, heights, .. } = &frames.bumps;
            let steps = [load_f32(&steps[0]), load_f32(&steps[1])];
            let heights = [load_f32(&heights[0]), load_f32(&heights[1]), load_f32(&heights[2])];
            let n = displaced_normal(ns, frames.derivatives_of_heights(simd), steps, heights);
            bent = Vector::select(is_in(bumped), n, bent);
        }
        let n = bending.limited(bent, is_in(valid), is_in(turning));
        let (s, t) = frame_about(n, dpdu);
        surfaces.set_frames(simd, all, [s, t, n]);
    }
}
