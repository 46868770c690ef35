//! Queries of a tree: the basic ones as its methods, all others by a builder.

use crate::batch::for_each;
use crate::bvh::Bvh;
use crate::closest_point::{self, ClosestPoint};
use crate::faces::Faces;
use crate::hit_point::HitPoint;
use crate::observer::{Listener, Observer};
use crate::origin_primitive::OriginPrimitive;
use crate::ray::{Hit, Ray};
use crate::settings::Settings;
use crate::trace_ray::TraceRay;
use crate::{batch, single};

/// A query of a [`Bvh`], in builder style; created by [`Bvh::query`].
///
/// A query initially sees everything. Setters such as [`Self::mask`] narrow it and return it; methods such as
/// [`Self::closest_hit`] trace rays, either [`Ray`]s or [`RayF64`](crate::RayF64)s. A query is small
/// and `Copy` (except with an observer), so it can be created once and used often.
///
/// ```
/// use lookfrom_bvh::{Builder, Faces, Hit, HitF64, OriginPrimitive, Ray, RayF64, Triangles};
/// let mut builder = Builder::new();
/// let positions = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
/// let wall = builder.triangles(Triangles { positions: &positions, indices: &[[0, 1, 2]] });
/// builder.geometry_mask(wall, 0b01);
/// let bvh = builder.build()?;
///
/// // From where the corners are seen counter-clockwise.
/// let ray = Ray::new([0.25, 0.25, 1.0], [0.0, 0.0, -1.0]);
/// let hit = bvh.query().mask(0b01).faces(Faces::Front).closest_hit(&ray);
/// assert_eq!(hit, bvh.closest_hit(&ray));
/// assert_eq!(bvh.query().mask(0b10).closest_hit(&ray), Hit::MISS);
/// assert_eq!(bvh.query().faces(Faces::Back).closest_hit(&RayF64::from(ray)), HitF64::MISS);
/// assert!(!bvh.query().origin(OriginPrimitive::of(&hit)).occluded(&ray));
/// # Ok::<(), lookfrom_bvh::BuildError>(())
/// ```
#[derive(Clone, Copy, Debug)]
#[must_use = "a query does nothing until it traces a ray"]
pub struct Query<'a, O = ()> {
    settings: Settings<'a>,
    observer: O,
}

impl Bvh {
    /// A query of the whole tree: see [`Query`].
    ///
    /// ```
    /// # use lookfrom_bvh::{Builder, Ray, Sphere};
    /// # let mut builder = Builder::new();
    /// # builder.spheres(&[Sphere { center: [0.0; 3], radius: 1.0 }]);
    /// # let bvh = builder.build()?;
    /// let ray = Ray::new([0.0, 0.0, 3.0], [0.0, 0.0, -1.0]);
    /// assert_eq!(bvh.query().closest_hit(&ray), bvh.closest_hit(&ray));
    /// # Ok::<(), lookfrom_bvh::BuildError>(())
    /// ```
    pub const fn query(&self) -> Query<'_> {
        Query { settings: Settings::new(self), observer: () }
    }

    /// The hit with the smallest t in the ray's range, or [`Hit::MISS`]. Of several hits at equal t it is the one
    /// with the lowest ids: geometry outside of instances comes first, then by instance, geometry and primitive.
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
        single::closest_hit_of_everything(self, ray, 0.0)
    }

    /// True if anything is hit in the ray's range.
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
        single::occluded_by_everything(self, ray, 0.0)
    }

    /// [`Self::closest_hit`] for each ray, on several threads where there are many. Coherent rays are traced in
    /// packets. The two slices should have equal lengths; the surplus of the longer one is ignored.
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
        batch::closest_hits(&Settings::new(self), rays, hits);
    }

    /// [`Self::occluded`] for each ray, as [`Self::closest_hits`].
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
        batch::occluded_many(&Settings::new(self), rays, occluded);
    }
}

