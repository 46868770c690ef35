//! The start of a batch: random numbers of the camera, points of the image, and camera rays, eight side by side where the
//! camera has an image plane.

use std::f32::consts::PI;

use glam::{DMat4, DVec3, Vec3};
use lookfrom_bvh::Ray;
use lookfrom_simd::{Float, Kernel, Real, Simd, dispatch, f32x8, f64x8, level, prelude::*, u32x8, u64x8};

use super::{Renderer, SampleId};
use crate::core::color::Wavelengths;
use crate::core::lanes::{LANES, by_lane, filled, scatter};
use crate::core::sampler::{self, lanes::PixelSamplers};
use crate::core::times::Times;
use crate::core::vector::Vector;
use crate::shading::texture::SpectralMode;
use crate::view::View;
use crate::view::camera::{CameraRay, StartingRay};
use crate::view::lens_system::Crossing;
use crate::world::{MeasuredSurface, World};

/// Dimensions of a sample's random numbers that the camera uses; rays use hashes of their address and dimension.
const LENS_DIMENSION: u32 = 1;
const WAVELENGTH_DIMENSION: u32 = 2;
const TIME_DIMENSION: u32 = 3;
const SURFACE_DIMENSION: u32 = 4;

/// A ray that starts on a surface that is measured.
struct MeasuringRay {
    origin: [f32; 3],
    direction: Vec3,
    /// The factor of its light: π in the mean, since directions have the density cos θ / π.
    weight: f32,
}

/// The camera rays of a batch and what they are made of, by slot: memory that is reused.
#[derive(Debug, Default)]
pub(super) struct Start {
    /// Random numbers, empty where they are not needed.
    wavelengths: Vec<[f32; 2]>,
    /// The range of wavelengths of a spectral film.
    range: Option<[f32; 2]>,
    /// Random numbers: the times of samples while the shutter is open.
    pub(super) times: Times,
    /// Points of the image, in pixels, y up; empty where the camera has an image plane.
    points: Vec<[f64; 2]>,
    /// The rays of the kernel.
    pub(super) rays: Vec<Ray>,
    /// The factors of light: the filter's weights, times those of rays through a lens system or from a surface that is measured.
    pub(super) weights: Vec<f32>,
    /// The filter's weights alone; empty where they are all.
    filter_weights: Vec<f32>,
}

impl Start {
    /// The spectral mode of each sample, or one for all in RGB.
    pub(super) fn modes(&self) -> impl Iterator<Item = SpectralMode> {
        let rgb = self.wavelengths.is_empty().then_some(SpectralMode::Rgb);
        let wavelengths = |[u, _]: &[f32; 2]| match self.range {
            None => Wavelengths::sample_visible(*u),
            Some(range) => Wavelengths::sample_uniform(*u, range),
        };
        rgb.into_iter().chain(self.wavelengths.iter().map(move |u| SpectralMode::Spectral(wavelengths(u))))
    }

    /// Whether there may be rays that a lens system blocks.
    pub(super) fn are_any_blocked(&self) -> bool {
        !self.filter_weights.is_empty()
    }

    /// Whether a lens system blocks the ray of a slot, where it may.
    pub(super) fn is_blocked(&self, slot: usize) -> bool {
        self.weights[slot] == 0.0
    }

    /// The filter's weights, one for each slot.
    pub(super) fn filter_weights(&self) -> &[f32] {
        if self.filter_weights.is_empty() { &self.weights } else { &self.filter_weights }
    }
}

/// Distance of a parallel camera from the scene, in sizes of the scene, beyond which its rays start nearer.
const FAR: f64 = 8.0;

/// The point in render space at or around which rays of a camera start. Those of a parallel camera begin with the scene
/// where it is far away, so that its distance costs no precision; but not in a medium, through all of which light has to go.
pub(super) fn ray_start(world: &World, view: &View, eye: DVec3) -> DVec3 {
    let camera = &view.camera;
    let bounds = world.bvh.bounds();
    let [min, max] = [bounds.min, bounds.max].map(|corner| Vec3::from_array(corner).as_dvec3());
    let is_in_medium = !world.space_of(view.medium).is_empty();
    if !camera.is_parallel() || is_in_medium || !(max - min).is_finite() || min.x > max.x {
        return eye;
    }
    let w = camera.w().normalize();
    let size = (max - min).length();
    let distance = ((min + max) * 0.5 - eye).dot(w) - size;
    if distance > FAR * size { eye + w * distance } else { eye }
}

impl Renderer {
    /// The camera ray of a sample and the filter weight.
    pub fn camera_ray(&self, id: SampleId) -> (CameraRay, f32) {
        let two = |dimension| self.sampler.two(id.pixel, id.sample, dimension);
        let (point, weight) = self.image_point(id.pixel.map(f64::from), two(sampler::PIXEL));
        let ray = self.view.camera.ray(point, two(LENS_DIMENSION));
        let Some(surface) = &self.surface else { return (ray, weight) };
        let MeasuringRay { origin, direction, weight: of_surface } = self.measuring_ray(surface, id);
        let a_from_eye = Vec3::from_array(origin).as_dvec3() - self.ray_start;
        (CameraRay { a_from_eye, direction: direction.as_dvec3(), weight: of_surface, ..ray }, weight)
    }

