//! The same questions for rays in double precision.
//!
//! For those whose rays are not numbers of f32: CAD far from the origin, measurements, other people's trees to compare with.
//! Plain scalar code over the same nodes, and the same decision, whose f64 is not rounded here. So for rays that are numbers
//! of f32 the answers are [`Bvh::closest_hit`]'s, but finer: hits that are equal in f32 are told apart.

use crate::Bvh;
use crate::aabb::Aabb;
use crate::bvh::Leaf;
use crate::exact::Exact;
use crate::node::{Child, Content, Node, WIDTH};
use crate::ray::{NONE, Ray};
use crate::vector::{round_down, round_up};
use crate::{sphere, triangle};

/// Room for rounding in distances along a ray, relative, 2⁻²⁰: that of the rays in f32, since the decision may use it all.
const ROOM: f64 = 9.536_743_164_062_5e-7;

/// A ray in double precision: the points `p(t) = origin + t · direction` with `t_min < t < t_max`.
///
/// The direction may have any length but zero; `t` counts in its lengths. A ray with a NaN, an empty range, or an
/// origin or direction that f32 would round to infinity (or to a zero direction) hits nothing.
///
/// ```
/// use lookfrom_bvh::RayF64;
/// let ray = RayF64 { t_max: 10.0, ..RayF64::new([0.1, 0.2, 0.3], [0.0, 0.0, 1.0]) };
/// assert_eq!((ray.t_min, ray.t_max), (0.0, 10.0));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RayF64 {
    /// Where `t` is zero.
    pub origin: [f64; 3],
    /// Hits need `t > t_min`. May be negative.
    pub t_min: f64,
    /// Any length but zero.
    pub direction: [f64; 3],
    /// Hits need `t < t_max`. May be infinite.
    pub t_max: f64,
}

impl RayF64 {
    /// The ray with `t` in (0, ∞).
    ///
    /// ```
    /// assert_eq!(lookfrom_bvh::RayF64::new([0.0; 3], [1.0, 0.0, 0.0]).t_max, f64::INFINITY);
    /// ```
    pub const fn new(origin: [f64; 3], direction: [f64; 3]) -> Self {
        Self { origin, t_min: 0.0, direction, t_max: f64::INFINITY }
    }
}

impl From<Ray> for RayF64 {
    fn from(ray: Ray) -> Self {
        let Ray { origin, t_min, direction, t_max } = ray;
        Self {
            origin: origin.map(f64::from),
            t_min: t_min.into(),
            direction: direction.map(f64::from),
            t_max: t_max.into(),
        }
    }
}

/// Where a [`RayF64`] meets a primitive, or [`HitF64::MISS`].
///
/// ```
/// assert!(!lookfrom_bvh::HitF64::MISS.is_hit());
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HitF64 {
    /// The ray's parameter: the hit is at `origin + t · direction`. Infinite for a miss.
    pub t: f64,
    /// Of a triangle: β, the weight of its second corner. Of a sphere: 0. Of a procedural: what it says, in f32.
    pub u: f64,
    /// Of a triangle: γ, the weight of its third corner. Of a sphere: 0. Of a procedural: what it says, in f32.
    pub v: f64,
    /// Number of the primitive in its geometry.
    pub primitive: u32,
    /// Number of the geometry in its tree, in the order in which the builder was told.
    pub geometry: u32,
    /// Number of the instance, [`NONE`] where the geometry is not in an instance.
    pub instance: u32,
}

impl HitF64 {
    /// Nothing was hit.
    ///
    /// ```
    /// assert_eq!(lookfrom_bvh::HitF64::MISS.t, f64::INFINITY);
    /// ```
    pub const MISS: Self =
        Self { t: f64::INFINITY, u: 0.0, v: 0.0, primitive: NONE, geometry: NONE, instance: NONE };

    /// Whether something was hit.
    ///
    /// ```
    /// use lookfrom_bvh::HitF64;
    /// assert!(HitF64 { primitive: 0, ..HitF64::MISS }.is_hit());
    /// ```
    pub const fn is_hit(&self) -> bool {
        self.primitive != NONE
    }

    /// The order of hits at equal `t`, as that of [`Hit`](crate::Hit)s.
    fn rank(&self) -> (u32, u32, u32) {
        (self.instance.wrapping_add(1), self.geometry, self.primitive)
    }

    fn precedes(&self, other: &Self) -> bool {
        self.t < other.t || (self.t == other.t && self.rank() < other.rank())
    }
}

