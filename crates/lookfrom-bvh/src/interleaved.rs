//! Incoherent rays through trees that are larger than the caches: eight in flight on one core, one visit each in turn.
//!
//! A ray's next node or block of triangles is prefetched, and by the time of the ray's next turn it has arrived: group
//! prefetching, Chen, Ailamaki, Gibbons, Mowry (2004), "Improving Hash Join Performance through Prefetching". A ray makes
//! the same visits as alone (see `traverse`), so the results are the same, bit for bit. In trees that fit into the
//! caches the turns cost more than they bring.
//!
//! In an instance a ray is traced alone, and so are unusual rays.

use std::ops::Range;

use crate::bvh::Bvh;
use crate::collector::BatchQuery;
use crate::exact::ExactRay;
use crate::node::{Child, Content, Slabs};
use crate::prepared::PreparedRay;
use crate::ray::{NONE, Ray};
use crate::settings::Settings;
use crate::stack::{REST, SEGMENT, SEGMENTS, Stack, TraversalStack, fits_a_segment};
use crate::traverse::{TraversalState, TreePath, trace_any};
use crate::visibility::Visibility;
use lookfrom_simd::Simd;

/// Size from which a tree's nodes and triangles count as larger than the caches, in bytes.
const LARGE: usize = 64 << 20;

/// Whether turns pay in a tree.
pub(crate) fn pays(bvh: &Bvh) -> bool {
    is_possible(bvh) && size_of_val(&*bvh.nodes) + size_of_val(&*bvh.triangles) >= LARGE
}

fn is_possible(bvh: &Bvh) -> bool {
    fits_a_segment(bvh.statistics.depth)
}

/// Traces rays of a query, one visit each in turn.
#[inline(never)]
pub(crate) fn trace_interleaved<'a, S: Simd, C: BatchQuery, V: Visibility<'a>>(
    simd: S,
    settings: &Settings<'a>,
    rays: &[Ray],
    results: &mut [C::Result],
    stack: &mut Stack,
) {
    simd.vectorize(
        #[inline(always)]
        || {
            let mut waiting = 0..rays.len().min(results.len());
            let mut in_flight = Vec::with_capacity(SEGMENTS);
            for segment in 0..SEGMENTS {
                let bottom = segment * SEGMENT;
                let first = start_next::<S, C, V>(simd, settings, rays, results, &mut waiting, bottom, stack);
                in_flight.extend(first);
            }
            while !in_flight.is_empty() {
                let mut done = None;
                for (index, ray) in in_flight.iter_mut().enumerate() {
                    if ray.visit(simd, settings.bvh, rays, stack) {
                        continue;
                    }
                    results[ray.number] = ray.state.collector.result();
                    let next = start_next(simd, settings, rays, results, &mut waiting, ray.bottom, stack);
                    let Some(next) = next else {
                        done = Some(index);
                        break;
                    };
                    *ray = next;
                }
                if let Some(done) = done {
                    in_flight.swap_remove(done);
                }
            }
        },
    );
}

/// A ray between two of its turns.
struct InFlight<'a, S: Simd, C, V> {
    slabs: Slabs<S>,
    number: usize,
    prepared: PreparedRay,
    path: TreePath<'a>,
    state: TraversalState<C, V, ()>,
    /// Its segment of the stack.
    bottom: usize,
    height: usize,
}

/// Starts the next of the waiting rays. Unusual ones before it are traced at once.
#[inline(always)]
fn start_next<'a, S: Simd, C: BatchQuery, V: Visibility<'a>>(
    simd: S,
    settings: &Settings<'a>,
    rays: &[Ray],
    results: &mut [C::Result],
    waiting: &mut Range<usize>,
    bottom: usize,
    stack: &mut Stack,
) -> Option<InFlight<'a, S, C, V>> {
    let bvh = settings.bvh;
    for number in waiting {
        let ray = &rays[number];
        let visibility = V::of(settings, number);
        if ray.t_min < ray.t_max
            && let Some(prepared) = PreparedRay::usual(simd, ray, bvh.largest)
        {
            let state = TraversalState { instance: NONE, collector: C::start(ray), visibility, observer: () };
            let path = TreePath::new(&prepared, &state);
            let slabs = Slabs::new(simd, &prepared);
            return Some(InFlight { slabs, number, prepared, path, state, bottom, height: bottom });
        }
        results[number] = trace_alone::<S, C, V>(simd, bvh, ray, visibility, stack);
    }
    None
}

