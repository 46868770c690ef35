//! Settings of a query: the tree, and the part of it that rays see.

use crate::bvh::Bvh;
use crate::faces::Faces;
use crate::origin_primitive::OriginPrimitive;

/// The part of a tree that rays see.
#[derive(Clone, Copy, Debug)]
pub struct Settings<'a> {
    pub(crate) bvh: &'a Bvh,
    /// `None` where masks are ignored.
    pub(crate) mask: Option<u32>,
    pub(crate) faces: Faces,
    /// True if only crossings count: see [`Query::crossings`](crate::Query::crossings).
    pub(crate) crossings: bool,
    /// The origin primitive of rays for which `origins` has none.
    pub(crate) origin: OriginPrimitive,
    pub(crate) origins: &'a [OriginPrimitive],
    /// The time of rays for which `times` has none.
    pub(crate) time: f32,
    pub(crate) times: &'a [f32],
}

/// The kind of visibility that settings need; each has a type in `visibility`.
pub(crate) enum VisibilityKind {
    Everything,
    ExceptOrigin,
    Masked,
}

impl<'a> Settings<'a> {
    /// Settings that see the whole tree.
    pub(crate) const fn new(bvh: &'a Bvh) -> Self {
        Self {
            bvh,
            mask: None,
            faces: Faces::Both,
            crossings: false,
            origin: OriginPrimitive::NONE,
            origins: &[],
            time: 0.0,
            times: &[],
        }
    }

    /// The simplest kind of visibility that suffices.
    pub(crate) fn visibility_kind(&self) -> VisibilityKind {
        if self.mask.is_some() || self.faces != Faces::Both || self.crossings {
            VisibilityKind::Masked
        } else if self.origins.is_empty() && self.origin == OriginPrimitive::NONE {
            VisibilityKind::Everything
        } else {
            VisibilityKind::ExceptOrigin
        }
    }

    /// The origin primitive of the ray with index `number`.
    #[inline(always)]
    pub(crate) fn origin_of(&self, number: usize) -> OriginPrimitive {
        self.origins.get(number).copied().unwrap_or(self.origin)
    }

    /// The time of the ray with index `number`.
    #[inline(always)]
    pub(crate) fn time_of(&self, number: usize) -> f32 {
        self.times.get(number).copied().unwrap_or(self.time)
    }

    /// Settings for the rays from the index `first` on.
    pub(crate) fn from(self, first: usize) -> Self {
        let origins = self.origins.get(first..).unwrap_or_default();
        Self { origins, times: self.times.get(first..).unwrap_or_default(), ..self }
    }
}
