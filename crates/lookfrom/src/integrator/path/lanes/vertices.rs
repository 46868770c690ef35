//! Vertices of paths on surfaces, with the frames that they are shaded in: in columns of memory, and as numbers of any width.

use lookfrom_simd::{Float, Mask, Real, Simd, f32x8, f64x8, mask32x8, prelude::*};

use crate::aov::FirstSurfaceColumns;
use crate::core::lanes::width::Width;
use crate::core::lanes::{Columns, LANES, load, load_f64, row, set_row, store, store_f64};
use crate::core::points::{Exits, Lift, Points};
use crate::core::spectrum::Spectrum;
use crate::core::vector::Vector;
use crate::integrator::path::Vertex;
use crate::shading::material::Guard;

/// Eight vertices in memory, by component.
#[derive(Clone, Copy, Default)]
pub(super) struct VertexColumns {
    position: Columns<3, f64>,
    error: Columns<3, f64>,
    ng: Columns<3, f64>,
    /// The axes of the frames; the third are the shading normals.
    frame: [Columns<3>; 3],
    /// In render space.
    wo: Columns<3>,
    /// The ways to the smooth surfaces that meshes stand for, and the normals of those; in the lanes of a mask.
    lift: [Columns<3>; 2],
    lifted: u32,
    /// The guards of bent normals, where a lane has one.
    guards: Option<GuardColumns>,
}

/// Guards of bent normals, by component, in the lanes of a mask.
#[derive(Clone, Copy, Default)]
struct GuardColumns {
    ns: Columns<3>,
    alpha_squared: [f32; LANES],
    lanes: u32,
}

impl VertexColumns {
    /// Replaces all of them.
    #[inline(always)]
    pub(super) fn set<S: Simd>(
        &mut self,
        points: Points<f32x8<S>>,
        ng: Vector<f64x8<S>>,
        [s, t, n]: [Vector<f32x8<S>>; 3],
        wo: Vector<f32x8<S>>,
    ) {
        self.position = store_f64(points.position);
        self.error = store_f64(points.error);
        self.ng = store_f64(ng);
        self.frame = [store(s), store(t), store(n)];
        self.wo = store(wo);
        self.guards = None;
    }

    /// Replaces the smooth surfaces that meshes stand for, which are there in the lanes of a mask.
    #[inline(always)]
    pub(super) fn set_lifts<S: Simd>(&mut self, lift: Lift<f32x8<S>>, lanes: u32) {
        let zero = lift.way.x.like(0.0);
        self.lifted = lanes & lift.way.length_squared().gt(zero).to_bitmask() as u32;
        if self.lifted != 0 {
            self.lift = [store(lift.way), store(lift.ns)];
        }
    }

    /// The surfaces of vertices, from the first lane on.
    pub(super) fn of_vertices(vertices: &[&Vertex]) -> Self {
        let mut columns = Self::default();
        for (lane, vertex) in vertices.iter().enumerate().take(LANES) {
            let surface = &vertex.surface;
            set_row(&mut columns.position, lane, surface.point.position);
            set_row(&mut columns.error, lane, surface.point.error);
            set_row(&mut columns.ng, lane, surface.ng.to_array());
            set_row(&mut columns.wo, lane, surface.wo.to_array());
            columns.set_frame(lane, vertex.shading.axes());
            columns.set_guard(lane, vertex.shading.guard());
            if let Some(lift) = surface.lift() {
                columns.lifted |= 1 << lane;
                set_row(&mut columns.lift[0], lane, lift.way.into());
                set_row(&mut columns.lift[1], lane, lift.ns.into());
            }
        }
        columns
    }

    /// Gives a lane a guard, if there is one.
    #[inline]
    pub(super) fn set_guard(&mut self, lane: usize, guard: Option<&Guard>) {
        if let Some(guard) = guard {
            let guards = self.guards.get_or_insert_default();
            guards.lanes |= 1 << lane;
            set_row(&mut guards.ns, lane, guard.ns.into());
            guards.alpha_squared[lane] = guard.alpha_squared;
        }
    }

    /// The guard of a lane.
    pub(super) fn guard(&self, lane: usize) -> Option<Guard> {
        let guards = self.guards.as_ref().filter(|guards| guards.lanes & 1 << lane != 0)?;
        Some(Guard { ns: row(&guards.ns, lane).into(), alpha_squared: guards.alpha_squared[lane] })
    }

    /// Replaces the axes of a lane's frame.
    #[inline]
    pub(super) fn set_frame(&mut self, lane: usize, axes: [[f32; 3]; 3]) {
        for (columns, axis) in self.frame.iter_mut().zip(axes) {
            set_row(columns, lane, axis);
        }
    }

    /// Replaces the axes of frames in the lanes of a mask.
    #[inline(always)]
    pub(super) fn set_frames<S: Simd>(&mut self, simd: S, lanes: u32, axes: [Vector<f32x8<S>>; 3]) {
        let is_new = mask32x8::from_bitmask(simd, lanes.into());
        let mut k = 0;
        while k < 3 {
            self.frame[k] = store(Vector::select(is_new, axes[k], load(simd, &self.frame[k])));
            k += 1;
        }
    }

    /// The geometric normals.
    #[inline(always)]
    pub(super) fn load_ng<S: Simd>(&self, simd: S) -> Vector<f32x8<S>> {
        Vector::narrow(load_f64(simd, &self.ng))
    }

