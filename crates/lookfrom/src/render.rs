//! The renderer: stages over batches of paths (start, hit, step, occluded, add). `driver` schedules pixels and samples.
//!
//! [`Renderer::render_tile`] is pure: the same world, view, settings, pixels and sample numbers give the same bits, on
//! any machine, with any number of threads. Everything else ([`Renderer::render`], the inspector, a session) only
//! chooses the tiles and samples to render.

mod aovs;
mod camera_warnings;
mod cost;
mod cryptomattes;
mod driver;
mod footprint;
mod guide;
mod interior;
mod labels;
mod parts;
mod progress;
mod sensor;
mod spectral_film;
mod start;
mod traced;
mod transport;

use std::ops::Range;
use std::sync::Arc;

use glam::DVec3;
use lookfrom_bvh::{Hit, OriginPrimitive, Ray};
use lookfrom_scene::camera::Projection;
use lookfrom_scene::settings::{
    Background, ImageSettings, LightPathLayer, PixelBounds, RenderSettings, Sensor as SensorSettings,
};
use lookfrom_scene::{Error, ErrorKind, Location, Result, Scene, Warning};

use crate::aov::{AovAccumulator, RayHit};
use crate::core::color::Sensor;
use crate::core::filter::Filter;
use crate::core::sampler::Sampler;
use crate::core::times::Times;
pub use crate::film::SampleId;
use crate::film::{FEATURE_SAMPLES, FilmTile, SampleSums};
use crate::integrator::{
    BatchStreams, Event, Integrator, LightPathState, LightPaths, Path, PathState, Probe, Queues, Scratch,
    StepOutput, resolve_shadows,
};
use crate::shading::interior_stack::InteriorStack;
use crate::shading::texture::SpectralMode;
use crate::view::View;
use crate::world::{MeasuredSurface, World};

pub(crate) use camera_warnings::Subject;
pub use cost::Cost;
pub use cryptomattes::MOST_MATTE_SAMPLES;
use start::Start;
use transport::Transport;

pub use crate::core::parallel::MOST_THREADS;
pub use driver::FEWEST_SAMPLES;
pub use labels::Label;
pub use progress::{Progress, Rendered, StopCriteria, StopReason, TileDone};
pub use traced::{Rays, Traced};

/// The version of the code that computes samples: raised by every change of the bits of any sample, so that films of
/// different versions are not merged. `tests/command/pinned.txt` holds both together.
pub const SAMPLING_VERSION: u32 = 29;

/// The most samples that make a batch together: half as many again as a tile of the driver has pixels, so that any fewer pixels
/// make batches of at least three quarters of those of a whole tile.
const BATCH: usize = 1536;

/// A world, a view of it and the render settings: everything that determines the light of a picture.
///
/// Owns what it needs and is cheap to clone; the world is shared.
#[derive(Clone, Debug)]
pub struct Renderer {
    world: Arc<World>,
    view: View,
    settings: RenderSettings,
    integrator: Arc<dyn Transport>,
    /// Whether the integrator is a custom one, not that of the settings.
    is_plugged_in: bool,
    /// The camera's position in render space.
    eye: DVec3,
    /// The point in render space that its rays start at or around: the eye, or of a parallel camera far away a point nearer
    /// to the scene.
    ray_start: DVec3,
    /// The surface of a camera that measures irradiance, on which its rays start.
    surface: Option<Arc<MeasuredSurface>>,
    /// The bodies and the medium around it, or around that surface.
    interior: InteriorStack,
    filter: Filter,
    sampler: Sampler,
    sensor: Sensor,
    /// Whether the sensor leaves light in RGB as it is.
    keeps_rgb: bool,
    /// The light-path expressions of the picture's layers, if there are any.
    light_paths: Option<Arc<LightPaths>>,
}

