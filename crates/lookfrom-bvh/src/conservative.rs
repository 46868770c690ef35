//! The conservative triangle test: Möller, Trumbore (1997) in f32 with error bounds, eight at a time.
//!
//! It finds triangles that the ray surely misses and triangles that the ray surely hits; the rest is left to the
//! exact test (see `triangle`). Any way of computing it is allowed that has an error bound. Lanes hold eight
//! triangles and one ray, or, in packets, eight rays and one triangle.

use std::marker::PhantomData;

use crate::aabb::Aabb;
use crate::error_bounds::{ERROR, SURE_AFTER, USUAL_UNDERFLOW};
use crate::lanes::{combined, least_of_each, splat_all};
use crate::prepared::PreparedRay;
use crate::ray::NONE;
use lookfrom_simd::{LaneMask, Simd, f32x8, f32x16, prelude::*};
use prefetch_index::prefetch_index;

/// Number of triangles in a block.
pub(crate) const BLOCK: usize = 8;

/// One number per triangle of a block.
type Lanes<S> = f32x8<S>;

/// Eight triangles, component by component. 384 bytes, of which a ray reads 320, five cache lines.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub(crate) struct TriangleBlock {
    /// `corners[corner][axis][lane]`; unused lanes repeat lane 0.
    corners: [[[f32; BLOCK]; 3]; 3],
    /// The largest component of the edges at the first corner; −1 in unused lanes.
    extent: [f32; BLOCK],
    geometry: [u32; BLOCK],
    /// [`NONE`] in unused lanes.
    primitive: [u32; BLOCK],
}

/// The extent that marks unused lanes.
const UNUSED: f32 = -1.0;

/// Numbers side by side: eight, or sixteen where vectors are that wide.
pub(crate) trait Numbers<S: Simd>: SimdFloat<S, Element = f32> {}

impl<S: Simd, F: SimdFloat<S, Element = f32>> Numbers<S> for F {}

/// The result of a test, lane by lane.
pub(crate) struct ConservativeTest<S: Simd, F: Numbers<S> = Lanes<S>> {
    /// Triangles that are not surely missed.
    pub(crate) kept: LaneMask,
    /// Triangles that are surely hit in the ray's range.
    pub(crate) surely_hit: LaneMask,
    /// The surely hit triangles as a SIMD mask.
    pub(crate) sure: F::Mask,
    /// Triangles that the ray's line surely passes through, in its range or not.
    pub(crate) surely_crossed: F::Mask,
    distance: F,
    distance_room: F,
    size: F,
    size_room: F,
    determinant: F,
}

impl<S: Simd, F: Numbers<S>> ConservativeTest<S, F> {
    /// The front faces among the sure hits.
    #[inline(always)]
    pub(crate) fn looks_at_front(&self) -> F::Mask {
        self.determinant.simd_lt(0.0)
    }

    /// Lower and upper bounds of the scaled t of each sure hit.
    #[inline(always)]
    pub(crate) fn between(&self) -> [F; 2] {
        [
            (self.distance - self.distance_room) / (self.size + self.size_room),
            (self.distance + self.distance_room) / (self.size - self.size_room),
        ]
    }
}

/// Rays for the test: one in every lane, or as many as lanes.
#[derive(Clone, Copy)]
pub(crate) struct RayLanes<S: Simd, F: Numbers<S> = Lanes<S>> {
    pub(crate) origin: [F; 3],
    pub(crate) direction: [F; 3],
    pub(crate) t_min: F,
    sure_before: F,
    error: F,
    underflow: F,
    rounding: F,
    level: PhantomData<S>,
}

impl<S: Simd> RayLanes<S> {
    #[inline(always)]
    pub(crate) fn new(simd: S, ray: &PreparedRay) -> Self {
        Self {
            origin: splat_all(simd, ray.scaled.origin),
            direction: splat_all(simd, ray.scaled.direction),
            t_min: Lanes::splat(simd, ray.t_min),
            sure_before: Lanes::splat(simd, ray.scaled.sure_before),
            error: Lanes::splat(simd, ray.scaled.error),
            underflow: Lanes::splat(simd, ray.scaled.underflow),
            rounding: Lanes::splat(simd, ray.scaled.rounding),
            level: PhantomData,
        }
    }
}

