//! Blocks of triangles and rays from one origin, such as those of a pinhole camera.
//!
//! The vectors from the origin to a triangle's corners span a pyramid. The edge functions of a ray are the dot
//! products of its direction with the normals of the pyramid's sides: Amanatides, Choi (1997), "Ray Tracing
//! Triangular Meshes". The normals, and the triangle's distance, serve all rays. Of groups of rays whose
//! directions are in a box, the greatest possible dot product excludes triangles for all of them at once.
//!
//! The quantities are those of the conservative test (see `conservative`), with its error bounds: d·(f × c) replaces
//! f·(c × d), a sum of the same products. All signs are turned so that they are positive for a ray that hits; the
//! sign of a triangle is not clear where its plane nearly contains the origin.

use crate::conservative::{BLOCK, TriangleBlock};
use crate::error_bounds::{ERROR, SURE_AFTER, USUAL_UNDERFLOW};
use crate::vector::{cross, dot, subtract};
use lookfrom_simd::{Simd, f32x8, mask32x8, prelude::*};

/// One number per triangle of a block.
type Row = [f32; BLOCK];

/// A box of directions from one origin, around its center, and the end of the longest ray: in each lane.
#[derive(Clone, Copy)]
pub(crate) struct Beams<S: Simd> {
    pub(crate) center: [f32x8<S>; 3],
    /// Half of the box's extent.
    pub(crate) half: [f32x8<S>; 3],
    pub(crate) end: f32x8<S>,
}

/// A triangle block as seen from the common origin of rays.
pub(crate) struct CommonOriginBlock {
    /// The triangles whose signs are clear. The other fields are right for these only.
    pub(crate) clear: u32,
    /// Triangles among them that show their front faces.
    pub(crate) front: u32,
    /// `sides[side][axis]`: vectors whose dot products with a direction are the edge functions.
    sides: [[Row; 3]; 3],
    /// Their magnitudes.
    magnitudes: [[Row; 3]; 3],
    /// Vectors whose dot products with a direction are the determinants.
    normal: [Row; 3],
    /// Lower and upper bound of t times the determinant.
    near: Row,
    far: Row,
    /// Error bounds of the edge functions, and twice that of the determinant.
    bound: Row,
    size_room: Row,
}

/// Eight rays and a triangle.
pub(crate) struct Outcome<S: Simd> {
    /// The rays that may hit it before their ends.
    pub(crate) kept: mask32x8<S>,
    /// The rays that surely hit it, somewhere between `first` and `last`, if `last` is not beyond their ends.
    pub(crate) sure: mask32x8<S>,
    pub(crate) first: f32x8<S>,
    pub(crate) last: f32x8<S>,
}

impl CommonOriginBlock {
    /// The block as seen by usual rays with a direction of which no component is larger than `length`.
    #[inline(always)]
    pub(crate) fn new<S: Simd>(simd: S, block: &TriangleBlock, origin: [f32; 3], length: f32) -> Self {
        let triangles = block.lanes(simd);
        let [a, b, c] = triangles.corners;
        let extent = triangles.extent.abs();
        let way = [a[0] - origin[0], a[1] - origin[1], a[2] - origin[2]];
        let (e, f) = (subtract(b, a), subtract(c, a));
        let normal = cross(e, f);
        let distance = dot(normal, way);

        let reach = way[0].abs().max(way[1].abs()).max(way[2].abs());
        let underflow = f32x8::splat(simd, USUAL_UNDERFLOW);
        let relative = extent * (ERROR * length) + underflow;
        let bound = (reach + extent) * relative + underflow;
        let size_error = extent * relative + underflow;
        let distance_error = (extent * (extent * ERROR + underflow) + underflow) * reach + underflow;
        let (near, far) = (distance.abs() - 2.0 * distance_error, distance.abs() + 2.0 * distance_error);

        let sign = f32x8::splat(simd, 1.0).copysign(distance);
        let (normal, u, v) = (times(normal, sign), times(cross(f, way), sign), times(cross(way, e), sign));
        let w = subtract(subtract(normal, u), v);
        let used = triangles.extent.simd_ge(0.0);
        let clear = (used & near.simd_gt(0.0)).to_bitmask() as u32;
        Self {
            clear,
            front: clear & distance.simd_lt(0.0).to_bitmask() as u32,
            sides: [rows(u), rows(v), rows(w)],
            magnitudes: [rows(magnitudes(u)), rows(magnitudes(v)), rows(magnitudes(w))],
            normal: rows(normal),
            near: near.into(),
            far: far.into(),
            bound: bound.into(),
            size_room: (size_error + size_error).into(),
        }
    }

