//! The search for the nearest point: boxes by their distances, nearest first.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use super::ClosestPointF64;
use crate::aabb::{Aabb, LARGEST_COORDINATE};
use crate::affine::Affine;
use crate::bvh::Part;
use crate::ellipsoid::nearest_on_ellipsoid;
use crate::item::Leaf;
use crate::masks::Masks;
use crate::nearest::{Nearest, nearest_on_triangle};
use crate::node::{Child, Content, WIDTH};
use crate::ray::NONE;
use crate::settings::Settings;
use crate::unrounded::Shapes;
use crate::vector::{dot, subtract};

/// Relative margin for the rounding of distances: 2⁻²⁰.
const ROOM: f64 = 1.0 + 9.536_743_164_062_5e-7;

/// Relative error of a transformed box, with a large margin: 2⁻⁴⁶.
const MAPPED_ERROR: f64 = 1.421_085_471_520_200_4e-14;

/// The point nearest to `point` of what a query sees at its time, at most `max_distance` away; with `any` the first that is found.
pub(super) fn search<S: Shapes>(
    settings: &Settings<'_>,
    shapes: S,
    point: [f64; 3],
    max_distance: f64,
    any: bool,
) -> Option<ClosestPointF64> {
    let usable = point.iter().all(|x| x.abs() <= f64::from(LARGEST_COORDINATE)) && max_distance >= 0.0;
    if !usable {
        return None;
    }
    let mut search = Search {
        settings: *settings,
        shapes,
        point,
        max_distance,
        any,
        best: None,
        queue: BinaryHeap::new(),
    };
    search.enter(0.0, NONE);
    search.run();
    search.best
}

/// A child still to be opened.
struct QueueEntry {
    /// Lower bound of the distances within it.
    distance: f64,
    child: Child,
    /// Whether it belongs to the moving part of its tree.
    moves: bool,
    /// Index of the instance in the outer tree's list; [`NONE`] for the outer tree itself.
    place: u32,
}

impl Ord for QueueEntry {
    /// The nearest is the largest, which the heap returns first.
    fn cmp(&self, other: &Self) -> Ordering {
        other.distance.total_cmp(&self.distance)
    }
}

impl PartialOrd for QueueEntry {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for QueueEntry {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for QueueEntry {}

struct Search<'a, S> {
    settings: Settings<'a>,
    shapes: S,
    point: [f64; 3],
    max_distance: f64,
    /// True if any point that is near enough suffices.
    any: bool,
    best: Option<ClosestPointF64>,
    queue: BinaryHeap<QueueEntry>,
}

impl<S: Shapes> Search<'_, S> {
    /// Adds the roots of the outer tree, or of an instance's.
    fn enter(&mut self, distance: f64, place: u32) {
        let outer = self.settings.bvh;
        let bvh = outer.instances.get(place as usize).map_or(outer, |instance| &*instance.bvh);
        let has_moving = bvh.moving.as_ref().is_some_and(|moving| !moving.is_empty());
        let parts = [(false, !bvh.nodes.is_empty()), (true, has_moving)];
        let roots = parts.into_iter().filter(|&(_, exists)| exists);
        self.queue.extend(roots.map(|(moves, _)| QueueEntry { distance, child: Child::ROOT, moves, place }));
    }

    fn run(&mut self) {
        let (outer, time) = (self.settings.bvh, self.settings.time_of(0));
        while let Some(QueueEntry { distance, child, moves, place }) = self.queue.pop() {
            if distance > self.end() || (self.any && self.best.is_some()) {
                break;
            }
            let instance = outer.instances.get(place as usize);
            let bvh = instance.map_or(outer, |instance| &*instance.bvh);
            let space = match instance {
                Some(instance) => {
                    let map = outer.instance_map_at(place, time);
                    Space::new(map.unwrap_or(instance.world_from_object), self.point, place)
                }
                None => Space::world(self.point),
            };
            let part = match &bvh.moving {
                Some(moving) if moves => Part::Moving(moving, moving.moment(time)),
                _ => Part::Standing(bvh),
            };
            match child.content() {
                Content::Node(number) => {
                    let node = part.node(number);
                    for slot in 0..WIDTH {
                        let bounds = node.child_bounds(slot);
                        if bounds.is_empty() {
                            continue;
                        }
                        let distance = space.distance_to_box(&bounds) - self.shapes.error();
                        if distance <= self.end() {
                            self.queue.push(QueueEntry { distance, child: node.child(slot), moves, place });
                        }
                    }
                }
                Content::Triangles(block) => {
                    let block = part.block(block);
                    for lane in 0..block.count() {
                        let (geometry, primitive) = block.ids(lane);
                        let ids = [space.instance, geometry, primitive];
                        if self.shows(&bvh.masks, ids) {
                            let corners = self.shapes.triangle(ids, block.corners(lane));
                            self.offer(ids, nearest_on_triangle(&corners.map(|p| space.offset(p))));
                        }
                    }
                }
                Content::Leaf(leaf) => match part.leaf(leaf) {
                    Leaf::Spheres { block } => {
                        for item in bvh.spheres[block as usize].items() {
                            let ids = [space.instance, item.geometry, item.primitive];
                            if self.shows(&bvh.masks, ids) {
                                let (center, radius) =
                                    self.shapes.sphere(ids, (item.shape.center, item.shape.radius));
                                self.offer(ids, space.sphere(center, radius));
                            }
                        }
                    }
                    Leaf::Procedurals { .. } | Leaf::Capsules { .. } => {}
                    Leaf::Instances { first, count } => {
                        for place in first..first + count {
                            if self.settings.mask.is_none_or(|mask| outer.masks.shows_instance(place, mask)) {
                                self.enter(distance, place);
                            }
                        }
                    }
                },
            }
        }
    }

