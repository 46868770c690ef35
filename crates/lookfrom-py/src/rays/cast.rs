//! The closest hits of rays, and whether there are any.

use lookfrom_bvh::{Hit, Ray};

use super::chunk::{Chunk, Relation, WorldRay};
use super::refine::{FineHit, refine};
use super::tree::{Selection, Tree};

/// A tree, what rays see of it, and the memory of a thread.
pub(super) struct Caster<'a> {
    pub(super) tree: &'a Tree,
    pub(super) selection: Selection,
    pub(super) chunk: Chunk,
    pub(super) hits: Vec<Hit>,
    found: Vec<bool>,
}

impl<'a> Caster<'a> {
    pub(super) fn new(tree: &'a Tree, selection: Selection) -> Self {
        Self { tree, selection, chunk: Chunk::default(), hits: Vec::new(), found: Vec::new() }
    }

    /// The closest hit of each ray of the chunk, in order.
    pub(super) fn closest_hits(&mut self, mut take: impl FnMut(usize, FineHit)) {
        self.trace();
        for (number, hit) in self.hits.iter().enumerate() {
            if let Some(later) = self.hits.get(number + 2 * AHEAD) {
                self.tree.fetch_face(later);
            }
            if let Some(later) = self.hits.get(number + AHEAD) {
                self.tree.fetch_vertices(later);
            }
            let fine = if hit.is_hit() { self.decide(number, hit) } else { FineHit::MISS };
            take(self.chunk.place(number), fine);
        }
    }

    /// The closest hit of each ray, without t and weights: the ids of most are the kernel's.
    pub(super) fn closest_ids(&mut self, mut take: impl FnMut(usize, [u32; 3])) {
        self.trace();
        for (number, hit) in self.hits.iter().enumerate() {
            let mut ids = [hit.primitive, hit.geometry, hit.instance];
            if hit.is_hit() && !self.chunk.relations[number].is_surely_inside(hit.t) {
                let fine = self.decide(number, hit);
                ids = [fine.primitive, fine.geometry, fine.instance];
            }
            take(self.chunk.place(number), ids);
        }
    }

    fn trace(&mut self) {
        self.hits.clear();
        self.hits.resize(self.chunk.rays.len(), Hit::MISS);
        self.selection.of(&self.tree.bvh).closest_hits(&self.chunk.rays, &mut self.hits);
    }

    /// A ray's closest hit, given the kernel's.
    #[inline]
    fn decide(&self, number: usize, hit: &Hit) -> FineHit {
        let (ray, relation) = (self.chunk.world_ray(number), &self.chunk.relations[number]);
        let fine = self.refine(&ray, relation, hit);
        if relation.is_inside(fine.t) {
            return fine;
        }
        if fine.t >= relation.t_max {
            return FineHit::MISS;
        }
        self.after_start(number, &ray)
    }

    fn refine(&self, ray: &WorldRay, relation: &Relation, hit: &Hit) -> FineHit {
        refine(self.tree, ray, relation, hit)
    }

    /// The closest hit of a ray that starts so near to a surface that the kernel has found the surface behind it.
    #[cold]
    fn after_start(&self, number: usize, ray: &WorldRay) -> FineHit {
        let (kernels, relation) = (&self.chunk.rays[number], &self.chunk.relations[number]);
        let query = self.selection.of(&self.tree.bvh);
        let beyond = (relation.range()[0] + 2.0 * relation.margin) as f32;
        let near = self.first_inside(number, ray, &kernels.with_t_max(beyond.min(kernels.t_max)));
        if near.t.is_finite() {
            return near;
        }
        let hit = query.closest_hit(&Ray { t_min: beyond.next_down(), ..*kernels });
        if !hit.is_hit() {
            return FineHit::MISS;
        }
        let fine = self.refine(ray, relation, &hit);
        if relation.is_inside(fine.t) { fine } else { FineHit::MISS }
    }

    /// The first of all hits in the ray's range; `kernels` is a part of the kernel's ray.
    fn first_inside(&self, number: usize, ray: &WorldRay, kernels: &Ray) -> FineHit {
        let relation = &self.chunk.relations[number];
        let mut all = Vec::new();
        self.selection.of(&self.tree.bvh).all_hits(kernels, &mut all);
        let fine = all.iter().map(|hit| self.refine(ray, relation, hit));
        fine.filter(|hit| relation.is_inside(hit.t)).fold(FineHit::MISS, |first, hit| {
            if hit.t < first.t || (hit.t == first.t && hit.rank() < first.rank()) { hit } else { first }
        })
    }

    /// For each ray of the chunk, whether it hits anything.
    pub(super) fn occluded(&mut self, mut take: impl FnMut(usize, bool)) {
        // What is hit away from the ends of the ranges is hit; what is hit near them is decided in f64.
        let Chunk { rays, relations, .. } = &mut self.chunk;
        let mut whole = Vec::with_capacity(rays.len());
        for (ray, relation) in rays.iter_mut().zip(relations.iter()) {
            whole.push([ray.t_min, ray.t_max]);
            let [first, last] = relation.range();
            ray.t_min = (first + relation.margin).max(0.0) as f32;
            ray.t_max = (last - relation.margin) as f32;
        }
        self.found.clear();
        self.found.resize(whole.len(), false);
        self.selection.of(&self.tree.bvh).occluded_many(&self.chunk.rays, &mut self.found);
        for (number, &[t_min, t_max]) in whole.iter().enumerate() {
            take(
                self.chunk.place(number),
                self.found[number] || self.is_occluded_near_ends(number, [t_min, t_max]),
            );
        }
    }

    /// True if a ray hits something near one of the ends of its range.
    fn is_occluded_near_ends(&self, number: usize, [t_min, t_max]: [f32; 2]) -> bool {
        let middle = &self.chunk.rays[number];
        let ends = if middle.t_min < middle.t_max {
            [[t_min, middle.t_min.next_up()], [middle.t_max.next_down(), t_max]]
        } else {
            [[t_min, t_max], [0.0; 2]]
        };
        ends.iter().any(|&[t_min, t_max]| {
            let end = Ray { t_min, t_max, ..*middle };
            t_min < t_max
                && self.may_reach(&end)
                && self.first_inside(number, &self.chunk.world_ray(number), &end).t.is_finite()
        })
    }

    /// False for most ends that are outside of the tree: the first point tells where a short one is.
    fn may_reach(&self, end: &Ray) -> bool {
        const SHORT: f32 = 1e-4;
        const ROOM: f32 = 1e-3;
        let bounds = self.tree.bvh.bounds();
        let is_near = |axis: usize| {
            let x = end.origin[axis] + end.t_min * end.direction[axis];
            x > bounds.min[axis] - ROOM && x < bounds.max[axis] + ROOM
        };
        end.t_min < BEYOND && (end.t_max - end.t_min > SHORT || (0..3).all(is_near))
    }
}

/// Prefetch distance in hits: primitives are fetched into the cache so far ahead.
const AHEAD: usize = 16;

/// No kernel's ray reaches a tree after this.
const BEYOND: f32 = 64.0;