/// The memory of a batch, reused by the next one.
#[derive(Debug, Default)]
struct Batch {
    ids: Vec<SampleId>,
    start: Start,
    queues: Queues,
    /// Paths under way, and those that are next.
    paths: Scratch,
    rays: Vec<Ray>,
    /// The times of the rays that are traced.
    times: Times,
    origin_primitives: Vec<OriginPrimitive>,
    hits: Vec<Hit>,
    /// The samples' light in RGB, by slot.
    light: Vec<[f32; 3]>,
    sums: SampleSums,
    aov_sums: AovAccumulator,
}

impl Renderer {
    /// A renderer of a picture of `world` as `view` sees it.
    ///
    /// # Errors
    /// `Invalid` for no samples, or a crop without pixels; as [`ImageSettings::validate`] and [`RenderSettings::validate`].
    pub fn new(world: Arc<World>, view: View, settings: RenderSettings) -> Result<Self> {
        Self::check(&view, &settings)?;
        Ok(Self::without_guide(world.unguided(), view, settings)?.with_guide())
    }

    /// Whether there are samples and pixels, and all settings have a meaning.
    fn check(view: &View, settings: &RenderSettings) -> Result<()> {
        let invalid = |message: String| Err(Error::new(ErrorKind::Invalid, &Location::default(), message));
        let image = &view.image;
        if settings.samples == 0 {
            return invalid("0 samples per pixel; expected at least 1".into());
        }
        if let Some(PixelBounds { x0, y0, x1, y1 }) = image.crop
            && (x0 >= x1 || y0 >= y1 || x1 > image.width || y1 > image.height)
        {
            return invalid(format!(
                "the crop {x0},{y0},{x1},{y1} is not a part of the picture of {} × {} pixels (x0 < x1, y0 < y1)",
                image.width, image.height
            ));
        }
        image.validate()?;
        settings.validate()?;
        spectral_film::check(image, settings)
    }

    /// [`Renderer::new`] for settings that have been checked, which learns no guide.
    fn without_guide(world: Arc<World>, view: View, settings: RenderSettings) -> Result<Self> {
        let world = match world.needs_footprint() {
            true => world.seen_by(footprint::of_pixels(&view.camera)),
            false => world,
        };
        let eye = view.camera.lookfrom() - world.origin();
        let ray_start = start::ray_start(&world, &view, eye);
        let surface = match &view.camera.projection {
            Projection::Irradiance { surface } => Some(Arc::new(world.measured_surface(surface, &view.at)?)),
            _ => None,
        };
        let space = world.space_of(view.medium);
        let interior = match &surface {
            None => interior::interior_at(&world, ray_start, space),
            Some(surface) => interior::interior_around(&world, surface, space),
        };
        Ok(Self {
            filter: Filter::new(view.image.filter),
            sampler: Sampler::new(settings.sampler, settings.seed),
            sensor: Sensor::new(&view.image.sensor),
            keeps_rgb: view.image.sensor == SensorSettings::default(),
            integrator: transport::of_settings(&settings, &view.camera, eye),
            is_plugged_in: false,
            light_paths: light_paths(&world, &view.image.light_paths)?.map(Arc::new),
            world,
            view,
            settings,
            eye,
            ray_start,
            surface,
            interior,
        })
    }

    /// A renderer of a scene, which is compiled, with its own camera and settings. Problems that do not prevent
    /// rendering are added to `warnings`.
    ///
    /// # Errors
    /// As [`Scene::validate`], [`View::of_scene`], [`World::compile`] and [`Renderer::new`].
    pub fn of_scene(scene: Scene, warnings: &mut Vec<Warning>) -> Result<Self> {
        scene.validate()?;
        let (view, settings) = (View::of_scene(&scene)?, scene.render.clone());
        let subject = Subject::of_scene(&scene, scene.bounds());
        let renderer = Self::new(Arc::new(World::compile_valid(scene, warnings)?), view, settings)?;
        renderer.check_view(&subject, warnings);
        Ok(renderer)
    }

    /// Warns of a camera that sees nothing of the scene, or is inside a body.
    pub(crate) fn check_view(&self, subject: &Subject, warnings: &mut Vec<Warning>) {
        camera_warnings::check(self, subject, warnings);
    }