    /// The ray of a sample on the surface that is measured.
    fn measuring_ray(&self, surface: &MeasuredSurface, id: SampleId) -> MeasuringRay {
        let two = |dimension| self.sampler.two(id.pixel, id.sample, dimension);
        let point = surface.sample(&self.world, two(SURFACE_DIMENSION));
        let (origin, direction) = point.leave(two(LENS_DIMENSION));
        MeasuringRay { origin, direction, weight: PI * point.weight }
    }

    /// The crossings of the lens system by the camera ray of a sample, if the camera has one.
    pub(crate) fn crossings(&self, id: SampleId) -> Option<Vec<Crossing>> {
        let two = |dimension| self.sampler.two(id.pixel, id.sample, dimension);
        let (point, _) = self.image_point(id.pixel.map(f64::from), two(sampler::PIXEL));
        let camera = &self.view.camera;
        Some(camera.lens_system.as_ref()?.crossings(camera.film_point(point)?, two(LENS_DIMENSION)))
    }

    /// Whether light depends on the time: of what moves, or the camera.
    pub(crate) fn moves(&self) -> bool {
        self.world.bvh.is_moving() || self.view.camera.motion.is_some()
    }

    /// The time of a sample while the shutter is open, from 0 to 1; 0 where nothing moves.
    pub(crate) fn time(&self, id: SampleId) -> f32 {
        match self.moves() {
            true => self.sampler.one(id.pixel, id.sample, TIME_DIMENSION),
            false => 0.0,
        }
    }

    /// The time of a sample and the camera's map from where it is when the shutter opens, if it moves.
    pub(crate) fn camera_motion(&self, id: SampleId) -> Option<(f32, DMat4)> {
        let time = self.time(id);
        self.view.camera.motion.as_ref().map(|motion| (time, motion.at(time.into())))
    }

    /// A camera ray as a ray of the kernel, with `t` of the notes: 1 on the image plane. The camera is where it is when the shutter
    /// opens.
    pub(super) fn kernel_ray(&self, ray: &CameraRay) -> Ray {
        let a = self.ray_start + ray.a_from_eye;
        let ray = Ray::new(a.as_vec3().to_array(), ray.direction.as_vec3().to_array());
        self.clip().map_or(ray, |[t_min, t_max]| Ray { t_min, t_max, ..ray })
    }

    /// The range of `t` in which camera rays meet surfaces, between the clipping planes of the camera, if it has any.
    fn clip(&self) -> Option<[f32; 2]> {
        let camera = &self.view.camera;
        let planes = camera.clip.filter(|_| camera.is_flat())?;
        // Rays of parallel cameras may start before the eye.
        let (w, eye) = (camera.w(), camera.lookfrom() - self.world.origin());
        let start = (self.ray_start - eye).dot(w) / w.length_squared();
        Some(planes.map(|distance| (((distance - start) / camera.distance) as f32).max(0.0)))
    }

    /// Replaces `start` by the camera rays of the samples.
    pub(super) fn start(&self, ids: &[SampleId], start: &mut Start) {
        let Start { wavelengths, range, times, points, rays, weights, filter_weights } = start;
        *range = self.image().spectral_film.as_ref().map(|film| film.range);
        let camera = &self.view.camera;
        let count = if self.is_spectral() { ids.len() } else { 0 };
        self.sampler.two_of_each(count, |k| (ids[k].pixel, ids[k].sample), WAVELENGTH_DIMENSION, wavelengths);
        points.clear();
        weights.clear();
        filter_weights.clear();
        rays.clear();
        let moving = if self.moves() { ids } else { &[] };
        times.replace(moving.iter().map(|id| self.time(*id)));
        if camera.is_flat() {
            dispatch(level(), FlatRays { renderer: self, ids, rays, weights, filter_weights });
            if let Some([t_min, t_max]) = self.clip() {
                rays.iter_mut().for_each(|ray| (ray.t_min, ray.t_max) = (t_min, t_max));
            }
        } else {
            dispatch(level(), ImagePoints { renderer: self, ids, points, weights });
        }
        if let Some(surface) = &self.surface {
            filter_weights.clone_from(weights);
            for (id, weight) in ids.iter().zip(weights) {
                let MeasuringRay { origin, direction, weight: of_surface } = self.measuring_ray(surface, *id);
                rays.push(Ray::new(origin, direction.to_array()));
                *weight *= of_surface;
            }
        } else if !camera.is_flat() {
            rays.extend(points.iter().map(|point| self.kernel_ray(&camera.ray(*point, [0.5; 2]))));
        }
        if let Some(motion) = &camera.motion {
            for (ray, time) in rays.iter_mut().zip(times.as_slice()) {
                *ray = self.moved(&motion.at((*time).into()), ray);
            }
        }
    }