impl Bvh {
    /// The hit with the least t in the ray's range; ties are decided as by [`Self::closest_hit`]. [`HitF64::MISS`] where
    /// there is none.
    ///
    /// `t` is right to about 10⁻¹⁵ of sizes and distances, `u` and `v` to about 10⁻¹⁰ (less where a triangle is seen nearly
    /// edge on); procedural shapes are asked in f32. Some times slower than `closest_hit`.
    ///
    /// ```
    /// use lookfrom_bvh::{Builder, RayF64, Triangles};
    /// let mut builder = Builder::new();
    /// let positions = [[0.0, 0.0, 1.0], [1.0, 0.0, 1.0], [0.0, 1.0, 1.0]];
    /// builder.triangles(Triangles { positions: &positions, indices: &[[0, 1, 2]] });
    /// let bvh = builder.build()?;
    /// let hit = bvh.closest_hit_f64(&RayF64::new([0.1, 0.2, 1.0 - 1e-12], [0.0, 0.0, 1e-12]));
    /// assert!((hit.t - 1.0).abs() < 1e-4 && (hit.u - 0.1).abs() < 1e-15 && (hit.v - 0.2).abs() < 1e-15);
    /// # Ok::<(), lookfrom_bvh::BuildError>(())
    /// ```
    pub fn closest_hit_f64(&self, ray: &RayF64) -> HitF64 {
        let mut closest = HitF64::MISS;
        self.walk_all(ray, |hit| {
            if hit.precedes(&closest) {
                closest = hit;
            }
            closest.t
        });
        closest
    }

    /// Whether anything is hit in the ray's range.
    ///
    /// ```
    /// use lookfrom_bvh::{Builder, RayF64, Sphere};
    /// let mut builder = Builder::new();
    /// builder.spheres(&[Sphere { center: [0.0; 3], radius: 1.0 }]);
    /// let bvh = builder.build()?;
    /// let ray = RayF64::new([0.0, 0.0, 3.0], [0.0, 0.0, -1.0]);
    /// assert!(bvh.occluded_f64(&RayF64 { t_max: 2.0 + 1e-15, ..ray }));
    /// assert!(!bvh.occluded_f64(&RayF64 { t_max: 2.0, ..ray }));
    /// # Ok::<(), lookfrom_bvh::BuildError>(())
    /// ```
    pub fn occluded_f64(&self, ray: &RayF64) -> bool {
        let mut found = false;
        self.walk_all(ray, |_| {
            found = true;
            f64::NEG_INFINITY
        });
        found
    }

    /// Replaces the content of `hits` by all hits in the ray's range, sorted by t and then as ties are decided. A triangle gives
    /// at most one hit, a sphere two, a procedural shape one (its nearest).
    ///
    /// ```
    /// use lookfrom_bvh::{Builder, RayF64, Sphere};
    /// let mut builder = Builder::new();
    /// builder.spheres(&[Sphere { center: [0.0; 3], radius: 1.0 }]);
    /// let mut hits = Vec::new();
    /// builder.build()?.all_hits_f64(&RayF64::new([0.0, 0.0, 3.0], [0.0, 0.0, -1.0]), &mut hits);
    /// assert_eq!(hits.iter().map(|hit| hit.t).collect::<Vec<_>>(), [2.0, 4.0]);
    /// # Ok::<(), lookfrom_bvh::BuildError>(())
    /// ```
    pub fn all_hits_f64(&self, ray: &RayF64, hits: &mut Vec<HitF64>) {
        hits.clear();
        self.walk_all(ray, |hit| {
            hits.push(hit);
            f64::INFINITY
        });
        // A zero is a zero, whatever its sign.
        hits.sort_unstable_by(|a, b| {
            (a.t + 0.0).total_cmp(&(b.t + 0.0)).then_with(|| a.rank().cmp(&b.rank()))
        });
    }

    /// Tells of hits in the ray's range until none are left up to the t that `tell` returned last.
    fn walk_all(&self, ray: &RayF64, mut tell: impl FnMut(HitF64) -> f64) {
        let exact = Exact { origin: ray.origin, direction: ray.direction, t_min: ray.t_min };
        if ray.t_min < ray.t_max && !self.nodes.is_empty() && is_usable(&exact) {
            let mut walk = Walk { outer: self, ray, end: ray.t_max, tell: &mut tell };
            walk.node(self, &exact, NONE, 0);
        }
    }
}

/// A ray on its way.
struct Walk<'a> {
    outer: &'a Bvh,
    /// In the world.
    ray: &'a RayF64,
    /// Hits beyond this are not wanted.
    end: f64,
    tell: &'a mut dyn FnMut(HitF64) -> f64,
}