impl<'a, S: Simd, C: BatchQuery, V: Visibility<'a>> InFlight<'a, S, C, V> {
    /// Visits a node or a leaf. Returns false when the ray is done.
    #[inline(always)]
    fn visit(&mut self, simd: S, bvh: &'a Bvh, rays: &[Ray], stack: &mut Stack) -> bool {
        let Self { slabs, number, prepared, path, state, bottom, height } = self;
        let exact = || ExactRay::new(std::hint::black_box(&rays[*number]));
        if let Content::Leaf(_) | Content::Triangles(_) = path.current.content() {
            let rest = &mut TraversalStack::above(stack, REST);
            if path.test_leaf(simd, bvh, prepared, exact, state, rest) {
                return false;
            }
        }
        let segment = &mut TraversalStack { entries: stack, bottom: *bottom, height: *height };
        let next = match path.current.content() {
            Content::Node(node) => path.enter(simd, bvh, node, slabs, state, segment),
            _ => path.leave_leaf(prepared, state, segment),
        };
        *height = segment.height;
        let Some(child) = next else {
            path.finish(exact, state);
            return false;
        };
        path.current = child;
        prefetch(bvh, child);
        true
    }
}

#[inline(always)]
fn prefetch(bvh: &Bvh, child: Child) {
    match child.content() {
        Content::Node(number) => bvh.nodes[number].prefetch(),
        Content::Triangles(number) => bvh.triangles[number].prefetch(),
        Content::Leaf(_) => {}
    }
}

#[cold]
#[inline(never)]
fn trace_alone<'a, S: Simd, C: BatchQuery, V: Visibility<'a>>(
    simd: S,
    bvh: &Bvh,
    ray: &Ray,
    visibility: V,
    stack: &mut Stack,
) -> C::Result {
    let mut state = TraversalState { instance: NONE, collector: C::start(ray), visibility, observer: () };
    if ray.t_min < ray.t_max {
        let rest = &mut TraversalStack::above(stack, REST);
        trace_any(simd, bvh, &ExactRay::new(ray), &mut state, rest);
    }
    state.collector.result()
}

#[cfg(test)]
mod tests {
    use std::marker::PhantomData;
    use std::sync::Arc;

    use super::*;
    use crate::collector::{AnyHit, ClosestHit};
    use crate::dispatch::{dispatch, levels};
    use crate::faces::Faces;
    use crate::origin_primitive::OriginPrimitive;
    use crate::ray::Hit;
    use crate::single;
    use crate::stack::with_stack;
    use crate::testing::Random;
    use crate::visibility::{Everything, ExceptOrigin, Masked};
    use crate::{Affine, Builder, Sphere, Triangles};
    use lookfrom_simd::Kernel;

    struct InTurn<'a, 'b, C: BatchQuery, V>(&'b Settings<'a>, &'b [Ray], &'b mut [C::Result], PhantomData<V>);

    impl<'a, C: BatchQuery, V: Visibility<'a>> Kernel for InTurn<'a, '_, C, V> {
        type Output = ();
        #[inline(always)]
        fn run<S: Simd>(self, simd: S) {
            with_stack(|stack| trace_interleaved::<S, C, V>(simd, self.0, self.1, self.2, stack));
        }
    }

