//! What can be asked of a ray: the closest hit, whether there is any, all of them.

use crate::ray::{Hit, OriginPrimitive, Ray};

/// What is asked.
pub(crate) trait Query {
    /// Whether near children are to be visited before far ones.
    const NEAREST_FIRST: bool;

    /// Whether any hit will do, wherever in the ray's range it is.
    const ANY_HIT: bool;

    /// Whether the query is about a part of the geometry, so that the methods below `accept` are to be asked.
    const SELECTS: bool = false;

    /// No hit beyond this t is wanted; one at it may be.
    fn end(&self) -> f32;

    /// Hears of a hit beyond the ray's `t_min`. Returns true where no more are wanted.
    fn accept(&mut self, hit: Hit) -> bool;

    /// Whether a triangle outside of instances is the one that the ray leaves, which it does not meet again.
    fn leaves(&self, (geometry, primitive): (u32, u32)) -> bool {
        let _ = (geometry, primitive);
        false
    }

    /// The ray is about to enter an instance, named by its place in the outer tree's list. False where it is not to.
    fn enter_instance(&mut self, place: usize) -> bool {
        let _ = place;
        true
    }

    /// The ray is in the outer tree again.
    fn leave_instance(&mut self) {}

    /// Whether the query is about a primitive of the tree that the ray is in.
    fn shows(&self, geometry: u32, primitive: u32) -> bool {
        let _ = (geometry, primitive);
        true
    }

    /// Whether the query is about the face that the ray looks at.
    fn shows_face(&self, is_front: impl FnOnce() -> bool) -> bool {
        let _ = is_front;
        true
    }
}

/// The hit with the least t; of several, that of the lowest rank.
pub(crate) struct Closest {
    t_max: f32,
    end: f32,
    left: OriginPrimitive,
    pub(crate) hit: Hit,
}

impl Closest {
    #[inline(always)]
    pub(crate) fn new(ray: &Ray) -> Self {
        Self::after(ray, Hit::MISS)
    }

    /// The query that has heard of a hit.
    #[inline(always)]
    pub(crate) fn after(ray: &Ray, hit: Hit) -> Self {
        let end = if hit.t < ray.t_max { hit.t } else { ray.t_max };
        Self { t_max: ray.t_max, end, left: OriginPrimitive::NONE, hit }
    }

    /// The query of a ray that leaves something.
    #[inline(always)]
    pub(crate) fn leaving(ray: &Ray, left: OriginPrimitive) -> Self {
        Self { left, ..Self::new(ray) }
    }
}

impl Query for Closest {
    const NEAREST_FIRST: bool = true;
    const ANY_HIT: bool = false;

    #[inline(always)]
    fn end(&self) -> f32 {
        self.end
    }

    #[inline(always)]
    fn leaves(&self, triangle: (u32, u32)) -> bool {
        self.left.is(triangle)
    }

    #[inline(always)]
    fn accept(&mut self, hit: Hit) -> bool {
        if hit.t < self.t_max && hit.precedes(&self.hit) {
            self.hit = hit;
            self.end = hit.t;
        }
        false
    }
}

/// Whether there is a hit.
pub(crate) struct Any {
    t_max: f32,
    left: OriginPrimitive,
    pub(crate) found: bool,
}

impl Any {
    #[inline(always)]
    pub(crate) fn new(ray: &Ray) -> Self {
        Self::leaving(ray, OriginPrimitive::NONE)
    }

    /// The query of a ray that leaves something.
    #[inline(always)]
    pub(crate) fn leaving(ray: &Ray, left: OriginPrimitive) -> Self {
        Self { t_max: ray.t_max, left, found: false }
    }
}

impl Query for Any {
    const NEAREST_FIRST: bool = true;
    const ANY_HIT: bool = true;

    #[inline(always)]
    fn end(&self) -> f32 {
        self.t_max
    }

    #[inline(always)]
    fn leaves(&self, triangle: (u32, u32)) -> bool {
        self.left.is(triangle)
    }

    #[inline(always)]
    fn accept(&mut self, hit: Hit) -> bool {
        self.found |= hit.t < self.t_max;
        self.found
    }
}

/// Every hit, in no order.
pub(crate) struct All {
    t_max: f32,
    pub(crate) hits: Vec<Hit>,
}

impl All {
    pub(crate) fn new(ray: &Ray, hits: Vec<Hit>) -> Self {
        Self { t_max: ray.t_max, hits }
    }
}

impl Query for All {
    const NEAREST_FIRST: bool = false;
    const ANY_HIT: bool = false;

    #[inline(always)]
    fn end(&self) -> f32 {
        self.t_max
    }

    #[inline(always)]
    fn accept(&mut self, hit: Hit) -> bool {
        if hit.t < self.t_max {
            self.hits.push(hit);
        }
        false
    }
}
