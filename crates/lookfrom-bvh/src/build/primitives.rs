//! The primitives of a tree: everything added to the builder, with a number and a box each.

use std::sync::Arc;

use crate::aabb::{Aabb, LARGEST_COORDINATE};
use crate::affine::Affine;
use crate::bvh::Instance;
use crate::conservative::BLOCK;
use crate::node::Child;
use crate::parallel;
use crate::procedural::Procedural;
use crate::ray::NONE;
use crate::sphere::Sphere;
use crate::vector::{cross, subtract, wide};

use super::BuildError;
use super::reference::Reference;

/// A geometry that was added to the builder.
#[derive(Debug)]
pub(super) enum Geometry {
    /// Three corners per triangle.
    Triangles(Vec<[[f32; 3]; 3]>),
    /// Three corners per triangle, for each time.
    MovingTriangles(Vec<Vec<[[f32; 3]; 3]>>),
    Spheres(Vec<Sphere>),
    Procedural(Arc<dyn Procedural>),
}

impl Geometry {
    fn kind(&self) -> Kind {
        match self {
            Self::Triangles(_) | Self::MovingTriangles(_) => Kind::Triangle,
            Self::Spheres(_) => Kind::Sphere,
            Self::Procedural(shapes) if shapes.count() > 0 && shapes.capsule(0).is_some() => Kind::Thin,
            Self::Procedural(_) => Kind::Procedural,
        }
    }

    pub(super) fn count(&self) -> usize {
        match self {
            Self::Triangles(corners) => corners.len(),
            Self::MovingTriangles(times) => times.first().map_or(0, Vec::len),
            Self::Spheres(spheres) => spheres.len(),
            Self::Procedural(shapes) => shapes.count() as usize,
        }
    }

    fn bounds(&self, primitive: u32) -> Aabb {
        match self {
            Self::Triangles(corners) => Aabb::around(&corners[primitive as usize]),
            Self::MovingTriangles(times) => {
                around_all(times.iter().map(|at| Aabb::around(&at[primitive as usize])))
            }
            Self::Spheres(spheres) => spheres[primitive as usize].bounds(),
            Self::Procedural(shapes) => shapes.bounds(primitive),
        }
    }

    /// True if a ray can hit a primitive, at any time, apart from its box.
    fn is_usable(&self, primitive: u32) -> bool {
        match self {
            Self::Triangles(corners) => has_area(&corners[primitive as usize]),
            Self::MovingTriangles(times) => times.iter().any(|at| has_area(&at[primitive as usize])),
            Self::Spheres(spheres) => has_surface(&spheres[primitive as usize]),
            Self::Procedural(_) => true,
        }
    }
}

/// The part of a tree that is built: what stands still, or what moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Part {
    Standing,
    Moving,
}

/// The box around boxes at several times.
fn around_all(boxes: impl Iterator<Item = Aabb>) -> Aabb {
    boxes.fold(Aabb::EMPTY, |mut all, bounds| {
        all.unite(&bounds);
        all
    })
}

/// All candidates for the tree, numbered: the primitives of one geometry after the other, then the instances.
pub(super) struct Primitives<'a> {
    pub(super) geometries: &'a [Geometry],
    pub(super) instances: &'a [Instance],
    /// The maps of instances that move, by id.
    maps: &'a [Box<[Affine]>],
    part: Part,
    /// The first number of each geometry, and of the instances.
    first: Vec<u32>,
    /// The kind of each geometry.
    kinds: Vec<Kind>,
}

impl<'a> Primitives<'a> {
    pub(super) fn new(
        (geometries, instances): (&'a [Geometry], &'a [Instance]),
        maps: &'a [Box<[Affine]>],
        part: Part,
    ) -> Result<Self, BuildError> {
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
        let kinds = geometries.iter().map(Geometry::kind).collect();
        Ok(Self { geometries, instances, maps, part, first, kinds })
    }

    pub(super) fn count(&self) -> usize {
        self.first[self.geometries.len()] as usize + self.instances.len()
    }

