//! The way of a pixel: start, hit, step, occluded, add. Which pixels and samples are rendered when is decided in `driver`.
//!
//! [`Renderer::render_tile`] is pure: the same world, view, settings, pixels and sample numbers give the same bits, on any
//! machine, with any number of threads. Everything else ([`Renderer::render`], the inspector, a session) only decides which
//! tiles and samples are rendered.

mod backdrop;
mod driver;
mod guide;
mod outlook;
mod seen;
mod transport;

use std::ops::Range;
use std::sync::Arc;

use glam::DVec3;
use lookfrom_bvh::{Hit, Left, Ray};
use lookfrom_scene::scene::SourceFormat;
use lookfrom_scene::settings::{ColorMode, Crop, ImageSettings, RenderSettings, Sensor as SensorSettings};
use lookfrom_scene::{Error, ErrorKind, Location, Result, Scene, Warning};

use crate::camera::CameraRay;
use crate::color::{Sensor, Wavelengths};
use crate::film::{FilmTile, GUIDED_SAMPLES};
use crate::filter::Filter;
use crate::integrator::{Departure, Event, Integrator, Next, Numbers, Path, Probe, Samples, resolve_shadows};
use crate::sampler::Sampler;
use crate::spectrum::Spectrum;
use crate::texture::Lanes;
use crate::view::View;
use crate::world::World;

use backdrop::Met;
use guide::First;
use seen::Seen;
use transport::Transport;

pub use driver::{FEWEST_SAMPLES, Progress, Rendered, StopCriteria, StopReason, TileDone};

/// The dimensions of a sample's random numbers that the camera uses; rays use hashes of their place in the tree.
const FILTER_DIMENSION: u32 = 0;
const LENS_DIMENSION: u32 = 1;
const WAVELENGTH_DIMENSION: u32 = 2;

/// A world, a view of it and the settings of the computation: everything that decides the light of a picture.
///
/// Owns what it needs and is cheap to clone; the world is shared.
#[derive(Clone, Debug)]
pub struct Renderer {
    world: Arc<World>,
    view: View,
    settings: RenderSettings,
    integrator: Arc<dyn Transport>,
    /// Whether the integrator is not the one that the settings name.
    is_plugged_in: bool,
    /// The camera's position in render space.
    eye: DVec3,
    filter: Filter,
    sampler: Sampler,
    sensor: Sensor,
    /// For reflectances: no exposure, no white balance.
    plain_sensor: Sensor,
}

/// Which sample of which pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SampleId {
    /// Column and row from the top left.
    pub pixel: [u32; 2],
    /// Number of the sample in its pixel.
    pub sample: u32,
}

/// How many rays were traced.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Rays {
    /// From the camera.
    pub camera: u64,
    /// Mirrored and refracted.
    pub secondary: u64,
    /// To lights.
    pub shadow: u64,
}

impl Rays {
    /// All together.
    pub fn total(self) -> u64 {
        self.camera + self.secondary + self.shadow
    }
}

impl std::ops::AddAssign for Rays {
    fn add_assign(&mut self, other: Self) {
        self.camera += other.camera;
        self.secondary += other.secondary;
        self.shadow += other.shadow;
    }
}

/// A sample's light before the film, with what the filter and the camera made of it.
#[derive(Clone, Copy, Debug)]
pub struct Traced {
    /// What the film gets: `radiance · weight`.
    pub rgb: [f32; 3],
    /// The sum over the tree of rays.
    pub radiance: Spectrum,
    /// What the lanes of `radiance` mean.
    pub lanes: Lanes,
    /// The filter's weight: 1 for filters without negative lobes.
    pub weight: f32,
    /// How much of what is behind the picture it hides, 1 for all; not yet weighed.
    pub alpha: f32,
}

/// Random numbers for the camera's rays of a batch, by slot. Empty where nothing asks for them.
#[derive(Debug, Default)]
struct StartNumbers {
    filter: Vec<[f32; 2]>,
    lens: Vec<[f32; 2]>,
    wavelengths: Vec<[f32; 2]>,
}

/// The memory of a batch, which the next one uses again.
#[derive(Debug, Default)]
struct Batch {
    numbers: StartNumbers,
    samples: Samples,
    weights: Vec<f32>,
    paths: Vec<Path>,
    rays: Vec<Ray>,
    left: Vec<Left>,
    hits: Vec<Hit>,
    met: Vec<Met>,
    /// What the camera's rays met, by slot; only where it is asked for.
    firsts: Vec<First>,
    traced: Vec<Traced>,
}

