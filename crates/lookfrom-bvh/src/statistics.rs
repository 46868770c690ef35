//! Statistics of a tree, counted when it is built.

use crate::aabb::Aabb;
use crate::conservative::TriangleBlock;
use crate::item::Leaf;
use crate::node::{Content, Node};
use crate::sphere::SphereBlock;

/// Statistics of a tree.
///
/// ```
/// # use lookfrom_bvh::{Builder, Sphere};
/// # let mut builder = Builder::new();
/// # builder.spheres(&[Sphere { center: [0.0; 3], radius: 1.0 }]);
/// # let bvh = builder.build()?;
/// let statistics = bvh.statistics();
/// assert_eq!((statistics.spheres, statistics.nodes, statistics.left_out), (1, 1, 0));
/// # Ok::<(), lookfrom_bvh::BuildError>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Statistics {
    /// Number of triangles in the tree.
    pub triangles: usize,
    /// Number of spheres in the tree.
    pub spheres: usize,
    /// Number of procedural shapes in the tree.
    pub procedurals: usize,
    /// Number of instances in the tree.
    pub instances: usize,
    /// Number of primitives and instances that no ray can hit and that are not in the tree.
    pub left_out: usize,
    /// Number of nodes, of up to eight children.
    pub nodes: usize,
    /// Number of leaves.
    pub leaves: usize,
    /// Number of levels of nodes.
    pub depth: usize,
    /// Expected number of nodes and leaves that a random line through the tree's box visits: the sum of their
    /// areas, relative to the root's.
    pub cost: f64,
}

impl Statistics {
    /// The statistics of a tree in which nothing was left out.
    pub(crate) fn of(
        nodes: &[Node],
        triangles: &[TriangleBlock],
        spheres: &[SphereBlock],
        leaves: &[Leaf],
    ) -> Self {
        let Some(root) = nodes.first() else { return Self::default() };
        let mut bounds = Aabb::EMPTY;
        root.children().for_each(|(_, child, _)| bounds.unite(&child));
        let root_area = f64::from(bounds.half_area());
        let mut walk = Walk { nodes, triangles, spheres, leaves, root_area, statistics: Self::default() };
        walk.visit(0, 1);
        walk.statistics
    }
}

/// A walk through a tree that counts its content.
struct Walk<'a> {
    nodes: &'a [Node],
    triangles: &'a [TriangleBlock],
    spheres: &'a [SphereBlock],
    leaves: &'a [Leaf],
    root_area: f64,
    statistics: Statistics,
}

impl Walk<'_> {
    fn visit(&mut self, number: usize, depth: usize) {
        self.statistics.nodes += 1;
        self.statistics.depth = self.statistics.depth.max(depth);
        for (_, bounds, content) in self.nodes[number].children() {
            if self.root_area > 0.0 {
                self.statistics.cost += f64::from(bounds.half_area()) / self.root_area;
            }
            self.statistics.leaves += usize::from(!matches!(content, Content::Node(_)));
            match content {
                Content::Node(child) => self.visit(child, depth + 1),
                Content::Triangles(block) => self.statistics.triangles += self.triangles[block].count(),
                Content::Leaf(leaf) => match self.leaves[leaf] {
                    Leaf::Spheres { block } => {
                        self.statistics.spheres += self.spheres[block as usize].count();
                    }
                    Leaf::Procedurals { count, .. } => self.statistics.procedurals += count as usize,
                    Leaf::Capsules { count, .. } => self.statistics.procedurals += usize::from(count),
                    Leaf::Instances { count, .. } => self.statistics.instances += count as usize,
                },
            }
        }
    }
}
