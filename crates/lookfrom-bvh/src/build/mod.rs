//! From geometry to a tree.
//!
//! Geometry is copied as it is told, primitives that no ray can meet are left out, `sah` splits the rest in two again and
//! again, and `collapse` turns that binary tree into the wide one that rays walk.

mod collapse;
mod plan;
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
use crate::sphere::Sphere;
use crate::validate::Statistics;
use crate::vector::{cross, subtract, wide};

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

/// One thing that goes into the tree.
#[derive(Clone, Copy, Debug)]
struct Item {
    /// Padded.
    bounds: Aabb,
    kind: Kind,
    /// Number of the geometry; of an instance, its place in the list of usable instances.
    geometry: u32,
    primitive: u32,
}

/// What an item is. A leaf holds items of one kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Triangle,
    Sphere,
    Procedural,
    Instance,
}

impl Kind {
    /// How many fit into a leaf.
    fn leaf_capacity(self) -> usize {
        match self {
            Self::Triangle | Self::Sphere => 8,
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
        let mut corners = Vec::with_capacity(triangles.indices.len());
        for (triangle, indices) in triangles.indices.iter().enumerate() {
            let corner = |i: usize| triangles.positions.get(indices[i] as usize).copied();
            if let (Some(a), Some(b), Some(c)) = (corner(0), corner(1), corner(2)) {
                corners.push([a, b, c]);
                continue;
            }
            let positions = triangles.positions.len();
            let index = indices.iter().copied().find(|&i| i as usize >= positions).unwrap_or(NONE);
            let triangle = triangle as u32;
            self.error.get_or_insert(BuildError::IndexOutOfRange { geometry, triangle, index, positions });
            break;
        }
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
        let instances = self.usable_instances()?;
        let primitives = self.count() + instances.len() as u64;
        if primitives >= Child::LIMIT || self.geometries.len() as u64 >= u64::from(NONE) {
            return Err(BuildError::TooMany { primitives });
        }
        let mut statistics = Statistics::default();
        let (items, bounds) = self.items(&instances, &mut statistics);
        let mut references: Vec<sah::Reference> = items
            .iter()
            .enumerate()
            .map(|(index, item)| sah::Reference { bounds: item.bounds, item: index as u32 })
            .collect();
        let mut binary = sah::build(&mut references, &items, self.quality);
        if self.quality == Quality::Best
            && let Some((other, sorted)) = reinsert::reinsert(&binary, &references)
        {
            // A cheaper binary tree may make a dearer wide one, where leaves no longer fill up.
            let cost = |binary: &[sah::Binary], references: &[sah::Reference]| {
                plan::Plan::new(binary, references, &items).cost()
            };
            if cost(&other, &sorted) < cost(&binary, &references) {
                (binary, references) = (other, sorted);
            }
        }
        let mut bvh = collapse::collapse(&binary, &references, &items, &self.geometries, instances);
        bvh.set_bounds(bounds);
        bvh.statistics = Statistics { left_out: statistics.left_out, ..bvh.take_statistics() };
        Ok(bvh)
    }

    /// Number of primitives, instances aside.
    fn count(&self) -> u64 {
        self.geometries
            .iter()
            .map(|geometry| match geometry {
                Geometry::Triangles(corners) => corners.len() as u64,
                Geometry::Spheres(spheres) => spheres.len() as u64,
                Geometry::Procedural(shapes) => u64::from(shapes.count()),
            })
            .sum()
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

    /// Everything that rays can meet, and the box around it.
    fn items(&self, instances: &[Instance], statistics: &mut Statistics) -> (Vec<Item>, Aabb) {
        let mut items = Vec::with_capacity(self.count() as usize + instances.len());
        let mut all = Aabb::EMPTY;
        let mut add = |bounds: Aabb, usable: bool, kind, geometry: usize, primitive: usize| {
            if !usable || !bounds.is_valid() {
                statistics.left_out += 1;
                return;
            }
            all.unite(&bounds);
            let (geometry, primitive) = (geometry as u32, primitive as u32);
            items.push(Item { bounds: bounds.padded(), kind, geometry, primitive });
        };
        for (index, geometry) in self.geometries.iter().enumerate() {
            match geometry {
                Geometry::Triangles(corners) => {
                    for (primitive, corners) in corners.iter().enumerate() {
                        let bounds = Aabb::around(corners);
                        add(bounds, has_area(corners), Kind::Triangle, index, primitive);
                    }
                }
                Geometry::Spheres(spheres) => {
                    for (primitive, sphere) in spheres.iter().enumerate() {
                        add(sphere.bounds(), has_surface(sphere), Kind::Sphere, index, primitive);
                    }
                }
                Geometry::Procedural(shapes) => {
                    for primitive in 0..shapes.count() {
                        add(shapes.bounds(primitive), true, Kind::Procedural, index, primitive as usize);
                    }
                }
            }
        }
        for (place, instance) in instances.iter().enumerate() {
            add(instance.bounds(), true, Kind::Instance, place, instance.id as usize);
        }
        (items, all)
    }
}

/// Whether the corners are finite numbers and do not lie on a line.
pub(crate) fn has_area(corners: &[[f32; 3]; 3]) -> bool {
    if !corners.iter().flatten().all(|x| x.abs() <= LARGEST_COORDINATE) {
        return false;
    }
    let [a, b, c] = corners.map(wide);
    cross(subtract(b, a), subtract(c, a)).iter().any(|&x| x != 0.0)
}

/// Whether the sphere is finite and larger than a point.
pub(crate) fn has_surface(sphere: &Sphere) -> bool {
    sphere.radius > 0.0 && sphere.is_finite() && sphere.bounds().is_valid()
}
