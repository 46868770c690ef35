//! The tree: flat arrays of nodes, leaves and primitives.

use std::sync::Arc;

use crate::aabb::Aabb;
use crate::affine::Affine;
use crate::capsule::CapsuleBlock;
use crate::conservative::TriangleBlock;
use crate::item::{Leaf, ProceduralItem};
use crate::masks::Masks;
use crate::node::Node;
use crate::procedural::Procedural;
use crate::sphere::SphereBlock;
use crate::statistics::Statistics;
use lookfrom_simd::{Level, level};

mod fit;
mod instance;
mod moving;

pub(crate) use instance::Instance;
pub use moving::moment;
pub(crate) use moving::{Moment, Moving, Part};

/// A bounding volume hierarchy (BVH) for tracing rays. Made by a [`Builder`](crate::Builder); immutable, and shared
/// between threads.
///
/// The basic queries are methods: the closest hit, occlusion, and both for batches of [`Ray`](crate::Ray)s. [`Self::query`]
/// gives all others: all hits, masks and faces, origin primitives, observers, rays in f64.
///
/// ```
/// # use lookfrom_bvh::{Builder, Ray, Sphere};
/// # let mut builder = Builder::new();
/// # builder.spheres(&[Sphere { center: [0.0; 3], radius: 1.0 }]);
/// # let bvh = builder.build()?;
/// assert!(bvh.occluded(&Ray::new([0.0, 0.0, 3.0], [0.0, 0.0, -1.0])));
/// # Ok::<(), lookfrom_bvh::BuildError>(())
/// ```
#[derive(Debug)]
pub struct Bvh {
    /// All nodes, root first.
    pub(crate) nodes: Vec<Node>,
    pub(crate) triangles: Vec<TriangleBlock>,
    /// The leaves without triangles.
    pub(crate) leaves: Vec<Leaf>,
    /// The boxes of `leaves`, as stored in nodes.
    pub(crate) leaf_bounds: Vec<Aabb>,
    pub(crate) spheres: Vec<SphereBlock>,
    pub(crate) procedurals: Vec<ProceduralItem>,
    /// The capsules of thin procedural shapes.
    pub(crate) capsules: Vec<CapsuleBlock>,
    /// By geometry; `None` for all others.
    pub(crate) procedural_shapes: Vec<Option<Arc<dyn Procedural>>>,
    /// By id, as the builder numbered them; shared with the builder.
    pub(crate) instances: Arc<Vec<Instance>>,
    pub(crate) masks: Masks,
    /// The moving part, if there is one.
    pub(crate) moving: Option<Arc<Moving>>,
    pub(crate) bounds: Aabb,
    pub(crate) statistics: Statistics,
    /// The largest coordinate of a triangle.
    pub(crate) largest: f32,
    /// The SIMD level for tracing.
    pub(crate) level: Level,
}

impl Default for Bvh {
    /// The empty tree.
    fn default() -> Self {
        Self {
            nodes: Vec::new(),
            triangles: Vec::new(),
            leaves: Vec::new(),
            leaf_bounds: Vec::new(),
            spheres: Vec::new(),
            procedurals: Vec::new(),
            capsules: Vec::new(),
            procedural_shapes: Vec::new(),
            instances: Arc::default(),
            masks: Masks::default(),
            moving: None,
            bounds: Aabb::EMPTY,
            statistics: Statistics::default(),
            largest: 0.0,
            level: level(),
        }
    }
}

impl Bvh {
    /// The box around everything, at all times; [`Aabb::EMPTY`] for an empty tree.
    ///
    /// ```
    /// # use lookfrom_bvh::{Builder, Ray, Sphere};
    /// # let mut builder = Builder::new();
    /// # builder.spheres(&[Sphere { center: [0.0; 3], radius: 1.0 }]);
    /// # let bvh = builder.build()?;
    /// assert!(bvh.bounds().max[0] >= 1.0);
    /// # Ok::<(), lookfrom_bvh::BuildError>(())
    /// ```
    pub fn bounds(&self) -> Aabb {
        self.bounds
    }

    /// The map of an instance, world from object; of one that moves, at the time 0.
    ///
    /// # Panics
    /// If there is no such instance.
    ///
    /// ```
    /// # use lookfrom_bvh::{Affine, Builder};
    /// # use std::sync::Arc;
    /// # let mut builder = Builder::new();
    /// let up = Affine { translation: [0.0, 0.0, 1.0], ..Affine::IDENTITY };
    /// let instance = builder.instance(Arc::new(Builder::new().build()?), up);
    /// assert_eq!(builder.build()?.instance_map(instance), &up);
    /// # Ok::<(), lookfrom_bvh::BuildError>(())
    /// ```
    #[inline]
    pub fn instance_map(&self, instance: u32) -> &Affine {
        &self.instances[instance as usize].world_from_object
    }

