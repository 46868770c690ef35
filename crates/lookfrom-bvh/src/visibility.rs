//! The part of the geometry that a query sees: masks, faces, and the exclusion of the origin primitive.
//!
//! Each kind of visibility is a type, so that queries of the whole tree are compiled separately, without
//! overhead.

use crate::bvh::Bvh;
use crate::conservative::TriangleBlock;
use crate::exact::ExactRay;
use crate::faces::Faces;
use crate::masks::Masks;
use crate::origin_primitive::OriginPrimitive;
use crate::settings::Settings;
use crate::triangle;
use lookfrom_simd::LaneMask;

/// The part of the geometry that one ray sees.
pub(crate) trait Visibility<'a>: Copy {
    /// True if there may be an origin primitive, so that [`Self::origin`] must be called.
    const HAS_ORIGIN: bool;

    /// True if masks or faces may hide primitives, so that the other methods must be called.
    const SELECTS: bool;

    /// The visibility for the ray with index `number` of a query.
    fn of(settings: &Settings<'a>, number: usize) -> Self;

    /// The primitive that the ray starts on.
    #[inline(always)]
    fn origin(&self) -> OriginPrimitive {
        OriginPrimitive::NONE
    }

    /// Called before the ray enters an instance, given by its index in the outer tree's list. Returns false if the
    /// instance is hidden.
    #[inline(always)]
    fn enter_instance(&mut self, place: usize) -> bool {
        let _ = place;
        true
    }

    /// Called when the ray is back in the outer tree.
    #[inline(always)]
    fn leave_instance(&mut self) {}

    /// True if the ray sees a primitive of the current tree.
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

    /// True if the ray sees only what it crosses, not what it touches.
    #[inline(always)]
    fn crossings(&self) -> bool {
        false
    }

    /// True if a triangle, in an instance or not, is the ray's origin primitive.
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

/// All but the origin primitive.
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

/// The primitives selected by the query's mask and faces, except the origin primitive.
#[derive(Clone, Copy)]
pub(crate) struct Masked<'a> {
    mask: Option<u32>,
    faces: Faces,
    crossings: bool,
    origin: OriginPrimitive,
    outer: &'a Bvh,
    /// The masks of the current tree.
    masks: &'a Masks,
}

impl<'a> Visibility<'a> for Masked<'a> {
    const HAS_ORIGIN: bool = true;
    const SELECTS: bool = true;

    #[inline(always)]
    fn of(settings: &Settings<'a>, number: usize) -> Self {
        let &Settings { bvh, mask, faces, crossings, .. } = settings;
        Self { mask, faces, crossings, origin: settings.origin_of(number), outer: bvh, masks: &bvh.masks }
    }

    #[inline(always)]
    fn origin(&self) -> OriginPrimitive {
        self.origin
    }

    fn enter_instance(&mut self, place: usize) -> bool {
        let instance = &self.outer.instances[place];
        let is_shown = self.mask.is_none_or(|mask| self.outer.masks.shows_instance(place as u32, mask));
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

    #[inline(always)]
    fn crossings(&self) -> bool {
        self.crossings
    }
}

/// The lanes that a ray sees among the given ones. Lanes that the ray misses may be wrong, because they have
/// no defined face.
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
        visibility.shows(geometry, primitive)
            && visibility.faces().shows(is_front)
            && (!visibility.crossings() || triangle::is_crossed(ray, &block.corners(lane)))
    };
    lanes.filter(is_shown).fold(0, |shown, lane| shown | 1 << lane)
}