    /// Whether the picture would be the background alone only because the camera sees the backs of single-sided surfaces.
    pub(crate) fn sees_only_backs(&self) -> bool {
        camera_warnings::sees_only_backs(self)
    }

    /// This renderer with a custom integrator in place of the one in the settings.
    #[must_use]
    pub fn with_integrator(self, integrator: impl Integrator + 'static) -> Self {
        Self { integrator: Arc::new(integrator), is_plugged_in: true, ..self }
    }

    /// A renderer of this world with these settings and another view.
    ///
    /// # Errors
    /// As [`Renderer::new`].
    pub fn with_view(&self, view: View) -> Result<Self> {
        // A guide does not depend on how a picture is developed, nor on the part of it that is rendered.
        if view.starts_rays_as(&self.view) {
            Self::check(&view, &self.settings)?;
            let other = Self::without_guide(self.world.clone(), view, self.settings.clone())?;
            return Ok(self.with_same_integrator(other));
        }
        self.with_world(self.world.clone(), view)
    }

    /// Another renderer with the custom integrator of this one, if it has one.
    pub(crate) fn with_same_integrator(&self, other: Self) -> Self {
        match self.is_plugged_in {
            true => Self { integrator: self.integrator.clone(), is_plugged_in: true, ..other },
            false => other,
        }
    }

    /// A renderer with these settings of another world, or the same one with other lights, and a view of it.
    ///
    /// # Errors
    /// As [`Renderer::new`].
    pub fn with_world(&self, world: Arc<World>, view: View) -> Result<Self> {
        Ok(self.with_same_integrator(Self::new(world, view, self.settings.clone())?))
    }

    /// A renderer of this view and world with other settings, and the integrator that they name.
    ///
    /// # Errors
    /// As [`Renderer::new`].
    pub fn with_settings(&self, settings: RenderSettings) -> Result<Self> {
        // A guide does not depend on the number of samples and the seed.
        let RenderSettings { samples, allocation, seed, .. } = settings;
        if (RenderSettings { samples, allocation, seed, ..self.settings.clone() }) == settings {
            Self::check(&self.view, &settings)?;
            return Self::without_guide(self.world.clone(), self.view.clone(), settings);
        }
        Self::new(self.world.clone(), self.view.clone(), settings)
    }

    /// The world.
    pub fn world(&self) -> &Arc<World> {
        &self.world
    }

    /// The view of it.
    pub fn view(&self) -> &View {
        &self.view
    }

    /// The sensor, which converts light to colour.
    pub fn sensor(&self) -> &Sensor {
        &self.sensor
    }

    /// The render settings.
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

    /// Background of rays of the camera that hit nothing: the environment alone for a measurement.
    fn background(&self) -> Background {
        if self.surface.is_some() { Background::Environment } else { self.image().background }
    }

    /// The path that begins with a ray of the camera, of one sample in RGB.
    fn root<S: PathState>(&self, ray: Ray) -> Path<S> {
        Path {
            ray,
            beta: SpectralMode::Rgb.one(),
            slot: 0,
            depth: 0,
            address: Path::ROOT,
            interior: self.interior,
            origin_primitive: OriginPrimitive::NONE,
            blurred: false,
            light_path: LightPathState::default(),
            state: S::default(),
        }
    }

    /// Computes samples. The result for a sample does not depend on the others.
    pub fn trace(&self, ids: &[SampleId]) -> (Vec<Traced>, Rays) {
        let mut batch = Batch::default();
        let rays = self.integrator.trace(self, ids, &mut batch);
        (self.traced(&batch).collect(), rays)
    }

    /// As [`Renderer::trace`], and adds all events of the computation to `events`.
    pub fn trace_events(&self, ids: &[SampleId], events: &mut Vec<Event>) -> (Vec<Traced>, Rays) {
        let mut batch = Batch::default();
        let rays = self.integrator.trace_events(self, ids, events, &mut batch);
        (self.traced(&batch).collect(), rays)
    }

