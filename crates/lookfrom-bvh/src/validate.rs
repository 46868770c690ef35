//! Validation of a tree, and its statistics.

use std::fmt;

use crate::Bvh;
use crate::aabb::Aabb;
use crate::bvh::Leaf;
use crate::node::{Content, LARGEST_DEPTH, Node, WIDTH};

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

/// A violated invariant of a tree.
///
/// ```
/// # use lookfrom_bvh::{Builder, Sphere};
/// # let mut builder = Builder::new();
/// # builder.spheres(&[Sphere { center: [0.0; 3], radius: 1.0 }]);
/// # let bvh = builder.build()?;
/// if let Err(invalid) = bvh.validate() {
///     unreachable!("a fault of lookfrom-bvh: {invalid}");
/// }
/// # Ok::<(), lookfrom_bvh::BuildError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Invalid(String);

impl fmt::Display for Invalid {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for Invalid {}

impl Bvh {
    /// Counts the content without checking the tree.
    pub(crate) fn take_statistics(&self) -> Statistics {
        let mut walk = Walk::default();
        if !self.nodes.is_empty() {
            walk.count(self, 0, 1);
        }
        walk.statistics
    }
}

/// Checks the whole tree.
pub(crate) fn validate(bvh: &Bvh) -> Result<Statistics, Invalid> {
    let mut check = Check {
        bvh,
        nodes: vec![false; bvh.nodes.len()],
        blocks: vec![false; bvh.triangles.len()],
        leaves: vec![false; bvh.leaves.len()],
        spheres: vec![false; bvh.spheres.len()],
        procedurals: vec![false; bvh.procedurals.len()],
        // Those that were left out are not in the tree.
        instances: bvh.instances.iter().map(|instance| !instance.bounds().is_valid()).collect(),
        ids: Vec::new(),
    };
    if !bvh.nodes.is_empty() {
        check.node(0)?;
    }

    // Everything is reached, and only once.
    for (name, seen) in [
        ("node", &check.nodes),
        ("block", &check.blocks),
        ("leaf", &check.leaves),
        ("sphere", &check.spheres),
        ("procedural", &check.procedurals),
        ("instance", &check.instances),
    ] {
        if let Some(missing) = seen.iter().position(|seen| !seen) {
            return Err(Invalid(format!("{name} {missing} is not in the tree")));
        }
    }
    check.ids.sort_unstable();
    if let Some(pair) = check.ids.windows(2).find(|pair| pair[0] == pair[1]) {
        return Err(Invalid(format!("primitive {} of geometry {} is there twice", pair[0].1, pair[0].0)));
    }

    for (number, instance) in bvh.instances.iter().enumerate() {
        if !instance.bvh.instances.is_empty() {
            return Err(Invalid(format!("the tree of instance {number} holds instances")));
        }
        instance.bvh.validate()?;
    }

    let statistics = Statistics { left_out: bvh.statistics.left_out, ..bvh.take_statistics() };
    if statistics != bvh.statistics {
        return Err(Invalid(format!("counted {statistics:?}, but it says {:?}", bvh.statistics)));
    }
    if statistics.depth > LARGEST_DEPTH {
        return Err(Invalid(format!("{} levels, more than {LARGEST_DEPTH}", statistics.depth)));
    }
    Ok(statistics)
}

/// The non-empty children of a node.
fn children(node: &Node) -> impl Iterator<Item = (usize, Aabb, Content)> + '_ {
    (0..WIDTH).filter_map(|slot| {
        let bounds = node.child_bounds(slot);
        (!bounds.is_empty()).then(|| (slot, bounds, node.child(slot).content()))
    })
}

#[derive(Default)]
struct Walk {
    statistics: Statistics,
    root_area: f64,
}

impl Walk {
    fn count(&mut self, bvh: &Bvh, number: usize, depth: usize) {
        let node = &bvh.nodes[number];
        if depth == 1 {
            let mut bounds = Aabb::EMPTY;
            children(node).for_each(|(_, child, ..)| bounds.unite(&child));
            self.root_area = f64::from(bounds.half_area());
        }
        self.statistics.nodes += 1;
        self.statistics.depth = self.statistics.depth.max(depth);
        for (_, bounds, content) in children(node) {
            if self.root_area > 0.0 {
                self.statistics.cost += f64::from(bounds.half_area()) / self.root_area;
            }
            self.statistics.leaves += usize::from(!matches!(content, Content::Node(_)));
            match content {
                Content::Node(child) => self.count(bvh, child, depth + 1),
                Content::Triangles(block) => self.statistics.triangles += bvh.triangles[block].count(),
                Content::Leaf(leaf) => match bvh.leaves[leaf] {
                    Leaf::Spheres { count, .. } => self.statistics.spheres += count as usize,
                    Leaf::Procedurals { count, .. } => self.statistics.procedurals += count as usize,
                    Leaf::Instances { count, .. } => self.statistics.instances += count as usize,
                },
            }
        }
    }
}

