//! Lens systems: rays from the film through each surface to the scene. Kolb, Mitchell, Hanrahan (1995), "A Realistic Camera Model for
//! Computer Graphics"; sampled and weighted as in Pharr, Jakob, Humphreys (2023), "Physically Based Rendering", 5.4.
//!
//! *Lens space*: x to the viewer's right, y up, z along the axis to the scene, in units of the world; the film is in z = 0.
//!
//! A surface of curvature c and vertex v is met where c|q|² + 2 q_z = 0, with q = p − v; the root is the one near the vertex, and
//! c q + z is the normal, of unit length (Feder 1951, "Optical Calculations with Automatic Computing Machinery"). All is
//! generic over the width, so that eight rays cross together.

mod aperture;
mod focus;
mod pupil;
#[cfg(test)]
pub(crate) mod tests;

use lookfrom_scene::lens::{LensConvention, LensSurface, LensSystem as Written};
use lookfrom_scene::{Error, Location, Result};
use lookfrom_simd::{Float, Real};

use crate::core::vector::Vector;
use aperture::ApertureImage;
use focus::ThickLens;
use pupil::{ExitPupil, INTERVALS};

/// A lens system that is focused, with the bounds of its exit pupil.
#[derive(Clone, Debug, PartialEq)]
pub struct LensSystem {
    /// From the film to the front.
    surfaces: Vec<Surface>,
    /// The stop's transmittance, where it is no circle.
    aperture: Option<ApertureImage>,
    /// Distance of the rear surface's vertex from the film.
    rear: f64,
    /// Radius of the rear surface.
    rear_radius: f64,
    /// Radius of the stop nearest to the film, which shapes fill.
    stop_radius: f64,
    /// Half the film's diagonal.
    film_radius: f64,
    /// Focal length, principal planes and magnification.
    thick: ThickLens,
    pupil: ExitPupil,
    /// The factor of all weights.
    exposure: f64,
    /// The irradiance of the film's middle relative to the radiance that it sees, in steradians.
    irradiance: f64,
}

/// A surface, in lens space.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Surface {
    /// z of its vertex.
    vertex: f64,
    /// 1 / radius of curvature, positive where the centre lies toward the film; 0 for the stop.
    curvature: f64,
    /// Index of refraction on the film's side over that on the scene's side; `None` for the stop.
    ratio: Option<f64>,
    /// The square of the radius of its aperture, or of a circle around the shape of the stop.
    radius_squared: f64,
}

/// Rays on their way through a lens system.
#[derive(Clone, Copy, Debug)]
struct LensRay<F: Float> {
    p: Vector<F>,
    /// The direction, of unit length.
    d: Vector<F>,
    /// Their points in the plane of the stop, x and y.
    on_stop: [F; 2],
    passes: F::Mask,
}

/// Rays that leave a lens system, in lens space.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LeavingRay<R: Real> {
    /// The point on the front surface.
    pub(crate) origin: Vector<R::Double>,
    /// The direction, of unit length.
    pub(crate) direction: Vector<R::Double>,
    /// The factor of its light; 0 where it is blocked, and the ray means nothing.
    pub(crate) weight: R,
}

/// A ray at a surface, in lens space: data for the inspector.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossing {
    /// The point where the ray meets the surface; NaN if it does not.
    pub point: [f64; 3],
    /// The direction behind it, of unit length; NaN after a total reflection.
    pub direction: [f64; 3],
    /// Whether light passes: the point is within the aperture, and the light is refracted.
    pub passes: bool,
}

/// The section of a surface through the axis, in lens space: data for the inspector.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Section {
    /// z of its vertex.
    pub vertex: f64,
    /// 1 / radius of curvature, positive where the centre lies toward the film; 0 for planes and the stop.
    pub curvature: f64,
    /// Radius of its aperture.
    pub radius: f64,
    /// Index of refraction on the scene's side over that on the film's side; `None` for the stop.
    pub index_ratio: Option<f64>,
}

