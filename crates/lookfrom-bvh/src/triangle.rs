//! Does a ray meet a triangle, and where?
//!
//! Two steps. The *filter* takes four triangles at once in f32 and excludes those that the ray surely misses; it may be
//! calculated in any way. The *decision* takes one triangle in f64 and alone says what is hit, so that the same bits come
//! out whatever the filter, the tree or the machine.
//!
//! The decision is watertight: Woop, Benthin, Wald (2013), "Watertight Ray/Triangle Intersection". Corners are moved to
//! the ray's origin and sheared so that the ray runs along one axis. A corner's two remaining coordinates come out the
//! same for every triangle that has it, and signs of the edge functions are right for these coordinates: rounding is
//! monotonous, so a difference of two rounded products has the sign of the exact one or is 0, and then the rounding
//! errors of the products decide. So rays see a plane mesh without gaps. An edge belongs to both of its triangles.
//!
//! `t` is the plane's, `n·(p0 − o) / n·d`, from differences of f32 values that f64 holds (nearly) exactly: its sign is
//! right to about 10⁻¹⁵ of the triangle's size, however near the origin is to the plane.

use crate::aabb::Aabb;
use crate::exact::{Exact, Rounded};
use crate::prepared::{self, Prepared};
use crate::ray::NONE;
use crate::simd::{Chosen, Simd, f32x8, mask32x8, prelude::*};
use crate::vector::{cross, cross_magnitude, dot, subtract, wide};

/// Triangles in a block.
pub(crate) const BLOCK: usize = 8;

/// As many numbers as a block has triangles.
type Lanes<S> = f32x8<S>;

/// Errors of the filter's determinants: 160 units of rounding, relative to the longest component of the direction.
///
/// Relative to the largest component e of the edges and c of the way to the first corner: an edge function is a sum of
/// three products of e and a sum of two products of c and the direction; with one unit for each rounding its error is
/// below 45 e c units, that of the determinant N·d below 45 e e, and that of the third edge function, which is the
/// determinant less the other two, below 114 e c + 57 e e. An origin that was rounded adds to c.
pub(crate) const ERROR: f32 = 160.0 / 16_777_216.0;

/// What underflow may add, relative to the direction where that is longer than 1: some products that are less than this.
pub(crate) const UNDERFLOW: f32 = 64.0 * f32::MIN_POSITIVE;

/// Beyond this (2⁴⁰) the filter's products may overflow, and it excludes nothing.
pub(crate) const LARGEST_FILTERED: f32 = 1.099_511_6e12;

/// Four triangles, component by component.
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

/// Where a triangle is met: `t`, and the weights of its second and third corner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Crossing<T = f32> {
    pub(crate) t: T,
    pub(crate) u: T,
    pub(crate) v: T,
}

/// What the filter says of a block.
pub(crate) struct Sifted<S: Simd> {
    /// Those that are not surely missed: they are to be decided.
    pub(crate) kept: Chosen,
    /// Those of which the decision is known: a hit in the ray's range.
    pub(crate) surely_hit: Chosen,
    /// The same as a mask.
    pub(crate) sure: mask32x8<S>,
    distance: Lanes<S>,
    distance_room: Lanes<S>,
    size: Lanes<S>,
    size_room: Lanes<S>,
}

impl<S: Simd> Sifted<S> {
    /// Between which scaled t each of those that are surely hit is surely hit.
    #[inline(always)]
    pub(crate) fn between(&self) -> [Lanes<S>; 2] {
        [
            (self.distance - self.distance_room) / (self.size + self.size_room),
            (self.distance + self.distance_room) / (self.size - self.size_room),
        ]
    }
}

/// Scaled distances of sure hits are above this, 2⁻⁶⁰, and below 2⁶⁰.
pub(crate) const SURE_AFTER: f32 = 8.673_617e-19;

/// What the filter needs of a ray, in every lane.
#[derive(Clone, Copy)]
pub(crate) struct Sieve<S: Simd> {
    pub(crate) origin: [Lanes<S>; 3],
    pub(crate) direction: [Lanes<S>; 3],
    pub(crate) t_min: Lanes<S>,
    sure_before: Lanes<S>,
    error: Lanes<S>,
    underflow: Lanes<S>,
    rounding: Lanes<S>,
}