impl Renderer {
    /// A renderer of a picture of `world` as `view` sees it.
    ///
    /// # Errors
    /// `Invalid` for no samples, or a crop without pixels.
    pub fn new(world: Arc<World>, view: View, settings: RenderSettings) -> Result<Self> {
        let invalid = |message: String| Err(Error::new(ErrorKind::Invalid, &Location::default(), message));
        let image = &view.image;
        if settings.samples == 0 {
            return invalid("0 samples a pixel; expected at least 1".into());
        }
        if let Some(Crop { x0, y0, x1, y1 }) = image.crop
            && (x0 >= x1 || y0 >= y1 || x1 > image.width || y1 > image.height)
        {
            return invalid(format!(
                "the crop {x0},{y0},{x1},{y1} is not a part of the picture of {} × {} pixels (x0 < x1, y0 < y1)",
                image.width, image.height
            ));
        }
        let eye = view.camera.lookfrom() - world.origin();
        Ok(Self {
            filter: Filter::new(image.filter),
            sampler: Sampler::new(settings.sampler, settings.seed),
            plain_sensor: Sensor::default(),
            sensor: Sensor::new(&image.sensor),
            integrator: transport::of_settings(&settings, &view.camera, eye),
            is_plugged_in: false,
            world,
            view,
            settings,
            eye,
        })
    }

    /// Compiles a scene, and renders the view by its own camera with its own settings. What can be survived is added to
    /// `warnings`.
    ///
    /// # Errors
    /// As [`View::of_scene`], [`World::compile`] and [`Renderer::new`].
    pub fn of_scene(scene: Scene, warnings: &mut Vec<Warning>) -> Result<Self> {
        let (view, settings) = (View::of_scene(&scene)?, scene.render.clone());
        let at = scene.camera.as_ref().map(|camera| camera.at.clone()).unwrap_or_default();
        let (bounds, is_model) = (scene.bounds(), scene.source_format != SourceFormat::Scene);
        let renderer = Self::new(Arc::new(World::compile(scene, warnings)?), view, settings)?;
        outlook::check(&renderer, bounds, &at, is_model, warnings);
        Ok(renderer)
    }

    /// The same with an integrator of one's own in place of the one that the settings name.
    #[must_use]
    pub fn with_integrator(self, integrator: impl Integrator + 'static) -> Self {
        Self { integrator: Arc::new(integrator), is_plugged_in: true, ..self }
    }

    /// The same world and settings, seen otherwise.
    ///
    /// # Errors
    /// As [`Renderer::new`].
    pub fn with_view(&self, view: View) -> Result<Self> {
        let other = Self::new(self.world.clone(), view, self.settings.clone())?;
        Ok(match self.is_plugged_in {
            true => Self { integrator: self.integrator.clone(), is_plugged_in: true, ..other },
            false => other,
        })
    }

    /// The same view of the same world, computed otherwise: by the integrator that the settings name.
    ///
    /// # Errors
    /// As [`Renderer::new`].
    pub fn with_settings(&self, settings: RenderSettings) -> Result<Self> {
        Self::new(self.world.clone(), self.view.clone(), settings)
    }

    /// The world that is pictured.
    pub fn world(&self) -> &Arc<World> {
        &self.world
    }

    /// The view of it.
    pub fn view(&self) -> &View {
        &self.view
    }

    /// What light is turned into colour by.
    pub fn sensor(&self) -> &Sensor {
        &self.sensor
    }

    /// How it is rendered.
    pub fn settings(&self) -> &RenderSettings {
        &self.settings
    }

