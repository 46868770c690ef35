//! Validation of a tree.

use std::fmt;
use std::ops::Range;

use crate::aabb::Aabb;
use crate::bvh::Bvh;
use crate::item::Leaf;
use crate::node::{Content, LARGEST_DEPTH};
use crate::statistics::Statistics;

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
    /// Checks every invariant that tracing relies on, and recounts the statistics. Slow: for tests and
    /// debugging.
    ///
    /// # Errors
    /// A bug of this library, and its place.
    ///
    /// ```
    /// # use lookfrom_bvh::{Builder, Ray, Sphere};
    /// # let mut builder = Builder::new();
    /// # builder.spheres(&[Sphere { center: [0.0; 3], radius: 1.0 }]);
    /// # let bvh = builder.build()?;
    /// assert_eq!(bvh.validate(), Ok(bvh.statistics()));
    /// # Ok::<(), lookfrom_bvh::BuildError>(())
    /// ```
    pub fn validate(&self) -> Result<Statistics, Invalid> {
        validate(self)
    }
}

/// Checks the whole tree.
fn validate(bvh: &Bvh) -> Result<Statistics, Invalid> {
    let mut check = Check {
        bvh,
        nodes: vec![false; bvh.nodes.len()],
        blocks: vec![false; bvh.triangles.len()],
        leaves: vec![false; bvh.leaves.len()],
        spheres: vec![false; bvh.spheres.len()],
        procedurals: vec![false; bvh.procedurals.len()],
        capsules: vec![false; bvh.capsules.len()],
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
        ("block of spheres", &check.spheres),
        ("procedural", &check.procedurals),
        ("block of capsules", &check.capsules),
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

    let statistics = bvh.count(bvh.statistics.left_out);
    if statistics != bvh.statistics {
        return Err(Invalid(format!("counted {statistics:?}, but it says {:?}", bvh.statistics)));
    }
    if statistics.depth > LARGEST_DEPTH {
        return Err(Invalid(format!("{} levels, more than {LARGEST_DEPTH}", statistics.depth)));
    }
    Ok(statistics)
}

struct Check<'a> {
    bvh: &'a Bvh,
    nodes: Vec<bool>,
    blocks: Vec<bool>,
    leaves: Vec<bool>,
    spheres: Vec<bool>,
    procedurals: Vec<bool>,
    capsules: Vec<bool>,
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
        for (slot, bounds, content) in node.children() {
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
            Leaf::Spheres { block } => {
                mark(&mut self.spheres, block as usize, 1, "block of spheres")?;
                for item in bvh.spheres[block as usize].items() {
                    inside.unite(&item.shape.bounds());
                    self.ids.push((item.geometry, item.primitive));
                }
            }
            Leaf::Procedurals { first, count } => inside = self.procedurals(first, count)?,
            Leaf::Capsules { block, first, count } => {
                mark(&mut self.capsules, block as usize, 1, "block of capsules")?;
                inside = self.procedurals(first, count.into())?;
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

    fn procedurals(&mut self, first: u32, count: u32) -> Result<Aabb, Invalid> {
        let bvh = self.bvh;
        let mut inside = Aabb::EMPTY;
        for item in &bvh.procedurals[mark(&mut self.procedurals, first as usize, count, "procedural")?] {
            let Some(shapes) = bvh.shapes_of(item) else {
                return Err(Invalid(format!("geometry {} of an item is not procedural", item.geometry)));
            };
            inside.unite(&shapes.bounds(item.primitive));
            self.ids.push((item.geometry, item.primitive));
        }
        Ok(inside)
    }
}

/// Marks items as reached, and fails where they do not exist or were reached before.
fn mark(seen: &mut [bool], first: usize, count: u32, name: &str) -> Result<Range<usize>, Invalid> {
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
