//! Traversal of rays in double precision.
//!
//! Plain scalar code over the same nodes, with the same exact tests, whose f64 results are not rounded here. So for
//! rays whose numbers are f32 the results agree with single precision, but are finer: hits at equal t in f32 are
//! distinguished.

use crate::aabb::Aabb;
use crate::batch::for_each;
use crate::bvh::{Bvh, Part};
use crate::conservative::TriangleBlock;
use crate::exact::ExactRay;
use crate::item::{Leaf, ProceduralItem};
use crate::node::{Child, Content, Node, WIDTH};
use crate::observer::Observer;
use crate::ray::{NONE, Ray};
use crate::ray_f64::{HitF64, RayF64};
use crate::settings::Settings;
use crate::vector::{round_down, round_up};
use crate::visibility::{Masked, Visibility};
use crate::{sphere, triangle};

/// Relative margin for rounding in distances along a ray, 2⁻²⁰: the same as for rays in f32, since the exact tests
/// may use all of it.
const ROOM: f64 = 9.536_743_164_062_5e-7;

/// The closest hit.
pub(crate) fn closest_hit(
    settings: &Settings<'_>,
    ray: &RayF64,
    observer: Option<&mut dyn Observer>,
) -> HitF64 {
    let mut closest = HitF64::MISS;
    traverse(settings, ray, observer, |hit| {
        if hit.precedes(&closest) {
            closest = hit;
        }
        closest.t
    });
    closest
}

/// True if there is a hit.
pub(crate) fn occluded(settings: &Settings<'_>, ray: &RayF64, observer: Option<&mut dyn Observer>) -> bool {
    let mut found = false;
    traverse(settings, ray, observer, |_| {
        found = true;
        f64::NEG_INFINITY
    });
    found
}

/// Adds all hits to `hits`, which must be empty, and sorts them by t, at equal t by rank.
pub(crate) fn all_hits(
    settings: &Settings<'_>,
    ray: &RayF64,
    hits: &mut Vec<HitF64>,
    observer: Option<&mut dyn Observer>,
) {
    traverse(settings, ray, observer, |hit| {
        hits.push(hit);
        f64::INFINITY
    });
    // A zero is a zero, whatever its sign.
    hits.sort_unstable_by(|a, b| (a.t + 0.0).total_cmp(&(b.t + 0.0)).then_with(|| a.rank().cmp(&b.rank())));
}

/// The closest hit of each ray.
pub(crate) fn closest_hits(settings: &Settings<'_>, rays: &[RayF64], hits: &mut [HitF64]) {
    for_each(rays, hits, |number, ray, hit| *hit = closest_hit(&settings.from(number), ray, None));
}

/// True for each ray that has a hit.
pub(crate) fn occluded_many(settings: &Settings<'_>, rays: &[RayF64], occluded: &mut [bool]) {
    for_each(rays, occluded, |number, ray, occluded| {
        *occluded = self::occluded(&settings.from(number), ray, None);
    });
}

/// Commits all hits in the ray's range up to the t that `commit` returned last.
fn traverse(
    settings: &Settings<'_>,
    ray: &RayF64,
    observer: Option<&mut dyn Observer>,
    mut commit: impl FnMut(HitF64) -> f64,
) {
    let bvh = settings.bvh;
    let exact = ExactRay { origin: ray.origin, direction: ray.direction, t_min: ray.t_min };
    if ray.t_min < ray.t_max && is_usable(&exact) {
        let visibility = Masked::of(settings, 0);
        let (time, commit) = (settings.time_of(0), &mut commit);
        let mut traversal = Traversal { outer: bvh, ray, time, end: ray.t_max, visibility, observer, commit };
        traversal.tree(bvh, &exact, NONE);
    }
}

/// A ray during traversal.
struct Traversal<'a, 'o> {
    outer: &'a Bvh,
    /// The ray in world space.
    ray: &'a RayF64,
    time: f32,
    /// Hits beyond this are ignored.
    end: f64,
    visibility: Masked<'a>,
    observer: Option<&'o mut dyn Observer>,
    commit: &'a mut dyn FnMut(HitF64) -> f64,
}

impl Traversal<'_, '_> {
    /// Traces a ray through a tree and its moving part, with the ray in the tree's space.
    fn tree(&mut self, bvh: &Bvh, ray: &ExactRay<f64>, instance: u32) {
        if !bvh.nodes.is_empty() {
            self.node(Part::Standing(bvh), ray, instance, 0);
        }
        if let Some(moving) = bvh.moving.as_ref().filter(|moving| !moving.is_empty()) {
            self.node(Part::Moving(moving, moving.moment(self.time)), ray, instance, 0);
        }
    }

    /// Visits a node and all nodes below it.
    fn node(&mut self, part: Part<'_>, ray: &ExactRay<f64>, instance: u32, number: usize) {
        let node = part.node(number);
        let (mut entered, count) = enter(&node, ray, self.ray.t_min);
        let entered = &mut entered[..count];
        entered.sort_by(|a, b| a.0.total_cmp(&b.0));
        let is_beyond = |near: f64, end: f64| near - near.abs() * ROOM > end;
        if let Some(observer) = &mut self.observer {
            let reached = entered.iter().filter(|(near, _)| !is_beyond(*near, self.end)).count();
            observer.node(instance, number as u32);
            observer.boxes(instance, node.count() as u32, reached as u32);
        }
        for &(near, child) in entered.iter() {
            if is_beyond(near, self.end) {
                continue;
            }
            match child.content() {
                Content::Node(below) => self.node(part, ray, instance, below),
                Content::Triangles(block) => self.triangles(&part.block(block), ray, instance),
                Content::Leaf(leaf) => self.leaf(part, ray, instance, leaf),
            }
        }
    }

