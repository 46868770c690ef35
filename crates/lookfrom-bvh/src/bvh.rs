//! The tree itself, and the doors to it.

use std::sync::Arc;

use crate::aabb::Aabb;
use crate::dispatch::dispatch;
use crate::filter::TriangleBlock;
use crate::instance::Instance;
use crate::masks::Masks;
use crate::node::Node;
use crate::packet::{OccludedMany, TraceMany};
use crate::procedural::Procedural;
use crate::query::{All, Any, Closest};
use crate::ray::{Hit, OriginPrimitive, Ray};
use crate::sphere::Sphere;
use crate::traverse::Trace;
use crate::validate::{Invalid, Statistics};
use crate::watch::Observer;
use lookfrom_simd::{Level, level};

/// Rays (or points) that one thread answers before it looks for others' work.
#[cfg(feature = "parallel")]
const BATCH: usize = 4096;

/// Geometry that rays can be traced against. Made by a [`Builder`](crate::Builder); frozen, and shared between threads.
///
/// ```
/// # use lookfrom_bvh::{Builder, Ray, Sphere};
/// # let mut builder = Builder::new();
/// # builder.spheres(&[Sphere { center: [0.0; 3], radius: 1.0 }]);
/// # let bvh = builder.build()?;
/// assert!(bvh.occluded(&Ray::new([0.0, 0.0, 3.0], [0.0, 0.0, -1.0])));
/// # Ok::<(), lookfrom_bvh::BuildError>(())
/// ```
#[derive(Debug)]
pub struct Bvh {
    /// The root first.
    pub(crate) nodes: Vec<Node>,
    pub(crate) triangles: Vec<TriangleBlock>,
    /// Those that hold no triangles.
    pub(crate) leaves: Vec<Leaf>,
    pub(crate) spheres: Vec<SphereItem>,
    pub(crate) procedurals: Vec<ProceduralItem>,
    pub(crate) procedural_shapes: Vec<Arc<dyn Procedural>>,
    pub(crate) instances: Vec<Instance>,
    pub(crate) masks: Masks,
    pub(crate) bounds: Aabb,
    pub(crate) statistics: Statistics,
    /// The largest coordinate of a triangle.
    pub(crate) largest: f32,
    /// The instructions to trace with.
    pub(crate) level: Level,
}

/// What is in a leaf that holds no triangles: items in the array of their kind.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Leaf {
    Spheres { first: u32, count: u32 },
    Procedurals { first: u32, count: u32 },
    Instances { first: u32, count: u32 },
}

/// A sphere and what it is called.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SphereItem {
    pub(crate) shape: Sphere,
    pub(crate) geometry: u32,
    pub(crate) primitive: u32,
}

/// One of a procedural's shapes: `shape` is its place in [`Bvh::procedural_shapes`].
#[derive(Clone, Copy, Debug)]
pub(crate) struct ProceduralItem {
    pub(crate) shape: u32,
    pub(crate) geometry: u32,
    pub(crate) primitive: u32,
}

impl Default for Bvh {
    /// The tree of nothing.
    fn default() -> Self {
        Self {
            nodes: Vec::new(),
            triangles: Vec::new(),
            leaves: Vec::new(),
            spheres: Vec::new(),
            procedurals: Vec::new(),
            procedural_shapes: Vec::new(),
            instances: Vec::new(),
            masks: Masks::default(),
            bounds: Aabb::EMPTY,
            statistics: Statistics::default(),
            largest: 0.0,
            level: level(),
        }
    }
}

impl Bvh {
    /// The box around everything, [`Aabb::EMPTY`] where there is nothing.
    ///
    /// ```
    /// # use lookfrom_bvh::{Builder, Ray, Sphere};
    /// # let mut builder = Builder::new();
    /// # builder.spheres(&[Sphere { center: [0.0; 3], radius: 1.0 }]);
    /// # let bvh = builder.build()?;
    /// assert!(bvh.bounds().max[0] >= 1.0);
    /// # Ok::<(), lookfrom_bvh::BuildError>(())
    /// ```
    pub fn bounds(&self) -> Aabb {
        self.bounds
    }

