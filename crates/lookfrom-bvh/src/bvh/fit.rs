//! Boxes from the leaves up, for primitives that are elsewhere.

use super::Bvh;
use crate::aabb::Aabb;
use crate::item::Leaf;
use crate::node::{Content, WIDTH};

impl Bvh {
    /// Refits the boxes of a node and of all below it. Returns the box around their primitives, and the node's own,
    /// which contains the primitives' padded boxes. Boxes of instances are given by id.
    pub(crate) fn fit(&mut self, number: usize, instance_bounds: &dyn Fn(usize) -> Aabb) -> [Aabb; 2] {
        let mut all = [Aabb::EMPTY; 2];
        for slot in 0..WIDTH {
            let kept = self.nodes[number].child_bounds(slot);
            if kept.is_empty() {
                continue;
            }
            let child = self.nodes[number].child(slot);
            let [exact, padded] = match child.content() {
                Content::Node(below) => self.fit(below, instance_bounds),
                Content::Triangles(block) => {
                    let block = &self.triangles[block];
                    around((0..block.count()).map(|lane| Aabb::around(&block.corners(lane))))
                }
                Content::Leaf(leaf) => match self.leaves[leaf] {
                    Leaf::Spheres { block } => {
                        around(self.spheres[block as usize].items().map(|item| item.shape.bounds()))
                    }
                    Leaf::Procedurals { .. } | Leaf::Capsules { .. } => [kept; 2],
                    Leaf::Instances { first, count } => {
                        let range = first as usize..(first + count) as usize;
                        around(range.map(instance_bounds))
                    }
                },
            };
            self.nodes[number].place(slot, &padded, child);
            if let Content::Leaf(leaf) = child.content() {
                self.leaf_bounds[leaf] = padded;
            }
            all[0].unite(&exact);
            all[1].unite(&padded);
        }
        all
    }
}

/// The box around some boxes, and the box around these boxes padded.
fn around(boxes: impl Iterator<Item = Aabb>) -> [Aabb; 2] {
    boxes.fold([Aabb::EMPTY; 2], |[mut exact, mut padded], bounds| {
        exact.unite(&bounds);
        padded.unite(&bounds.padded());
        [exact, padded]
    })
}