    /// Commits a hit if it is in range.
    fn report(&mut self, [t, u, v]: [f64; 3], (geometry, primitive): (u32, u32), instance: u32) {
        if t > self.ray.t_min && t < self.ray.t_max {
            self.end = (self.commit)(HitF64 { t, u, v, primitive, geometry, instance });
        }
    }

    /// True if a primitive must be tested. The observer is notified in any case.
    fn is_candidate(&mut self, instance: u32, (geometry, primitive): (u32, u32)) -> bool {
        if let Some(observer) = &mut self.observer {
            observer.candidate(instance, geometry, primitive);
        }
        self.visibility.shows(geometry, primitive)
    }

    fn triangles(&mut self, block: &TriangleBlock, ray: &ExactRay<f64>, instance: u32) {
        for lane in 0..block.count() {
            let (ids, corners) = (block.ids(lane), block.corners(lane));
            if self.is_candidate(instance, ids)
                && !self.visibility.is_origin(instance, ids)
                && let Some(met) = triangle::intersect_exact(ray, &corners, block.extent(lane))
                && self.visibility.faces().shows(|| triangle::is_front(ray, &corners))
                && (!self.visibility.crossings() || triangle::is_crossed(ray, &corners))
            {
                self.report([met.t, met.u, met.v], ids, instance);
            }
        }
    }

    fn procedurals(&mut self, bvh: &Bvh, items: &[ProceduralItem], ray: &ExactRay<f64>, instance: u32) {
        let [origin, direction] = [ray.origin, ray.direction].map(|x| x.map(|x| x as f32));
        for item in items {
            let ids = (item.geometry, item.primitive);
            if !self.is_candidate(instance, ids) {
                continue;
            }
            // Query one step beyond the end: a hit at the same t may win the tie.
            let (t_min, t_max) =
                (round_down(self.ray.t_min), round_up(self.end.min(self.ray.t_max)).next_up());
            let asked = Ray { origin, t_min, direction, t_max };
            let found = bvh.shapes_of(item).and_then(|shapes| shapes.intersect(item.primitive, &asked));
            if let Some(found) = found {
                self.report([found.t, found.u, found.v].map(f64::from), ids, instance);
            }
        }
    }

    fn leaf(&mut self, part: Part<'_>, ray: &ExactRay<f64>, instance: u32, leaf: usize) {
        let range = |first: u32, count: u32| first as usize..(first + count) as usize;
        let bvh = match part {
            Part::Standing(bvh) => bvh,
            // The leaves of what moves hold instances, which are the outer tree's.
            Part::Moving(..) => self.outer,
        };
        match part.leaf(leaf) {
            Leaf::Spheres { block } => {
                for item in bvh.spheres[block as usize].items() {
                    let ids = (item.geometry, item.primitive);
                    if !self.is_candidate(instance, ids) {
                        continue;
                    }
                    let Some([t1, t2]) = sphere::intersect_exact(ray, &item.shape) else { continue };
                    if self.visibility.crossings() && t1 == t2 {
                        continue;
                    }
                    let faces = self.visibility.faces();
                    if faces.shows(|| true) {
                        self.report([t1, 0.0, 0.0], ids, instance);
                    }
                    if t1 < t2 && faces.shows(|| false) {
                        self.report([t2, 0.0, 0.0], ids, instance);
                    }
                }
            }
            Leaf::Procedurals { first, count } => {
                self.procedurals(bvh, &bvh.procedurals[range(first, count)], ray, instance);
            }
            Leaf::Capsules { first, count, .. } => {
                self.procedurals(bvh, &bvh.procedurals[range(first, count.into())], ray, instance);
            }
            Leaf::Instances { first, count } => {
                let outer = self.outer;
                for place in range(first, count) {
                    let instance = &outer.instances[place];
                    let inside = match outer.instance_map_at(place as u32, self.time) {
                        None => Some(instance.ray_in_object(ray)),
                        Some(map) => instance.ray_in_moved(&map, ray),
                    };
                    if let Some(inside) = inside.filter(is_usable)
                        && self.visibility.enter_instance(place)
                    {
                        self.tree(&instance.bvh, &inside, place as u32);
                        self.visibility.leave_instance();
                    }
                }
            }
        }
    }
}

/// True if a ray can hit anything: its origin and direction, rounded to f32, are finite, and its direction is not
/// zero.
fn is_usable(ray: &ExactRay<f64>) -> bool {
    let finite = ray.origin.iter().chain(&ray.direction).all(|&x| (x as f32).is_finite());
    finite && ray.direction.iter().any(|&x| x as f32 != 0.0)
}

/// The children of a node that a line hits after `t_min`, and the t at which it enters them.
fn enter(node: &Node, ray: &ExactRay<f64>, t_min: f64) -> ([(f64, Child); WIDTH], usize) {
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

/// The interval of t in which a line is inside a box; the first is larger than the second if it is empty.
fn slabs(bounds: &Aabb, ray: &ExactRay<f64>) -> [f64; 2] {
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
