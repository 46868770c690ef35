//! From geometry to a tree.
//!
//! Geometry is copied as it is told, primitives that no ray can meet are left out, `sah` splits the rest in two again and
//! again, and `collapse` turns that binary tree into the wide one that rays walk.

mod collapse;
mod cut;
mod parallel;
mod plan;
mod reference;
mod reinsert;
mod sah;

use std::fmt;
use std::sync::Arc;

use crate::Bvh;
use crate::aabb::{Aabb, LARGEST_COORDINATE};
use crate::affine::Affine;
use crate::instance::Instance;
use crate::node::Child;
use crate::procedural::Procedural;
use crate::ray::NONE;
use crate::simd::Level;
use crate::sphere::Sphere;
use crate::validate::Statistics;
use crate::vector::{cross, subtract, wide};

use plan::Plan;
use reference::Reference;

/// Triangles over shared corners, borrowed while the builder copies them. Rays hit both faces.
#[derive(Clone, Copy, Debug)]
pub struct Triangles<'a> {
    /// Corners.
    pub positions: &'a [[f32; 3]],
    /// Three corners a triangle.
    pub indices: &'a [[u32; 3]],
}

/// How much time to spend on the tree. The answers to rays do not depend on it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Quality {
    /// Built soonest.
    Fast,
    /// For most purposes.
    #[default]
    Balanced,
    /// Traced soonest.
    Best,
}

/// What a tree cannot be built from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum BuildError {
    /// A triangle names a corner that is not there.
    IndexOutOfRange {
        /// The geometry, as the builder numbered it.
        geometry: u32,
        /// The triangle in it.
        triangle: u32,
        /// What it names.
        index: u32,
        /// How many positions there are.
        positions: usize,
    },
    /// An instanced tree holds instances itself; there are two levels only.
    NestedInstance {
        /// The instance, as the builder numbered it.
        instance: u32,
    },
    /// A matrix has no inverse, or its entries or its inverse's are out of range.
    SingularMatrix {
        /// The instance, as the builder numbered it.
        instance: u32,
    },
    /// Ids are 32 bits wide.
    TooMany {
        /// How many primitives there are.
        primitives: u64,
    },
}

impl fmt::Display for BuildError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::IndexOutOfRange { geometry, triangle, index, positions } => write!(
                f,
                "triangle {triangle} of geometry {geometry} names position {index}, but there are {positions}; \
                 indices count from 0"
            ),
            Self::NestedInstance { instance } => write!(
                f,
                "the tree of instance {instance} holds instances itself, but there are two levels only; \
                 put its instances into the outer tree, with their maps multiplied"
            ),
            Self::SingularMatrix { instance } => write!(
                f,
                "the matrix of instance {instance} has no usable inverse; scales need to be finite and other than 0"
            ),
            Self::TooMany { primitives } => {
                write!(
                    f,
                    "{primitives} primitives, but ids reach only to {}; use several trees",
                    Child::LIMIT - 1
                )
            }
        }
    }
}

impl std::error::Error for BuildError {}

/// Collects geometry and builds a [`Bvh`] from it.
///
/// Geometries are numbered from 0 in the order of the calls, instances from 0 on their own.
///
/// ```
/// use lookfrom_bvh::{Affine, Builder, Quality, Ray, Sphere};
/// use std::sync::Arc;
///
/// let mut ball = Builder::new();
/// ball.spheres(&[Sphere { center: [0.0; 3], radius: 1.0 }]);
/// let ball = Arc::new(ball.build()?);
///
/// let mut scene = Builder::new();
/// scene.quality(Quality::Best);
/// for x in 0..3 {
///     scene.instance(ball.clone(), Affine { translation: [4.0 * f64::from(x), 0.0, 0.0], ..Affine::IDENTITY });
/// }
/// let hit = scene.build()?.closest_hit(&Ray::new([4.0, 0.0, 5.0], [0.0, 0.0, -1.0]));
/// assert_eq!((hit.instance, hit.geometry, hit.primitive, hit.t), (1, 0, 0, 4.0));
/// # Ok::<(), lookfrom_bvh::BuildError>(())
/// ```
#[derive(Debug, Default)]
pub struct Builder {
    quality: Quality,
    geometries: Vec<Geometry>,
    instances: Vec<(Arc<Bvh>, Affine)>,
    error: Option<BuildError>,
}

/// What the builder was told.
#[derive(Debug)]
enum Geometry {
    /// Three corners a triangle.
    Triangles(Vec<[[f32; 3]; 3]>),
    Spheres(Vec<Sphere>),
    Procedural(Arc<dyn Procedural>),
}

impl Geometry {
    fn kind(&self) -> Kind {
        match self {
            Self::Triangles(_) => Kind::Triangle,
            Self::Spheres(_) => Kind::Sphere,
            Self::Procedural(_) => Kind::Procedural,
        }
    }