    pub(crate) fn set_bounds(&mut self, bounds: Aabb) {
        self.bounds = bounds;
        self.largest = bounds.min.iter().chain(&bounds.max).fold(0.0, |largest, x| x.abs().max(largest));
    }

    /// Bytes held for tracing, without the trees of instances (which are shared) and without procedural shapes.
    ///
    /// ```
    /// # use lookfrom_bvh::{Builder, Ray, Sphere};
    /// # let mut builder = Builder::new();
    /// # builder.spheres(&[Sphere { center: [0.0; 3], radius: 1.0 }]);
    /// # let bvh = builder.build()?;
    /// assert!(bvh.memory() > 0);
    /// # Ok::<(), lookfrom_bvh::BuildError>(())
    /// ```
    pub fn memory(&self) -> usize {
        size_of::<Self>()
            + size_of_val(&*self.nodes)
            + size_of_val(&*self.triangles)
            + size_of_val(&*self.leaves)
            + size_of_val(&*self.spheres)
            + size_of_val(&*self.procedurals)
            + size_of_val(&*self.procedural_shapes)
            + size_of_val(&*self.instances)
            + self.masks.memory()
    }

    /// What the tree consists of, counted when it was built.
    ///
    /// ```
    /// # use lookfrom_bvh::{Builder, Ray, Sphere};
    /// # let mut builder = Builder::new();
    /// # builder.spheres(&[Sphere { center: [0.0; 3], radius: 1.0 }]);
    /// # let bvh = builder.build()?;
    /// assert_eq!(bvh.statistics().spheres, 1);
    /// # Ok::<(), lookfrom_bvh::BuildError>(())
    /// ```
    pub fn statistics(&self) -> Statistics {
        self.statistics
    }

    /// Checks every property that tracing relies on, and counts again. Slow: for tests and for doubts.
    ///
    /// # Errors
    /// What is wrong, and where: a fault of this library.
    ///
    /// ```
    /// # use lookfrom_bvh::{Builder, Ray, Sphere};
    /// # let mut builder = Builder::new();
    /// # builder.spheres(&[Sphere { center: [0.0; 3], radius: 1.0 }]);
    /// # let bvh = builder.build()?;
    /// assert_eq!(bvh.validate(), Ok(bvh.statistics()));
    /// # Ok::<(), lookfrom_bvh::BuildError>(())
    /// ```
    pub fn validate(&self) -> Result<Statistics, Invalid> {
        crate::validate::validate(self)
    }

    /// The hit with the least t in the ray's range; of several at equal t the one with the lowest ids, where geometry
    /// outside of instances comes first, then by instance, geometry and primitive. [`Hit::MISS`] where there is none.
    ///
    /// ```
    /// use lookfrom_bvh::{Builder, Hit, Ray, Sphere};
    /// let mut builder = Builder::new();
    /// builder.spheres(&[Sphere { center: [0.0; 3], radius: 1.0 }]);
    /// let bvh = builder.build()?;
    /// assert_eq!(bvh.closest_hit(&Ray::new([0.0, 0.0, 3.0], [0.0, 0.0, -2.0])).t, 1.0);
    /// assert_eq!(bvh.closest_hit(&Ray::new([0.0, 0.0, 3.0], [0.0, 1.0, 0.0])), Hit::MISS);
    /// # Ok::<(), lookfrom_bvh::BuildError>(())
    /// ```
    pub fn closest_hit(&self, ray: &Ray) -> Hit {
        Trace { bvh: self, ray, ask: Closest::new, watch: () }.go().hit
    }

    /// [`Self::closest_hit`], while someone watches. The answer is the same.
    ///
    /// ```
    /// # use lookfrom_bvh::{Builder, Ray, Sphere};
    /// # let mut builder = Builder::new();
    /// # builder.spheres(&[Sphere { center: [0.0; 3], radius: 1.0 }]);
    /// # let bvh = builder.build()?;
    /// # use lookfrom_bvh::Observer;
    /// struct Candidates(u32);
    /// impl Observer for Candidates {
    ///     fn candidate(&mut self, _: u32, _: u32, _: u32) {
    ///         self.0 += 1;
    ///     }
    /// }
    /// let mut candidates = Candidates(0);
    /// let hit = bvh.closest_hit_watched(&Ray::new([0.0, 0.0, 3.0], [0.0, 0.0, -1.0]), &mut candidates);
    /// assert_eq!((hit.t, candidates.0), (2.0, 1));
    /// # Ok::<(), lookfrom_bvh::BuildError>(())
    /// ```
    pub fn closest_hit_watched(&self, ray: &Ray, watch: &mut impl Observer) -> Hit {
        Trace { bvh: self, ray, ask: Closest::new, watch }.go().hit
    }