impl<S: Simd, F: Numbers<S>> RayLanes<S, F> {
    /// A usual ray of the world in each lane; `error` is [`ERROR`] times the largest component of its direction.
    #[inline(always)]
    pub(crate) fn of_rays(simd: S, origin: [F; 3], direction: [F; 3], t_min: F, error: F) -> Self {
        let sure_before = F::splat(simd, 1.0 / SURE_AFTER);
        let underflow = F::splat(simd, USUAL_UNDERFLOW);
        let (rounding, level) = (F::splat(simd, 0.0), PhantomData);
        Self { origin, direction, t_min, sure_before, error, underflow, rounding, level }
    }
}

#[inline(always)]
fn load<S: Simd>(simd: S, values: &[[f32; BLOCK]; 3]) -> [Lanes<S>; 3] {
    [
        Lanes::load_array_ref(simd, &values[0]),
        Lanes::load_array_ref(simd, &values[1]),
        Lanes::load_array_ref(simd, &values[2]),
    ]
}

impl TriangleBlock {
    /// Packs one to eight triangles: corners, geometry, primitive.
    pub(crate) fn new(triangles: &[([[f32; 3]; 3], u32, u32)]) -> Self {
        let mut block = Self {
            corners: [[[0.0; BLOCK]; 3]; 3],
            extent: [0.0; BLOCK],
            geometry: [NONE; BLOCK],
            primitive: [NONE; BLOCK],
        };
        for lane in 0..BLOCK {
            let (corners, geometry, primitive) = triangles.get(lane).unwrap_or(&triangles[0]);
            for corner in 0..3 {
                for axis in 0..3 {
                    block.corners[corner][axis][lane] = corners[corner][axis];
                    let edge = (corners[corner][axis] - corners[0][axis]).abs();
                    block.extent[lane] = block.extent[lane].max(edge);
                }
            }
            if lane < triangles.len() {
                block.geometry[lane] = *geometry;
                block.primitive[lane] = *primitive;
            } else {
                block.extent[lane] = UNUSED;
            }
        }
        block
    }

    /// This block with its corners on the way to those of another with the same triangles.
    #[inline(always)]
    pub(crate) fn between(&self, later: &Self, fraction: f32) -> Self {
        let (part, rest) = (fraction, 1.0 - fraction);
        let mut block = self.clone();
        for corner in 0..3 {
            for axis in 0..3 {
                let [a, b] = [&self.corners[corner][axis], &later.corners[corner][axis]];
                for lane in 0..BLOCK {
                    block.corners[corner][axis][lane] = a[lane] * rest + b[lane] * part;
                }
            }
        }
        let mut extent = [0.0_f32; BLOCK];
        for corner in 1..3 {
            for axis in 0..3 {
                for lane in 0..BLOCK {
                    let edge = block.corners[corner][axis][lane] - block.corners[0][axis][lane];
                    extent[lane] = extent[lane].max(edge.abs());
                }
            }
        }
        for lane in 0..BLOCK {
            block.extent[lane] = if self.extent[lane] == UNUSED { UNUSED } else { extent[lane] };
        }
        block
    }

    /// The corners of all triangles, `[corner][axis]`, and their extents.
    #[inline(always)]
    pub(crate) fn lanes<S: Simd>(&self, simd: S) -> TriangleLanes<S> {
        let corners =
            [load(simd, &self.corners[0]), load(simd, &self.corners[1]), load(simd, &self.corners[2])];
        TriangleLanes { corners, extent: Lanes::load_array_ref(simd, &self.extent) }
    }

    /// Asks for the five cache lines that the test reads.
    #[inline(always)]
    pub(crate) fn prefetch(&self) {
        let [first, second, third] = &self.corners;
        prefetch_index(first, 0);
        prefetch_index(second, 0);
        prefetch_index(second, 1);
        prefetch_index(third, 0);
        prefetch_index(self.extent.as_slice(), 0);
    }

    /// Number of triangles.
    pub(crate) fn count(&self) -> usize {
        self.primitive.iter().filter(|&&primitive| primitive != NONE).count()
    }