impl<S: Simd> Sieve<S> {
    #[inline(always)]
    pub(crate) fn new(simd: S, ray: &Prepared) -> Self {
        Self {
            origin: splat_all(simd, ray.shadow.origin),
            direction: splat_all(simd, ray.shadow.direction),
            t_min: Lanes::splat(simd, ray.t_min),
            sure_before: Lanes::splat(simd, ray.shadow.sure_before),
            error: Lanes::splat(simd, ray.shadow.error),
            underflow: Lanes::splat(simd, ray.shadow.underflow),
            rounding: Lanes::splat(simd, ray.shadow.rounding),
        }
    }

    /// A usual ray of the world in each lane; `error` is [`ERROR`] times the longest component of its direction.
    #[inline(always)]
    pub(crate) fn of_rays(
        simd: S,
        origin: [Lanes<S>; 3],
        direction: [Lanes<S>; 3],
        t_min: Lanes<S>,
        error: Lanes<S>,
    ) -> Self {
        let sure_before = Lanes::splat(simd, 1.0 / SURE_AFTER);
        let underflow = Lanes::splat(simd, prepared::USUAL_UNDERFLOW);
        Self { origin, direction, t_min, sure_before, error, underflow, rounding: Lanes::splat(simd, 0.0) }
    }
}

