//! The tree and its basic queries. All others are in `query`.

use std::sync::Arc;

use crate::aabb::Aabb;
use crate::affine::Affine;
use crate::conservative::TriangleBlock;
use crate::instance::Instance;
use crate::masks::Masks;
use crate::node::Node;
use crate::procedural::Procedural;
use crate::query::Settings;
use crate::ray::{Hit, Ray};
use crate::sphere::Sphere;
use crate::validate::{Invalid, Statistics};
use crate::{batch, single};
use lookfrom_simd::{Level, level};

/// A bounding volume hierarchy (BVH) for tracing rays. Made by a [`Builder`](crate::Builder); immutable, and shared
/// between threads.
///
/// The basic queries are methods: the closest hit, occlusion, and both for batches of [`Ray`]s. [`Self::query`]
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
    pub(crate) spheres: Vec<SphereItem>,
    pub(crate) procedurals: Vec<ProceduralItem>,
    pub(crate) procedural_shapes: Vec<Arc<dyn Procedural>>,
    /// By id, as the builder numbered them; shared with the builder.
    pub(crate) instances: Arc<Vec<Instance>>,
    pub(crate) masks: Masks,
    pub(crate) bounds: Aabb,
    pub(crate) statistics: Statistics,
    /// The largest coordinate of a triangle.
    pub(crate) largest: f32,
    /// The SIMD level for tracing.
    pub(crate) level: Level,
}

/// The content of a leaf without triangles: a range of items in the array of their kind.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Leaf {
    Spheres { first: u32, count: u32 },
    Procedurals { first: u32, count: u32 },
    Instances { first: u32, count: u32 },
}

/// A sphere and its ids.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SphereItem {
    pub(crate) shape: Sphere,
    pub(crate) geometry: u32,
    pub(crate) primitive: u32,
}

/// One of a procedural's shapes: `shape` is the procedural's index in [`Bvh::procedural_shapes`].
#[derive(Clone, Copy, Debug)]
pub(crate) struct ProceduralItem {
    pub(crate) shape: u32,
    pub(crate) geometry: u32,
    pub(crate) primitive: u32,
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
            procedural_shapes: Vec::new(),
            instances: Arc::default(),
            masks: Masks::default(),
            bounds: Aabb::EMPTY,
            statistics: Statistics::default(),
            largest: 0.0,
            level: level(),
        }
    }
}

impl Bvh {
    /// The box around everything; [`Aabb::EMPTY`] for an empty tree.
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

    /// The map of an instance, world from object.
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

    pub(crate) fn set_bounds(&mut self, bounds: Aabb) {
        self.bounds = bounds;
        self.largest = bounds.min.iter().chain(&bounds.max).fold(0.0, |largest, x| x.abs().max(largest));
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
            + size_of_val(&*self.procedural_shapes)
            + size_of_val(&*self.instances)
            + self.masks.memory()
    }

    /// Statistics of the tree, counted when it was built.
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
        crate::validate::validate(self)
    }

    /// The hit with the smallest t in the ray's range, or [`Hit::MISS`]. Of several hits at equal t it is the one
    /// with the lowest ids: geometry outside of instances comes first, then by instance, geometry and primitive.
    ///
    /// ```
    /// use lookfrom_bvh::{Builder, Hit, Ray, Sphere};
    /// let mut builder = Builder::new();
    /// builder.spheres(&[Sphere { center: [0.0; 3], radius: 1.0 }]);
    /// let bvh = builder.build()?;
    /// assert_eq!(bvh.closest_hit(&Ray::new([0.0, 0.0, 3.0], [0.0, 0.0, -2.0])).t, 1.0);
    /// assert_eq!(bvh.closest_hit(&Ray::new([0.0, 0.0, 3.0], [0.0, 1.0, 0.0])), Hit::MISS);
    /// # Ok::<(), lookfrom_bvh::BuildError>(())
    /// ```
    pub fn closest_hit(&self, ray: &Ray) -> Hit {
        single::closest_hit_of_everything(self, ray)
    }

    /// True if anything is hit in the ray's range.
    ///
    /// ```
    /// # use lookfrom_bvh::{Builder, Ray, Sphere};
    /// # let mut builder = Builder::new();
    /// # builder.spheres(&[Sphere { center: [0.0; 3], radius: 1.0 }]);
    /// # let bvh = builder.build()?;
    /// let ray = Ray::new([0.0, 0.0, 3.0], [0.0, 0.0, -1.0]);
    /// assert!(bvh.occluded(&ray) && !bvh.occluded(&ray.with_t_max(2.0)));
    /// # Ok::<(), lookfrom_bvh::BuildError>(())
    /// ```
    pub fn occluded(&self, ray: &Ray) -> bool {
        single::occluded_by_everything(self, ray)
    }

    /// [`Self::closest_hit`] for each ray, on several threads where there are many. Coherent rays are traced in
    /// packets. The two slices should have equal lengths; the surplus of the longer one is ignored.
    ///
    /// ```
    /// # use lookfrom_bvh::{Builder, Hit, Ray, Sphere};
    /// # let mut builder = Builder::new();
    /// # builder.spheres(&[Sphere { center: [0.0; 3], radius: 1.0 }]);
    /// # let bvh = builder.build()?;
    /// let rays = [3.0, -3.0].map(|z| Ray::new([0.0, 0.0, z], [0.0, 0.0, -1.0]));
    /// let mut hits = [Hit::MISS; 2];
    /// bvh.closest_hits(&rays, &mut hits);
    /// assert_eq!(hits.map(|hit| hit.is_hit()), [true, false]);
    /// # Ok::<(), lookfrom_bvh::BuildError>(())
    /// ```
    pub fn closest_hits(&self, rays: &[Ray], hits: &mut [Hit]) {
        batch::closest_hits(&Settings::new(self), rays, hits);
    }

    /// [`Self::occluded`] for each ray, as [`Self::closest_hits`].
    ///
    /// ```
    /// # use lookfrom_bvh::{Builder, Ray, Sphere};
    /// # let mut builder = Builder::new();
    /// # builder.spheres(&[Sphere { center: [0.0; 3], radius: 1.0 }]);
    /// # let bvh = builder.build()?;
    /// let rays = [3.0, -3.0].map(|z| Ray::new([0.0, 0.0, z], [0.0, 0.0, -1.0]));
    /// let mut occluded = [false; 2];
    /// bvh.occluded_many(&rays, &mut occluded);
    /// assert_eq!(occluded, [true, false]);
    /// # Ok::<(), lookfrom_bvh::BuildError>(())
    /// ```
    pub fn occluded_many(&self, rays: &[Ray], occluded: &mut [bool]) {
        batch::occluded_many(&Settings::new(self), rays, occluded);
    }
}