impl Walk<'_> {
    /// Visits a node of a tree, in whose space the ray is, and all below it.
    fn node(&mut self, bvh: &Bvh, ray: &Exact<f64>, instance: u32, number: usize) {
        let (mut entered, count) = enter(&bvh.nodes[number], ray, self.ray.t_min);
        let entered = &mut entered[..count];
        entered.sort_by(|a, b| a.0.total_cmp(&b.0));
        for &(near, child) in entered.iter() {
            if near - near.abs() * ROOM > self.end {
                continue;
            }
            match child.content() {
                Content::Node(below) => self.node(bvh, ray, instance, below),
                Content::Triangles(block) => self.triangles(bvh, ray, instance, block),
                Content::Leaf(leaf) => self.leaf(bvh, ray, instance, bvh.leaves[leaf]),
            }
        }
    }

    /// Tells of a hit that is in range.
    fn hear(&mut self, [t, u, v]: [f64; 3], (geometry, primitive): (u32, u32), instance: u32) {
        if t > self.ray.t_min && t < self.ray.t_max {
            self.end = (self.tell)(HitF64 { t, u, v, primitive, geometry, instance });
        }
    }

    fn triangles(&mut self, bvh: &Bvh, ray: &Exact<f64>, instance: u32, block: usize) {
        let block = &bvh.triangles[block];
        for lane in 0..block.count() {
            if let Some(met) = triangle::decide(ray, &block.corners(lane), block.extent(lane)) {
                self.hear([met.t, met.u, met.v], block.ids(lane), instance);
            }
        }
    }

    fn leaf(&mut self, bvh: &Bvh, ray: &Exact<f64>, instance: u32, leaf: Leaf) {
        let range = |first: u32, count: u32| first as usize..(first + count) as usize;
        match leaf {
            Leaf::Spheres { first, count } => {
                for item in &bvh.spheres[range(first, count)] {
                    let Some([t1, t2]) = sphere::decide(ray, &item.shape) else { continue };
                    self.hear([t1, 0.0, 0.0], (item.geometry, item.primitive), instance);
                    if t1 < t2 {
                        self.hear([t2, 0.0, 0.0], (item.geometry, item.primitive), instance);
                    }
                }
            }
            Leaf::Procedurals { first, count } => {
                for item in &bvh.procedurals[range(first, count)] {
                    let [origin, direction] = [ray.origin, ray.direction].map(|x| x.map(|x| x as f32));
                    // Ask one step beyond the end: a hit at the same t may win the tie.
                    let (t_min, t_max) =
                        (round_down(self.ray.t_min), round_up(self.end.min(self.ray.t_max)).next_up());
                    let asked = Ray { origin, t_min, direction, t_max };
                    let shapes = &bvh.procedural_shapes[item.shape as usize];
                    if let Some(found) = shapes.intersect(item.primitive, &asked) {
                        let met = [found.t, found.u, found.v].map(f64::from);
                        self.hear(met, (item.geometry, item.primitive), instance);
                    }
                }
            }
            Leaf::Instances { first, count } => {
                let outer = self.outer;
                for inside in &outer.instances[range(first, count)] {
                    let inner = ray.in_object(&inside.world_from_object, &inside.object_from_world);
                    if is_usable(&inner) {
                        self.node(&inside.bvh, &inner, inside.id, 0);
                    }
                }
            }
        }
    }
}

/// Whether a ray can hit anything: its origin and direction, rounded to f32, are finite, and its direction is not zero.
fn is_usable(ray: &Exact<f64>) -> bool {
    let finite = ray.origin.iter().chain(&ray.direction).all(|&x| (x as f32).is_finite());
    finite && ray.direction.iter().any(|&x| x as f32 != 0.0)
}

/// The children of a node that a line meets after `t_min`, and where it enters them.
fn enter(node: &Node, ray: &Exact<f64>, t_min: f64) -> ([(f64, Child); WIDTH], usize) {
    let mut entered = [(0.0, Child::ROOT); WIDTH];
    let mut count = 0;
    for slot in 0..WIDTH {
        let bounds = node.child_bounds(slot);
        let [near, far] = slabs(&bounds, ray);
        if !bounds.is_empty()
            && near - near.abs() * ROOM <= far + far.abs() * ROOM
            && far + far.abs() * ROOM >= t_min
        {
            entered[count] = (near, node.child(slot));
            count += 1;
        }
    }
    (entered, count)
}

/// Between which t a line is in a box; the first is beyond the second where it never is.
fn slabs(bounds: &Aabb, ray: &Exact<f64>) -> [f64; 2] {
    let (mut near, mut far) = (f64::NEG_INFINITY, f64::INFINITY);
    for axis in 0..3 {
        let [low, high] = [bounds.min[axis], bounds.max[axis]].map(|x| f64::from(x) - ray.origin[axis]);
        if ray.direction[axis] == 0.0 {
            if low > 0.0 || high < 0.0 {
                return [f64::INFINITY, f64::NEG_INFINITY];
            }
            continue;
        }
        let [a, b] = [low / ray.direction[axis], high / ray.direction[axis]];
        near = near.max(a.min(b));
        far = far.min(a.max(b));
    }
    [near, far]
}