struct Check<'a> {
    bvh: &'a Bvh,
    nodes: Vec<bool>,
    blocks: Vec<bool>,
    leaves: Vec<bool>,
    spheres: Vec<bool>,
    procedurals: Vec<bool>,
    instances: Vec<bool>,
    /// Geometry and primitive of everything but instances.
    ids: Vec<(u32, u32)>,
}

impl Check<'_> {
    /// Checks a node and all below it; returns the box around its children.
    fn node(&mut self, number: usize) -> Result<Aabb, Invalid> {
        let bvh = self.bvh;
        mark(&mut self.nodes, number, 1, "node")?;
        let node = &bvh.nodes[number];
        let mut all = Aabb::EMPTY;
        for (slot, bounds, content) in children(node) {
            let inside = match content {
                Content::Node(child) => self.node(child)?,
                Content::Triangles(block) => self.triangles(block)?,
                Content::Leaf(leaf) => {
                    if bvh.leaf_bounds.get(leaf) != Some(&bounds) {
                        return Err(Invalid(format!("leaf {leaf}: its box is not that of node {number}")));
                    }
                    self.leaf(leaf)?
                }
            };
            // (Boxes are a little larger than the largest allowed coordinate.)
            let is_finite = bounds.min.iter().chain(&bounds.max).all(|x| x.is_finite());
            if !is_finite || !bounds.contains(&inside) {
                return Err(Invalid(format!(
                    "node {number}, child {slot}: {bounds:?} does not hold its content, {inside:?}"
                )));
            }
            all.unite(&bounds);
        }
        if all.is_empty() {
            return Err(Invalid(format!("node {number} has no children")));
        }
        Ok(all)
    }

    fn triangles(&mut self, block: usize) -> Result<Aabb, Invalid> {
        mark(&mut self.blocks, block, 1, "block")?;
        let block = &self.bvh.triangles[block];
        let mut inside = Aabb::EMPTY;
        for lane in 0..block.count() {
            inside.unite(&Aabb::around(&block.corners(lane)));
            self.ids.push(block.ids(lane));
        }
        Ok(inside)
    }

    fn leaf(&mut self, leaf: usize) -> Result<Aabb, Invalid> {
        mark(&mut self.leaves, leaf, 1, "leaf")?;
        let bvh = self.bvh;
        let mut inside = Aabb::EMPTY;
        match bvh.leaves[leaf] {
            Leaf::Spheres { first, count } => {
                for item in &bvh.spheres[mark(&mut self.spheres, first as usize, count, "sphere")?] {
                    inside.unite(&item.shape.bounds());
                    self.ids.push((item.geometry, item.primitive));
                }
            }
            Leaf::Procedurals { first, count } => {
                for item in
                    &bvh.procedurals[mark(&mut self.procedurals, first as usize, count, "procedural")?]
                {
                    inside.unite(&bvh.procedural_shapes[item.shape as usize].bounds(item.primitive));
                    self.ids.push((item.geometry, item.primitive));
                }
            }
            Leaf::Instances { first, count } => {
                for instance in &bvh.instances[mark(&mut self.instances, first as usize, count, "instance")?]
                {
                    inside.unite(&instance.bounds());
                }
            }
        }
        Ok(inside)
    }
}

/// Marks items as reached, and fails where they do not exist or were reached before.
fn mark(seen: &mut [bool], first: usize, count: u32, name: &str) -> Result<std::ops::Range<usize>, Invalid> {
    let range = first..first + count as usize;
    let Some(items) = seen.get_mut(range.clone()) else {
        return Err(Invalid(format!("{name} {first} is named but not there")));
    };
    if items.is_empty() || items.contains(&true) {
        return Err(Invalid(format!("{name} {first} is named twice, or a leaf is empty")));
    }
    items.fill(true);
    Ok(range)
}