impl LensSystem {
    /// The system focused at its distance.
    ///
    /// # Errors
    /// `Invalid` for lengths that are not positive and finite, an aperture without light, a distance too near for a sharp
    /// image, and a system that no light passes.
    pub fn new(written: &Written, at: &Location) -> Result<Self> {
        let name = &written.name;
        for (what, value) in [
            ("the focus distance", written.focus_distance),
            ("the diagonal of the film", written.film_diagonal),
            ("the size of a millimetre", written.millimetre),
            ("the diameter of the aperture", written.stop_diameter.unwrap_or(1.0)),
        ] {
            if !(value > 0.0 && value.is_finite()) {
                return Err(Error::invalid(at, format!("{what} is {value}; expected a positive number")));
            }
        }
        // Without a stop there is nothing that has a shape.
        let has_stop = written.surfaces.iter().any(LensSurface::is_stop);
        let aperture = ApertureImage::new(&written.shape, at)?.filter(|_| has_stop);
        let thick = focus::focused(written, at)?;
        let mut vertex = thick.rear;
        let mut surfaces: Vec<Surface> = Vec::with_capacity(written.surfaces.len());
        for (place, surface) in written.surfaces.iter().enumerate().rev() {
            if !surfaces.is_empty() {
                vertex += surface.thickness * written.millimetre;
            }
            let before = place.checked_sub(1).map_or(1.0, |place| written.surfaces[place].index);
            let own = surface.diameter;
            let diameter =
                if surface.is_stop() { own.min(written.stop_diameter.unwrap_or(own)) } else { own };
            let radius = 0.5 * diameter * written.millimetre;
            surfaces.push(Surface {
                vertex,
                curvature: if surface.is_stop() {
                    0.0
                } else {
                    1.0 / (surface.curvature_radius * written.millimetre)
                },
                ratio: (!surface.is_stop()).then(|| surface.index / before),
                radius_squared: radius * radius,
            });
        }
        let rear_radius = surfaces.first().map_or(0.0, |rear| rear.radius_squared.sqrt());
        let stop = surfaces.iter().find(|surface| surface.ratio.is_none());
        let stop_radius = stop.map_or(rear_radius, |stop| stop.radius_squared.sqrt());
        let reach = aperture.as_ref().map_or(1.0, ApertureImage::reach);
        for stop in surfaces.iter_mut().filter(|surface| surface.ratio.is_none()) {
            stop.radius_squared *= reach * reach;
        }
        let film_radius = 0.5 * written.film_diagonal * written.millimetre;
        let mut system = Self {
            surfaces,
            aperture,
            rear: thick.rear,
            rear_radius,
            stop_radius,
            film_radius,
            thick,
            pupil: ExitPupil::default(),
            exposure: 1.0,
            irradiance: 0.0,
        };
        system.pupil = ExitPupil::of(&system, written.convention);
        system.irradiance = pupil::irradiance(&system);
        let is_passed = system.irradiance > 0.0 && system.irradiance.is_finite();
        if !is_passed {
            let message = format!("no light from the middle of the film passes the lens system {name:?}");
            return Err(
                Error::invalid(at, message).hint("check the diameters of its surfaces and of the aperture")
            );
        }
        if written.convention == LensConvention::AsPinhole {
            system.exposure = 1.0 / system.irradiance;
        }
        Ok(system)
    }

    /// The rays from points of the film, in lens space, through points of the exit pupil that `u` chooses.
    #[inline(always)]
    pub(crate) fn leaving<R: Real>(&self, film: [R::Double; 2], u: [R; 2]) -> LeavingRay<R> {
        let (on_rear, area) = self.on_rear_plane(film, u);
        let (ray, cosine) = self.toward(film, on_rear);
        let zero = cosine.like(0.0);
        let cosine_squared = cosine * cosine;
        let weight = cosine_squared * cosine_squared * area * (self.exposure / (self.rear * self.rear));
        let ray = self.crossed(ray);
        let weight = R::narrow(<R::Double as Float>::select(ray.passes, weight, zero))
            * self.transmittance::<R>(ray.on_stop);
        LeavingRay { origin: ray.p, direction: ray.d, weight }
    }

    /// Points of the plane through the rear vertex within the bounds of the exit pupil, and the areas of the bounds.
    #[inline(always)]
    fn on_rear_plane<R: Real>(&self, [x, y]: [R::Double; 2], [u, v]: [R; 2]) -> ([R::Double; 2], R::Double) {
        let distance = (x * x + y * y).sqrt();
        let zero = distance.like(0.0);
        let interval =
            R::to_integer(R::narrow(distance * distance.like(INTERVALS as f64 / self.film_radius)));
        let left = R::lookup(interval, |interval| self.pupil.bounds(interval)[0]).widen();
        let right = R::lookup(interval, |interval| self.pupil.bounds(interval)[1]).widen();
        let bottom = R::lookup(interval, |interval| self.pupil.bounds(interval)[2]).widen();
        let top = R::lookup(interval, |interval| self.pupil.bounds(interval)[3]).widen();
        let (width, height) = (right - left, top - bottom);
        let (along, across) = (left + width * u.widen(), bottom + height * v.widen());
        // The bounds are those of film points on the x axis.
        let is_middle = distance.eq(zero);
        let cosine = <R::Double as Float>::select(is_middle, distance.like(1.0), x / distance);
        let sine = <R::Double as Float>::select(is_middle, zero, y / distance);
        ([cosine * along - sine * across, sine * along + cosine * across], width * height)
    }

    /// Rays from points of the film to points of the plane through the rear vertex, and their cosines to the axis.
    #[inline(always)]
    fn toward<F: Float<Scalar = f64>>(&self, [x, y]: [F; 2], [to_x, to_y]: [F; 2]) -> (LensRay<F>, F) {
        let zero = x.like(0.0);
        let d = Vector::new(to_x - x, to_y - y, x.like(self.rear)).normalize();
        let passes = zero.eq(zero);
        (LensRay { p: Vector::new(x, y, zero), d, on_stop: [zero; 2], passes }, d.z)
    }