    /// The name of the integrator.
    pub fn integrator(&self) -> &'static str {
        self.integrator.name()
    }

    fn image(&self) -> &ImageSettings {
        &self.view.image
    }

    /// The camera's ray for a sample and the filter's weight.
    pub fn camera_ray(&self, id: SampleId) -> (CameraRay, f32) {
        let two = |dimension| self.sampler.two(id.pixel, id.sample, dimension);
        self.camera_ray_by(id, two(FILTER_DIMENSION), two(LENS_DIMENSION))
    }

    #[inline]
    fn camera_ray_by(&self, id: SampleId, u: [f32; 2], lens: [f32; 2]) -> (CameraRay, f32) {
        let [column, row] = id.pixel.map(f64::from);
        let (offset, weight) = self.filter.sample(u);
        let x_k = column + 0.5 + f64::from(offset[0]);
        let y_k = f64::from(self.image().height) - (row + 0.5 + f64::from(offset[1]));
        (self.view.camera.ray([x_k, y_k], lens), weight)
    }

    /// Follows samples to their light. The result for a sample does not depend on the others.
    pub fn trace(&self, ids: &[SampleId]) -> (Vec<Traced>, Rays) {
        let mut batch = Batch::default();
        let rays = self.integrator.trace(self, ids, &mut batch);
        (batch.traced, rays)
    }

    /// As [`Renderer::trace`], with everything that happens on the way added to `events`.
    pub fn trace_events(&self, ids: &[SampleId], events: &mut Vec<Event>) -> (Vec<Traced>, Rays) {
        let mut batch = Batch::default();
        let rays = self.integrator.trace_events(self, ids, events, &mut batch);
        (batch.traced, rays)
    }

    fn trace_with<I: Integrator, P: Probe>(
        &self,
        integrator: &I,
        ids: &[SampleId],
        probe: &mut P,
        batch: &mut Batch,
    ) -> Rays {
        let mut rays_traced = Rays { camera: ids.len() as u64, ..Rays::default() };
        let Batch { numbers: start, samples, weights, paths, rays, left, hits, met, firsts, traced } = batch;
        let mut next = Next { samples: std::mem::take(samples), probe };
        next.samples.clear();

        let has_backdrop = self.has_backdrop();
        met.clear();
        met.resize(ids.len(), Met::default());

        // Start: a ray from the camera for each sample.
        let around_camera = self.world.space_of(self.view.medium);
        self.prepare_start(ids, start);
        weights.clear();
        for (slot, id) in ids.iter().enumerate() {
            let lens = start.lens.get(slot).copied().unwrap_or_default();
            let (ray, weight) = self.camera_ray_by(*id, start.filter[slot], lens);
            weights.push(weight);
            let lanes = start.wavelengths.get(slot).map_or(Lanes::Rgb, |u| lanes_by(*u));
            next.samples.start(lanes);
            next.samples.paths.push(Path {
                ray: self.kernel_ray(&ray),
                beta: lanes.one(),
                slot: slot as u32,
                depth: 0,
                address: Path::ROOT,
                media: around_camera,
                departure: Departure::default(),
            });
        }

        while !next.samples.paths.is_empty() {
            // Hit: the nearest surface for every ray of the batch.
            std::mem::swap(paths, &mut next.samples.paths);
            next.samples.paths.clear();
            rays.clear();
            rays.extend(paths.iter().map(|path| path.ray));
            hits.clear();
            hits.resize(rays.len(), Hit::MISS);
            left.clear();
            left.extend(paths.iter().map(|path| path.departure.left));
            self.world.bvh.closest_hits_leaving(rays, left, hits);
            guide::note_firsts(firsts, paths, hits);

            // Step: from each hit to contributions, shadow rays and further paths.
            let numbers = |path: &Path| {
                let SampleId { pixel, sample } = ids[path.slot as usize];
                Numbers { sampler: self.sampler.of_pixel(pixel), sample, address: path.address }
            };
            if has_backdrop {
                self.show_backdrops(paths, hits, met, &mut next);
            }
            integrator.step_all(&self.world, numbers, paths, hits, &mut next);
            if has_backdrop {
                self.expect_light(met, &mut next);
            }

            // Occluded: what arrives of the lights.
            rays_traced.shadow += resolve_shadows(&self.world, integrator.passing(), &mut next);
            rays_traced.secondary += next.samples.paths.len() as u64;
        }

        *samples = next.samples;
        traced.clear();
        traced.extend(samples.radiance.iter().zip(&samples.lanes).zip(&*weights).zip(&*met).map(
            |(((&radiance, &lanes), &weight), &met)| {
                let (rgb, alpha) = match met {
                    Met::Thing => (self.rgb(radiance * weight, &lanes), 1.0),
                    _ => self.with_alpha(radiance, weight, &lanes, met),
                };
                Traced { rgb, radiance, lanes, weight, alpha }
            },
        ));
        rays_traced
    }

    /// The kernel's form of a camera ray, with `t` of the notes: 1 on the image plane.
    #[inline]
    fn kernel_ray(&self, ray: &CameraRay) -> Ray {
        let a = self.eye + ray.a_from_eye;
        Ray::new(a.as_vec3().to_array(), ray.direction.as_vec3().to_array())
    }

    /// Draws the numbers that the camera's rays of a batch ask for.
    fn prepare_start(&self, ids: &[SampleId], numbers: &mut StartNumbers) {
        let StartNumbers { filter, lens, wavelengths } = numbers;
        let draw = |is_asked: bool, dimension: u32, numbers: &mut Vec<[f32; 2]>| {
            let count = if is_asked { ids.len() } else { 0 };
            self.sampler.two_of_each(count, |k| (ids[k].pixel, ids[k].sample), dimension, numbers);
        };
        draw(true, FILTER_DIMENSION, filter);
        draw(self.view.camera.lens.is_some(), LENS_DIMENSION, lens);
        draw(self.is_spectral(), WAVELENGTH_DIMENSION, wavelengths);
    }

    /// Whether the lanes of samples are wavelengths.
    fn is_spectral(&self) -> bool {
        self.settings.color == ColorMode::Spectral && self.integrator.is_light()
    }

    /// What the lanes of a sample mean.
    fn lanes(&self, id: SampleId) -> Lanes {
        if self.is_spectral() {
            lanes_by(self.sampler.two(id.pixel, id.sample, WAVELENGTH_DIMENSION))
        } else {
            Lanes::Rgb
        }
    }

    /// What the sensor makes of light: linear Rec. 709.
    pub fn rgb(&self, light: Spectrum, lanes: &Lanes) -> [f32; 3] {
        let rgb = match lanes {
            Lanes::Rgb if self.image().sensor == SensorSettings::default() => return light.rgb(),
            Lanes::Rgb => self.sensor.balanced(light.rgb()),
            Lanes::Spectral(wavelengths) => self.sensor.rgb(light, wavelengths),
        };
        self.limited(rgb)
    }

    /// A colour of which no channel of the sensor is brighter than it may be (pbrt's `maxcomponentvalue`). Channels are looked
    /// at before they become RGB: there single wavelengths are far outside of the gamut.
    fn limited(&self, rgb: [f32; 3]) -> [f32; 3] {
        let most = self.image().sensor.max_component;
        if most == f32::INFINITY {
            return rgb;
        }
        // Light that a filter's negative lobes weigh is limited as well.
        let brightest = self.sensor.channels(rgb).into_iter().fold(0.0, |most, c| c.abs().max(most));
        if brightest > most { rgb.map(|c| c * (most / brightest)) } else { rgb }
    }

    /// Adds the given samples of every pixel of a tile to its light.
    pub fn render_tile(&self, samples: Range<u32>, tile: &mut FilmTile) -> Rays {
        let mut rays = Rays::default();
        let mut batch = Batch::default();
        let mut ids: Vec<SampleId> = Vec::new();
        for sample in samples {
            ids.clear();
            ids.extend(blocks(tile.area()).map(|pixel| SampleId { pixel, sample }));
            let is_guided = tile.has_guides() && sample < GUIDED_SAMPLES;
            batch.firsts.clear();
            batch.firsts.resize(if is_guided { ids.len() } else { 0 }, First::NOTHING);
            rays += if tile.has_layers() {
                let mut seen = Seen::new(self, ids.iter().map(|id| self.lanes(*id)).collect());
                let rays = self.integrator.trace_seen(self, &ids, &mut seen, &mut batch);
                for (id, features) in ids.iter().zip(seen.into_features()) {
                    if let Some(features) = features {
                        tile.add_features(id.pixel[0], id.pixel[1], &features);
                    }
                }
                rays
            } else {
                self.integrator.trace(self, &ids, &mut batch)
            };
            self.add_guides(&ids, &batch.firsts, tile);
            for (id, traced) in ids.iter().zip(&batch.traced) {
                let [x, y] = id.pixel;
                tile.add_with_alpha(x, y, id.sample, traced.rgb, traced.alpha * traced.weight);
                if tile.has_channels() {
                    tile.add_channels(x, y, self.sensor.channels(traced.rgb));
                }
            }
        }
        rays
    }
}

/// The wavelengths of a sample, by its random numbers.
fn lanes_by([u, _]: [f32; 2]) -> Lanes {
    Lanes::Spectral(Wavelengths::sample_visible(u))
}

/// The pixels of an area by square blocks of 8 × 8, so that the rays of a packet of the kernel lie close together.
fn blocks(area: Crop) -> impl Iterator<Item = [u32; 2]> {
    const SIDE: usize = 8;
    let Crop { x0, y0, x1, y1 } = area;
    let corners = (y0..y1).step_by(SIDE).flat_map(move |y| (x0..x1).step_by(SIDE).map(move |x| [x, y]));
    corners.flat_map(move |[x, y]| {
        let end = |start: u32, end: u32| (start + SIDE as u32).min(end);
        (y..end(y, y1)).flat_map(move |row| (x..end(x, x1)).map(move |column| [column, row]))
    })
}