    /// Compares rays in turn with single rays. Returns the number of hits.
    fn compare<'a, V: Visibility<'a>>(settings: &Settings<'a>, rays: &[Ray]) -> usize {
        let mut hits = vec![Hit::MISS; rays.len()];
        let mut occluded = vec![false; rays.len()];
        let level = settings.bvh.level;
        dispatch(level, InTurn::<ClosestHit, V>(settings, rays, &mut hits, PhantomData));
        dispatch(level, InTurn::<AnyHit, V>(settings, rays, &mut occluded, PhantomData));
        for (number, ray) in rays.iter().enumerate() {
            let settings = settings.from(number);
            let alone = single::closest_hit(&settings, ray);
            let bits = |hit: Hit| ([hit.t, hit.u, hit.v].map(f32::to_bits), hit.rank());
            assert_eq!(bits(hits[number]), bits(alone), "{ray:?}");
            assert_eq!(occluded[number], single::occluded(&settings, ray), "{ray:?}");
        }
        hits.iter().filter(|hit| hit.is_hit()).count()
    }

    fn random_ray(random: &mut Random, center: [f32; 3], size: f32) -> Ray {
        let origin = random.near(center, 2.0 * size);
        let target = random.near(center, size);
        let toward = [0, 1, 2].map(|axis| target[axis] - origin[axis]);
        let ray = Ray { t_max: 3.0 * random.unit(), ..Ray::new(origin, toward) };
        match random.below(12) {
            0 => Ray { t_min: -1.0, ..ray },
            1 => Ray { t_min: f32::NAN, ..ray },
            2 => Ray::new(origin, toward.map(|x| x * 1e-30)),
            3 => Ray::new(origin, [0.0, toward[1], 0.0]),
            _ => ray,
        }
    }

    #[test]
    fn rays_in_turn_hit_what_single_rays_hit() {
        let mut random = Random::new(5);
        let (mut hits, mut all) = (0, 0);
        for _ in 0..25 {
            let (center, size) = (random.point_with_exponents(-6, 6), random.size(-6, 6));
            let positions: Vec<[f32; 3]> = (0..600).map(|_| random.near(center, size)).collect();
            let indices: Vec<[u32; 3]> = (0..300).map(|_| [0; 3].map(|_| random.below(600))).collect();
            let triangles = Triangles { positions: &positions, indices: &indices };
            let mut object = Builder::new();
            object.triangles(triangles);
            let mut builder = Builder::new();
            let geometry = builder.triangles(triangles);
            let masks: Vec<u32> = (0..300).map(|_| 1 + random.below(3)).collect();
            builder.primitive_masks(geometry, &masks);
            builder.spheres(&[Sphere { center: random.near(center, size), radius: 0.2 * size }]);
            let translation = random.near([0.0; 3], 0.5 * size).map(f64::from);
            builder.instance(Arc::new(object.build().unwrap()), Affine { translation, ..Affine::IDENTITY });
            let mut bvh = builder.build().unwrap();
            assert!(is_possible(&bvh) && !pays(&bvh));

            let count = random.below(200) as usize;
            let rays: Vec<Ray> = (0..count).map(|_| random_ray(&mut random, center, size)).collect();
            let origins: Vec<OriginPrimitive> = rays
                .iter()
                .map(|ray| match random.below(3) {
                    0 => OriginPrimitive::NONE,
                    _ => OriginPrimitive::of(&bvh.closest_hit(ray)),
                })
                .collect();
            for level in levels() {
                bvh.level = level;
                let settings = Settings::new(&bvh);
                let except = Settings { origins: &origins, ..settings };
                hits += compare::<Everything>(&settings, &rays);
                hits += compare::<ExceptOrigin>(&except, &rays);
                hits += compare::<Masked<'_>>(&Settings { mask: Some(2), ..except }, &rays);
                hits += compare::<Masked<'_>>(&Settings { faces: Faces::Front, ..settings }, &rays);
                all += 4 * count;
            }
        }
        assert!(hits > all / 5 && hits < all * 9 / 10, "{hits} hits of {all}");
    }

    #[test]
    fn turns_pay_in_large_trees() {
        let bvh = Bvh { nodes: vec![crate::node::Node::EMPTY; LARGE / 256], ..Bvh::default() };
        assert!(pays(&bvh));
        // Too deep for a segment of the stack.
        let statistics = crate::statistics::Statistics { depth: 36, ..bvh.statistics };
        assert!(!pays(&Bvh { statistics, ..bvh }));
    }
}
