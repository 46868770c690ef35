//! All hits of rays, in order, and their number.

use lookfrom_bvh::Hit;

use super::cast::Caster;
use super::refine::{FineHit, refine};

impl Caster<'_> {
    /// All hits of each ray of the chunk, or its crossings, sorted by t.
    pub(super) fn all_hits(&mut self, crossings: bool, mut take: impl FnMut(usize, &[FineHit])) {
        let (mut hits, mut fine) = (std::mem::take(&mut self.hits), Vec::new());
        for number in 0..self.chunk.rays.len() {
            self.find_all(number, crossings, &mut hits);
            let (ray, relation) = (self.chunk.world_ray(number), &self.chunk.relations[number]);
            fine.clear();
            hits.iter().for_each(|hit| self.tree.fetch_face(hit));
            hits.iter().for_each(|hit| self.tree.fetch_vertices(hit));
            let refined = hits.iter().map(|hit| refine(self.tree, &ray, relation, hit));
            fine.extend(refined.filter(|hit| relation.is_inside(hit.t)));
            fine.sort_by(|a, b| a.t.total_cmp(&b.t).then_with(|| a.rank().cmp(&b.rank())));
            take(self.chunk.place(number), &fine);
        }
        self.hits = hits;
    }

    /// The number of hits of each ray of the chunk.
    pub(super) fn count_hits(&mut self, crossings: bool, mut take: impl FnMut(usize, usize)) {
        let mut hits = std::mem::take(&mut self.hits);
        for number in 0..self.chunk.rays.len() {
            self.find_all(number, crossings, &mut hits);
            let (ray, relation) = (self.chunk.world_ray(number), &self.chunk.relations[number]);
            let is_inside = |hit: &&Hit| {
                relation.is_surely_inside(hit.t)
                    || relation.is_inside(refine(self.tree, &ray, relation, hit).t)
            };
            take(self.chunk.place(number), hits.iter().filter(is_inside).count());
        }
        self.hits = hits;
    }

    fn find_all(&self, number: usize, crossings: bool, hits: &mut Vec<Hit>) {
        let (query, ray) = (self.selection.of(&self.tree.bvh), &self.chunk.rays[number]);
        if crossings {
            query.crossings(ray, hits);
        } else {
            query.all_hits(ray, hits);
        }
    }
}