    fn trace_with<I: Integrator, P: Probe>(
        &self,
        integrator: &I,
        ids: &[SampleId],
        probe: &mut P,
        batch: &mut Batch,
    ) -> Rays {
        let mut rays_traced = Rays::default();
        let Batch { start, queues, paths, rays, times, origin_primitives, hits, .. } = batch;
        let mut both = paths.take::<[Vec<Path<I::State>>; 2]>();
        let [mut under_way, next] = std::mem::take(&mut *both);
        let light_paths = self.light_paths.as_deref();
        let light_path = light_paths.map_or_else(LightPathState::default, LightPaths::start);
        let mut output = StepOutput {
            queues: std::mem::take(queues),
            paths: next,
            background: self.background(),
            light_paths,
            probe,
        };

        // Start: a ray from the camera for each sample that no lens system blocks.
        self.start(ids, start);
        output.queues.start(ids.len(), start.modes());
        output.queues.times.clone_from(&start.times);
        let modes = &output.queues.modes;
        let path = |(slot, ray): (usize, &Ray)| Path {
            beta: modes[slot].one(),
            slot: slot as u32,
            light_path,
            ..self.root(*ray)
        };
        let all = start.rays.iter().enumerate();
        match start.are_any_blocked() {
            true => output.paths.extend(all.filter(|(slot, _)| !start.is_blocked(*slot)).map(path)),
            false => output.paths.extend(all.map(path)),
        }
        rays_traced.camera = output.paths.len() as u64;
        let starting = std::mem::take(&mut output.paths);
        output.start_layers(&self.world, &starting);
        output.paths = starting;

        let streams = BatchStreams { sampler: &self.sampler, ids };
        let mut are_from_camera = true;
        while !output.paths.is_empty() {
            // Hit: the nearest surface for every ray of the batch.
            std::mem::swap(&mut under_way, &mut output.paths);
            output.paths.clear();
            // All are replaced.
            hits.resize(under_way.len(), Hit::MISS);
            times.gather(&output.queues.times, under_way.iter().map(|path| path.slot));
            let query = self.world.bvh.query().times(times.as_slice());
            if are_from_camera && under_way.len() == ids.len() {
                query.closest_hits(&start.rays, hits);
                output.queues.first_surfaces.note_outermost(hits);
            } else if are_from_camera {
                rays.clear();
                rays.extend(under_way.iter().map(|path| path.ray));
                query.closest_hits(rays, hits);
                let slots = under_way.iter().map(|path| path.slot);
                output.queues.first_surfaces.note_outermost_of(slots, hits, ids.len());
            } else {
                rays.clear();
                rays.extend(under_way.iter().map(|path| path.ray));
                origin_primitives.clear();
                origin_primitives.extend(under_way.iter().map(|path| path.origin_primitive));
                query.origins(origin_primitives).closest_hits(rays, hits);
                output.queues.first_surfaces.note_behind(straight(&under_way, hits));
            }
            are_from_camera = false;

            // Step: from each hit to contributions, shadow rays and further paths.
            integrator.step_all(&self.world, &streams, &under_way, hits, &mut output);

            // Occluded: trace shadow rays and add unoccluded light.
            rays_traced.shadow += resolve_shadows(&self.world, integrator.shadow_transparency(), &mut output);
            rays_traced.secondary += output.paths.len() as u64;
        }

        *queues = output.queues;
        *both = [under_way, output.paths];
        paths.put(both);
        rays_traced
    }

    /// Adds the given samples of every pixel of a tile to the tile, and records them in its ledger.
    ///
    /// # Errors
    /// `Invalid` where the tile has one of them already.
    pub fn render_tile(&self, samples: Range<u32>, tile: &mut FilmTile) -> Result<Rays> {
        self.render_pixels(&mut Batch::default(), &[tile.area()], samples, tile)
    }