    /// The positions, in render space.
    #[inline(always)]
    pub(super) fn load_position<S: Simd>(&self, simd: S) -> Vector<f64x8<S>> {
        load_f64(simd, &self.position)
    }

    /// The directions back along the rays.
    #[inline(always)]
    pub(super) fn load_wo<S: Simd>(&self, simd: S) -> Vector<f32x8<S>> {
        load(simd, &self.wo)
    }

    /// The direction back along a lane's ray.
    #[inline]
    pub(super) fn wo(&self, lane: usize) -> [f32; 3] {
        row(&self.wo, lane)
    }

    /// Leaves them to AOVs.
    #[inline]
    pub(super) fn leave(&self, first: &mut FirstSurfaceColumns) {
        (first.position, first.wo) = (self.position, self.wo);
        for (narrow, wide) in first.ng.iter_mut().flatten().zip(self.ng.iter().flatten()) {
            *narrow = *wide as f32;
        }
    }

    /// The position of a lane.
    #[inline]
    pub(super) fn position(&self, lane: usize) -> [f64; 3] {
        row(&self.position, lane)
    }

    /// The geometric normal of a lane.
    #[inline]
    pub(super) fn ng(&self, lane: usize) -> [f64; 3] {
        row(&self.ng, lane)
    }

    /// The axes of a lane's frame.
    #[inline]
    pub(super) fn axes(&self, lane: usize) -> [[f32; 3]; 3] {
        self.frame.map(|axis| row(&axis, lane))
    }

    /// The shading normal of a lane.
    #[inline]
    pub(super) fn ns(&self, lane: usize) -> [f32; 3] {
        row(&self.frame[2], lane)
    }

    /// The surfaces as numbers of a width.
    #[inline(always)]
    pub(super) fn load<W: Width>(&self, width: W) -> Vertices<W::Real> {
        let [s, t, n] =
            [load(width, &self.frame[0]), load(width, &self.frame[1]), load(width, &self.frame[2])];
        let wo = load(width, &self.wo);
        let ng = load_f64(width, &self.ng);
        Vertices {
            points: Points { position: load_f64(width, &self.position), error: load_f64(width, &self.error) },
            ng,
            s,
            t,
            n,
            wo: Vector { x: wo.dot(s), y: wo.dot(t), z: wo.dot(n) },
            cos_ng: wo.dot(Vector::narrow(ng)),
            lift: (self.lifted != 0).then(|| {
                let [way, ns] = [load(width, &self.lift[0]), load(width, &self.lift[1])];
                let none = Vector::splat(way.x, [0.0; 3]);
                Lift { way: Vector::select(width.mask(self.lifted), way, none), ns }
            }),
            guard: self.guards.as_ref().map(
                #[inline(always)]
                |guards| Guard {
                    // By the shading normal itself, a guard without shadows lets everything through.
                    ns: Vector::select(width.mask(guards.lanes), load(width, &guards.ns), n),
                    alpha_squared: width.load_f32(&guards.alpha_squared),
                },
            ),
        }
    }
}

/// Vertices and the frames that they are shaded in.
pub(super) struct Vertices<R: Real> {
    pub(super) points: Points<R>,
    /// Geometric normals, of unit length.
    pub(super) ng: Vector<R::Double>,
    pub(super) s: Vector<R>,
    pub(super) t: Vector<R>,
    /// Shading normals.
    pub(super) n: Vector<R>,
    /// In the frame.
    pub(super) wo: Vector<R>,
    /// The cosines of `wo` to the geometric normals.
    pub(super) cos_ng: R,
    /// The smooth surfaces that meshes stand for.
    pub(super) lift: Option<Lift<R>>,
    /// The guards of normals that are bent.
    pub(super) guard: Option<Guard<R>>,
}

impl<R: Real> Vertices<R> {
    /// From render space to the frames.
    #[inline(always)]
    pub(super) fn local(&self, w: Vector<R>) -> Vector<R> {
        Vector { x: w.dot(self.s), y: w.dot(self.t), z: w.dot(self.n) }
    }

    /// From the frames to render space, of unit length.
    #[inline(always)]
    pub(super) fn render(&self, w: Vector<R>) -> Vector<R> {
        (self.s * w.x + self.t * w.y + self.n * w.z).normalize()
    }

    /// The ways out of the surfaces.
    #[inline(always)]
    pub(super) fn exits(&self) -> Exits<'_, R> {
        self.points.exits(self.ng).lifted(self.lift.as_ref())
    }

    /// The value of a BSDF for light from `wi`, in render space, less what the guards of bent normals keep off.
    #[inline(always)]
    pub(super) fn guarded(&self, f: Spectrum<R>, wi: Vector<R>) -> Spectrum<R> {
        match &self.guard {
            Some(guard) => f * guard.lets_through(wi, self.n),
            None => f,
        }
    }

    /// Whether the geometric and the shading normal agree that `wo` and `wi`, in render space, are on one side, or that
    /// they are not.
    #[inline(always)]
    pub(super) fn agrees(&self, wi: Vector<R>) -> R::Mask {
        let zero = self.cos_ng.like(0.0);
        let is_beside = (self.wo.z * wi.dot(self.n)).gt(zero);
        let mut is_outside = (self.cos_ng * wi.dot(Vector::narrow(self.ng))).gt(zero);
        if let Some(lift) = &self.lift {
            is_outside = is_outside | zero.narrow_mask(lift.is_above(wi));
        }
        is_outside.choose(is_beside, !is_beside)
    }
}
