//! From the binary tree to the wide one, as `plan` has chosen.
//!
//! Nodes are written depth first, leaves beside them in the same order, so neighbours in space are neighbours in memory.

use crate::Bvh;
use crate::bvh::{Leaf, ProceduralItem, SphereItem};
use crate::instance::Instance;
use crate::node::{Child, Node};
use crate::triangle::TriangleBlock;

use super::plan::Plan;
use super::sah::{Binary, Reference};
use super::{Geometry, Item, Kind};

/// Makes the tree, all but its bounds and statistics.
pub(super) fn collapse(
    binary: &[Binary],
    references: &[Reference],
    items: &[Item],
    geometries: &[Geometry],
    instances: Vec<Instance>,
) -> Bvh {
    let mut bvh = Bvh::default();
    // Procedural geometries keep their order; an item names its place among them.
    let mut procedural_place = vec![0; geometries.len()];
    for (index, geometry) in geometries.iter().enumerate() {
        if let Geometry::Procedural(shapes) = geometry {
            procedural_place[index] = bvh.procedural_shapes.len() as u32;
            bvh.procedural_shapes.push(shapes.clone());
        }
    }
    let plan = Plan::new(binary, references, items);
    let mut collapse =
        Collapse { plan, binary, references, items, geometries, procedural_place, instances, bvh };
    if !binary.is_empty() {
        collapse.node(0);
    }
    collapse.bvh
}

struct Collapse<'a> {
    plan: Plan<'a>,
    binary: &'a [Binary],
    references: &'a [Reference],
    items: &'a [Item],
    geometries: &'a [Geometry],
    procedural_place: Vec<u32>,
    instances: Vec<Instance>,
    bvh: Bvh,
}

impl Collapse<'_> {
    /// Writes the node that stands for a binary one, and all below it; returns it.
    fn node(&mut self, root: usize) -> Child {
        let (children, count) = self.plan.children(root);
        let number = self.bvh.nodes.len();
        self.bvh.nodes.push(Node::EMPTY);
        for (slot, &child) in children[..count].iter().enumerate() {
            let node = self.binary[child];
            let placed = if self.plan.is_leaf(child) { self.leaf(&node) } else { self.node(child) };
            self.bvh.nodes[number].place(slot, &node.bounds, placed);
        }
        Child::node(number)
    }

    /// Writes the primitives of a leaf.
    fn leaf(&mut self, node: &Binary) -> Child {
        let range = node.first as usize..(node.first + node.count) as usize;
        let mut items: Vec<&Item> =
            self.references[range].iter().map(|reference| &self.items[reference.item as usize]).collect();
        items.sort_unstable_by_key(|item| (item.geometry, item.primitive));
        let count = node.count;
        let bvh = &mut self.bvh;
        let leaf = match items[0].kind {
            Kind::Triangle => {
                let triangles: Vec<_> = items
                    .iter()
                    .filter_map(|item| match &self.geometries[item.geometry as usize] {
                        Geometry::Triangles(corners) => {
                            Some((corners[item.primitive as usize], item.geometry, item.primitive))
                        }
                        _ => None,
                    })
                    .collect();
                bvh.triangles.push(TriangleBlock::new(&triangles));
                return Child::triangles(bvh.triangles.len() - 1);
            }
            Kind::Sphere => {
                let first = bvh.spheres.len() as u32;
                for item in items {
                    if let Geometry::Spheres(spheres) = &self.geometries[item.geometry as usize] {
                        let shape = spheres[item.primitive as usize];
                        let (geometry, primitive) = (item.geometry, item.primitive);
                        bvh.spheres.push(SphereItem { shape, geometry, primitive });
                    }
                }
                Leaf::Spheres { first, count }
            }
            Kind::Procedural => {
                let first = bvh.procedurals.len() as u32;
                for item in items {
                    let (geometry, primitive) = (item.geometry, item.primitive);
                    let shape = self.procedural_place[geometry as usize];
                    bvh.procedurals.push(ProceduralItem { shape, geometry, primitive });
                }
                Leaf::Procedurals { first, count }
            }
            Kind::Instance => {
                let first = bvh.instances.len() as u32;
                bvh.instances.extend(items.iter().map(|item| self.instances[item.geometry as usize].clone()));
                Leaf::Instances { first, count }
            }
        };
        bvh.leaves.push(leaf);
        Child::leaf(bvh.leaves.len() - 1)
    }
}
