//! A chunk of rays, prepared for the kernel: in the frame of a tree, in f32, with room for the rounding.
//!
//! The kernel's rays start a little before the range that was asked for and end a little after it, so that no hit is lost by
//! rounding; hits near the ends are then decided in f64. Rays from far away start near the tree, so that their rounding, too, is
//! relative to the tree's size. Rays from one point, such as those of a camera, start there, since the kernel is faster then.

use lookfrom_bvh::Ray;
use numpy::ndarray::ArrayView1;

use super::frame::{dot, largest, times, to_unit};
use super::tree::Tree;
use crate::arrays::Rows;

/// Rays in a chunk: few enough that all about them stays in the cache, and at most as many as the kernel traces on one thread.
pub(super) const CHUNK: usize = 1024;

/// Rays that start farther away than this, in units of the frame, start nearer instead.
const FAR: f64 = 4.0;

/// The same for rays from one point.
const FAR_TOGETHER: f64 = 16.0;

/// Errors of rounding, relative to coordinates: 2⁻²¹, with a margin for all that the kernel's exact test does.
const ROUNDING: f64 = 4.768_371_582_031_25e-7;

/// Rays as Python passes them, seen without the GIL.
#[derive(Clone, Copy)]
pub(super) struct Rays<'a> {
    pub(super) origins: Rows<'a>,
    pub(super) directions: Rows<'a>,
    pub(super) t_min: ArrayView1<'a, f64>,
    pub(super) t_max: ArrayView1<'a, f64>,
    /// Rays in a row of a picture; 0 where they are none.
    pub(super) width: usize,
}

/// A ray as it was given.
#[derive(Clone, Copy, Debug)]
pub(super) struct WorldRay {
    pub(super) origin: [f64; 3],
    pub(super) direction: [f64; 3],
}

/// Map from a kernel's ray to the ray in the world.
#[derive(Clone, Copy, Debug)]
pub(super) struct Relation {
    /// Kernel's t = `factor` · t − `start`.
    pub(super) factor: f64,
    pub(super) start: f64,
    /// Hits that are nearer than this to the ends of the range are decided in f64.
    pub(super) margin: f64,
    /// The range that was asked for.
    pub(super) t_min: f64,
    pub(super) t_max: f64,
}

impl Relation {
    /// t in the world.
    #[inline]
    pub(super) fn t(&self, kernels: f32) -> f64 {
        (f64::from(kernels) + self.start) / self.factor
    }

    /// The ends of the range as the kernel's t.
    #[inline]
    pub(super) fn range(&self) -> [f64; 2] {
        [self.t_min, self.t_max].map(|t| t * self.factor - self.start)
    }

    /// True if a hit is surely in the range.
    #[inline]
    pub(super) fn is_surely_inside(&self, kernels: f32) -> bool {
        let (t, [first, last]) = (f64::from(kernels), self.range());
        t > first + self.margin && t < last - self.margin
    }

    #[inline]
    pub(super) fn is_inside(&self, t: f64) -> bool {
        t > self.t_min && t < self.t_max
    }
}

/// The memory of a thread for its chunks.
#[derive(Default)]
pub(super) struct Chunk {
    /// The places of the rays' results, counted from the start of their share.
    places: Vec<u32>,
    origins: Vec<[f64; 3]>,
    directions: Vec<[f64; 3]>,
    pub(super) rays: Vec<Ray>,
    pub(super) relations: Vec<Relation>,
}

impl Chunk {
    /// Prepares the rays at some places after `first`. Returns the number of the first that makes no sense, if there is one; it
    /// hits nothing.
    pub(super) fn prepare(
        &mut self,
        tree: &Tree,
        rays: &Rays<'_>,
        first: usize,
        places: &[u32],
    ) -> Option<usize> {
        self.places.clear();
        self.places.extend_from_slice(places);
        rays.origins.pick(first, places, &mut self.origins);
        rays.directions.pick(first, places, &mut self.directions);
        self.rays.clear();
        self.relations.clear();
        let start_together = self.start_together(tree);
        let mut senseless = None;
        for ((&origin, &direction), &place) in self.origins.iter().zip(&self.directions).zip(places) {
            let number = first + place as usize;
            let ends = [rays.t_min[number], rays.t_max[number]];
            if !makes_sense(origin, direction, ends) {
                senseless = Some(senseless.unwrap_or(number).min(number));
            }
            let (ray, relation) = prepare(tree, origin, direction, ends, start_together);
            self.rays.push(ray);
            self.relations.push(relation);
        }
        senseless
    }

    pub(super) fn place(&self, number: usize) -> usize {
        self.places[number] as usize
    }

    pub(super) fn world_ray(&self, number: usize) -> WorldRay {
        WorldRay { origin: self.origins[number], direction: self.directions[number] }
    }

    /// True if all rays start at one point, with no surface so near that rounding could move the point through it.
    fn start_together(&self, tree: &Tree) -> bool {
        let Some(&first) = self.origins.first() else { return false };
        let p = tree.frame.point(first);
        let size = largest(p);
        size <= FAR_TOGETHER
            && self.origins.len() > 1
            && self.origins.iter().all(|&origin| origin == first)
            && !tree.bvh.is_near(p.map(|x| x as f32), (4.0 * margin(size)) as f32)
    }
}

/// True if all numbers are finite (the range may end at infinity) and the direction is not zero.
#[inline]
fn makes_sense(origin: [f64; 3], direction: [f64; 3], [t_min, t_max]: [f64; 2]) -> bool {
    let length = largest(direction);
    largest(origin).is_finite() & length.is_finite() & (length > 0.0) & !t_min.is_nan() & !t_max.is_nan()
}

fn margin(size: f64) -> f64 {
    ROUNDING * (4.0 + size)
}

/// The kernel's ray for a ray, and how they relate. A ray whose numbers make no sense becomes one that hits nothing.
#[inline]
pub(super) fn prepare(
    tree: &Tree,
    origin: [f64; 3],
    direction: [f64; 3],
    [t_min, t_max]: [f64; 2],
    start_together: bool,
) -> (Ray, Relation) {
    let shrink = to_unit(largest(direction));
    let d = times(direction, shrink);
    let o = tree.frame.point(origin);
    let factor = tree.frame.scale / shrink;
    let (first, last) = (t_min * factor, t_max * factor);
    let size = largest(o);

    let (start, margin) = if start_together && first >= 0.0 {
        (0.0, margin(size))
    } else if size <= FAR && first.abs() <= FAR {
        (first - margin(size), margin(size))
    } else {
        // Before it reaches the tree: from where it is nearest to the middle, back by more than the tree's radius.
        let nearest = -dot(o, d) / dot(d, d) - FAR;
        (nearest.max(first - margin(2.0 * FAR)), margin(2.0 * FAR))
    };
    let from = [0, 1, 2].map(|axis| (o[axis] + start * d[axis]) as f32);
    let ray = Ray {
        origin: from,
        t_min: (first - margin - start).max(0.0) as f32,
        direction: d.map(|x| x as f32),
        t_max: (last + margin - start) as f32,
    };
    (ray, Relation { factor, start, margin, t_min, t_max })
}
