//! Eight surfaces side by side, in memory and in vectors.

use lookfrom_simd::{Simd, f32x8, f64x8, prelude::*};

use crate::core::lanes::LANES;
use crate::core::points::Points;
use crate::core::vector::Vector;
use crate::integrator::path::Vertex;

/// Eight surfaces in memory, by component.
#[derive(Clone, Copy)]
pub(super) struct SurfaceColumns {
    position: [[f64; LANES]; 3],
    error: [[f64; LANES]; 3],
    ng: [[f64; LANES]; 3],
    /// The axes of the frames; the third are the shading normals.
    frame: [[[f32; LANES]; 3]; 3],
    /// In render space.
    wo: [[f32; LANES]; 3],
}

impl SurfaceColumns {
    #[inline(always)]
    pub(super) fn new<S: Simd>(
        points: Points<f32x8<S>>,
        ng: Vector<f64x8<S>>,
        [s, t, n]: [Vector<f32x8<S>>; 3],
        wo: Vector<f32x8<S>>,
    ) -> Self {
        Self {
            position: store_f64(points.position),
            error: store_f64(points.error),
            ng: store_f64(ng),
            frame: [store(s), store(t), store(n)],
            wo: store(wo),
        }
    }

    /// The surfaces of vertices.
    pub(super) fn of_vertices(vertices: &[&Vertex; LANES]) -> Self {
        let (zeros, wide_zeros) = ([[0.0; LANES]; 3], [[0.0; LANES]; 3]);
        let mut columns =
            Self { position: wide_zeros, error: wide_zeros, ng: wide_zeros, frame: [zeros; 3], wo: zeros };
        for (lane, vertex) in vertices.iter().enumerate() {
            let (surface, axes) = (&vertex.surface, vertex.shading.axes());
            for k in 0..3 {
                columns.position[k][lane] = surface.point.position[k];
                columns.error[k][lane] = surface.point.error[k];
                columns.ng[k][lane] = surface.ng[k];
                columns.wo[k][lane] = surface.wo[k];
                for (column, axis) in columns.frame.iter_mut().zip(axes) {
                    column[k][lane] = axis[k];
                }
            }
        }
        columns
    }

    /// Replaces the axes of a lane's frame.
    #[inline]
    pub(super) fn set_frame(&mut self, lane: usize, axes: [[f32; 3]; 3]) {
        for (column, axis) in self.frame.iter_mut().zip(axes) {
            for k in 0..3 {
                column[k][lane] = axis[k];
            }
        }
    }

    /// The direction back along a lane's ray.
    #[inline]
    pub(super) fn wo(&self, lane: usize) -> [f32; 3] {
        self.wo.map(|column| column[lane])
    }

    /// The position of a lane.
    #[inline]
    pub(super) fn position(&self, lane: usize) -> [f64; 3] {
        self.position.map(|column| column[lane])
    }

    /// The geometric normal of a lane.
    #[inline]
    pub(super) fn ng(&self, lane: usize) -> [f64; 3] {
        self.ng.map(|column| column[lane])
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

#[inline(always)]
fn store<S: Simd>(v: Vector<f32x8<S>>) -> [[f32; LANES]; 3] {
    [v.x.into(), v.y.into(), v.z.into()]
}

#[inline(always)]
fn store_f64<S: Simd>(v: Vector<f64x8<S>>) -> [[f64; LANES]; 3] {
    [v.x.into(), v.y.into(), v.z.into()]
}

#[inline(always)]
fn load<S: Simd>(simd: S, v: &[[f32; LANES]; 3]) -> Vector<f32x8<S>> {
    Vector {
        x: f32x8::load_array(simd, v[0]),
        y: f32x8::load_array(simd, v[1]),
        z: f32x8::load_array(simd, v[2]),
    }
}

#[inline(always)]
fn load_f64<S: Simd>(simd: S, v: &[[f64; LANES]; 3]) -> Vector<f64x8<S>> {
    Vector {
        x: f64x8::load_array(simd, v[0]),
        y: f64x8::load_array(simd, v[1]),
        z: f64x8::load_array(simd, v[2]),
    }
}