    /// The number of candidates in the part that is built.
    pub(super) fn count_in_part(&self) -> usize {
        let moving =
            self.geometries.iter().filter(|geometry| matches!(geometry, Geometry::MovingTriangles(_)));
        let moving = moving.map(Geometry::count).sum::<usize>()
            + self.maps.iter().filter(|maps| !maps.is_empty()).count();
        match self.part {
            Part::Standing => self.count() - moving,
            Part::Moving => moving,
        }
    }

    /// Geometry and primitive; for an instance, the number of geometries and the instance's index.
    pub(super) fn ids(&self, number: u32) -> (u32, u32) {
        let geometry = self.first.partition_point(|&first| first <= number) - 1;
        (geometry as u32, number - self.first[geometry])
    }

    fn bounds(&self, number: u32) -> Aabb {
        let (geometry, primitive) = self.ids(number);
        match self.geometries.get(geometry as usize) {
            Some(geometry) => geometry.bounds(primitive),
            None => match self.maps.get(primitive as usize) {
                Some(maps) if !maps.is_empty() => {
                    let object = &self.instances[primitive as usize].bvh;
                    around_all(maps.iter().map(|map| object.bounds_under(map)))
                }
                _ => self.instances[primitive as usize].bounds(),
            },
        }
    }

    /// Whether a primitive is in the part of the tree that is built.
    fn is_in_part(&self, number: u32) -> bool {
        let (geometry, primitive) = self.ids(number);
        let moves = match self.geometries.get(geometry as usize) {
            Some(geometry) => matches!(geometry, Geometry::MovingTriangles(_)),
            None => self.maps.get(primitive as usize).is_some_and(|maps| !maps.is_empty()),
        };
        moves == (self.part == Part::Moving)
    }

    /// The reference with its padded box, which is empty where no ray can hit the primitive.
    fn reference(&self, number: u32) -> Reference {
        let (geometry, primitive) = self.ids(number);
        let (usable, kind) = match self.geometries.get(geometry as usize) {
            Some(shapes) => (shapes.is_usable(primitive), self.kinds[geometry as usize]),
            None => (true, Kind::Instance),
        };
        let bounds = self.bounds(number);
        let bounds = if usable && bounds.is_valid() && self.is_in_part(number) {
            bounds.padded()
        } else {
            Aabb::EMPTY
        };
        Reference::new(&bounds, number, kind)
    }

    /// References to all primitives that rays can hit.
    pub(super) fn references(&self) -> Vec<Reference> {
        let make = |number| self.reference(number as u32);
        let mut references = parallel::collect(self.count(), parallel::GRAIN, make);
        let is_left_out = |reference: &Reference| reference.bounds().is_empty();
        if parallel::chunks(&references, |references| references.iter().any(is_left_out)).contains(&true) {
            references.retain(|reference| !is_left_out(reference));
        }
        references
    }

    /// The box around the referenced primitives.
    pub(super) fn bounds_of(&self, references: &[Reference]) -> Aabb {
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

/// The kind of a primitive. A leaf holds primitives of one kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Triangle,
    Sphere,
    Procedural,
    /// A procedural shape in a capsule.
    Thin,
    Instance,
}

impl Kind {
    /// The largest of the capacities below.
    pub(super) const MOST_IN_A_LEAF: usize = BLOCK;

    /// Maximum number of primitives in a leaf.
    pub(super) fn leaf_capacity(self) -> usize {
        match self {
            Self::Triangle | Self::Sphere | Self::Thin => Self::MOST_IN_A_LEAF,
            Self::Procedural | Self::Instance => 1,
        }
    }
}

/// True if the corners are finite numbers and not collinear.
pub(crate) fn has_area(corners: &[[f32; 3]; 3]) -> bool {
    // (One comparison of the sum of magnitudes, which is NaN where one of them is.)
    let sum: f32 = corners.iter().flatten().map(|x| x.abs()).sum();
    let is_finite =
        sum <= LARGEST_COORDINATE || corners.iter().flatten().all(|x| x.abs() <= LARGEST_COORDINATE);
    let [a, b, c] = corners.map(wide);
    is_finite && cross(subtract(b, a), subtract(c, a)) != [0.0; 3]
}

/// True if the sphere is finite and larger than a point.
pub(crate) fn has_surface(sphere: &Sphere) -> bool {
    sphere.radius > 0.0 && sphere.is_finite() && sphere.bounds().is_valid()
}
