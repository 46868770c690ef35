//! The queries of a ray: its closest hit, occlusion, all of its hits.

use crate::ray::{Hit, Ray};

/// The state of a query: it collects hits, and its `end` limits the further search.
pub(crate) trait Collector {
    /// True if near children must be visited before far ones.
    const NEAREST_FIRST: bool;

    /// True if any hit in the ray's range suffices.
    const ANY_HIT: bool;

    /// Hits beyond this t are ignored; one at exactly this t may count.
    fn end(&self) -> f32;

    /// Takes a hit beyond the ray's `t_min`. Returns true if no more hits are needed.
    fn commit(&mut self, hit: Hit) -> bool;

    /// Whether no more hits are needed.
    #[inline(always)]
    fn is_done(&self) -> bool {
        false
    }
}

/// A query of packets: its state is restored ray by ray.
pub(crate) trait PacketCollector: Collector {
    /// The state of a ray whose closest hit so far is `hit`, and for which hits beyond `end` are ignored.
    fn resume(ray: &Ray, hit: Hit, end: f32) -> Self;

    /// The closest hit so far.
    fn hit(&self) -> Hit;

    /// True if there was any hit.
    fn found(&self) -> bool;
}

/// A query of many rays, with one result for each.
pub(crate) trait BatchQuery: PacketCollector {
    type Result: Send;

    /// The state before any hit.
    fn start(ray: &Ray) -> Self;

    fn result(&self) -> Self::Result;

    /// The state after a part of the tree, which gave this result.
    fn after(ray: &Ray, result: &Self::Result) -> Self;

    /// The places of the closest hits of a packet with these results; none for any-hit queries.
    fn hits_of(results: &mut [Self::Result]) -> &mut [Hit];

    /// Stores the results of a packet that are not hits: bit i of `found` is set where ray i hits anything.
    fn store(found: u64, results: &mut [Self::Result]);
}

/// The hit with the smallest t; of several, the one with the lowest rank.
pub(crate) struct ClosestHit {
    t_max: f32,
    end: f32,
    pub(crate) hit: Hit,
}

impl Collector for ClosestHit {
    const NEAREST_FIRST: bool = true;
    const ANY_HIT: bool = false;

    #[inline(always)]
    fn end(&self) -> f32 {
        self.end
    }

    #[inline(always)]
    fn commit(&mut self, hit: Hit) -> bool {
        if hit.t < self.t_max && hit.precedes(&self.hit) {
            self.hit = hit;
            self.end = if hit.t < self.end { hit.t } else { self.end };
        }
        false
    }
}

impl PacketCollector for ClosestHit {
    #[inline(always)]
    fn resume(ray: &Ray, hit: Hit, end: f32) -> Self {
        let end = if end < ray.t_max { end } else { ray.t_max };
        Self { t_max: ray.t_max, end: if hit.t < end { hit.t } else { end }, hit }
    }

    #[inline(always)]
    fn hit(&self) -> Hit {
        self.hit
    }

    #[inline(always)]
    fn found(&self) -> bool {
        self.hit.is_hit()
    }
}

impl BatchQuery for ClosestHit {
    type Result = Hit;

    #[inline(always)]
    fn start(ray: &Ray) -> Self {
        Self { t_max: ray.t_max, end: ray.t_max, hit: Hit::MISS }
    }

    #[inline(always)]
    fn result(&self) -> Hit {
        self.hit
    }

    #[inline(always)]
    fn after(ray: &Ray, hit: &Hit) -> Self {
        Self::resume(ray, *hit, ray.t_max)
    }

    #[inline(always)]
    fn hits_of(hits: &mut [Hit]) -> &mut [Hit] {
        hits
    }

    #[inline(always)]
    fn store(_: u64, _: &mut [Hit]) {}
}

/// Occlusion: any hit.
pub(crate) struct AnyHit {
    t_max: f32,
    pub(crate) found: bool,
}

impl Collector for AnyHit {
    const NEAREST_FIRST: bool = true;
    const ANY_HIT: bool = true;

    #[inline(always)]
    fn end(&self) -> f32 {
        self.t_max
    }

    #[inline(always)]
    fn commit(&mut self, hit: Hit) -> bool {
        self.found |= hit.t < self.t_max;
        self.found
    }

    #[inline(always)]
    fn is_done(&self) -> bool {
        self.found
    }
}

impl PacketCollector for AnyHit {
    #[inline(always)]
    fn resume(ray: &Ray, _: Hit, _: f32) -> Self {
        Self::start(ray)
    }

    #[inline(always)]
    fn hit(&self) -> Hit {
        Hit::MISS
    }

    #[inline(always)]
    fn found(&self) -> bool {
        self.found
    }
}

impl BatchQuery for AnyHit {
    type Result = bool;

    #[inline(always)]
    fn start(ray: &Ray) -> Self {
        Self { t_max: ray.t_max, found: false }
    }

    #[inline(always)]
    fn result(&self) -> bool {
        self.found
    }

    #[inline(always)]
    fn after(ray: &Ray, found: &bool) -> Self {
        Self { t_max: ray.t_max, found: *found }
    }

    #[inline(always)]
    fn hits_of(_: &mut [bool]) -> &mut [Hit] {
        &mut []
    }

    #[inline(always)]
    fn store(found: u64, occluded: &mut [bool]) {
        for (ray, occluded) in occluded.iter_mut().enumerate() {
            *occluded = found >> ray & 1 != 0;
        }
    }
}

/// All hits, in no particular order.
pub(crate) struct AllHits {
    t_max: f32,
    pub(crate) hits: Vec<Hit>,
}

impl AllHits {
    /// `hits` must be empty.
    pub(crate) fn new(ray: &Ray, hits: Vec<Hit>) -> Self {
        Self { t_max: ray.t_max, hits }
    }
}

impl Collector for AllHits {
    const NEAREST_FIRST: bool = false;
    const ANY_HIT: bool = false;

    #[inline(always)]
    fn end(&self) -> f32 {
        self.t_max
    }

    #[inline(always)]
    fn commit(&mut self, hit: Hit) -> bool {
        if hit.t < self.t_max {
            self.hits.push(hit);
        }
        false
    }
}
