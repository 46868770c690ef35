//! The part of the geometry that a query sees: masks, faces, and the exclusion of the origin primitive.
//!
//! Each kind of visibility is a type, so that queries about everything are compiled apart and pay nothing.

use crate::Bvh;
use crate::conservative::TriangleBlock;
use crate::exact::ExactRay;
use crate::masks::Masks;
use crate::origin_primitive::OriginPrimitive;
use crate::query::Settings;
use crate::triangle;
use lookfrom_simd::LaneMask;

/// The faces of surfaces that rays hit.
///
/// A triangle's front is where its corners are seen counter-clockwise, a sphere's is its outside. In an instance the
/// faces are those that the object has in its own space: the outside of a closed object stays its outside in a mirror.
/// Procedural shapes have no faces that the tree knows of and are hit from any side; their
/// [`intersect`](crate::Procedural::intersect) may choose.
///
/// ```
/// # use lookfrom_bvh::{Builder, Faces, Ray, Sphere};
/// # let mut builder = Builder::new();
/// # builder.spheres(&[Sphere { center: [0.0; 3], radius: 1.0 }]);
/// # let bvh = builder.build()?;
/// let inside = Ray::new([0.0; 3], [0.0, 0.0, 1.0]);
/// let sees = |faces| bvh.query().faces(faces).occluded(&inside);
/// assert_eq!([Faces::Both, Faces::Front, Faces::Back].map(sees), [true, false, true]);
/// # Ok::<(), lookfrom_bvh::BuildError>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Faces {
    /// Both.
    #[default]
    Both,
    /// Only those that the ray meets from their front: back faces are culled.
    Front,
    /// Only those that the ray meets from behind: front faces are culled.
    Back,
}

impl Faces {
    #[inline(always)]
    pub(crate) fn shows(self, is_front: impl FnOnce() -> bool) -> bool {
        match self {
            Self::Both => true,
            Self::Front => is_front(),
            Self::Back => !is_front(),
        }
    }
}

/// The part of the geometry that one ray sees.
pub(crate) trait Visibility<'a>: Copy {
    /// Whether there may be an origin primitive, so that [`Self::origin`] is to be asked.
    const HAS_ORIGIN: bool;

    /// Whether masks or faces may hide primitives, so that the other methods are to be asked.
    const SELECTS: bool;

    /// The visibility of the ray with a number among those of a query.
    fn of(settings: &Settings<'a>, number: usize) -> Self;

    /// The primitive that the ray starts on.
    #[inline(always)]
    fn origin(&self) -> OriginPrimitive {
        OriginPrimitive::NONE
    }

    /// The ray is about to enter an instance, named by its place in the outer tree's list. False where it is not to.
    #[inline(always)]
    fn enter_instance(&mut self, place: usize) -> bool {
        let _ = place;
        true
    }

    /// The ray is in the outer tree again.
    #[inline(always)]
    fn leave_instance(&mut self) {}

    /// Whether the ray sees a primitive of the tree that it is in.
    #[inline(always)]
    fn shows(&self, geometry: u32, primitive: u32) -> bool {
        let _ = (geometry, primitive);
        true
    }

    /// The faces that the ray sees.
    #[inline(always)]
    fn faces(&self) -> Faces {
        Faces::Both
    }

    /// Whether a triangle of an instance, or of none, is the one that the ray starts on.
    #[inline(always)]
    fn is_origin(&self, instance: u32, triangle: (u32, u32)) -> bool {
        Self::HAS_ORIGIN && self.origin().is(instance, triangle)
    }
}

/// All of the geometry.
#[derive(Clone, Copy)]
pub(crate) struct Everything;

impl Visibility<'_> for Everything {
    const HAS_ORIGIN: bool = false;
    const SELECTS: bool = false;

    #[inline(always)]
    fn of(_: &Settings<'_>, _: usize) -> Self {
        Self
    }
}

/// All but the triangle that the ray starts on.
#[derive(Clone, Copy)]
pub(crate) struct ExceptOrigin(OriginPrimitive);

impl Visibility<'_> for ExceptOrigin {
    const HAS_ORIGIN: bool = true;
    const SELECTS: bool = false;

    #[inline(always)]
    fn of(settings: &Settings<'_>, number: usize) -> Self {
        Self(settings.origin_of(number))
    }

    #[inline(always)]
    fn origin(&self) -> OriginPrimitive {
        self.0
    }
}

/// The primitives whose masks and faces are those of the query, but for the triangle that the ray starts on.
#[derive(Clone, Copy)]
pub(crate) struct Masked<'a> {
    mask: Option<u32>,
    faces: Faces,
    origin: OriginPrimitive,
    outer: &'a Bvh,
    /// Those of the tree that the ray is in.
    masks: &'a Masks,
}

impl<'a> Visibility<'a> for Masked<'a> {
    const HAS_ORIGIN: bool = true;
    const SELECTS: bool = true;

    #[inline(always)]
    fn of(settings: &Settings<'a>, number: usize) -> Self {
        let &Settings { bvh, mask, faces, .. } = settings;
        Self { mask, faces, origin: settings.origin_of(number), outer: bvh, masks: &bvh.masks }
    }

    #[inline(always)]
    fn origin(&self) -> OriginPrimitive {
        self.origin
    }

    fn enter_instance(&mut self, place: usize) -> bool {
        let instance = &self.outer.instances[place];
        let is_shown = self.mask.is_none_or(|mask| self.outer.masks.shows_instance(instance.id, mask));
        if is_shown {
            self.masks = &instance.bvh.masks;
        }
        is_shown
    }

    fn leave_instance(&mut self) {
        self.masks = &self.outer.masks;
    }

    fn shows(&self, geometry: u32, primitive: u32) -> bool {
        self.mask.is_none_or(|mask| self.masks.shows(geometry, primitive, mask))
    }

    #[inline(always)]
    fn faces(&self) -> Faces {
        self.faces
    }
}

/// Those of some lanes that a ray sees. Lanes that the ray misses may be wrong: there a face is not defined.
#[inline(never)]
pub(crate) fn shown<'a, V: Visibility<'a>>(
    visibility: &V,
    block: &TriangleBlock,
    ray: &ExactRay,
    lanes: LaneMask,
) -> u32 {
    let is_shown = |&lane: &usize| {
        let (geometry, primitive) = block.ids(lane);
        let is_front = || triangle::is_front(ray, &block.corners(lane));
        visibility.shows(geometry, primitive) && visibility.faces().shows(is_front)
    };
    lanes.filter(is_shown).fold(0, |shown, lane| shown | 1 << lane)
}
