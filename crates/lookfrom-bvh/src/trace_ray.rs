//! The types of rays that queries trace, and the code for each: f32 by SIMD, f64 by scalar code.

use crate::observer::Observer;
use crate::ray::{Hit, Ray};
use crate::ray_f64::{HitF64, RayF64};
use crate::settings::Settings;
use crate::{batch, single, traverse_f64};

/// A type of ray that queries trace: [`Ray`], whose `Hit` is [`Hit`], or [`RayF64`], whose `Hit` is [`HitF64`]. The
/// trait is sealed.
///
/// ```
/// use lookfrom_bvh::{Bvh, TraceRay};
/// /// How many hits a ray has, in either precision.
/// fn count<R: TraceRay>(bvh: &Bvh, ray: &R) -> usize {
///     let mut hits = Vec::new();
///     bvh.query().all_hits(ray, &mut hits);
///     hits.len()
/// }
/// # assert_eq!(count(&Bvh::default(), &lookfrom_bvh::Ray::new([0.0; 3], [1.0; 3])), 0);
/// ```
pub trait TraceRay: sealed::Trace {}

impl TraceRay for Ray {}

impl TraceRay for RayF64 {}

mod sealed {
    use crate::observer::Observer;
    use crate::settings::Settings;

    /// The queries of a type of ray.
    pub trait Trace: Copy + Sync + Sized {
        /// A hit in the same precision.
        type Hit: Copy + Send;

        fn closest_hit(settings: &Settings<'_>, ray: &Self, observer: Option<&mut dyn Observer>)
        -> Self::Hit;
        fn occluded(settings: &Settings<'_>, ray: &Self, observer: Option<&mut dyn Observer>) -> bool;
        /// Adds the hits to `hits`, which must be empty.
        fn all_hits(
            settings: &Settings<'_>,
            ray: &Self,
            hits: &mut Vec<Self::Hit>,
            observer: Option<&mut dyn Observer>,
        );
        fn closest_hits(settings: &Settings<'_>, rays: &[Self], hits: &mut [Self::Hit]);
        fn occluded_many(settings: &Settings<'_>, rays: &[Self], occluded: &mut [bool]);
    }
}

impl sealed::Trace for Ray {
    type Hit = Hit;

    fn closest_hit(settings: &Settings<'_>, ray: &Self, observer: Option<&mut dyn Observer>) -> Hit {
        match observer {
            Some(observer) => single::observed_closest_hit(settings, ray, observer),
            None => single::closest_hit(settings, ray),
        }
    }

    fn occluded(settings: &Settings<'_>, ray: &Self, observer: Option<&mut dyn Observer>) -> bool {
        match observer {
            Some(observer) => single::observed_occluded(settings, ray, observer),
            None => single::occluded(settings, ray),
        }
    }

    fn all_hits(
        settings: &Settings<'_>,
        ray: &Self,
        hits: &mut Vec<Hit>,
        observer: Option<&mut dyn Observer>,
    ) {
        match observer {
            Some(observer) => single::observed_all_hits(settings, ray, hits, observer),
            None => single::all_hits(settings, ray, hits),
        }
    }

    fn closest_hits(settings: &Settings<'_>, rays: &[Self], hits: &mut [Hit]) {
        batch::closest_hits(settings, rays, hits);
    }

    fn occluded_many(settings: &Settings<'_>, rays: &[Self], occluded: &mut [bool]) {
        batch::occluded_many(settings, rays, occluded);
    }
}

impl sealed::Trace for RayF64 {
    type Hit = HitF64;

    fn closest_hit(settings: &Settings<'_>, ray: &Self, observer: Option<&mut dyn Observer>) -> HitF64 {
        traverse_f64::closest_hit(settings, ray, observer)
    }

    fn occluded(settings: &Settings<'_>, ray: &Self, observer: Option<&mut dyn Observer>) -> bool {
        traverse_f64::occluded(settings, ray, observer)
    }

    fn all_hits(
        settings: &Settings<'_>,
        ray: &Self,
        hits: &mut Vec<HitF64>,
        observer: Option<&mut dyn Observer>,
    ) {
        traverse_f64::all_hits(settings, ray, hits, observer);
    }

    fn closest_hits(settings: &Settings<'_>, rays: &[Self], hits: &mut [HitF64]) {
        traverse_f64::closest_hits(settings, rays, hits);
    }

    fn occluded_many(settings: &Settings<'_>, rays: &[Self], occluded: &mut [bool]) {
        traverse_f64::occluded_many(settings, rays, occluded);
    }
}