    /// One coordinate of a corner.
    #[inline(always)]
    pub(crate) fn coordinate(&self, corner: usize, axis: usize, lane: usize) -> f32 {
        self.corners[corner][axis][lane & (BLOCK - 1)]
    }

    #[inline(always)]
    pub(crate) fn ids(&self, lane: usize) -> (u32, u32) {
        let lane = lane & (BLOCK - 1);
        (self.geometry[lane], self.primitive[lane])
    }

    /// The largest component of the edges at the first corner.
    #[inline(always)]
    pub(crate) fn extent(&self, lane: usize) -> f32 {
        self.extent[lane & (BLOCK - 1)]
    }

    #[inline(always)]
    pub(crate) fn corners(&self, lane: usize) -> [[f32; 3]; 3] {
        let lane = lane & (BLOCK - 1);
        let mut corners = [[0.0; 3]; 3];
        for corner in 0..3 {
            for axis in 0..3 {
                corners[corner][axis] = self.corners[corner][axis][lane];
            }
        }
        corners
    }

    /// The triangles that the ray may hit between its `t_min` and an end, and those that it surely hits.
    #[inline(always)]
    pub(crate) fn test_conservatively<S: Simd>(
        &self,
        simd: S,
        ray: &RayLanes<S>,
        end: f32,
    ) -> ConservativeTest<S> {
        self.lanes(simd).test_conservatively(simd, ray, Lanes::splat(simd, end))
    }

    /// The box around the triangles.
    #[inline(always)]
    pub(crate) fn bounds<S: Simd>(&self, simd: S) -> Aabb {
        let [a, b, c] = self.lanes(simd).corners;
        let (mut min, mut max) = (a, a);
        for axis in 0..3 {
            min[axis] = a[axis].min(b[axis]).min(c[axis]);
            max[axis] = a[axis].max(b[axis]).max(c[axis]);
        }
        let all = least_of_each([min[0], min[1], min[2], -max[0], -max[1], -max[2], min[0], min[0]]);
        let [x, y, z, to_x, to_y, to_z, ..]: [f32; BLOCK] = all.into();
        Aabb { min: [x, y, z], max: [-to_x, -to_y, -to_z] }
    }
}

/// Triangles in lanes: several, or one in all of them.
pub(crate) struct TriangleLanes<S: Simd> {
    /// `corners[corner][axis]`.
    pub(crate) corners: [[Lanes<S>; 3]; 3],
    /// Negative in unused lanes.
    pub(crate) extent: Lanes<S>,
}

impl<S: Simd> TriangleLanes<S> {
    /// One of a block's triangles in every lane.
    #[inline(always)]
    pub(crate) fn splat(simd: S, block: &TriangleBlock, lane: usize) -> Self {
        let corners = block.corners(lane);
        let corners = [splat_all(simd, corners[0]), splat_all(simd, corners[1]), splat_all(simd, corners[2])];
        Self { corners, extent: Lanes::splat(simd, block.extent(lane)) }
    }

    /// The edges and normals.
    #[inline(always)]
    pub(crate) fn edges(&self) -> TriangleEdges<S> {
        let ([a, b, c], extent) = (self.corners, self.extent);
        let e = [b[0] - a[0], b[1] - a[1], b[2] - a[2]];
        let f = [c[0] - a[0], c[1] - a[1], c[2] - a[2]];
        let normal = [
            e[1].mul_sub(f[2], e[2] * f[1]),
            e[2].mul_sub(f[0], e[0] * f[2]),
            e[0].mul_sub(f[1], e[1] * f[0]),
        ];
        TriangleEdges { corner: a, edges: [e, f], normal, extent, level: PhantomData }
    }

    /// Lane by lane, whether the ray may hit the triangle between its `t_min` and an end, and whether
    /// it surely does.
    #[inline(always)]
    pub(crate) fn test_conservatively(
        &self,
        simd: S,
        ray: &RayLanes<S>,
        t_max: Lanes<S>,
    ) -> ConservativeTest<S> {
        let edges = self.edges();
        edges.test_range(simd, ray, t_max, &edges.test_sides(ray))
    }
}

/// Triangles by their first corner, the edges from it, and their cross product.
#[derive(Clone, Copy)]
pub(crate) struct TriangleEdges<S: Simd, F: Numbers<S> = Lanes<S>> {
    corner: [F; 3],
    edges: [[F; 3]; 2],
    normal: [F; 3],
    extent: F,
    level: PhantomData<S>,
}