impl<'a, O> Query<'a, O> {
    /// Selects only primitives that have a bit in common with `mask`: in their own mask, in their geometry's and in
    /// their instance's (see [`Builder::geometry_mask`](crate::Builder::geometry_mask)). Masks that were not set
    /// have all bits. A query without a mask sees everything, whatever its mask.
    ///
    /// ```
    /// # use lookfrom_bvh::{Builder, Ray, Sphere};
    /// let mut builder = Builder::new();
    /// let ball = builder.spheres(&[Sphere { center: [0.0; 3], radius: 1.0 }]);
    /// builder.geometry_mask(ball, 0b10);
    /// let bvh = builder.build()?;
    /// let ray = Ray::new([0.0; 3], [0.0, 0.0, 1.0]);
    /// assert!(bvh.query().mask(0b11).occluded(&ray) && !bvh.query().mask(0b01).occluded(&ray));
    /// # Ok::<(), lookfrom_bvh::BuildError>(())
    /// ```
    pub fn mask(mut self, mask: u32) -> Self {
        self.settings.mask = Some(mask);
        self
    }

    /// Selects front or back faces only.
    ///
    /// ```
    /// use lookfrom_bvh::{Builder, Faces, Ray, Sphere};
    /// let mut builder = Builder::new();
    /// builder.spheres(&[Sphere { center: [0.0; 3], radius: 1.0 }]);
    /// let bvh = builder.build()?;
    /// let ray = Ray::new([0.0, 0.0, 3.0], [0.0, 0.0, -1.0]);
    /// assert_eq!(bvh.query().faces(Faces::Back).closest_hit(&ray).t, 4.0);
    /// # Ok::<(), lookfrom_bvh::BuildError>(())
    /// ```
    pub fn faces(mut self, faces: Faces) -> Self {
        self.settings.faces = faces;
        self
    }

    /// Excludes the triangle that the rays start on: they do not hit it again. See [`OriginPrimitive`].
    ///
    /// ```
    /// # use lookfrom_bvh::{Builder, Hit, OriginPrimitive, Ray, Triangles};
    /// # let mut builder = Builder::new();
    /// # let positions = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    /// # builder.triangles(Triangles { positions: &positions, indices: &[[0, 1, 2]] });
    /// # let bvh = builder.build()?;
    /// let hit = bvh.closest_hit(&Ray::new([0.2, 0.2, 1.0], [0.0, 0.0, -1.0]));
    /// let mirrored = Ray::new([0.2, 0.2, 0.0], [0.0, 0.0, 1.0]);
    /// assert_eq!(bvh.query().origin(OriginPrimitive::of(&hit)).closest_hit(&mirrored), Hit::MISS);
    /// # Ok::<(), lookfrom_bvh::BuildError>(())
    /// ```
    pub fn origin(mut self, origin: OriginPrimitive) -> Self {
        self.settings.origin = origin;
        self
    }

    /// Sets the origin primitive of each ray of a batch, in the order of the rays. Rays beyond the end of the slice
    /// use that of [`Self::origin`]. A single ray is a batch of one.
    ///
    /// ```
    /// # use lookfrom_bvh::{Builder, Hit, OriginPrimitive, Ray, Triangles};
    /// # let mut builder = Builder::new();
    /// # let positions = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    /// # builder.triangles(Triangles { positions: &positions, indices: &[[0, 1, 2]] });
    /// # let bvh = builder.build()?;
    /// let ray = Ray::new([0.2, 0.2, 1.0], [0.0, 0.0, -1.0]);
    /// let wall = OriginPrimitive::of(&bvh.closest_hit(&ray));
    /// let mut occluded = [true, false];
    /// bvh.query().origins(&[wall, OriginPrimitive::NONE]).occluded_many(&[ray, ray], &mut occluded);
    /// assert_eq!(occluded, [false, true]);
    /// # Ok::<(), lookfrom_bvh::BuildError>(())
    /// ```
    pub fn origins(mut self, origins: &'a [OriginPrimitive]) -> Self {
        self.settings.origins = origins;
        self
    }