#[inline(always)]
fn splat_all<S: Simd>(simd: S, values: [f32; 3]) -> [Lanes<S>; 3] {
    [Lanes::splat(simd, values[0]), Lanes::splat(simd, values[1]), Lanes::splat(simd, values[2])]
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
    /// Packs one to four triangles: corners, geometry, primitive.
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

    /// How many triangles there are.
    pub(crate) fn count(&self) -> usize {
        self.primitive.iter().filter(|&&primitive| primitive != NONE).count()
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

    /// Which of the triangles the ray may meet between its `t_min` and an end, and which it surely does.
    #[inline(always)]
    pub(crate) fn filter<S: Simd>(&self, simd: S, ray: &Sieve<S>, end: f32) -> Sifted<S> {
        let corners =
            [load(simd, &self.corners[0]), load(simd, &self.corners[1]), load(simd, &self.corners[2])];
        let extent = Lanes::load_array_ref(simd, &self.extent);
        TriangleLanes { corners, extent }.sift(simd, ray, Lanes::splat(simd, end))
    }

    /// The box around the triangles.
    #[inline(always)]
    pub(crate) fn bounds<S: Simd>(&self, simd: S) -> Aabb {
        let [a, b, c] =
            [load(simd, &self.corners[0]), load(simd, &self.corners[1]), load(simd, &self.corners[2])];
        let mut bounds = Aabb::EMPTY;
        for axis in 0..3 {
            let [min, max] = [a[axis].min(b[axis]).min(c[axis]), a[axis].max(b[axis]).max(c[axis])];
            for lane in 0..BLOCK {
                bounds.min[axis] = bounds.min[axis].min(min[lane]);
                bounds.max[axis] = bounds.max[axis].max(max[lane]);
            }
        }
        bounds
    }
}

/// Triangles in lanes: several, or one in all of them.
pub(crate) struct TriangleLanes<S: Simd> {
    /// `corners[corner][axis]`.
    corners: [[Lanes<S>; 3]; 3],
    extent: Lanes<S>,
}

impl<S: Simd> TriangleLanes<S> {
    /// One of a block's triangles in every lane.
    #[inline(always)]
    pub(crate) fn splat(simd: S, block: &TriangleBlock, lane: usize) -> Self {
        let corners = block.corners(lane);
        let corners = [splat_all(simd, corners[0]), splat_all(simd, corners[1]), splat_all(simd, corners[2])];
        Self { corners, extent: Lanes::splat(simd, block.extent(lane)) }
    }

    /// Lane by lane: may the ray meet the triangle between its `t_min` and an end, and does it surely?
    ///
    /// Möller, Trumbore (1997), "Fast, Minimum Storage Ray/Triangle Intersection", without the division.
    #[inline(always)]
    pub(crate) fn sift(&self, simd: S, ray: &Sieve<S>, t_max: Lanes<S>) -> Sifted<S> {
        let ([[ax, ay, az], [bx, by, bz], [gx, gy, gz]], extent) = (self.corners, self.extent);
        let [dx, dy, dz] = ray.direction;

        // The edges, the way to the first corner, and the normal.
        let (ex, ey, ez) = (bx - ax, by - ay, bz - az);
        let (fx, fy, fz) = (gx - ax, gy - ay, gz - az);
        let (cx, cy, cz) = (ax - ray.origin[0], ay - ray.origin[1], az - ray.origin[2]);
        let nx = ey.mul_sub(fz, ez * fy);
        let ny = ez.mul_sub(fx, ex * fz);
        let nz = ex.mul_sub(fy, ey * fx);

        // The determinant, and the edge functions: its parts that belong to the corners.
        let rx = cy.mul_sub(dz, cz * dy);
        let ry = cz.mul_sub(dx, cx * dz);
        let rz = cx.mul_sub(dy, cy * dx);
        let determinant = nx.mul_add(dx, ny.mul_add(dy, nz * dz));
        let u = fx.mul_add(rx, fy.mul_add(ry, fz * rz));
        let v = -ex.mul_add(rx, ey.mul_add(ry, ez * rz));
        let w = determinant - (u + v);

        // Bound their errors: of what holds the direction once, relative to its length.
        let underflow = ray.underflow;
        let relative = extent.mul_add(ray.error, underflow);
        let reach = cx.abs().max(cy.abs()).max(cz.abs()) + ray.rounding;
        let bound = (reach + extent).mul_add(relative, underflow);
        let size_error = extent.mul_add(relative, underflow);

        let distance = nx.mul_add(cx, ny.mul_add(cy, nz * cz));
        let distance_error = extent.mul_add(extent.mul_add(ERROR, underflow), underflow) * reach;
        let unused = extent.simd_lt(0.0);
        let found = Found { edges: [u, v, w], bound, determinant, size_error, distance, distance_error };
        found.sift(simd, ray, t_max, unused)
    }
}

/// What the filter compares: numbers and bounds of their errors.
struct Found<S: Simd> {
    /// The edge functions.
    edges: [Lanes<S>; 3],
    bound: Lanes<S>,
    /// Their sum.
    determinant: Lanes<S>,
    size_error: Lanes<S>,
    /// t times the determinant.
    distance: Lanes<S>,
    distance_error: Lanes<S>,
}

impl<S: Simd> Found<S> {
    #[inline(always)]
    fn sift(&self, simd: S, ray: &Sieve<S>, t_max: Lanes<S>, unused: mask32x8<S>) -> Sifted<S> {
        let &Self { edges: [u, v, w], bound, determinant, size_error, distance, distance_error } = self;
        // A miss has two edge functions of surely different signs. Comparisons with NaN are false, and exclude nothing.
        let least = u.min(v).min(w);
        let most = u.max(v).max(w);
        let outside = least.simd_lt(-bound) & most.simd_gt(bound);

        // Or its t is surely out of range, where the determinant's sign is sure.
        let size = determinant.abs();
        let distance = distance * Lanes::splat(simd, 1.0).copysign(determinant);
        let beyond = distance.simd_gt(t_max.mul_add(size, size_error.mul_add(t_max.abs(), distance_error)));
        let before = distance.simd_lt(ray.t_min.mul_sub(size, size_error.mul_add(ray.t_min, distance_error)));
        let out_of_range = size.simd_gt(size_error) & (beyond | before);
        let excluded = outside | out_of_range | unused;

        // A hit is sure where all that is the other way round, with twice the room for what is compared.
        let inside = least.simd_gt(bound) | most.simd_lt(-bound);
        let (size_room, distance_room) = (size_error + size_error, distance_error + distance_error);
        let first = ray.t_min.max(SURE_AFTER);
        let last = t_max.min(ray.sure_before);
        let in_range = distance.simd_gt(first.mul_add(size, size_room.mul_add(first, distance_room)))
            & distance.simd_lt(last.mul_sub(size, size_room.mul_add(last, distance_room)));
        let sure = inside & in_range & size.simd_gt(size_room) & !unused;
        let lanes = (1 << BLOCK) - 1;
        Sifted {
            kept: Chosen(!excluded.to_bitmask() as u32 & lanes),
            surely_hit: Chosen(sure.to_bitmask() as u32 & lanes),
            sure,
            distance,
            distance_room,
            size,
            size_room,
        }
    }
}

/// A block's triangles as they are seen from a point: what is the same for all rays that start there.
pub(crate) struct SeenBlock {
    /// `normal[axis][lane]`, and likewise what the direction is multiplied by for the edge functions.
    normal: [[f32; BLOCK]; 3],
    u: [[f32; BLOCK]; 3],
    v: [[f32; BLOCK]; 3],
    distance: [f32; BLOCK],
    /// Errors, without the direction's.
    bound: [f32; BLOCK],
    size_error: [f32; BLOCK],
    distance_error: [f32; BLOCK],
}

impl SeenBlock {
    #[inline(always)]
    pub(crate) fn new<S: Simd>(simd: S, block: &TriangleBlock, origin: [f32; 3]) -> Self {
        let [a, b, c] = [0, 1, 2].map(
            #[inline(always)]
            |corner| load(simd, &block.corners[corner]),
        );
        let extent = Lanes::load_array_ref(simd, &block.extent).abs();
        let minus = |p: [Lanes<S>; 3], q: [Lanes<S>; 3]| [p[0] - q[0], p[1] - q[1], p[2] - q[2]];
        let cross = |p: [Lanes<S>; 3], q: [Lanes<S>; 3]| {
            [
                p[1].mul_sub(q[2], p[2] * q[1]),
                p[2].mul_sub(q[0], p[0] * q[2]),
                p[0].mul_sub(q[1], p[1] * q[0]),
            ]
        };
        let (e, f) = (minus(b, a), minus(c, a));
        let way = [a[0] - origin[0], a[1] - origin[1], a[2] - origin[2]];
        let normal = cross(e, f);
        let reach = way[0].abs().max(way[1].abs()).max(way[2].abs());
        let relative = extent.mul_add(ERROR, Lanes::splat(simd, prepared::USUAL_UNDERFLOW));
        let [u, v] = [cross(f, way), cross(way, e)];
        let arrays = |x: [Lanes<S>; 3]| [x[0].into(), x[1].into(), x[2].into()];
        Self {
            normal: arrays(normal),
            u: arrays(u),
            v: arrays(v),
            distance: normal[0].mul_add(way[0], normal[1].mul_add(way[1], normal[2] * way[2])).into(),
            bound: ((reach + extent) * relative).into(),
            size_error: (extent * relative).into(),
            distance_error: (extent.mul_add(relative, prepared::USUAL_UNDERFLOW) * reach).into(),
        }
    }

    /// [`TriangleLanes::sift`] for one of the triangles and rays from that point; `length` is the longest component of each ray's
    /// direction. d·(f × c) takes the place of f·(c × d): the same products, so the same errors.
    #[inline(always)]
    pub(crate) fn sift<S: Simd>(
        &self,
        simd: S,
        lane: usize,
        ray: &Sieve<S>,
        length: Lanes<S>,
        t_max: Lanes<S>,
    ) -> Sifted<S> {
        let lane = lane & (BLOCK - 1);
        let [dx, dy, dz] = ray.direction;
        let along = |n: &[[f32; BLOCK]; 3]| dx.mul_add(n[0][lane], dy.mul_add(n[1][lane], dz * n[2][lane]));
        let (determinant, u, v) = (along(&self.normal), along(&self.u), along(&self.v));
        let w = determinant - (u + v);
        let found = Found {
            edges: [u, v, w],
            bound: length.mul_add(self.bound[lane], ray.underflow),
            determinant,
            size_error: length.mul_add(self.size_error[lane], ray.underflow),
            distance: Lanes::splat(simd, self.distance[lane]),
            distance_error: Lanes::splat(simd, self.distance_error[lane]),
        };
        found.sift(simd, ray, t_max, mask32x8::splat(simd, false))
    }
}

/// Decides whether and where a ray meets a triangle, with `t_min < t`. The caller compares t with the ray's end.
///
/// No component of the edges at the first corner is larger than `extent` (but for rounding to f32).
#[inline(always)]
pub(crate) fn decide<T: Rounded>(
    ray: &Exact<T>,
    corners: &[[f32; 3]; 3],
    extent: f32,
) -> Option<Crossing<T>> {
    let sheared = Sheared::new(ray, corners);
    if !sheared.is_met() {
        return None;
    }
    let meeting = meet(ray, corners);
    let extent = f64::from(extent);
    let product = extent * widest(ray.direction);
    let determinant = meeting.determinant.abs();
    let crossing =
        if determinant > CLEAR * product * (extent + widest(subtract(wide(corners[0]), ray.origin))) {
            meeting.round()
        } else if determinant > GRAZING * 6.5 * product * extent {
            // No product of the determinant is larger: t is right, the weights may have lost their digits.
            let [u, v] = sheared.weights();
            Crossing { t: T::rounded(meeting.t), u, v }
        } else {
            sheared.grazing(ray, corners)
        };
    (crossing.t > ray.t_min).then_some(crossing)
}

/// The largest magnitude.
fn widest([x, y, z]: [f64; 3]) -> f64 {
    x.abs().max(y.abs()).max(z.abs())
}

/// Where a ray meets the plane of a triangle, for one that the filter is sure of: all else that [`decide`] looks at is known. Its
/// determinant is clear: it is the sum of three edge functions that are beyond their error, which is [`ERROR`] relative to what
/// [`CLEAR`] is relative to.
#[inline(always)]
pub(crate) fn cross_surely(ray: &Exact, corners: &[[f32; 3]; 3]) -> Crossing {
    meet(ray, corners).round()
}

/// Whether the ray looks at the front of a triangle that it meets: the face from which its corners are seen
/// counter-clockwise. Signs are those of the decision, so a closed mesh is left through as many backs as it is entered
/// through fronts.
pub(crate) fn is_front(ray: &Exact, corners: &[[f32; 3]; 3]) -> bool {
    let Sheared { edges: [u, v, w], along, .. } = Sheared::new(ray, corners);
    (u + v + w > 0.0) == (along > 0.0)
}

/// A meeting before it is rounded.
struct Meeting {
    determinant: f64,
    t: f64,
    u: f64,
    v: f64,
}

impl Meeting {
    /// Weights that are less than 0 are so by their rounding alone.
    #[inline(always)]
    fn round<T: Rounded>(&self) -> Crossing<T> {
        let weight = |x: f64| T::rounded(if x > 0.0 { x } else { 0.0 });
        Crossing { t: T::rounded(self.t), u: weight(self.u), v: weight(self.v) }
    }
}

/// Where a ray meets the plane of a triangle: Cramer's rule, as Möller and Trumbore (1997) arrange it.
#[inline(always)]
fn meet<T: Rounded>(ray: &Exact<T>, corners: &[[f32; 3]; 3]) -> Meeting {
    let (p0, p1, p2) = (wide(corners[0]), wide(corners[1]), wide(corners[2]));
    let [e1, e2] = [subtract(p1, p0), subtract(p2, p0)];
    let c = subtract(p0, ray.origin);
    let n = cross(e1, e2);
    let r = cross(c, ray.direction);
    let determinant = dot(n, ray.direction);
    let inverse = 1.0 / determinant;
    Meeting { determinant, t: dot(n, c) * inverse, u: dot(e2, r) * inverse, v: -dot(e1, r) * inverse }
}

/// A triangle moved to the ray's origin and sheared so that the ray runs along the third axis, and its edge functions.
struct Sheared {
    corners: [[f64; 3]; 3],
    edges: [f64; 3],
    /// The direction's component along that axis.
    along: f64,
}

impl Sheared {
    #[inline(always)]
    fn new<T: Rounded>(ray: &Exact<T>, corners: &[[f32; 3]; 3]) -> Self {
        let [kx, ky, kz] = ray.axes();
        let d = ray.direction;
        // Multiplying by the direction's length, in place of dividing by it, keeps whole numbers whole: edges and
        // corners are met exactly.
        let shear = |corner: usize| {
            let p = subtract(wide(corners[corner]), ray.origin);
            [d[kz] * p[kx] - d[kx] * p[kz], d[kz] * p[ky] - d[ky] * p[kz], p[kz]]
        };
        let [a, b, c] = [shear(0), shear(1), shear(2)];
        let edges = [edge_function(c, b), edge_function(a, c), edge_function(b, a)];
        Self { corners: [a, b, c], edges, along: d[kz] }
    }

    /// Whether the ray meets the triangle or its edges. One that is seen edge on is not met.
    #[inline(always)]
    fn is_met(&self) -> bool {
        let [u, v, w] = self.edges;
        // Without short cuts: which of the signs it is cannot be predicted.
        let outside = ((u < 0.0) | (v < 0.0) | (w < 0.0)) & ((u > 0.0) | (v > 0.0) | (w > 0.0));
        !outside & (u + v + w != 0.0)
    }

    /// The crossing where the ray runs nearly along the triangle's plane. NaN where it is before the ray.
    #[cold]
    #[inline(never)]
    fn grazing<T: Rounded>(&self, ray: &Exact<T>, corners: &[[f32; 3]; 3]) -> Crossing<T> {
        let (p0, p1, p2) = (wide(corners[0]), wide(corners[1]), wide(corners[2]));
        let [e1, e2] = [subtract(p1, p0), subtract(p2, p0)];
        let (n, d) = (cross(e1, e2), ray.direction);
        let determinant = dot(n, d);
        let magnitude = dot(cross_magnitude(e1, e2), d.map(f64::abs));
        let ([u, v, w], [a, b, c]) = (self.edges, self.corners);
        let sum = u + v + w;
        let mut t = if determinant.abs() > DETERMINANT_ERROR * magnitude {
            dot(n, subtract(p0, ray.origin)) / determinant
        } else {
            // The ray runs along the plane, as far as f64 can tell: t is somewhere between the corners.
            (u * a[2] + v * b[2] + w * c[2]) / (sum * self.along)
        };
        if !(T::rounded(t) > ray.t_min) {
            t = f64::NAN;
        } else if determinant.abs() < GRAZING * magnitude {
            // Keep it inside the triangle's box, where every tree looks for it.
            t = clamp_to_box(ray, corners, t);
        }
        let [u, v] = self.weights();
        Crossing { t: T::rounded(t), u, v }
    }

    /// The weights of the second and third corner: never outside of the triangle, however far away that is.
    fn weights<T: Rounded>(&self) -> [T; 2] {
        let [u, v, w] = self.edges;
        let sum = u + v + w;
        [T::rounded(v / sum), T::rounded(w / sum)]
    }
}

/// Relative error of the determinant n·d, with much room: 2⁻⁴⁸ (rounding: about 6 · 2⁻⁵³).
const DETERMINANT_ERROR: f64 = 3.552_713_678_800_501e-15;

/// Below this relative determinant, 2⁻³⁰, the errors of t and of the edge functions may differ by more than 2⁻²² of the
/// triangle's size, which comes near the room of the box test.
const GRAZING: f64 = 9.313_225_746_154_785e-10;

/// From this relative determinant on, 2⁻¹⁷, the weights of Cramer's rule have f32's digits.
const CLEAR: f64 = 7.629_394_531_25e-6;

/// `p.x q.y − p.y q.x` with the right sign.
#[inline(always)]
fn edge_function(p: [f64; 3], q: [f64; 3]) -> f64 {
    let [first, second] = [p[0] * q[1], p[1] * q[0]];
    if first == second {
        // What was rounded away decides.
        return product_error(p[0], q[1], first) - product_error(p[1], q[0], second);
    }
    first - second
}

/// `a · b − product` exactly, where `product` is a · b rounded: Dekker (1971), Veltkamp's splitting.
#[cold]
fn product_error(a: f64, b: f64, product: f64) -> f64 {
    let split = |x: f64| {
        let scaled = x * 134_217_729.0; // 2²⁷ + 1
        let high = scaled - (scaled - x);
        (high, x - high)
    };
    let ((ah, al), (bh, bl)) = (split(a), split(b));
    ((ah * bh - product) + ah * bl + al * bh) + al * bl
}

/// Moves t into the interval in which the ray is inside the triangle's box.
fn clamp_to_box<T: Rounded>(ray: &Exact<T>, corners: &[[f32; 3]; 3], t: f64) -> f64 {
    let (mut near, mut far) = (f64::NEG_INFINITY, f64::INFINITY);
    for axis in 0..3 {
        if ray.direction[axis] != 0.0 {
            let at = |p: &[f32; 3]| (f64::from(p[axis]) - ray.origin[axis]) / ray.direction[axis];
            let [a, b, c] = [at(&corners[0]), at(&corners[1]), at(&corners[2])];
            near = near.max(a.min(b).min(c));
            far = far.min(a.max(b).max(c));
        }
    }
    t.min(far).max(near)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ray::Ray;
    use crate::simd::{Work, at_level, levels};

    struct Filter<'a>(&'a TriangleBlock, &'a Prepared);

    impl Work for Filter<'_> {
        type Output = (Chosen, Chosen, [f32; 2]);
        #[inline(always)]
        fn run<S: Simd>(self, simd: S) -> (Chosen, Chosen, [f32; 2]) {
            let sifted = self.0.filter(simd, &Sieve::new(simd, self.1), f32::INFINITY);
            let [first, last] = sifted.between();
            (sifted.kept, sifted.surely_hit, [first[0], last[0]])
        }
    }

    #[test]
    fn the_error_of_a_product_is_exact() {
        let (a, b) = (1.0 + 2.0_f64.powi(-40), 1.0 - 2.0_f64.powi(-40));
        assert_eq!(a * b, 1.0);
        assert_eq!(product_error(a, b, a * b), -(2.0_f64.powi(-80)));
    }

    #[test]
    fn a_wide_plane_one_ulp_beneath_the_origin() {
        // The plane runs through height 0.1; the ray starts there, one unit above and one below, and runs off slanting.
        let height = 0.1_f32;
        let corners = [[-1e6, -1e6, height], [1e6, -1e6, height], [3.0, 1e6, height]];
        for direction in [[0.3, -0.2, 1.0], [0.3, -0.2, 1e-6], [1e3, 0.0, 1e-3]] {
            for (z, above) in [(height, true), (height.next_up(), true), (height.next_down(), false)] {
                let ray = Exact::new(&Ray::new([0.1, -0.3, z], direction));
                assert_eq!(decide(&ray, &corners, 4e6).is_none(), above, "{direction:?} from {z}");
            }
        }
    }

    #[test]
    fn the_filter_keeps_what_is_decided_to_be_hit() {
        let mut random = crate::testing::Random::new(7);
        let levels = levels();
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
            let exact = Exact::new(&ray);
            let Some(shadow) = Prepared::new(fearless_simd::Fallback::new(), &exact, 0.0) else { continue };
            let block = TriangleBlock::new(&[(corners, 0, 0)]);
            let (chosen, surely_hit, [first, last]) =
                at_level(levels[all % levels.len()], Filter(&block, &shadow));
            let keep = chosen.count();
            all += 1;
            kept += keep;
            let hit = decide(&exact, &corners, block.extent(0));
            if hit.is_some() {
                hits += 1;
                assert_eq!(keep, 1, "{corners:?} {ray:?}");
            }
            if surely_hit != Chosen(0) {
                sure += 1;
                let t = f64::from(hit.unwrap().t) * f64::from(shadow.shadow.scale);
                assert!(f64::from(first) < t && t < f64::from(last), "{corners:?} {ray:?}");
            }
        }
        assert!(
            10_000 < sure && sure < hits && hits < kept && kept < all,
            "{sure} sure, {hits} hits, {kept} kept of {all}"
        );
    }
}