    /// Whether the query sees a primitive of a tree with these masks.
    fn shows(&self, masks: &Masks, [_, geometry, primitive]: [u32; 3]) -> bool {
        self.settings.mask.is_none_or(|mask| masks.shows(geometry, primitive, mask))
    }

    /// Boxes beyond this distance are ignored.
    fn end(&self) -> f64 {
        self.best.map_or(self.max_distance, |best| best.distance) * ROOM
    }

    /// Replaces the best point if a primitive's nearest point is nearer.
    fn offer(&mut self, [instance, geometry, primitive]: [u32; 3], nearest: Nearest) {
        let Nearest { offset, u, v, .. } = nearest;
        let position = [0, 1, 2].map(|axis| self.point[axis] + offset[axis]);
        let distance = self.shapes.distance(nearest.distance);
        let found = ClosestPointF64 { position, distance, u, v, primitive, geometry, instance };
        if found.distance <= self.max_distance && self.best.is_none_or(|best| found.precedes(&best)) {
            self.best = Some(found);
        }
    }
}

/// A tree's space relative to the query point: axes as in the world, the query point at 0.
struct Space {
    /// `None` for the world itself.
    map: Option<Affine>,
    /// The space's origin relative to the query point.
    origin: [f64; 3],
    instance: u32,
}

impl Space {
    fn world(point: [f64; 3]) -> Self {
        Self { map: None, origin: point.map(|x| -x), instance: NONE }
    }

    fn new(map: Affine, point: [f64; 3], instance: u32) -> Self {
        Self { map: Some(map), origin: subtract(map.translation, point), instance }
    }

    /// A point of the space relative to the query point.
    fn offset(&self, p: [f64; 3]) -> [f64; 3] {
        let p = self.map.as_ref().map_or(p, |map| map.vector(p));
        [0, 1, 2].map(|axis| p[axis] + self.origin[axis])
    }

    /// Lower bound of the distances within a box.
    fn distance_to_box(&self, bounds: &Aabb) -> f64 {
        let (mut low, mut high) = (self.origin, self.origin);
        for axis in 0..3 {
            match &self.map {
                None => {
                    low[axis] += f64::from(bounds.min[axis]);
                    high[axis] += f64::from(bounds.max[axis]);
                }
                Some(map) => {
                    // Each term takes its minimum and maximum independently.
                    let mut magnitude = self.origin[axis].abs();
                    for column in 0..3 {
                        let entry = map.matrix[axis][column];
                        let a = entry * f64::from(bounds.min[column]);
                        let b = entry * f64::from(bounds.max[column]);
                        low[axis] += a.min(b);
                        high[axis] += a.max(b);
                        magnitude += a.abs().max(b.abs());
                    }
                    low[axis] -= MAPPED_ERROR * magnitude;
                    high[axis] += MAPPED_ERROR * magnitude;
                }
            }
        }
        let outside = [0, 1, 2].map(|axis| low[axis].max(-high[axis]).max(0.0));
        dot(outside, outside).sqrt()
    }

    fn sphere(&self, center: [f64; 3], radius: f64) -> Nearest {
        let center = self.offset(center);
        if let Some(map) = &self.map {
            return nearest_on_ellipsoid(center, &map.matrix, radius);
        }
        let length = dot(center, center).sqrt();
        // At the centre all directions are equivalent.
        let toward = if length > 0.0 { center.map(|x| -x / length) } else { [1.0, 0.0, 0.0] };
        let offset = [0, 1, 2].map(|axis| center[axis] + radius * toward[axis]);
        Nearest { offset, distance: (length - radius).abs(), u: 0.0, v: 0.0 }
    }
}
