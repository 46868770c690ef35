//! Collapses the binary tree to the wide one, as chosen by `plan`.
//!
//! Nodes are written depth first, leaves in a separate list in the same order, so that neighbours in space are
//! neighbours in memory.

use std::ops::Range;

use crate::bvh::Bvh;
use crate::capsule::CapsuleBlock;
use crate::conservative::TriangleBlock;
use crate::item::{Leaf, ProceduralItem};
use crate::node::{Child, Node};
use crate::parallel;
use crate::sphere::{SphereBlock, SphereItem};

use super::plan::Plan;
use super::primitives::{Geometry, Kind, Primitives};
use super::reference::Reference;
use super::sah::Binary;

/// Builds the tree except for its bounds and statistics.
pub(super) fn collapse(
    binary: &[Binary],
    plan: &Plan,
    references: &[Reference],
    primitives: &Primitives<'_>,
) -> Bvh {
    let procedural_shapes = |geometry: &Geometry| match geometry {
        Geometry::Procedural(shapes) => Some(shapes.clone()),
        _ => None,
    };
    let procedural_shapes = primitives.geometries.iter().map(procedural_shapes).collect();
    let bvh = Bvh { procedural_shapes, ..Bvh::default() };
    let mut collapse =
        Collapse { plan, binary, references, primitives, blocks: Vec::new(), thin: Vec::new(), bvh };
    if !binary.is_empty() {
        collapse.node(0);
    }
    let Collapse { blocks, thin, mut bvh, .. } = collapse;
    bvh.triangles =
        parallel::collect(blocks.len(), 1024, |block| triangle_block(&blocks[block], references, primitives));
    bvh.capsules = parallel::collect(thin.len(), 1024, |leaf| capsule_block(&bvh, thin[leaf].clone()));
    bvh
}

struct Collapse<'a> {
    plan: &'a Plan,
    binary: &'a [Binary],
    references: &'a [Reference],
    primitives: &'a Primitives<'a>,
    /// The leaves of triangles.
    blocks: Vec<Binary>,
    /// The procedural items of the leaves of thin shapes.
    thin: Vec<Range<usize>>,
    bvh: Bvh,
}

impl Collapse<'_> {
    /// Writes the wide node of a binary one, and all below it; returns it as a child.
    fn node(&mut self, root: usize) -> Child {
        let (children, count) = self.plan.children(self.binary, root);
        let number = self.bvh.nodes.len();
        self.bvh.nodes.push(Node::EMPTY);
        for (slot, &child) in children[..count].iter().enumerate() {
            let node = self.binary[child];
            let placed = if self.plan.is_leaf(child) { self.leaf(&node) } else { self.node(child) };
            self.bvh.nodes[number].place(slot, &node.bounds, placed);
        }
        Child::node(number)
    }

    /// Writes the primitives of a leaf; triangles and capsules are only recorded, to be written later.
    fn leaf(&mut self, node: &Binary) -> Child {
        let kind = self.references[node.first as usize].kind();
        if kind == Kind::Triangle {
            self.blocks.push(*node);
            return Child::triangles(self.blocks.len() - 1);
        }
        let (numbers, count) = sorted_numbers(node, self.references);
        let ids = numbers[..count].iter().map(|&number| self.primitives.ids(number));
        let count = node.count;
        let bvh = &mut self.bvh;
        let leaf = match kind {
            Kind::Sphere => {
                let item = |(geometry, primitive)| match &self.primitives.geometries[geometry as usize] {
                    Geometry::Spheres(spheres) => {
                        Some(SphereItem { shape: spheres[primitive as usize], geometry, primitive })
                    }
                    _ => None,
                };
                bvh.spheres.push(SphereBlock::new(ids.filter_map(item)));
                Leaf::Spheres { block: bvh.spheres.len() as u32 - 1 }
            }
            Kind::Procedural | Kind::Thin => {
                let first = bvh.procedurals.len();
                bvh.procedurals
                    .extend(ids.map(|(geometry, primitive)| ProceduralItem { geometry, primitive }));
                if kind == Kind::Procedural {
                    Leaf::Procedurals { first: first as u32, count }
                } else {
                    self.thin.push(first..bvh.procedurals.len());
                    let block = self.thin.len() as u32 - 1;
                    Leaf::Capsules { block, first: first as u32, count: count as u8 }
                }
            }
            Kind::Instance | Kind::Triangle => {
                // Instances keep their order: they are large, and a leaf holds one.
                let first = self.primitives.ids(numbers[0]).1;
                Leaf::Instances { first, count }
            }
        };
        bvh.leaves.push(leaf);
        bvh.leaf_bounds.push(node.bounds);
        Child::leaf(bvh.leaves.len() - 1)
    }
}

/// The primitives of a leaf.
fn sorted_numbers(node: &Binary, references: &[Reference]) -> ([u32; Kind::MOST_IN_A_LEAF], usize) {
    let mut numbers = [u32::MAX; Kind::MOST_IN_A_LEAF];
    let references = &references[node.first as usize..][..node.count as usize];
    for (number, reference) in numbers.iter_mut().zip(references) {
        *number = reference.number();
    }
    numbers.sort_unstable();
    (numbers, references.len())
}

/// The capsules of a range of procedural items.
fn capsule_block(bvh: &Bvh, items: Range<usize>) -> CapsuleBlock {
    let mut capsules = [None; Kind::MOST_IN_A_LEAF];
    for (capsule, item) in capsules.iter_mut().zip(&bvh.procedurals[items]) {
        *capsule = bvh.shapes_of(item).and_then(|shapes| shapes.capsule(item.primitive));
    }
    CapsuleBlock::new(&capsules)
}

fn triangle_block(node: &Binary, references: &[Reference], primitives: &Primitives<'_>) -> TriangleBlock {
    let (numbers, count) = sorted_numbers(node, references);
    let mut triangles = [Default::default(); Kind::MOST_IN_A_LEAF];
    for (triangle, &number) in triangles.iter_mut().zip(&numbers[..count]) {
        let (geometry, primitive) = primitives.ids(number);
        let corners = match &primitives.geometries[geometry as usize] {
            Geometry::Triangles(corners) => corners,
            Geometry::MovingTriangles(times) => &times[0],
            _ => continue,
        };
        *triangle = (corners[primitive as usize], geometry, primitive);
    }
    TriangleBlock::new(&triangles[..count])
}