    /// [`Renderer::render_tile`] for the pixels of parts of a tile, in the memory of earlier batches.
    fn render_pixels(
        &self,
        batch: &mut Batch,
        parts: &[PixelBounds],
        samples: Range<u32>,
        tile: &mut FilmTile,
    ) -> Result<Rays> {
        for part in parts {
            tile.record_part(*part, samples.clone())?;
        }
        let mut rays = Rays::default();
        let mut ids = std::mem::take(&mut batch.ids);
        let pixels = blocks(parts);
        let together = samples_together(pixels.len(), &samples);
        ids.clear();
        ids.extend(
            pixels
                .into_iter()
                .flat_map(|pixel| (0..together).map(move |k| SampleId { pixel, sample: samples.start + k })),
        );
        for sample in samples.step_by(together as usize) {
            let space = tile.wants_first_hit(sample).then(|| self.camera_space());
            batch.queues.first_surfaces.set_space(space);
            rays += self.integrator.trace(self, &ids, batch);
            self.add_aovs(&ids, batch, tile);
            if tile.is_of_light() {
                let mut light = std::mem::take(&mut batch.light);
                self.light(batch, &mut light);
                tile.add_samples(&ids, &light, batch.start.filter_weights(), &mut batch.sums);
                batch.light = light;
            } else {
                for (slot, (id, traced)) in ids.iter().zip(self.traced(batch)).enumerate() {
                    let [x, y] = id.pixel;
                    tile.add_weighted(x, y, id.sample, traced.rgb, traced.alpha, traced.filter_weight);
                    if tile.has_light_paths() {
                        let layers = self.light_by_paths(batch, slot, &traced);
                        tile.add_light_paths(x, y, traced.rgb, traced.filter_weight, layers);
                    }
                    if tile.has_buckets() {
                        let buckets = self.light_by_buckets(batch, slot, &traced);
                        tile.add_spectrum(x, y, traced.rgb, traced.filter_weight, buckets);
                    }
                    if tile.has_channels() {
                        tile.add_channels(x, y, self.sensor.channels(traced.rgb));
                    }
                }
            }
            ids.iter_mut().for_each(|id| id.sample += together);
        }
        tile.add_sums(&ids, &mut batch.sums);
        tile.add_first_hit_sums(&ids, &mut batch.aov_sums);
        batch.ids = ids;
        Ok(rays)
    }
}

/// The paths that come straight from the camera, and their hits, by slot.
fn straight<S>(paths: &[Path<S>], hits: &[Hit]) -> impl Iterator<Item = (u32, RayHit)> {
    let straight = paths.iter().zip(hits).filter(|(path, _)| path.depth == 0);
    straight.map(|(path, hit)| (path.slot, RayHit { ray: path.ray, hit: *hit }))
}

/// The number of samples of each pixel that make a batch together: several where there are few pixels. A batch is of samples
/// that all count for the denoiser, or none.
fn samples_together(pixels: usize, samples: &Range<u32>) -> u32 {
    let mut together = 1;
    while samples.start >= FEATURE_SAMPLES
        && 2 * together as usize * pixels <= BATCH
        && samples.len().is_multiple_of(2 * together as usize)
    {
        together *= 2;
    }
    together
}

/// The light-path expressions of layers, for the lights of a world.
fn light_paths(world: &World, layers: &[LightPathLayer]) -> Result<Option<LightPaths>> {
    if layers.is_empty() {
        return Ok(None);
    }
    let is_environment = |index: usize| world.environments.contains(&(index as u32));
    let lights = world.names.lights.iter().enumerate();
    LightPaths::new(layers, lights.map(|(index, name)| (name.as_str(), is_environment(index)))).map(Some)
}

/// The pixels of disjoint areas by square blocks of 8 × 8, so that the rays of a packet of the kernel are coherent.
fn blocks(areas: &[PixelBounds]) -> Vec<[u32; 2]> {
    let Some(&PixelBounds { x0: left, y0: top, .. }) = areas.first() else { return Vec::new() };
    let mut pixels: Vec<[u32; 2]> = areas
        .iter()
        .flat_map(|area| (area.y0..area.y1).flat_map(|y| (area.x0..area.x1).map(move |x| [x, y])))
        .collect();
    // Blocks start at the corner of the first area.
    let block = |at: u32, start: u32| (i64::from(at) - i64::from(start)).div_euclid(8);
    pixels.sort_by_key(|[x, y]| (block(*y, top), block(*x, left)));
    pixels
}