    /// Whether anything is hit in the ray's range.
    ///
    /// ```
    /// # use lookfrom_bvh::{Builder, Ray, Sphere};
    /// # let mut builder = Builder::new();
    /// # builder.spheres(&[Sphere { center: [0.0; 3], radius: 1.0 }]);
    /// # let bvh = builder.build()?;
    /// let ray = Ray::new([0.0, 0.0, 3.0], [0.0, 0.0, -1.0]);
    /// assert!(bvh.occluded(&ray) && !bvh.occluded(&ray.with_t_max(2.0)));
    /// # Ok::<(), lookfrom_bvh::BuildError>(())
    /// ```
    pub fn occluded(&self, ray: &Ray) -> bool {
        Trace { bvh: self, ray, ask: Any::new, watch: () }.go().found
    }

    /// Replaces the content of `hits` by all hits in the ray's range, sorted by t and then as [`Self::closest_hit`]
    /// decides ties. A triangle gives at most one hit, a sphere two, a procedural shape one (its nearest).
    ///
    /// ```
    /// # use lookfrom_bvh::{Builder, Ray, Sphere};
    /// # let mut builder = Builder::new();
    /// # builder.spheres(&[Sphere { center: [0.0; 3], radius: 1.0 }]);
    /// # let bvh = builder.build()?;
    /// let mut hits = Vec::new();
    /// bvh.all_hits(&Ray::new([0.0, 0.0, 3.0], [0.0, 0.0, -1.0]), &mut hits);
    /// assert_eq!(hits.iter().map(|hit| hit.t).collect::<Vec<_>>(), [2.0, 4.0]);
    /// # Ok::<(), lookfrom_bvh::BuildError>(())
    /// ```
    pub fn all_hits(&self, ray: &Ray, hits: &mut Vec<Hit>) {
        hits.clear();
        let room = std::mem::take(hits);
        *hits = Trace { bvh: self, ray, ask: move |ray: &Ray| All::new(ray, room), watch: () }.go().hits;
        sort(hits);
    }

    /// [`Self::closest_hit`] for each ray, on several threads where there are many. The two slices should be equally
    /// long; what one has more than the other is left alone.
    ///
    /// ```
    /// # use lookfrom_bvh::{Builder, Hit, Ray, Sphere};
    /// # let mut builder = Builder::new();
    /// # builder.spheres(&[Sphere { center: [0.0; 3], radius: 1.0 }]);
    /// # let bvh = builder.build()?;
    /// let rays = [3.0, -3.0].map(|z| Ray::new([0.0, 0.0, z], [0.0, 0.0, -1.0]));
    /// let mut hits = [Hit::MISS; 2];
    /// bvh.closest_hits(&rays, &mut hits);
    /// assert_eq!(hits.map(|hit| hit.is_hit()), [true, false]);
    /// # Ok::<(), lookfrom_bvh::BuildError>(())
    /// ```
    pub fn closest_hits(&self, rays: &[Ray], hits: &mut [Hit]) {
        self.closest_hits_leaving(rays, &[], hits);
    }

    /// [`Self::closest_hits`] of rays that leave triangles, which a third slice tells (rays beyond its end leave none). Where
    /// that is true the answers are the same, sooner.
    ///
    /// ```
    /// # use lookfrom_bvh::{Builder, Hit, OriginPrimitive, Ray, Triangles};
    /// # let mut builder = Builder::new();
    /// # let positions = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    /// # builder.triangles(Triangles { positions: &positions, indices: &[[0, 1, 2]] });
    /// # let bvh = builder.build()?;
    /// let hit = bvh.closest_hit(&Ray::new([0.2, 0.2, 1.0], [0.0, 0.0, -1.0]));
    /// let mirrored = Ray::new([0.2, 0.2, 0.0_f32.next_up()], [0.0, 0.0, 1.0]);
    /// let mut hits = [hit];
    /// bvh.closest_hits_leaving(&[mirrored], &[OriginPrimitive::of(&hit)], &mut hits);
    /// assert_eq!(hits, [Hit::MISS]);
    /// # Ok::<(), lookfrom_bvh::BuildError>(())
    /// ```
    pub fn closest_hits_leaving(&self, rays: &[Ray], left: &[OriginPrimitive], hits: &mut [Hit]) {
        for_batches(rays, hits, |first, rays, hits| {
            let left = left.get(first..).unwrap_or_default();
            dispatch(self.level, TraceMany { bvh: self, rays, left, hits });
        });
    }

