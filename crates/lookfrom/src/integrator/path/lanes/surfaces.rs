//! Eight surfaces side by side, in memory and in vectors.

use lookfrom_simd::{Float, Simd, f32x8, f64x8, mask32x8, prelude::*};

use crate::core::lanes::{Columns, LANES, load, load_f64, row, set_row, store, store_f64};
use crate::core::points::{Lift, Points};
use crate::core::vector::Vector;
use crate::integrator::FirstSurfaceColumns;
use crate::integrator::path::Vertex;

/// Eight surfaces in memory, by component.
#[derive(Clone, Copy)]
pub(super) struct SurfaceColumns {
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
}

impl SurfaceColumns {
    /// None yet.
    pub(super) const NONE: Self = Self {
        position: [[0.0; LANES]; 3],
        error: [[0.0; LANES]; 3],
        ng: [[0.0; LANES]; 3],
        frame: [[[0.0; LANES]; 3]; 3],
        wo: [[0.0; LANES]; 3],
        lift: [[[0.0; LANES]; 3]; 2],
        lifted: 0,
    };

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

    /// The surfaces of vertices.
    pub(super) fn of_vertices(vertices: &[&Vertex; LANES]) -> Self {
        let mut columns = Self::NONE;
        for (lane, vertex) in vertices.iter().enumerate() {
            let surface = &vertex.surface;
            set_row(&mut columns.position, lane, surface.point.position);
            set_row(&mut columns.error, lane, surface.point.error);
            set_row(&mut columns.ng, lane, surface.ng.to_array());
            set_row(&mut columns.wo, lane, surface.wo.to_array());
            columns.set_frame(lane, vertex.shading.axes());
            if let Some(lift) = surface.lift() {
                columns.lifted |= 1 << lane;
                set_row(&mut columns.lift[0], lane, lift.way.into());
                set_row(&mut columns.lift[1], lane, lift.ns.into());
            }
        }
        columns
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

    /// The same for AOVs.
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

    /// The shading normal of a lane.
    #[inline]
    pub(super) fn ns(&self, lane: usize) -> [f32; 3] {
        row(&self.frame[2], lane)
    }

    /// The surfaces in vectors.
    #[inline(always)]
    pub(super) fn load<S: Simd>(&self, simd: S) -> Surfaces<S> {
        let [s, t, n] = [load(simd, &self.frame[0]), load(simd, &self.frame[1]), load(simd, &self.frame[2])];
        let wo = load(simd, &self.wo);
        let ng = load_f64(simd, &self.ng);
        Surfaces {
            points: Points { position: load_f64(simd, &self.position), error: load_f64(simd, &self.error) },
            ng,
            s,
            t,
            n,
            wo: Vector { x: wo.dot(s), y: wo.dot(t), z: wo.dot(n) },
            cos_ng: wo.dot(Vector::narrow(ng)),
            lift: (self.lifted != 0).then(|| {
                let is_lifted = mask32x8::from_bitmask(simd, self.lifted.into());
                let [way, ns] = [load(simd, &self.lift[0]), load(simd, &self.lift[1])];
                let none = Vector::splat(way.x, [0.0; 3]);
                Lift { way: Vector::select(is_lifted, way, none), ns }
            }),
        }
    }
}

/// Eight surfaces and the frames that they are shaded in.
pub(super) struct Surfaces<S: Simd> {
    pub(super) points: Points<f32x8<S>>,
    /// Geometric normals, of unit length.
    pub(super) ng: Vector<f64x8<S>>,
    pub(super) s: Vector<f32x8<S>>,
    pub(super) t: Vector<f32x8<S>>,
    /// Shading normals.
    pub(super) n: Vector<f32x8<S>>,
    /// In the frame.
    pub(super) wo: Vector<f32x8<S>>,
    /// The cosines of `wo` to the geometric normals.
    pub(super) cos_ng: f32x8<S>,
    /// The smooth surfaces that meshes stand for.
    pub(super) lift: Option<Lift<f32x8<S>>>,
}

impl<S: Simd> Surfaces<S> {
    /// From render space to the frames.
    #[inline(always)]
    pub(super) fn local(&self, w: Vector<f32x8<S>>) -> Vector<f32x8<S>> {
        Vector { x: w.dot(self.s), y: w.dot(self.t), z: w.dot(self.n) }
    }

    /// From the frames to render space, of unit length.
    #[inline(always)]
    pub(super) fn render(&self, w: Vector<f32x8<S>>) -> Vector<f32x8<S>> {
        (self.s * w.x + self.t * w.y + self.n * w.z).normalize()
    }
}