impl<S: Simd> TriangleEdges<S> {
    /// These triangles in both halves of vectors twice as wide.
    #[inline(always)]
    pub(crate) fn twice(&self, simd: S) -> TriangleEdges<S, f32x16<S>> {
        let Self { corner, edges: [e, f], normal, extent, level } = *self;
        TriangleEdges {
            corner: combined(simd, corner, corner),
            edges: [combined(simd, e, e), combined(simd, f, f)],
            normal: combined(simd, normal, normal),
            extent: simd.combine_f32x8(extent, extent),
            level,
        }
    }
}

/// On which sides of a triangle's edges a ray's line passes.
pub(crate) struct Sides<S: Simd, F: Numbers<S> = Lanes<S>> {
    /// The vector from the origin to the first corner, and its largest component, rounding included.
    way: [F; 3],
    reach: F,
    /// The sum of the edge functions.
    determinant: F,
    /// The least and the greatest of the edge functions, and the bound of their errors.
    least: F,
    most: F,
    bound: F,
    /// The lines that surely pass outside.
    pub(crate) outside: F::Mask,
}

/// Möller, Trumbore (1997), "Fast, Minimum Storage Ray/Triangle Intersection", without the division.
impl<S: Simd, F: Numbers<S>> TriangleEdges<S, F> {
    /// The first part of the test: the edge functions.
    #[inline(always)]
    pub(crate) fn test_sides(&self, ray: &RayLanes<S, F>) -> Sides<S, F> {
        let Self { corner, edges: [[ex, ey, ez], [fx, fy, fz]], normal: [nx, ny, nz], extent, .. } = *self;
        let [dx, dy, dz] = ray.direction;
        let way @ [cx, cy, cz] =
            [corner[0] - ray.origin[0], corner[1] - ray.origin[1], corner[2] - ray.origin[2]];

        // The determinant, and the edge functions as its parts that belong to the corners.
        let rx = cy.mul_sub(dz, cz * dy);
        let ry = cz.mul_sub(dx, cx * dz);
        let rz = cx.mul_sub(dy, cy * dx);
        let determinant = nx.mul_add(dx, ny.mul_add(dy, nz * dz));
        let u = fx.mul_add(rx, fy.mul_add(ry, fz * rz));
        let v = -ex.mul_add(rx, ey.mul_add(ry, ez * rz));
        let w = determinant - (u + v);

        // Errors of products with the direction are relative to its length.
        let relative = extent.mul_add(ray.error, ray.underflow);
        let reach = cx.abs().max(cy.abs()).max(cz.abs()) + ray.rounding;
        let bound = (reach + extent).mul_add(relative, ray.underflow);

        // A miss has two edge functions of surely different signs. Comparisons with NaN are false, and exclude
        // nothing.
        let least = u.min(v).min(w);
        let most = u.max(v).max(w);
        let outside = least.simd_lt(-bound) & most.simd_gt(bound);
        Sides { way, reach, determinant, least, most, bound, outside }
    }