    /// Rays behind all surfaces.
    #[inline(always)]
    fn crossed<F: Float<Scalar = f64>>(&self, mut ray: LensRay<F>) -> LensRay<F> {
        use lookfrom_simd::Mask;
        for surface in &self.surfaces {
            ray = surface.cross(ray);
            if !ray.passes.any() {
                break;
            }
        }
        ray
    }

    /// The part of the light that passes points of the stop, which are within its circle where that is its shape.
    #[inline(always)]
    fn transmittance<R: Real>(&self, [x, y]: [R::Double; 2]) -> R {
        let one = R::narrow(x).like(1.0);
        match &self.aperture {
            None => one,
            Some(aperture) => R::narrow(x).zip(R::narrow(y), |x, y| aperture.at([x, y], self.stop_radius)),
        }
    }

    /// The crossings of each surface by a ray from a point of the film, through the point of the exit pupil that `u` chooses, from the
    /// film on, up to the one that blocks it: first the point of the film and the direction from there.
    pub fn crossings(&self, film: [f64; 2], u: [f32; 2]) -> Vec<Crossing> {
        let (on_rear, _) = self.on_rear_plane::<f32>(film, u);
        let (mut ray, _) = self.toward(film, on_rear);
        let told = |ray: &LensRay<f64>, passes: bool| Crossing {
            point: [ray.p.x, ray.p.y, ray.p.z],
            direction: [ray.d.x, ray.d.y, ray.d.z],
            passes,
        };
        let mut crossings = vec![told(&ray, true)];
        for surface in &self.surfaces {
            ray = surface.cross(ray);
            let is_dark = surface.ratio.is_none() && self.transmittance::<f32>(ray.on_stop) == 0.0;
            crossings.push(told(&ray, ray.passes && !is_dark));
            if !ray.passes || is_dark {
                break;
            }
        }
        crossings
    }

    /// The surfaces from the film to the front.
    pub fn sections(&self) -> impl Iterator<Item = Section> {
        self.surfaces.iter().map(|surface| Section {
            vertex: surface.vertex,
            curvature: surface.curvature,
            radius: surface.ratio.map_or(self.stop_radius, |_| surface.radius_squared.sqrt()),
            index_ratio: surface.ratio.map(|ratio| 1.0 / ratio),
        })
    }

    /// The effective focal length, in units of the world.
    pub fn focal_length(&self) -> f64 {
        self.thick.focal_length
    }

    /// The working f-number, at the distance that is in focus: that of a thin lens that would light the middle of the film as much.
    pub fn f_number(&self) -> f64 {
        // E = π L sin² of the cone's half angle, and n sin = 1 / 2N.
        0.5 * (std::f64::consts::PI / self.irradiance).sqrt() / self.thick.film_index
    }

    /// Half the diagonal of the film, in units of the world.
    pub fn film_radius(&self) -> f64 {
        self.film_radius
    }

    /// The distance behind a pinhole at the middle of the film at which a film as large would show the plane of focus as large.
    pub(crate) fn pinhole_distance(&self) -> f64 {
        self.thick.pinhole_distance
    }
}

impl Surface {
    /// Rays behind the surface.
    #[inline(always)]
    fn cross<F: Float<Scalar = f64>>(&self, ray: LensRay<F>) -> LensRay<F> {
        let LensRay { p, d, mut on_stop, passes } = ray;
        let zero = p.x.like(0.0);
        let Some(ratio) = self.ratio else {
            let t = (p.x.like(self.vertex) - p.z) / d.z;
            let p = p + d * t;
            on_stop = [p.x, p.y];
            let passes = passes & !t.lt(zero) & self.is_within(p);
            return LensRay { p, d, on_stop, passes };
        };
        let (curvature, ratio) = (zero.like(self.curvature), zero.like(ratio));
        let q = Vector { z: p.z - zero.like(self.vertex), ..p };
        // c t² + 2 b t + e = 0
        let b = curvature * q.dot(d) + d.z;
        let e = curvature * q.dot(q) + (q.z + q.z);
        // The cosine between ray and normal.
        let cos_i = (b * b - curvature * e).sqrt();
        let t = -e / (b + cos_i);
        let (p, q) = (p + d * t, q + d * t);
        // Snell: the part along the surface is scaled by the ratio of indices.
        let cos_t_squared = zero.like(1.0) - ratio * ratio * (zero.like(1.0) - cos_i * cos_i);
        let bend = cos_t_squared.sqrt() - ratio * cos_i;
        let n = Vector { x: curvature * q.x, y: curvature * q.y, z: curvature * q.z + zero.like(1.0) };
        let d = d * ratio + n * bend;
        // NaN does not pass: a ray that misses the sphere, or is totally reflected.
        let passes = passes & self.is_within(p) & !t.lt(zero) & cos_t_squared.gt(zero);
        LensRay { p, d, on_stop, passes }
    }

    #[inline(always)]
    fn is_within<F: Float<Scalar = f64>>(&self, p: Vector<F>) -> F::Mask {
        (p.x * p.x + p.y * p.y).lt(p.x.like(self.radius_squared))
    }
}
