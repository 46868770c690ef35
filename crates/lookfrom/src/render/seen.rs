//! What the camera sees first: a watcher of the way of a batch that keeps the features of its camera rays.

use glam::{DMat4, DVec3, Vec3};

use super::Renderer;
use crate::film::Features;
use crate::integrator::{Event, Probe};
use crate::material::Shading;
use crate::spectrum::Spectrum;
use crate::surface::Surface;
use crate::texture::Lanes;

/// How many directions along each axis a material is asked in for its albedo.
const ALBEDO_GRID: u32 = 4;

/// Keeps the first surface of each sample.
pub(super) struct Seen<'a> {
    renderer: &'a Renderer,
    /// By slot: what the lanes meant at the start.
    lanes: Vec<Lanes>,
    /// To the camera's space, where x is to the left.
    view_from_world: DMat4,
    /// By slot.
    features: Vec<Option<Features>>,
    /// The slot of the path that is being followed, where it comes from the camera.
    current: Option<usize>,
}

impl<'a> Seen<'a> {
    pub(super) fn new(renderer: &'a Renderer, lanes: Vec<Lanes>) -> Self {
        let view_from_world = renderer.view.camera.world_from_view().inverse();
        Self { renderer, view_from_world, features: vec![None; lanes.len()], lanes, current: None }
    }

    /// By slot.
    pub(super) fn into_features(self) -> Vec<Option<Features>> {
        self.features
    }

    /// Keeps a surface that is shaded with `ns`, a unit vector of render space.
    fn see(&mut self, surface: &Surface, ns: Vec3, albedo: Spectrum) {
        let Some(slot) = self.current else { return };
        let world = &self.renderer.world;
        let lanes = &self.lanes[slot];
        let albedo = match lanes {
            Lanes::Rgb => albedo.rgb(),
            Lanes::Spectral(wavelengths) => {
                let white = world.light_of([1.0; 3], lanes);
                self.renderer.plain_sensor.rgb(albedo * white, wavelengths)
            }
        };
        // From render space to the features', where x is to the right.
        let mirrored = |v: DVec3| Vec3::new(-v.x as f32, v.y as f32, v.z as f32);
        let point = world.origin + DVec3::from_array(surface.point.position);
        let position = mirrored(self.view_from_world.transform_point3(point));
        let wo = surface.wo.as_dvec3();
        let normal = |n: DVec3| {
            let facing = if n.dot(wo) < 0.0 { -n } else { n };
            mirrored(self.view_from_world.transform_vector3(facing)).normalize_or_zero().to_array()
        };
        self.features[slot] = Some(Features {
            albedo,
            ng: normal(surface.ng),
            ns: normal(ns.as_dvec3()),
            position: position.to_array(),
            depth: position.z,
            uv: surface.uv.to_array(),
        });
    }
}

impl Probe for Seen<'_> {
    fn notice(&mut self, event: impl FnOnce() -> Event) {
        match event() {
            Event::Met { path, .. } => self.current = (path.depth == 0).then_some(path.slot as usize),
            Event::Shaded { surface, shading, .. } if self.current.is_some() => {
                self.see(&surface, shading.n(), albedo(&shading, surface.wo));
            }
            Event::Surface { surface, coefficients, .. } => {
                let albedo = coefficients.map_or(Spectrum::BLACK, |k| k.diffuse + k.mirror + k.transmission);
                self.see(&surface, surface.ns, albedo);
            }
            _ => {}
        }
    }
}

/// The part of the light from all around that leaves along `wo`, by a few directions.
fn albedo(shading: &Shading, wo: Vec3) -> Spectrum {
    let place = |k: u32| (k as f32 + 0.5) / ALBEDO_GRID as f32;
    shading.toward(wo, |toward| {
        let mut sum = Spectrum::BLACK;
        for k in 0..ALBEDO_GRID * ALBEDO_GRID {
            let u = [place(k % ALBEDO_GRID), place(k / ALBEDO_GRID)];
            let lobe = place((5 * k + 2) % ALBEDO_GRID);
            if let Some(sample) = toward.sample(lobe, u)
                && sample.pdf > 0.0
            {
                sum += sample.f * (shading.cos(sample.wi).abs() / sample.pdf);
            }
        }
        sum / (ALBEDO_GRID * ALBEDO_GRID) as f32
    })
}