    /// [`Self::occluded`] for each ray, on several threads where there are many. The two slices should be equally
    /// long; what one has more than the other is left alone.
    ///
    /// ```
    /// # use lookfrom_bvh::{Builder, Ray, Sphere};
    /// # let mut builder = Builder::new();
    /// # builder.spheres(&[Sphere { center: [0.0; 3], radius: 1.0 }]);
    /// # let bvh = builder.build()?;
    /// let rays = [3.0, -3.0].map(|z| Ray::new([0.0, 0.0, z], [0.0, 0.0, -1.0]));
    /// let mut occluded = [false; 2];
    /// bvh.occluded_many(&rays, &mut occluded);
    /// assert_eq!(occluded, [true, false]);
    /// # Ok::<(), lookfrom_bvh::BuildError>(())
    /// ```
    pub fn occluded_many(&self, rays: &[Ray], occluded: &mut [bool]) {
        self.occluded_many_leaving(rays, &[], occluded);
    }

    /// [`Self::occluded_many`] for rays that leave triangles, as [`Self::closest_hits_leaving`].
    ///
    /// ```
    /// # use lookfrom_bvh::{Builder, Hit, OriginPrimitive, Ray, Triangles};
    /// # let mut builder = Builder::new();
    /// # let positions = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    /// # builder.triangles(Triangles { positions: &positions, indices: &[[0, 1, 2]] });
    /// # let bvh = builder.build()?;
    /// let left = OriginPrimitive { geometry: 0, primitive: 0 };
    /// let mut occluded = [true];
    /// let ray = Ray::new([0.2, 0.2, 0.0_f32.next_up()], [0.0, 0.0, 1.0]);
    /// bvh.occluded_many_leaving(&[ray], &[left], &mut occluded);
    /// assert_eq!(occluded, [false]);
    /// # Ok::<(), lookfrom_bvh::BuildError>(())
    /// ```
    pub fn occluded_many_leaving(&self, rays: &[Ray], left: &[OriginPrimitive], occluded: &mut [bool]) {
        for_batches(rays, occluded, |first, rays, occluded| {
            let left = left.get(first..).unwrap_or_default();
            dispatch(self.level, OccludedMany { bvh: self, rays, left, occluded });
        });
    }
}

/// Sorts hits by t and then as ties are decided.
pub(crate) fn sort(hits: &mut [Hit]) {
    // A zero is a zero, whatever its sign.
    hits.sort_unstable_by(|a, b| (a.t + 0.0).total_cmp(&(b.t + 0.0)).then_with(|| a.rank().cmp(&b.rank())));
}

/// Answers each question in its place, batch by batch on several threads where there are many.
pub(crate) fn for_each<Q: Sync, A: Send>(
    questions: &[Q],
    answers: &mut [A],
    answer: impl Fn(&Q, &mut A) + Sync,
) {
    for_batches(questions, answers, |_, questions, answers| {
        questions.iter().zip(answers).for_each(|(question, place)| answer(question, place));
    });
}

/// The same, batch by batch, with the number of its first question.
fn for_batches<Q: Sync, A: Send>(
    questions: &[Q],
    answers: &mut [A],
    answer: impl Fn(usize, &[Q], &mut [A]) + Sync,
) {
    #[cfg(feature = "parallel")]
    if questions.len() > BATCH {
        use rayon::prelude::*;
        questions
            .par_chunks(BATCH)
            .zip(answers.par_chunks_mut(BATCH))
            .enumerate()
            .for_each(|(batch, (questions, answers))| answer(batch * BATCH, questions, answers));
        return;
    }
    answer(0, questions, answers);
}