    /// The time of all rays and points, 0 … 1, for what moves ([`Builder::moving_triangles`](crate::Builder::moving_triangles),
    /// [`Builder::moving_instance`](crate::Builder::moving_instance)); 0 without it.
    ///
    /// ```
    /// use lookfrom_bvh::{Affine, Builder, Ray, Sphere};
    /// let mut ball = Builder::new();
    /// ball.spheres(&[Sphere { center: [0.0; 3], radius: 1.0 }]);
    /// let up = Affine { translation: [0.0, 0.0, 4.0], ..Affine::IDENTITY };
    /// let mut builder = Builder::new();
    /// builder.moving_instance(ball.build()?.into(), &[Affine::IDENTITY, up]);
    /// let (bvh, ray) = (builder.build()?, Ray::new([0.0; 3], [0.0, 0.0, 1.0]));
    /// assert_eq!(bvh.query().time(0.5).closest_hit(&ray).t, 1.0);
    /// # Ok::<(), lookfrom_bvh::BuildError>(())
    /// ```
    pub fn time(mut self, time: f32) -> Self {
        self.settings.time = time;
        self
    }

    /// The time of each ray or point, in their order; those beyond the end have that of [`Self::time`].
    ///
    /// ```
    /// use lookfrom_bvh::{Affine, Builder, Hit, Ray, Sphere};
    /// let mut ball = Builder::new();
    /// ball.spheres(&[Sphere { center: [0.0; 3], radius: 1.0 }]);
    /// let up = Affine { translation: [0.0, 0.0, 4.0], ..Affine::IDENTITY };
    /// let mut builder = Builder::new();
    /// builder.moving_instance(ball.build()?.into(), &[Affine::IDENTITY, up]);
    /// let (bvh, ray) = (builder.build()?, Ray::new([0.0, 0.0, -2.0], [0.0, 0.0, 1.0]));
    /// let mut hits = [Hit::MISS; 2];
    /// bvh.query().times(&[0.0, 1.0]).closest_hits(&[ray, ray], &mut hits);
    /// assert_eq!(hits.map(|hit| hit.t), [1.0, 5.0]);
    /// # Ok::<(), lookfrom_bvh::BuildError>(())
    /// ```
    pub fn times(mut self, times: &'a [f32]) -> Self {
        self.settings.times = times;
        self
    }

    /// The point of `hit`, which is one of `ray` with this tree at the query's time ([`Self::time`]; of [`Self::times`], the first):
    /// as [`Bvh::hit_point`], whatever else the query selects.
    ///
    /// ```
    /// use lookfrom_bvh::{Affine, Builder, Ray, Sphere};
    /// let mut ball = Builder::new();
    /// ball.spheres(&[Sphere { center: [0.0; 3], radius: 1.0 }]);
    /// let up = Affine { translation: [0.0, 0.0, 4.0], ..Affine::IDENTITY };
    /// let mut builder = Builder::new();
    /// builder.moving_instance(ball.build()?.into(), &[Affine::IDENTITY, up]);
    /// let (bvh, ray) = (builder.build()?, Ray::new([0.0, 0.0, -2.0], [0.0, 0.0, 1.0]));
    /// let query = bvh.query().time(0.5);
    /// let at = query.hit_point(&ray, &query.closest_hit(&ray)).unwrap();
    /// assert_eq!((at.point.position, at.normal), ([0.0, 0.0, 1.0], [0.0, 0.0, -1.0]));
    /// # Ok::<(), lookfrom_bvh::BuildError>(())
    /// ```
    pub fn hit_point(&self, ray: &Ray, hit: &Hit) -> Option<HitPoint> {
        self.settings.bvh.hit_point_at(ray, hit, self.settings.time_of(0))
    }

    /// Notifies an observer of every node and candidate, including primitives that the query does not see. The
    /// results are the same. Batches are traced ray by ray, in order, on this thread.
    ///
    /// ```
    /// # use lookfrom_bvh::{Builder, Observer, Ray, Sphere};
    /// # let mut builder = Builder::new();
    /// # builder.spheres(&[Sphere { center: [0.0; 3], radius: 1.0 }]);
    /// # let bvh = builder.build()?;
    /// struct Candidates(u32);
    /// impl Observer for Candidates {
    ///     fn candidate(&mut self, _: u32, _: u32, _: u32) {
    ///         self.0 += 1;
    ///     }
    /// }
    /// let mut candidates = Candidates(0);
    /// let hit = bvh.query().observer(&mut candidates).closest_hit(&Ray::new([0.0, 0.0, 3.0], [0.0, 0.0, -1.0]));
    /// assert_eq!((hit.t, candidates.0), (2.0, 1));
    /// # Ok::<(), lookfrom_bvh::BuildError>(())
    /// ```
    pub fn observer(self, observer: &mut dyn Observer) -> Query<'a, &mut dyn Observer> {
        Query { settings: self.settings, observer }
    }
}