    fn count(&self) -> usize {
        match self {
            Self::Triangles(corners) => corners.len(),
            Self::Spheres(spheres) => spheres.len(),
            Self::Procedural(shapes) => shapes.count() as usize,
        }
    }

    fn bounds(&self, primitive: u32) -> Aabb {
        match self {
            Self::Triangles(corners) => Aabb::around(&corners[primitive as usize]),
            Self::Spheres(spheres) => spheres[primitive as usize].bounds(),
            Self::Procedural(shapes) => shapes.bounds(primitive),
        }
    }

    /// Whether a ray can meet a primitive, its box aside.
    fn is_usable(&self, primitive: u32) -> bool {
        match self {
            Self::Triangles(corners) => has_area(&corners[primitive as usize]),
            Self::Spheres(spheres) => has_surface(&spheres[primitive as usize]),
            Self::Procedural(_) => true,
        }
    }
}

/// All that may go into the tree, numbered: the primitives of one geometry after the other, then the instances.
struct Primitives<'a> {
    geometries: &'a [Geometry],
    instances: Vec<Instance>,
    /// The first number of each geometry, and of the instances.
    first: Vec<u32>,
}

impl<'a> Primitives<'a> {
    fn new(geometries: &'a [Geometry], instances: Vec<Instance>) -> Result<Self, BuildError> {
        let mut primitives = 0;
        let mut first = vec![0];
        for geometry in geometries {
            primitives += geometry.count() as u64;
            first.push(primitives as u32);
        }
        primitives += instances.len() as u64;
        if primitives >= Child::LIMIT || geometries.len() as u64 >= u64::from(NONE) {
            return Err(BuildError::TooMany { primitives });
        }
        Ok(Self { geometries, instances, first })
    }

    fn count(&self) -> usize {
        self.first[self.geometries.len()] as usize + self.instances.len()
    }

    /// Geometry and primitive; of an instance, the number of geometries and its place.
    fn ids(&self, number: u32) -> (u32, u32) {
        let geometry = self.first.partition_point(|&first| first <= number) - 1;
        (geometry as u32, number - self.first[geometry])
    }

    fn bounds(&self, number: u32) -> Aabb {
        let (geometry, primitive) = self.ids(number);
        match self.geometries.get(geometry as usize) {
            Some(geometry) => geometry.bounds(primitive),
            None => self.instances[primitive as usize].bounds(),
        }
    }

    /// What is to be sorted, with a padded box; an empty one where no ray can meet the primitive.
    fn reference(&self, number: u32) -> Reference {
        let (geometry, primitive) = self.ids(number);
        let (usable, kind) = match self.geometries.get(geometry as usize) {
            Some(geometry) => (geometry.is_usable(primitive), geometry.kind()),
            None => (true, Kind::Instance),
        };
        let bounds = self.bounds(number);
        let bounds = if usable && bounds.is_valid() { bounds.padded() } else { Aabb::EMPTY };
        Reference::new(&bounds, number, kind)
    }

    /// Everything that rays can meet.
    fn references(&self) -> Vec<Reference> {
        let make = |number| self.reference(number as u32);
        let mut references = parallel::collect(self.count(), parallel::GRAIN, make);
        let is_left_out = |reference: &Reference| reference.bounds().is_empty();
        if parallel::chunks(&references, |references| references.iter().any(is_left_out)).contains(&true) {
            references.retain(|reference| !is_left_out(reference));
        }
        references
    }

    /// The box around what is referred to.
    fn bounds_of(&self, references: &[Reference]) -> Aabb {
        let chunks = parallel::chunks(references, |references| {
            let mut bounds = Aabb::EMPTY;
            references.iter().for_each(|reference| bounds.unite(&self.bounds(reference.number())));
            bounds
        });
        chunks.iter().fold(Aabb::EMPTY, |mut all, bounds| {
            all.unite(bounds);
            all
        })
    }
}

/// What a primitive is. A leaf holds those of one kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Triangle,
    Sphere,
    Procedural,
    Instance,
}

impl Kind {
    /// The most of the numbers below.
    const MOST_IN_A_LEAF: usize = 8;

    /// How many fit into a leaf.
    fn leaf_capacity(self) -> usize {
        match self {
            Self::Triangle | Self::Sphere => Self::MOST_IN_A_LEAF,
            Self::Procedural | Self::Instance => 1,
        }
    }
}

impl Builder {
    /// A builder of nothing yet, with [`Quality::Balanced`].
    pub fn new() -> Self {
        Self::default()
    }

    /// How much time to spend on the tree.
    pub fn quality(&mut self, quality: Quality) -> &mut Self {
        self.quality = quality;
        self
    }