    /// The triangles that some ray of a beam may hit, among those with clear signs. The beam is the same in all lanes.
    #[inline(always)]
    pub(crate) fn enter<S: Simd>(&self, simd: S, beam: &Beams<S>) -> u32 {
        self.clear & self.meet(beam, &|numbers| row(simd, numbers))
    }

    /// The beams of which some ray may hit a triangle with a clear sign.
    #[inline(always)]
    pub(crate) fn beams_that_enter<S: Simd>(&self, simd: S, triangle: usize, beams: &Beams<S>) -> u32 {
        let triangle = triangle & (BLOCK - 1);
        self.meet(beams, &|numbers| f32x8::splat(simd, numbers[triangle]))
    }

    /// Beams and triangles, lane by lane; `lanes` are the triangles' numbers for the lanes.
    #[inline(always)]
    fn meet<S: Simd>(&self, beams: &Beams<S>, lanes: &impl Fn(&Row) -> f32x8<S>) -> u32 {
        let [u, v, w] = [self.most(0, beams, lanes), self.most(1, beams, lanes), self.most(2, beams, lanes)];
        // One error bound for the edge functions, one for the box.
        let (bound, near) = (lanes(&self.bound), lanes(&self.near));
        let inside = u.min(v).min(w).simd_ge(bound * -2.0);
        let nearer = near.simd_le((bound.mul_add(8.0, u + v + w)) * beams.end);
        (inside & nearer).to_bitmask() as u32 & 0xff
    }

    /// The greatest edge functions of directions in a box.
    #[inline(always)]
    fn most<S: Simd>(&self, side: usize, beams: &Beams<S>, lanes: &impl Fn(&Row) -> f32x8<S>) -> f32x8<S> {
        let (n, m) = (&self.sides[side], &self.magnitudes[side]);
        let Beams { center, half, .. } = beams;
        let mut most = lanes(&n[0]) * center[0];
        most = lanes(&n[1]).mul_add(center[1], most);
        most = lanes(&n[2]).mul_add(center[2], most);
        most = lanes(&m[0]).mul_add(half[0], most);
        most = lanes(&m[1]).mul_add(half[1], most);
        lanes(&m[2]).mul_add(half[2], most)
    }

    /// Tests eight rays against a triangle with a clear sign.
    #[inline(always)]
    pub(crate) fn test<S: Simd>(
        &self,
        simd: S,
        triangle: usize,
        direction: [f32x8<S>; 3],
        t_min: f32x8<S>,
        end: f32x8<S>,
    ) -> Outcome<S> {
        let triangle = triangle & (BLOCK - 1);
        let determinant = along(&self.normal, triangle, direction);
        let [u, v] = [along(&self.sides[0], triangle, direction), along(&self.sides[1], triangle, direction)];
        let least = u.min(v).min(determinant - (u + v));
        let (bound, size_room) =
            (f32x8::splat(simd, self.bound[triangle]), f32x8::splat(simd, self.size_room[triangle]));
        let first = f32x8::splat(simd, self.near[triangle]) / (determinant + size_room);
        let last = f32x8::splat(simd, self.far[triangle]) / (determinant - size_room);
        Outcome {
            kept: least.simd_ge(-bound) & first.simd_le(end),
            sure: least.simd_gt(bound)
                & first.simd_gt(t_min.max(SURE_AFTER))
                & last.simd_lt(1.0 / SURE_AFTER),
            first,
            last,
        }
    }
}

#[inline(always)]
fn row<S: Simd>(simd: S, row: &Row) -> f32x8<S> {
    f32x8::load_array_ref(simd, row)
}

#[inline(always)]
fn rows<S: Simd>([x, y, z]: [f32x8<S>; 3]) -> [Row; 3] {
    [x.into(), y.into(), z.into()]
}

#[inline(always)]
fn magnitudes<S: Simd>([x, y, z]: [f32x8<S>; 3]) -> [f32x8<S>; 3] {
    [x.abs(), y.abs(), z.abs()]
}

#[inline(always)]
fn times<S: Simd>([x, y, z]: [f32x8<S>; 3], factor: f32x8<S>) -> [f32x8<S>; 3] {
    [x * factor, y * factor, z * factor]
}

/// The dot products of a triangle's vector with directions.
#[inline(always)]
fn along<S: Simd>(vectors: &[Row; 3], triangle: usize, [x, y, z]: [f32x8<S>; 3]) -> f32x8<S> {
    let [a, b, c] = [vectors[0][triangle], vectors[1][triangle], vectors[2][triangle]];
    x.mul_add(a, y.mul_add(b, z * c))
}