impl<O: Listener> Query<'_, O> {
    /// The hit with the smallest t in the ray's range, or a miss. Of several hits at equal t it is the one with the
    /// lowest ids: geometry outside of instances comes first, then by instance, geometry and primitive.
    ///
    /// For a [`RayF64`](crate::RayF64) `t` is right to about 10⁻¹⁵ of sizes and distances, `u` and `v` to about
    /// 10⁻¹⁰ (less where a triangle is seen nearly edge-on); procedural shapes are queried in f32. It takes several
    /// times as long as a [`Ray`].
    ///
    /// ```
    /// use lookfrom_bvh::{Builder, RayF64, Triangles};
    /// let mut builder = Builder::new();
    /// let positions = [[0.0, 0.0, 1.0], [1.0, 0.0, 1.0], [0.0, 1.0, 1.0]];
    /// builder.triangles(Triangles { positions: &positions, indices: &[[0, 1, 2]] });
    /// let bvh = builder.build()?;
    /// let hit = bvh.query().closest_hit(&RayF64::new([0.1, 0.2, 1.0 - 1e-12], [0.0, 0.0, 1e-12]));
    /// assert!((hit.t - 1.0).abs() < 1e-4 && (hit.u - 0.1).abs() < 1e-15 && (hit.v - 0.2).abs() < 1e-15);
    /// # Ok::<(), lookfrom_bvh::BuildError>(())
    /// ```
    pub fn closest_hit<R: TraceRay>(mut self, ray: &R) -> R::Hit {
        R::closest_hit(&self.settings, ray, self.observer.observer())
    }

    /// True if there is a hit in the ray's range.
    ///
    /// ```
    /// use lookfrom_bvh::{Builder, RayF64, Sphere};
    /// let mut builder = Builder::new();
    /// builder.spheres(&[Sphere { center: [0.0; 3], radius: 1.0 }]);
    /// let bvh = builder.build()?;
    /// let ray = RayF64::new([0.0, 0.0, 3.0], [0.0, 0.0, -1.0]);
    /// assert!(bvh.query().occluded(&RayF64 { t_max: 2.0 + 1e-15, ..ray }));
    /// assert!(!bvh.query().occluded(&RayF64 { t_max: 2.0, ..ray }));
    /// # Ok::<(), lookfrom_bvh::BuildError>(())
    /// ```
    pub fn occluded<R: TraceRay>(mut self, ray: &R) -> bool {
        R::occluded(&self.settings, ray, self.observer.observer())
    }

    /// Replaces the content of `hits` by all hits in the ray's range, sorted by t, ties as in
    /// [`Self::closest_hit`]. A triangle gives at most one hit, a sphere two, a procedural shape one (its nearest).
    ///
    /// ```
    /// use lookfrom_bvh::{Builder, Faces, Ray, Sphere};
    /// let mut builder = Builder::new();
    /// builder.spheres(&[Sphere { center: [0.0; 3], radius: 1.0 }]);
    /// let bvh = builder.build()?;
    /// let ray = Ray::new([0.0, 0.0, 3.0], [0.0, 0.0, -1.0]);
    /// let mut hits = Vec::new();
    /// bvh.query().all_hits(&ray, &mut hits);
    /// assert_eq!(hits.iter().map(|hit| hit.t).collect::<Vec<_>>(), [2.0, 4.0]);
    /// # Ok::<(), lookfrom_bvh::BuildError>(())
    /// ```
    pub fn all_hits<R: TraceRay>(mut self, ray: &R, hits: &mut Vec<R::Hit>) {
        hits.clear();
        R::all_hits(&self.settings, ray, hits, self.observer.observer());
    }

    /// [`Self::all_hits`], but only those where the ray crosses a surface, each once: where it meets an edge or corner that
    /// triangles share it crosses those that it would hit if it were moved aside by an infinitely small amount. That is one of
    /// two triangles on different sides of the ray, and both or neither of two on the same side, whose edge it touches.
    /// So a line crosses a closed mesh an even number of times, and a ray crosses it an odd number of times if and only if it
    /// starts inside.
    ///
    /// ```
    /// use lookfrom_bvh::{Builder, Ray, Triangles};
    /// let positions = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
    /// let mut builder = Builder::new();
    /// builder.triangles(Triangles { positions: &positions, indices: &[[0, 1, 2], [0, 2, 3]] });
    /// let bvh = builder.build()?;
    /// let through_the_diagonal = Ray::new([0.5, 0.5, 1.0], [0.0, 0.0, -1.0]);
    /// let mut hits = Vec::new();
    /// bvh.query().all_hits(&through_the_diagonal, &mut hits);
    /// assert_eq!(hits.len(), 2);
    /// bvh.query().crossings(&through_the_diagonal, &mut hits);
    /// assert_eq!(hits.len(), 1);
    /// # Ok::<(), lookfrom_bvh::BuildError>(())
    /// ```
    pub fn crossings<R: TraceRay>(mut self, ray: &R, hits: &mut Vec<R::Hit>) {
        self.settings.crossings = true;
        self.all_hits(ray, hits);
    }

    /// [`Self::closest_hit`] for each ray, on several threads where there are many. Coherent [`Ray`]s
    /// are traced in packets. The two slices should have equal lengths; the surplus of the longer one is ignored.
    ///
    /// ```
    /// # use lookfrom_bvh::{Builder, Faces, Hit, Ray, Sphere};
    /// # let mut builder = Builder::new();
    /// # builder.spheres(&[Sphere { center: [0.0; 3], radius: 1.0 }]);
    /// # let bvh = builder.build()?;
    /// let rays = [3.0, -3.0].map(|z| Ray::new([0.0, 0.0, z], [0.0, 0.0, -1.0]));
    /// let mut hits = [Hit::MISS; 2];
    /// bvh.query().faces(Faces::Front).closest_hits(&rays, &mut hits);
    /// assert_eq!(hits.map(|hit| hit.is_hit()), [true, false]);
    /// # Ok::<(), lookfrom_bvh::BuildError>(())
    /// ```
    pub fn closest_hits<R: TraceRay>(mut self, rays: &[R], hits: &mut [R::Hit]) {
        if self.observer.observer().is_some() {
            for (number, (ray, hit)) in rays.iter().zip(hits).enumerate() {
                *hit = R::closest_hit(&self.settings.from(number), ray, self.observer.observer());
            }
        } else {
            R::closest_hits(&self.settings, rays, hits);
        }
    }

    /// [`Self::occluded`] for each ray, as [`Self::closest_hits`].
    ///
    /// ```
    /// # use lookfrom_bvh::{Builder, Faces, Ray, Sphere};
    /// # let mut builder = Builder::new();
    /// # builder.spheres(&[Sphere { center: [0.0; 3], radius: 1.0 }]);
    /// # let bvh = builder.build()?;
    /// let rays = [3.0, 0.0].map(|z| Ray::new([0.0, 0.0, z], [0.0, 0.0, -1.0]));
    /// let mut occluded = [false; 2];
    /// bvh.query().faces(Faces::Front).occluded_many(&rays, &mut occluded);
    /// assert_eq!(occluded, [true, false]);
    /// # Ok::<(), lookfrom_bvh::BuildError>(())
    /// ```
    pub fn occluded_many<R: TraceRay>(mut self, rays: &[R], occluded: &mut [bool]) {
        if self.observer.observer().is_some() {
            for (number, (ray, occluded)) in rays.iter().zip(occluded).enumerate() {
                *occluded = R::occluded(&self.settings.from(number), ray, self.observer.observer());
            }
        } else {
            R::occluded_many(&self.settings, rays, occluded);
        }
    }
}