    /// Adds triangles and returns their geometry's number. An index out of range makes [`Self::build`] fail.
    pub fn triangles(&mut self, triangles: Triangles<'_>) -> u32 {
        let geometry = self.geometries.len() as u32;
        let Triangles { positions, indices } = triangles;
        let out_of_range =
            |indices: &[u32; 3]| indices.iter().copied().find(|&i| i as usize >= positions.len());
        let firsts = parallel::chunks(indices, |indices| indices.iter().find_map(out_of_range));
        let corners = if firsts.iter().all(Option::is_none) {
            parallel::collect(indices.len(), parallel::GRAIN, |i| indices[i].map(|i| positions[i as usize]))
        } else {
            for (triangle, indices) in indices.iter().enumerate() {
                if let Some(index) = out_of_range(indices) {
                    let (triangle, positions) = (triangle as u32, positions.len());
                    self.error.get_or_insert(BuildError::IndexOutOfRange {
                        geometry,
                        triangle,
                        index,
                        positions,
                    });
                    break;
                }
            }
            Vec::new()
        };
        self.geometries.push(Geometry::Triangles(corners));
        geometry
    }

    /// Adds spheres and returns their geometry's number.
    pub fn spheres(&mut self, spheres: &[Sphere]) -> u32 {
        self.geometries.push(Geometry::Spheres(spheres.to_vec()));
        self.geometries.len() as u32 - 1
    }

    /// Adds shapes that the caller defines and returns their geometry's number.
    pub fn procedural(&mut self, shapes: Arc<dyn Procedural>) -> u32 {
        self.geometries.push(Geometry::Procedural(shapes));
        self.geometries.len() as u32 - 1
    }

    /// Places another tree in this one and returns the instance's number. A tree that holds instances itself, or a
    /// map without an inverse, makes [`Self::build`] fail.
    pub fn instance(&mut self, bvh: Arc<Bvh>, world_from_object: Affine) -> u32 {
        self.instances.push((bvh, world_from_object));
        self.instances.len() as u32 - 1
    }

    /// Builds the tree.
    ///
    /// Primitives that no ray can meet are left out and counted in [`Statistics::left_out`]: coordinates that are NaN,
    /// infinite or beyond 2¹⁰⁰, triangles without area, radii that are not positive, empty boxes, empty instances.
    ///
    /// # Errors
    /// See [`BuildError`].
    pub fn build(&self) -> Result<Bvh, BuildError> {
        if let Some(error) = &self.error {
            return Err(error.clone());
        }
        let primitives = Primitives::new(&self.geometries, self.usable_instances()?)?;
        let mut references = primitives.references();
        let bounds = primitives.bounds_of(&references);
        let left_out = primitives.count() - references.len();
        let mut binary = sah::build(&mut references, self.quality, Level::new());
        let mut plan = Plan::new(&binary, &references);
        if self.quality == Quality::Best
            && let Some((other, sorted)) = reinsert::reinsert(&binary, &references)
        {
            // A cheaper binary tree may make a dearer wide one, where leaves no longer fill up.
            let other_plan = Plan::new(&other, &sorted);
            if other_plan.cost() < plan.cost() {
                (binary, references, plan) = (other, sorted, other_plan);
            }
        }
        let mut bvh = collapse::collapse(&binary, &plan, &references, &primitives);
        bvh.set_bounds(bounds);
        bvh.statistics = Statistics { left_out, ..bvh.take_statistics() };
        Ok(bvh)
    }

    fn usable_instances(&self) -> Result<Vec<Instance>, BuildError> {
        let mut usable = Vec::with_capacity(self.instances.len());
        for (id, (bvh, map)) in self.instances.iter().enumerate() {
            let instance = id as u32;
            if !bvh.instances.is_empty() {
                return Err(BuildError::NestedInstance { instance });
            }
            let made = Instance::new(bvh.clone(), *map, instance);
            usable.push(made.ok_or(BuildError::SingularMatrix { instance })?);
        }
        Ok(usable)
    }
}

/// Whether the corners are finite numbers and do not lie on a line.
pub(crate) fn has_area(corners: &[[f32; 3]; 3]) -> bool {
    // (A sum of magnitudes is compared once, and is NaN where one of them is.)
    let sum: f32 = corners.iter().flatten().map(|x| x.abs()).sum();
    let is_finite =
        sum <= LARGEST_COORDINATE || corners.iter().flatten().all(|x| x.abs() <= LARGEST_COORDINATE);
    let [a, b, c] = corners.map(wide);
    is_finite && cross(subtract(b, a), subtract(c, a)) != [0.0; 3]
}

/// Whether the sphere is finite and larger than a point.
pub(crate) fn has_surface(sphere: &Sphere) -> bool {
    sphere.radius > 0.0 && sphere.is_finite() && sphere.bounds().is_valid()
}