    /// The map of an instance that moves ([`Builder::moving_instance`](crate::Builder::moving_instance), or an instance of a
    /// tree in which something moves) at a time, world from object; `None` for others.
    ///
    /// ```
    /// # use lookfrom_bvh::{Affine, Builder};
    /// # use std::sync::Arc;
    /// # let mut builder = Builder::new();
    /// let up = Affine { translation: [0.0, 0.0, 4.0], ..Affine::IDENTITY };
    /// let instance = builder.moving_instance(Arc::new(Builder::new().build()?), &[Affine::IDENTITY, up]);
    /// assert_eq!(builder.build()?.instance_map_at(instance, 0.5).unwrap().translation, [0.0, 0.0, 2.0]);
    /// # Ok::<(), lookfrom_bvh::BuildError>(())
    /// ```
    pub fn instance_map_at(&self, instance: u32, time: f32) -> Option<Affine> {
        self.moving.as_ref()?.map(instance, time)
    }

    /// Whether anything in the tree moves, so that queries depend on the time ([`Query::times`](crate::Query::times)).
    ///
    /// ```
    /// assert!(!lookfrom_bvh::Bvh::default().is_moving());
    /// ```
    pub fn is_moving(&self) -> bool {
        self.moving.is_some()
    }

    /// The tree of an instance, which others may share.
    ///
    /// ```
    /// # use std::sync::Arc;
    /// # use lookfrom_bvh::{Affine, Builder};
    /// let object = Arc::new(Builder::new().build()?);
    /// let mut builder = Builder::new();
    /// let instance = builder.instance(object.clone(), Affine::IDENTITY);
    /// assert!(Arc::ptr_eq(builder.build()?.instance_tree(instance), &object));
    /// # Ok::<(), lookfrom_bvh::BuildError>(())
    /// ```
    ///
    /// # Panics
    /// For the number of no instance.
    pub fn instance_tree(&self, instance: u32) -> &Arc<Self> {
        &self.instances[instance as usize].bvh
    }

    pub(crate) fn set_bounds(&mut self, bounds: Aabb) {
        self.bounds = bounds;
        self.largest = bounds.min.iter().chain(&bounds.max).fold(0.0, |largest, x| x.abs().max(largest));
    }

    /// The shapes that procedural items are of.
    #[inline(always)]
    pub(crate) fn shapes_of(&self, item: &ProceduralItem) -> Option<&dyn Procedural> {
        self.procedural_shapes[item.geometry as usize].as_deref()
    }

    /// Counts the content, beside which a number of primitives was left out.
    pub(crate) fn count(&self, left_out: usize) -> Statistics {
        Statistics { left_out, ..Statistics::of(&self.nodes, &self.triangles, &self.spheres, &self.leaves) }
    }

    /// Memory for tracing in bytes, without the trees of instances (which are shared) and without procedural
    /// shapes.
    ///
    /// ```
    /// # use lookfrom_bvh::{Builder, Ray, Sphere};
    /// # let mut builder = Builder::new();
    /// # builder.spheres(&[Sphere { center: [0.0; 3], radius: 1.0 }]);
    /// # let bvh = builder.build()?;
    /// assert!(bvh.memory() > 0);
    /// # Ok::<(), lookfrom_bvh::BuildError>(())
    /// ```
    pub fn memory(&self) -> usize {
        size_of::<Self>()
            + size_of_val(&*self.nodes)
            + size_of_val(&*self.triangles)
            + size_of_val(&*self.leaves)
            + size_of_val(&*self.leaf_bounds)
            + size_of_val(&*self.spheres)
            + size_of_val(&*self.procedurals)
            + size_of_val(&*self.capsules)
            + size_of_val(&*self.procedural_shapes)
            + size_of_val(&*self.instances)
            + self.masks.memory()
            + self.moving.as_ref().map_or(0, |moving| moving.memory())
    }

    /// Statistics of the tree without what moves, counted when it was built.
    ///
    /// ```
    /// # use lookfrom_bvh::{Builder, Ray, Sphere};
    /// # let mut builder = Builder::new();
    /// # builder.spheres(&[Sphere { center: [0.0; 3], radius: 1.0 }]);
    /// # let bvh = builder.build()?;
    /// assert_eq!(bvh.statistics().spheres, 1);
    /// # Ok::<(), lookfrom_bvh::BuildError>(())
    /// ```
    pub fn statistics(&self) -> Statistics {
        self.statistics
    }
}