/// Closest points, of what the query's mask selects, at its times. Faces and origin primitives do not matter, and observers are not
/// told.
impl<O> Query<'_, O> {
    /// [`Bvh::closest_point`].
    ///
    /// ```
    /// use lookfrom_bvh::{Affine, Builder, Sphere};
    /// let mut ball = Builder::new();
    /// ball.spheres(&[Sphere { center: [0.0; 3], radius: 1.0 }]);
    /// let up = Affine { translation: [0.0, 0.0, 4.0], ..Affine::IDENTITY };
    /// let mut builder = Builder::new();
    /// builder.moving_instance(ball.build()?.into(), &[Affine::IDENTITY, up]);
    /// let bvh = builder.build()?;
    /// let nearest = bvh.query().time(0.5).closest_point([0.0, 0.0, 6.0], f32::INFINITY).unwrap();
    /// assert_eq!((nearest.position, nearest.distance), ([0.0, 0.0, 3.0], 3.0));
    /// # Ok::<(), lookfrom_bvh::BuildError>(())
    /// ```
    pub fn closest_point(&self, point: [f32; 3], max_distance: f32) -> Option<ClosestPoint> {
        closest_point::closest_point(&self.settings, point, max_distance)
    }

    /// [`Bvh::closest_points`].
    ///
    /// ```
    /// # use lookfrom_bvh::{Builder, Sphere};
    /// # let mut builder = Builder::new();
    /// let ball = builder.spheres(&[Sphere { center: [0.0; 3], radius: 1.0 }]);
    /// builder.geometry_mask(ball, 0b10);
    /// let bvh = builder.build()?;
    /// let mut nearest = [None];
    /// bvh.query().mask(0b01).closest_points(&[[3.0, 0.0, 0.0]], f32::INFINITY, &mut nearest);
    /// assert!(nearest[0].is_none());
    /// # Ok::<(), lookfrom_bvh::BuildError>(())
    /// ```
    pub fn closest_points(
        &self,
        points: &[[f32; 3]],
        max_distance: f32,
        nearest: &mut [Option<ClosestPoint>],
    ) {
        let settings = self.settings;
        for_each(points, nearest, |number, &point, nearest| {
            *nearest = closest_point::closest_point(&settings.from(number), point, max_distance);
        });
    }

    /// [`Bvh::is_near`].
    ///
    /// ```
    /// # use lookfrom_bvh::{Builder, Sphere};
    /// # let mut builder = Builder::new();
    /// let ball = builder.spheres(&[Sphere { center: [0.0; 3], radius: 1.0 }]);
    /// builder.geometry_mask(ball, 0b10);
    /// let bvh = builder.build()?;
    /// let is_near = |mask| bvh.query().mask(mask).is_near([3.0, 0.0, 0.0], 2.0);
    /// assert!(is_near(0b11) && !is_near(0b01));
    /// # Ok::<(), lookfrom_bvh::BuildError>(())
    /// ```
    pub fn is_near(&self, point: [f32; 3], max_distance: f32) -> bool {
        closest_point::is_near(&self.settings, point, max_distance)
    }

    /// [`Bvh::are_near`].
    ///
    /// ```
    /// # use lookfrom_bvh::{Builder, Sphere};
    /// # let mut builder = Builder::new();
    /// let ball = builder.spheres(&[Sphere { center: [0.0; 3], radius: 1.0 }]);
    /// builder.geometry_mask(ball, 0b10);
    /// let mut near = [true];
    /// builder.build()?.query().mask(0b01).are_near(&[[3.0, 0.0, 0.0]], 2.0, &mut near);
    /// assert!(!near[0]);
    /// # Ok::<(), lookfrom_bvh::BuildError>(())
    /// ```
    pub fn are_near(&self, points: &[[f32; 3]], max_distance: f32, near: &mut [bool]) {
        let settings = self.settings;
        for_each(points, near, |number, &point, near| {
            *near = closest_point::is_near(&settings.from(number), point, max_distance);
        });
    }
}