    /// A ray of the camera where that has moved to, by a map of the world.
    fn moved(&self, map: &DMat4, ray: &Ray) -> Ray {
        let origin = self.world.origin();
        let [a, direction] = [ray.origin, ray.direction].map(|v| Vec3::from_array(v).as_dvec3());
        let a = map.transform_point3(a + origin) - origin;
        let direction = map.transform_vector3(direction);
        Ray { origin: a.as_vec3().to_array(), direction: direction.as_vec3().to_array(), ..*ray }
    }

    /// The point of the image that the filter chooses by `u`, in pixels, y up, and the filter's weight; in the pixel of a
    /// column and a row.
    #[inline(always)]
    fn image_point<R: Real>(&self, [column, row]: [R::Double; 2], u: [R; 2]) -> ([R::Double; 2], R) {
        let ([x, y], weight) = self.filter.sample(u);
        let half = column.like(0.5);
        let height = column.like(f64::from(self.view.image.height));
        ([column + half + x.widen(), height - (row + half + y.widen())], weight)
    }

    /// [`Self::image_point`] of up to eight samples, each with its random numbers, and those for the lens, if they are drawn.
    /// Unused lanes repeat the last one.
    #[inline(always)]
    fn image_points<S: Simd>(
        &self,
        simd: S,
        ids: &[SampleId],
        has_lens: bool,
    ) -> ([f64x8<S>; 2], f32x8<S>, [f32x8<S>; 2]) {
        let mut memory = None;
        let ids = filled(ids, &mut memory);
        let columns = f32x8::extend(u32x8::load_array(simd, by_lane!(lane => ids[lane].pixel[0])));
        let rows = f32x8::extend(u32x8::load_array(simd, by_lane!(lane => ids[lane].pixel[1])));
        let samples = u32x8::load_array(simd, by_lane!(lane => ids[lane].sample));
        let samplers = PixelSamplers::of_pixels(&self.sampler, columns | (rows << 32));
        let u = samplers.two(samples, u64x8::splat(simd, u64::from(sampler::PIXEL)));
        let (point, weight) = self.image_point([below_2_to_52(columns), below_2_to_52(rows)], u);
        let lens = match has_lens {
            true => samplers.two(samples, u64x8::splat(simd, u64::from(LENS_DIMENSION))),
            false => [f32x8::splat(simd, 0.5); 2],
        };
        (point, weight, lens)
    }
}

/// Integers below 2⁵² as numbers, exactly.
#[inline(always)]
fn below_2_to_52<S: Simd>(integers: u64x8<S>) -> f64x8<S> {
    const TWO_TO_52: f64 = 4_503_599_627_370_496.0;
    let sums: f64x8<S> = (integers | TWO_TO_52.to_bits()).bitcast();
    sums - TWO_TO_52
}

/// Appends the points of the image for samples, in pixels, y up, and the filter's weights.
struct ImagePoints<'a> {
    renderer: &'a Renderer,
    ids: &'a [SampleId],
    points: &'a mut Vec<[f64; 2]>,
    weights: &'a mut Vec<f32>,
}

impl Kernel for ImagePoints<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let Self { renderer, ids, points, weights } = self;
        for ids in ids.chunks(LANES) {
            let ([x, y], weight, _) = renderer.image_points(simd, ids, false);
            let (x, y, weight): ([f64; LANES], [f64; LANES], [f32; LANES]) =
                (x.into(), y.into(), weight.into());
            points.extend_from_slice(&by_lane!(lane => [x[lane], y[lane]])[..ids.len()]);
            weights.extend_from_slice(&weight[..ids.len()]);
        }
    }
}

/// Appends the rays of a camera with an image plane for samples, the factors of their light, and the filter's weights where those
/// are others.
struct FlatRays<'a> {
    renderer: &'a Renderer,
    ids: &'a [SampleId],
    rays: &'a mut Vec<Ray>,
    weights: &'a mut Vec<f32>,
    filter_weights: &'a mut Vec<f32>,
}

impl Kernel for FlatRays<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let Self { renderer, ids, rays, weights, filter_weights } = self;
        let camera = &renderer.view.camera;
        rays.reserve(ids.len());
        weights.reserve(ids.len());
        let has_lens = camera.has_lens();
        let eye = Vector::splat(f64x8::splat(simd, 0.0), renderer.ray_start.to_array());
        for ids in ids.chunks(LANES) {
            let (point, weight, lens) = renderer.image_points(simd, ids, has_lens);
            let StartingRay { a, direction, weight: of_lens } = camera.flat_ray(point, lens);
            let origins = scatter(Vector::<f32x8<S>>::narrow(eye + a));
            let directions = scatter(Vector::<f32x8<S>>::narrow(direction));
            rays.extend_from_slice(&by_lane!(lane => Ray::new(origins[lane], directions[lane]))[..ids.len()]);
            let mut all: [f32; LANES] = weight.into();
            if camera.lens_system.is_some() {
                filter_weights.extend_from_slice(&all[..ids.len()]);
                all = (weight * of_lens).into();
            }
            weights.extend_from_slice(&all[..ids.len()]);
        }
    }
}
