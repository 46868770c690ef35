//! Construction of the tree from geometry.
//!
//! Geometry is copied as it is added, primitives that no ray can hit are left out, `sah` splits the rest
//! recursively, and `collapse` turns that binary tree into the wide one that rays traverse.

mod collapse;
mod masks;
mod moving;
mod plan;
mod primitives;
mod reference;
mod reinsert;
mod sah;
mod split;

use std::collections::HashMap;
use std::fmt;
use std::sync::Arc;

use crate::aabb::Aabb;
use crate::affine::Affine;
use crate::bvh::{Bvh, Instance, Moving};
use crate::masks::Masks;
use crate::node::Child;
use crate::parallel;
use crate::procedural::Procedural;
use crate::sphere::Sphere;
use lookfrom_simd::level;

use plan::Plan;
use primitives::{Geometry, Part, Primitives};
pub(crate) use primitives::{has_area, has_surface};

/// Triangles with shared corners, borrowed while the builder copies them. Rays hit both faces.
///
/// ```
/// use lookfrom_bvh::{Builder, Triangles};
/// let positions = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
/// let mut builder = Builder::new();
/// builder.triangles(Triangles { positions: &positions, indices: &[[0, 1, 2]] });
/// assert_eq!(builder.build()?.statistics().triangles, 1);
/// # Ok::<(), lookfrom_bvh::BuildError>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Triangles<'a> {
    /// Corners.
    pub positions: &'a [[f32; 3]],
    /// Corner indices of each triangle.
    pub indices: &'a [[u32; 3]],
}

/// Build quality: time spent on the tree. The results of queries do not depend on it.
///
/// ```
/// use lookfrom_bvh::{Builder, Quality, Sphere};
/// let mut builder = Builder::new();
/// builder.spheres(&[Sphere { center: [0.0; 3], radius: 1.0 }]);
/// let bvh = builder.quality(Quality::Fast).build()?;
/// # assert_eq!(bvh.statistics().spheres, 1);
/// # Ok::<(), lookfrom_bvh::BuildError>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Quality {
    /// Fastest build.
    Fast,
    /// For most purposes.
    #[default]
    Balanced,
    /// Fastest traversal.
    Best,
}

