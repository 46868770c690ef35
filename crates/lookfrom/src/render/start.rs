//! The start of a batch: random numbers of the camera, and camera rays, eight side by side where the camera is linear.

use glam::DVec3;
use lookfrom_bvh::Ray;
use lookfrom_simd::{Float, Kernel, Simd, dispatch, f32x8, f64x8, level, prelude::*};

use super::{Renderer, SampleId};
use crate::core::lanes::{LANES, by_lane, scatter};
use crate::core::vector::Vector;
use crate::shading::texture::SpectralMode;
use crate::view::camera::{Camera, CameraRay};

/// Dimensions of a sample's random numbers that the camera uses; rays use hashes of their address and dimension.
const FILTER_DIMENSION: u32 = 0;
const LENS_DIMENSION: u32 = 1;
const WAVELENGTH_DIMENSION: u32 = 2;

/// The camera rays of a batch and what they are made of, by slot: memory that is reused.
#[derive(Debug, Default)]
pub(super) struct Start {
    /// Random numbers, empty where they are not needed.
    filter: Vec<[f32; 2]>,
    lens: Vec<[f32; 2]>,
    wavelengths: Vec<[f32; 2]>,
    /// Points of the image, in pixels, y up.
    points: Vec<[f64; 2]>,
    /// The rays of the kernel.
    pub(super) rays: Vec<Ray>,
    /// The filter's weights.
    pub(super) weights: Vec<f32>,
}

impl Start {
    /// The spectral mode of a sample.
    #[inline]
    pub(super) fn lanes(&self, slot: usize) -> SpectralMode {
        self.wavelengths.get(slot).map_or(SpectralMode::Rgb, |u| super::lanes_by(*u))
    }
}

impl Renderer {
    /// The camera ray of a sample and the filter weight.
    pub fn camera_ray(&self, id: SampleId) -> (CameraRay, f32) {
        let two = |dimension| self.sampler.two(id.pixel, id.sample, dimension);
        let (point, weight) = self.image_point(id, two(FILTER_DIMENSION));
        (self.view.camera.ray(point, two(LENS_DIMENSION)), weight)
    }

    /// A camera ray as a ray of the kernel, with `t` of the notes: 1 on the image plane.
    pub(super) fn kernel_ray(&self, ray: &CameraRay) -> Ray {
        let a = self.eye + ray.a_from_eye;
        Ray::new(a.as_vec3().to_array(), ray.direction.as_vec3().to_array())
    }

    /// Replaces `start` by the camera rays of the samples.
    pub(super) fn start(&self, ids: &[SampleId], start: &mut Start) {
        let Start { filter, lens, wavelengths, points, rays, weights } = start;
        let camera = &self.view.camera;
        let draw = |is_sampled: bool, dimension: u32, numbers: &mut Vec<[f32; 2]>| {
            let count = if is_sampled { ids.len() } else { 0 };
            self.sampler.two_of_each(count, |k| (ids[k].pixel, ids[k].sample), dimension, numbers);
        };
        draw(true, FILTER_DIMENSION, filter);
        draw(camera.lens.is_some(), LENS_DIMENSION, lens);
        draw(self.is_spectral(), WAVELENGTH_DIMENSION, wavelengths);

        points.clear();
        weights.clear();
        rays.clear();
        points.extend(ids.iter().zip(&*filter).map(|(id, u)| {
            let (point, weight) = self.image_point(*id, *u);
            weights.push(weight);
            point
        }));
        if camera.is_linear() {
            dispatch(level(), LinearRays { camera, eye: self.eye, points, rays });
        } else {
            rays.extend(points.iter().enumerate().map(|(slot, point)| {
                self.kernel_ray(&camera.ray(*point, lens.get(slot).copied().unwrap_or_default()))
            }));
        }
    }

    /// The point of the image that the filter chooses by `u`, in pixels, y up, and the filter's weight.
    #[inline]
    fn image_point(&self, id: SampleId, u: [f32; 2]) -> ([f64; 2], f32) {
        let [column, row] = id.pixel.map(f64::from);
        let (offset, weight) = self.filter.sample(u);
        let x_k = column + 0.5 + f64::from(offset[0]);
        let y_k = f64::from(self.view.image.height) - (row + 0.5 + f64::from(offset[1]));
        ([x_k, y_k], weight)
    }
}

/// Appends the rays of a linear camera through points of the image.
struct LinearRays<'a> {
    camera: &'a Camera,
    eye: DVec3,
    points: &'a [[f64; 2]],
    rays: &'a mut Vec<Ray>,
}

impl Kernel for LinearRays<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let Self { camera, eye, points, rays } = self;
        rays.reserve(points.len());
        for points in points.chunks(LANES) {
            // Unused lanes repeat the last point.
            let last = points.len() - 1;
            let x = f64x8::load_array(simd, by_lane!(lane => points[lane.min(last)][0]));
            let y = f64x8::load_array(simd, by_lane!(lane => points[lane.min(last)][1]));
            let [a, direction] = camera.linear_ray([x, y]);
            let eye = Vector { x: x.like(eye.x), y: x.like(eye.y), z: x.like(eye.z) };
            let origins = scatter(Vector::<f32x8<S>>::narrow(eye + a));
            let directions = scatter(Vector::<f32x8<S>>::narrow(direction));
            for lane in 0..points.len() {
                rays.push(Ray::new(origins[lane], directions[lane]));
            }
        }
    }
}