    /// The second part: whether t is in the ray's range. Distances are times the determinant.
    #[inline(always)]
    pub(crate) fn test_range(
        &self,
        simd: S,
        ray: &RayLanes<S, F>,
        t_max: F,
        sides: &Sides<S, F>,
    ) -> ConservativeTest<S, F> {
        let Self { normal: [nx, ny, nz], extent, .. } = *self;
        let Sides { way: [cx, cy, cz], reach, determinant, least, most, bound, outside } = *sides;
        let underflow = ray.underflow;
        let size_error = extent.mul_add(extent.mul_add(ray.error, underflow), underflow);
        let distance = nx.mul_add(cx, ny.mul_add(cy, nz * cz));
        let distance_error =
            extent.mul_add(extent.mul_add(ERROR, underflow), underflow).mul_add(reach, underflow);

        // A t surely out of range, where the determinant's sign is sure.
        let size = determinant.abs();
        let distance = distance * F::splat(simd, 1.0).copysign(determinant);
        let beyond = distance.simd_gt(t_max.mul_add(size, size_error.mul_add(t_max.abs(), distance_error)));
        let before = distance.simd_lt(ray.t_min.mul_sub(size, size_error.mul_add(ray.t_min, distance_error)));
        let out_of_range = size.simd_gt(size_error) & (beyond | before);
        let unused = extent.simd_lt(0.0);
        let excluded = outside | out_of_range | unused;

        // A hit is sure where all comparisons hold the other way round, with twice the error bounds.
        let inside = least.simd_gt(bound) | most.simd_lt(-bound);
        let (size_room, distance_room) = (size_error + size_error, distance_error + distance_error);
        let first = ray.t_min.max(SURE_AFTER);
        let last = t_max.min(ray.sure_before);
        let in_range = distance.simd_gt(first.mul_add(size, size_room.mul_add(first, distance_room)))
            & distance.simd_lt(last.mul_sub(size, size_room.mul_add(last, distance_room)));
        let surely_crossed = inside & size.simd_gt(size_room) & !unused;
        let sure = surely_crossed & in_range;
        let lanes = (1 << F::LEN) - 1;
        ConservativeTest {
            kept: LaneMask(!excluded.to_bitmask() as u32 & lanes),
            surely_hit: LaneMask(sure.to_bitmask() as u32 & lanes),
            sure,
            surely_crossed,
            distance,
            distance_room,
            size,
            size_room,
            determinant,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dispatch::{dispatch_or_scalar, levels_and_scalar};
    use crate::exact::ExactRay;
    use crate::ray::Ray;
    use crate::triangle::intersect_exact;
    use lookfrom_simd::Kernel;

    struct TestBlock<'a>(&'a TriangleBlock, &'a PreparedRay);

    impl Kernel for TestBlock<'_> {
        type Output = (LaneMask, LaneMask, [f32; 2]);
        #[inline(always)]
        fn run<S: Simd>(self, simd: S) -> (LaneMask, LaneMask, [f32; 2]) {
            let tested = self.0.test_conservatively(simd, &RayLanes::new(simd, self.1), f32::INFINITY);
            let [first, last] = tested.between();
            (tested.kept, tested.surely_hit, [first[0], last[0]])
        }
    }

    #[test]
    fn exact_hits_are_never_excluded() {
        let mut random = crate::testing::Random::new(7);
        let levels = levels_and_scalar();
        let (mut hits, mut sure, mut kept, mut all) = (0, 0, 0, 0);
        for _ in 0..200_000 {
            let center = random.point_with_exponents(-8, 8);
            let size = random.size(-8, 8);
            let corners = [0; 3].map(|_| random.near(center, size));
            let target = random.on_triangle(&corners);
            let away = size * random.size(-9, 0);
            let from_afar = random.unit() < 0.5;
            let origin =
                if from_afar { random.point_with_exponents(-8, 8) } else { random.near(target, away) };
            let stretch = random.size(-8, 8);
            let direction = match from_afar {
                true => [0, 1, 2].map(|i| stretch * (target[i] - origin[i])),
                false => random.near([0.0; 3], stretch),
            };
            let ray = Ray::new(origin, direction);
            let exact = ExactRay::new(&ray);
            let Some(prepared) = PreparedRay::new(fearless_simd::Fallback::new(), &exact, 0.0) else {
                continue;
            };
            let block = TriangleBlock::new(&[(corners, 0, 0)]);
            let (tested, surely_hit, [first, last]) =
                dispatch_or_scalar(levels[all % levels.len()], TestBlock(&block, &prepared));
            let keep = tested.count();
            all += 1;
            kept += keep;
            let hit = intersect_exact(&exact, &corners, block.extent(0));
            if hit.is_some() {
                hits += 1;
                assert_eq!(keep, 1, "{corners:?} {ray:?}");
            }
            if surely_hit != LaneMask(0) {
                sure += 1;
                let t = f64::from(hit.unwrap().t) * f64::from(prepared.scaled.scale);
                assert!(f64::from(first) < t && t < f64::from(last), "{corners:?} {ray:?}");
            }
        }
        assert!(
            10_000 < sure && sure < hits && hits < kept && kept < all,
            "{sure} sure, {hits} hits, {kept} kept of {all}"
        );
    }
}