/// Reason why a tree cannot be built.
///
/// ```
/// use lookfrom_bvh::{Builder, BuildError, Triangles};
/// let positions = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
/// let mut builder = Builder::new();
/// builder.triangles(Triangles { positions: &positions, indices: &[[1, 2, 3]] });
/// let error = builder.build().unwrap_err();
/// assert_eq!(error, BuildError::IndexOutOfRange { geometry: 0, triangle: 0, index: 3, positions: 3 });
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum BuildError {
    /// Something moves whose number of times does not fit that of all else that moves, or is less than two.
    TimeCount {
        /// Its number.
        times: usize,
        /// The number of all else.
        expected: usize,
    },
    /// A geometry that moves has different numbers of positions.
    PositionCount {
        /// The geometry.
        geometry: u32,
    },
    /// A triangle refers to a position that does not exist.
    IndexOutOfRange {
        /// The geometry, as the builder numbered it.
        geometry: u32,
        /// The triangle in it.
        triangle: u32,
        /// The index.
        index: u32,
        /// Number of positions.
        positions: usize,
    },
    /// An instanced tree contains instances itself; only two levels are supported.
    NestedInstance {
        /// The instance, as the builder numbered it.
        instance: u32,
    },
    /// A matrix has no inverse, or entries of it or its inverse are out of range.
    SingularMatrix {
        /// The instance, as the builder numbered it.
        instance: u32,
    },
    /// A mask is for a geometry that does not exist.
    NoSuchGeometry {
        /// The number of the missing geometry.
        geometry: u32,
        /// Number of geometries at the time.
        geometries: usize,
    },
    /// A mask is for an instance that does not exist.
    NoSuchInstance {
        /// The number of the missing instance.
        instance: u32,
        /// Number of instances at the time.
        instances: usize,
    },
    /// The number of masks differs from the number of primitives.
    MaskCount {
        /// The geometry, as the builder numbered it.
        geometry: u32,
        /// Number of masks.
        masks: usize,
        /// Number of primitives in the geometry.
        primitives: u64,
    },
    /// Too many primitives for 32-bit ids.
    TooMany {
        /// Number of primitives.
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
            Self::NoSuchGeometry { geometry, geometries } => write!(
                f,
                "a mask is for geometry {geometry}, but there are {geometries}, counted from 0; add the geometry first"
            ),
            Self::NoSuchInstance { instance, instances } => write!(
                f,
                "a mask is for instance {instance}, but there are {instances}, counted from 0; add the instance first"
            ),
            Self::MaskCount { geometry, masks, primitives } => {
                write!(f, "geometry {geometry} has {primitives} primitives, but {masks} masks; give each one")
            }
            Self::TimeCount { times, expected } => write!(
                f,
                "positions or maps at {times} times, where {expected} are expected; all triangles that move in a tree have the \
                 same number, at least 2, and instances that, too, or all else 2, 3, 5, 9 …"
            ),
            Self::PositionCount { geometry } => {
                write!(
                    f,
                    "geometry {geometry} has different numbers of positions at its times; give each vertex one"
                )
            }
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
    instances: Arc<Vec<Instance>>,
    masks: Masks,
    /// The number of times of what moves, and was added first.
    times: Option<usize>,
    /// The number of times of all triangles that move.
    triangle_times: Option<usize>,
    /// The maps of instances that move, by id.
    motions: HashMap<u32, Box<[Affine]>>,
    error: Option<BuildError>,
}

impl Builder {
    /// An empty builder, with [`Quality::Balanced`].
    ///
    /// ```
    /// use lookfrom_bvh::{Aabb, Builder};
    /// assert_eq!(Builder::new().build()?.bounds(), Aabb::EMPTY);
    /// # Ok::<(), lookfrom_bvh::BuildError>(())
    /// ```
    pub fn new() -> Self {
        Self::default()
    }

    /// Sets the build quality.
    ///
    /// ```
    /// use lookfrom_bvh::{Builder, Quality};
    /// let bvh = Builder::new().quality(Quality::Best).build()?;
    /// # assert!(bvh.bounds().is_empty());
    /// # Ok::<(), lookfrom_bvh::BuildError>(())
    /// ```
    pub fn quality(&mut self, quality: Quality) -> &mut Self {
        self.quality = quality;
        self
    }

    /// Adds triangles and returns their geometry's number. An index out of range makes [`Self::build`] fail.
    ///
    /// ```
    /// use lookfrom_bvh::{Builder, Triangles};
    /// let positions = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    /// let mut builder = Builder::new();
    /// let triangles = Triangles { positions: &positions, indices: &[[0, 1, 2]] };
    /// assert_eq!((builder.triangles(triangles), builder.triangles(triangles)), (0, 1));
    /// ```
    pub fn triangles(&mut self, triangles: Triangles<'_>) -> u32 {
        let corners = self.corners(triangles);
        self.geometries.push(Geometry::Triangles(corners));
        self.geometries.len() as u32 - 1
    }

    /// The corners of the triangles of the next geometry; none where an index is out of range.
    fn corners(&mut self, Triangles { positions, indices }: Triangles<'_>) -> Vec<[[f32; 3]; 3]> {
        let out_of_range =
            |indices: &[u32; 3]| indices.iter().copied().find(|&i| i as usize >= positions.len());
        let is_wrong = |indices: &[[u32; 3]]| indices.iter().any(|indices| out_of_range(indices).is_some());
        if parallel::chunks(indices, is_wrong).contains(&true) {
            let mut wrong =
                indices.iter().enumerate().filter_map(|(i, indices)| Some((i, out_of_range(indices)?)));
            if let Some((triangle, index)) = wrong.next() {
                let (geometry, triangle) = (self.geometries.len() as u32, triangle as u32);
                let positions = positions.len();
                self.fail(BuildError::IndexOutOfRange { geometry, triangle, index, positions });
            }
            return Vec::new();
        }
        parallel::collect(indices.len(), parallel::GRAIN, |i| indices[i].map(|i| positions[i as usize]))
    }

    /// Adds spheres and returns their geometry's number.
    ///
    /// ```
    /// use lookfrom_bvh::{Builder, Sphere};
    /// let mut builder = Builder::new();
    /// assert_eq!(builder.spheres(&[Sphere { center: [0.0; 3], radius: 1.0 }]), 0);
    /// ```
    pub fn spheres(&mut self, spheres: &[Sphere]) -> u32 {
        self.geometries.push(Geometry::Spheres(spheres.to_vec()));
        self.geometries.len() as u32 - 1
    }

    /// Adds procedural shapes and returns their geometry's number.
    ///
    /// ```
    /// use lookfrom_bvh::{Aabb, Builder, Procedural, ProceduralHit, Ray};
    /// use std::sync::Arc;
    ///
    /// /// Everything above the plane z = 0 counts as a wall there. (See [`Procedural`] for a whole example.)
    /// #[derive(Debug)]
    /// struct Floor;
    ///
    /// impl Procedural for Floor {
    ///     fn count(&self) -> u32 {
    ///         1
    ///     }
    ///     fn bounds(&self, _: u32) -> Aabb {
    ///         Aabb { min: [-9.0, -9.0, 0.0], max: [9.0, 9.0, 0.0] }
    ///     }
    ///     fn intersect(&self, _: u32, ray: &Ray) -> Option<ProceduralHit> {
    ///         let t = -ray.origin[2] / ray.direction[2];
    ///         (ray.t_min < t && t < ray.t_max).then_some(ProceduralHit { t, u: 0.0, v: 0.0 })
    ///     }
    /// }
    ///
    /// let mut builder = Builder::new();
    /// assert_eq!(builder.procedural(Arc::new(Floor)), 0);
    /// ```
    pub fn procedural(&mut self, shapes: Arc<dyn Procedural>) -> u32 {
        self.geometries.push(Geometry::Procedural(shapes));
        self.geometries.len() as u32 - 1
    }

    /// Adds an instance of another tree and returns the instance's number. A tree that contains instances itself,
    /// or a map without an inverse, makes [`Self::build`] fail.
    ///
    /// ```
    /// use lookfrom_bvh::{Affine, Builder, Ray, Sphere};
    /// use std::sync::Arc;
    /// let mut ball = Builder::new();
    /// ball.spheres(&[Sphere { center: [0.0; 3], radius: 1.0 }]);
    /// let mut scene = Builder::new();
    /// let up = Affine { translation: [0.0, 0.0, 5.0], ..Affine::IDENTITY };
    /// assert_eq!(scene.instance(Arc::new(ball.build()?), up), 0);
    /// assert_eq!(scene.build()?.closest_hit(&Ray::new([0.0; 3], [0.0, 0.0, 1.0])).t, 4.0);
    /// # Ok::<(), lookfrom_bvh::BuildError>(())
    /// ```
    pub fn instance(&mut self, bvh: Arc<Bvh>, world_from_object: Affine) -> u32 {
        let instance = self.instances.len() as u32;
        let is_nested = !bvh.instances.is_empty();
        match Instance::new(bvh, world_from_object) {
            Some(made) if !is_nested => Arc::make_mut(&mut self.instances).push(made),
            Some(_) => self.fail(BuildError::NestedInstance { instance }),
            None => self.fail(BuildError::SingularMatrix { instance }),
        }
        instance
    }

    /// Makes [`Self::build`] fail.
    fn fail(&mut self, error: BuildError) {
        self.error.get_or_insert(error);
    }

    /// Builds the tree.
    ///
    /// Primitives that no ray can hit are left out and counted in
    /// [`Statistics::left_out`](crate::Statistics::left_out): coordinates that are
    /// NaN, infinite or beyond 2¹⁰⁰, triangles without area, radii that are not positive, empty boxes, empty
    /// instances.
    ///
    /// # Errors
    /// See [`BuildError`].
    ///
    /// ```
    /// use lookfrom_bvh::{Builder, Sphere};
    /// let mut builder = Builder::new();
    /// builder.spheres(&[Sphere { center: [0.0; 3], radius: 1.0 }, Sphere { center: [f32::NAN; 3], radius: 1.0 }]);
    /// let statistics = builder.build()?.statistics();
    /// assert_eq!((statistics.spheres, statistics.left_out), (1, 1));
    /// # Ok::<(), lookfrom_bvh::BuildError>(())
    /// ```
    pub fn build(&self) -> Result<Bvh, BuildError> {
        if let Some(error) = &self.error {
            return Err(error.clone());
        }
        let (maps, times) = self.maps();
        let (mut bvh, mut bounds) = self.part(Part::Standing, &maps)?;
        if let Some(times) = times {
            let (topology, _) = self.part(Part::Moving, &maps)?;
            let corners =
                |time: usize, (geometry, primitive): (u32, u32)| match &self.geometries[geometry as usize] {
                    Geometry::MovingTriangles(times) => times[time][primitive as usize],
                    _ => [[0.0; 3]; 3],
                };
            let moving = Moving::new(topology, &self.instances, maps, times, corners);
            bounds.unite(&moving.bounds);
            bvh.moving = Some(Arc::new(moving));
        }
        bvh.set_bounds(bounds);
        bvh.instances = self.instances.clone();
        bvh.masks = self.masks.clone();
        Ok(bvh)
    }

    /// The tree over what stands still, or over the boxes of what moves, and the box around that.
    fn part(&self, part: Part, maps: &[Box<[Affine]>]) -> Result<(Bvh, Aabb), BuildError> {
        let primitives = Primitives::new((&self.geometries, &self.instances), maps, part)?;
        let mut references = primitives.references();
        let bounds = primitives.bounds_of(&references);
        let left_out = primitives.count_in_part() - references.len();
        let mut binary = sah::build(&mut references, self.quality, level());
        let mut plan = Plan::new(&binary, &references);
        if self.quality == Quality::Best
            && let Some((other, sorted)) = reinsert::reinsert(&binary, &references)
        {
            // A cheaper binary tree may give a more expensive wide one, where leaves are no longer full.
            let other_plan = Plan::new(&other, &sorted);
            if other_plan.cost() < plan.cost() {
                (binary, references, plan) = (other, sorted, other_plan);
            }
        }
        let mut bvh = collapse::collapse(&binary, &plan, &references, &primitives);
        bvh.statistics = bvh.count(left_out);
        Ok((bvh, bounds))
    }
}
