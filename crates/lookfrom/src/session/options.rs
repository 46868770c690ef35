//! Render options, which override the settings of a scene's file.
//!
//! Applied in two steps: the settings first, since auto-framing depends on the aspect ratio of the picture; then the
//! camera, which a model without one has only after framing.

use std::ops::Range;

use glam::DVec3;
use lookfrom_scene::camera::{Camera, Projection};
use lookfrom_scene::image::Image;
use lookfrom_scene::scene::Bounds;
use lookfrom_scene::settings::{
    Allocation, Background, ColorMode, CryptomatteKind, Filter, ImageSettings, Integrator, Layers,
    LightPathLayer, LightSampler, PixelBounds, Portals, RenderSettings, Sampler, SpectralFilm, Tonemap,
};
use lookfrom_scene::studio::Viewpoint;
use lookfrom_scene::{
    Budget, Error, ErrorKind, Files, ImportOptions, LoadContext, Location, Result, Variables,
};

use super::{Exposure, Format};
use crate::film::MOST_PIXELS;
use crate::render::StopCriteria;

/// Render options, which override the settings of the file; `None` keeps the file's setting, or the default.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// Width in pixels; alone it keeps the aspect ratio.
    pub width: Option<u32>,
    /// Height in pixels; alone it keeps the aspect ratio.
    pub height: Option<u32>,
    /// Crop window: only this part is rendered.
    pub crop: Option<PixelBounds>,
    /// Samples per pixel: numbers from [`first_sample`](Self::first_sample) to this one, exclusive.
    pub samples: Option<u32>,
    /// The number of the first sample: not 0 in a part of a picture, to be merged with others.
    pub first_sample: u32,
    /// Only part `i` of `n` of these samples, from 1: ranges of nearly equal length, so that the parts take nearly equal
    /// time, whatever the picture shows.
    pub part: Option<[u32; 2]>,
    /// Whether the film will be kept in a file ([`Session::provenance`](super::Session::provenance)): the files of the
    /// scene are digested as they are read.
    pub film: bool,
    /// The allocation of the samples to the pixels.
    pub allocation: Option<Allocation>,
    /// The light transport algorithm.
    pub integrator: Option<Integrator>,
    /// RGB or spectral.
    pub color: Option<ColorMode>,
    /// The light sampler.
    pub light_sampler: Option<LightSampler>,
    /// The openings through which environments are sampled.
    pub portals: Option<Portals>,
    /// AOVs besides the picture.
    pub layers: Option<Layers>,
    /// Layers of light-path expressions: those of the file's with the same names are replaced.
    pub light_paths: Vec<LightPathLayer>,
    /// Cryptomattes, in place of those of the file; empty for those of the file.
    pub cryptomattes: Vec<CryptomatteKind>,
    /// The number of buckets of a spectral film, for an EXR; 0 for a film of colours alone.
    pub spectral_buckets: Option<u32>,
    /// The range of the wavelengths of a spectral film, in nm ([`SpectralFilm::range`]).
    pub wavelengths: Option<[f32; 2]>,
    /// Whether the picture is denoised.
    pub denoise: Option<bool>,
    /// Maximum path depth.
    pub depth: Option<u32>,
    /// Throughput below which a branch of Whitted's tree is not followed.
    pub min_contribution: Option<f32>,
    /// The sampler.
    pub sampler: Option<Sampler>,
    /// Seed of the random numbers.
    pub seed: Option<u64>,
    /// Pixel filter.
    pub filter: Option<Filter>,
    /// Exposure in stops.
    pub exposure: Option<Exposure>,
    /// The tone map.
    pub tonemap: Option<Tonemap>,
    /// The background that camera rays see where they hit nothing.
    pub background: Option<Background>,
    /// The camera's position.
    pub lookfrom: Option<DVec3>,
    /// The point that it looks at.
    pub lookat: Option<DVec3>,
    /// The up direction: of the camera, and of the environment of a model. Any length.
    pub up: Option<DVec3>,
    /// Vertical field of view in degrees, in (0, 180).
    pub fov: Option<f64>,
    /// The view that the scene is framed from, in place of its camera.
    pub view: Option<Viewpoint>,
    /// The azimuth of that view in degrees, counter-clockwise as seen from above: 0 is the front, 90 the right side. Without
    /// `view` the rest is that of a model without a camera.
    pub azimuth: Option<f64>,
    /// Its elevation in degrees above the horizon, −90 to 90.
    pub elevation: Option<f64>,
    /// The box that a camera which is added frames, and that the floor lies under; `None` for that of the scene. Turntables frame all.
    pub bounds: Option<Bounds>,
    /// An equirectangular environment map, in place of the studio or of a scene's own environments.
    pub environment: Option<Image>,
    /// Rotation of environments around the up direction, in degrees, counter-clockwise as seen from above.
    pub rotate_environment: Option<f64>,
    /// Whether a shadow catcher lies below the model.
    pub floor: bool,
    /// Orbit of the camera around the model, in degrees, counter-clockwise as seen from above; environments rotate with
    /// it.
    pub turn: Option<f64>,
    /// Selection among several animations, variants, scenes and cameras of a file.
    pub import: ImportOptions,
    /// Values for the variables of a scene.
    pub variables: Variables,
    /// Stop criteria, besides the number of samples. With them and without `samples`, that number is not limited.
    pub stop: StopCriteria,
    /// Treatment of fireflies, pixels that single samples make far too bright.
    pub fireflies: Fireflies,
    /// Whether the session keeps the scene beside its world: so that its materials and lights can be changed
    /// ([`Session::set_material`](super::Session::set_material)).
    pub keep_scene: bool,
    /// The format that the picture will be encoded in, if it is known: AOVs that it cannot hold are not computed.
    pub format: Option<Format>,
    /// Number of threads, of which there are at most [`MOST_THREADS`](crate::render::MOST_THREADS); `None` is one per processor.
    pub threads: Option<usize>,
    /// The memory for all that the session reads, compiles and renders: by default, what this machine has.
    pub budget: Budget,
}

/// Treatment of fireflies, pixels that single samples make far too bright.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Fireflies {
    /// They stay.
    #[default]
    Keep,
    /// Their excess is spread over the pixels around.
    Spread,
}

/// Maximum number of samples per pixel.
pub const MOST_SAMPLES: u32 = 1 << 24;

/// The location of errors in options, in [`Location::file`].
pub const OPTIONS: &str = "the options";

/// The error for an option that does not suit the scene.
pub(super) fn unsuitable(message: String) -> Error {
    Error::new(ErrorKind::Request, &Location::default(), message)
}

impl Options {
    /// The context in which the scene is read.
    pub fn context<'f>(&self, files: &'f dyn Files) -> LoadContext<'f> {
        LoadContext {
            import: self.import.clone(),
            variables: self.variables.clone(),
            ..LoadContext::within(&self.budget, files)
        }
    }

    /// Checks the numbers that become no settings: of the view, what is around the scene, and the criteria to stop by.
    ///
    /// # Errors
    /// `Request` for a number that is out of range.
    pub(super) fn check_numbers(&self) -> Result<()> {
        self.stop.check()?;
        let finite = "a finite number of degrees";
        check_number("azimuth", self.azimuth, finite, f64::is_finite)?;
        check_number("rotate_environment", self.rotate_environment, finite, f64::is_finite)?;
        check_number("turn", self.turn, finite, f64::is_finite)?;
        check_elevation(self.elevation)?;
        check_fov(self.fov)?;
        if let Some(view) = self.view {
            check_number("azimuth", Some(view.azimuth), finite, f64::is_finite)?;
            check_elevation(Some(view.elevation))?;
            check_fov(view.fov)?;
        }
        let is_point = |point: DVec3| point.is_finite();
        check_vector("lookfrom", self.lookfrom, "finite coordinates", is_point)?;
        check_vector("lookat", self.lookat, "finite coordinates", is_point)?;
        let is_direction = |up: DVec3| up.is_finite() && up != DVec3::ZERO;
        check_vector("up", self.up, "a direction, of finite numbers that are not all 0", is_direction)?;
        check_bounds(self.bounds)
    }

    /// Applies the options to image and render settings.
    ///
    /// # Errors
    /// `Request` for a picture that is too large or has no pixels, and for a crop outside of it; as [`ImageSettings::validate`] and
    /// [`RenderSettings::validate`].
    pub(super) fn apply_to_settings(
        &self,
        image: &mut ImageSettings,
        render: &mut RenderSettings,
    ) -> Result<()> {
        let check = |image: &ImageSettings, render: &RenderSettings| {
            image.validate()?;
            render.validate()
        };
        let of_scene = check(image, render);
        self.replace_settings(image, render)?;
        check(image, render).map_err(|error| match of_scene {
            Ok(()) => Error { at: in_options(), ..error },
            Err(_) => error,
        })
    }

    /// # Errors
    /// `Request` for a picture that is too large or has no pixels, and for a crop outside of it.
    fn replace_settings(&self, image: &mut ImageSettings, render: &mut RenderSettings) -> Result<()> {
        self.resize(image)?;
        if let Some(crop) = self.crop {
            if crop.x1 > image.width || crop.y1 > image.height {
                let PixelBounds { x0, y0, x1, y1 } = crop;
                return Err(unsuitable(format!(
                    "the crop {x0},{y0},{x1},{y1} is not a part of the picture of {} × {} pixels",
                    image.width, image.height
                )));
            }
            image.crop = Some(crop);
        }
        replace(&mut image.filter, self.filter);
        if let Some(Exposure::Stops(stops)) = self.exposure {
            image.exposure = stops;
        }
        replace(&mut image.tonemap, self.tonemap);
        replace(&mut render.samples, self.samples);
        if self.allocation == Some(Allocation::Adaptive) && self.stop.noise.is_some() {
            return Err(unsuitable(
                "adaptive allocation spends a given number of samples; a limit of noise has no such number"
                    .to_owned(),
            ));
        }
        replace(&mut render.allocation, self.allocation);
        replace(&mut render.integrator, self.integrator);
        replace(&mut render.color, self.color);
        replace(&mut render.light_sampler, self.light_sampler);
        replace(&mut render.portals, self.portals);
        replace(&mut image.layers, self.layers);
        for layer in &self.light_paths {
            image.light_paths.retain(|other| other.name != layer.name);
            image.light_paths.push(layer.clone());
        }
        if !self.cryptomattes.is_empty() {
            image.cryptomattes = CryptomatteKind::distinct(self.cryptomattes.iter().copied());
        }
        image.spectral_film = self.spectral_film(image.spectral_film.take());
        replace(&mut image.denoise, self.denoise);
        replace(&mut image.background, self.background);
        replace(&mut render.depth, self.depth);
        replace(&mut render.min_contribution, self.min_contribution);
        replace(&mut render.sampler, self.sampler);
        replace(&mut render.seed, self.seed);
        Ok(())
    }

    /// The spectral film, in place of that of the scene.
    fn spectral_film(&self, of_scene: Option<SpectralFilm>) -> Option<SpectralFilm> {
        let kept = of_scene.filter(|_| self.spectral_buckets != Some(0));
        let is_asked = self.spectral_buckets.is_some_and(|buckets| buckets > 0) || self.wavelengths.is_some();
        let mut film = if is_asked { kept.unwrap_or(SpectralFilm::NONE) } else { kept? };
        replace(&mut film.buckets, self.spectral_buckets);
        replace(&mut film.range, self.wavelengths);
        Some(film)
    }

    /// The samples to take, of a picture with these settings.
    ///
    /// # Errors
    /// `Request` where there are none, for a part that is none of 1 to the number of parts, and for a part of an adaptive picture.
    pub(super) fn range(
        &self,
        &RenderSettings { samples, allocation, .. }: &RenderSettings,
    ) -> Result<Range<u32>> {
        let all = self.first_sample..samples;
        let [part, parts] = self.part.map(|part| part.map(u64::from)).unwrap_or([1, 1]);
        if !(1..=parts).contains(&part) {
            return Err(unsuitable(format!(
                "part {part} of {parts}; expected a part from 1 to the number of parts"
            )));
        }
        let length = u64::from(all.end.saturating_sub(all.start));
        let edge = |part: u64| all.start + (length * part / parts) as u32;
        let range = edge(part - 1)..edge(part);
        if range.is_empty() {
            return Err(unsuitable(format!(
                "part {part} of {parts} of the samples {}..{} has no sample; expected at least one for each part",
                all.start, all.end
            )));
        }
        let is_adaptive = self.stop.noise.is_some() || allocation == Allocation::Adaptive;
        if range != (0..samples) && is_adaptive {
            return Err(unsuitable(
                "adaptive sampling decides by all samples of a picture; a part of the samples cannot be adaptive"
                    .to_owned(),
            ));
        }
        Ok(range)
    }

    fn resize(&self, image: &mut ImageSettings) -> Result<()> {
        let (old_width, old_height) = (u64::from(image.width), u64::from(image.height));
        let of_scene = [image.width, image.height];
        let asked = [self.width.unwrap_or(image.width), self.height.unwrap_or(image.height)];
        if let Some([width, height]) = [of_scene, asked].into_iter().find(|sides| sides.contains(&0)) {
            return Err(unsuitable(format!(
                "a picture of {width} × {height} pixels; expected at least 1 × 1"
            )));
        }
        // One side alone: the other one keeps the aspect ratio, to the nearest pixel.
        let (width, height) = match (self.width.map(u64::from), self.height.map(u64::from)) {
            (None, None) => return Ok(()),
            (Some(width), Some(height)) => (width, height),
            (Some(width), None) => (width, (width * old_height + old_width / 2) / old_width),
            (None, Some(height)) => ((height * old_width + old_height / 2) / old_height, height),
        };
        let (width, height) = (width.max(1), height.max(1));
        if width.saturating_mul(height) > MOST_PIXELS {
            let message =
                format!("a picture of {width} × {height} pixels; at most {MOST_PIXELS} pixels are possible");
            return Err(unsuitable(message).hint(
                "parts of a larger one are pictures of their own, by `window` in [camera]: the range of x and y that is seen",
            ));
        }
        image.resize(width as u32, height as u32);
        Ok(())
    }

    /// Whether a view replaces the scene's camera.
    pub(super) fn chooses_view(&self) -> bool {
        self.view.is_some() || self.azimuth.is_some() || self.elevation.is_some()
    }

    /// Whether they ask for layers besides the picture.
    pub(super) fn asks_for_layers(&self) -> bool {
        self.layers.is_some_and(|layers| layers != Layers::None)
            || !self.light_paths.is_empty()
            || !self.cryptomattes.is_empty()
            || self.spectral_buckets.is_some_and(|buckets| buckets > 0)
    }

    /// The view that a scene without a camera is framed from.
    pub(super) fn viewpoint(&self) -> Viewpoint {
        let mut viewpoint = self.view.unwrap_or(Viewpoint::THREE_QUARTER);
        replace(&mut viewpoint.azimuth, self.azimuth);
        replace(&mut viewpoint.elevation, self.elevation);
        // A camera that is elsewhere does not keep the distance of the framing.
        if self.lookfrom.is_none() && self.fov.is_some() {
            viewpoint.fov = self.fov;
        }
        viewpoint
    }

    /// Applies the options to a camera, of a scene whose middle is this point; returns whether they change it.
    ///
    /// # Errors
    /// `Request` for a field of view where rays are parallel, and for a new position or direction of a camera that
    /// shears.
    pub(super) fn apply_to_camera(&self, camera: &mut Camera, middle: DVec3) -> Result<bool> {
        let moved = self.lookfrom.is_some() || self.lookat.is_some() || self.up_of_camera().is_some();
        if let Some(degrees) = self.fov {
            let fov = match &mut camera.projection {
                Projection::Perspective { fov } => fov,
                Projection::LensSystem(_) => {
                    return Err(unsuitable(
                        "a field of view has no meaning here: this scene's camera has a lens, and sees as much as its film is large"
                            .to_owned(),
                    ));
                }
                _ => {
                    return Err(unsuitable(
                        "a field of view has no meaning here: the rays of this scene's camera are parallel"
                            .to_owned(),
                    ));
                }
            };
            *fov = degrees;
        }
        if moved {
            self.look(camera, middle)?;
            // Errors of the camera from here on have no line in a file.
            camera.at = in_options();
        }
        Ok(moved || self.fov.is_some())
    }

    /// The up vector of a camera that no view frames: straight from above, what is up in the world is not in the picture.
    fn up_of_camera(&self) -> Option<DVec3> {
        self.up.filter(|_| !self.chooses_view())
    }

    fn look(&self, camera: &mut Camera, middle: DVec3) -> Result<()> {
        let mut look = camera.look(middle).ok_or_else(|| {
            unsuitable("lookfrom, lookat and up cannot change a camera whose matrix shears".to_owned())
        })?;
        replace(&mut look.lookfrom, self.lookfrom);
        replace(&mut look.lookat, self.lookat);
        replace(&mut look.up, self.up_of_camera());
        camera.set_look(look, middle);
        Ok(())
    }
}

/// The location of errors in options.
fn in_options() -> Location {
    Location { file: OPTIONS.into(), ..Location::default() }
}

/// Checks a number, given what is expected and whether a number is that.
fn check_number(name: &str, number: Option<f64>, expected: &str, is_valid: fn(f64) -> bool) -> Result<()> {
    match number {
        Some(number) if !is_valid(number) => {
            Err(unsuitable(format!("{name} is {number}; expected {expected}")))
        }
        _ => Ok(()),
    }
}

fn check_elevation(degrees: Option<f64>) -> Result<()> {
    check_number("elevation", degrees, "degrees from -90 to 90", |degrees| degrees.abs() <= 90.0)
}

fn check_fov(degrees: Option<f64>) -> Result<()> {
    check_number("fov", degrees, "degrees between 0 and 180", |degrees| degrees > 0.0 && degrees < 180.0)
}

fn check_vector(
    name: &str,
    vector: Option<DVec3>,
    expected: &str,
    is_valid: fn(DVec3) -> bool,
) -> Result<()> {
    match vector {
        Some(vector) if !is_valid(vector) => {
            Err(unsuitable(format!("{name} is {vector}; expected {expected}")))
        }
        _ => Ok(()),
    }
}

fn check_bounds(bounds: Option<Bounds>) -> Result<()> {
    // Those of scenes without shapes are empty.
    let Some(bounds @ Bounds { min, max }) = bounds.filter(|bounds| *bounds != Bounds::EMPTY) else {
        return Ok(());
    };
    if min.is_finite() && max.is_finite() && !bounds.is_empty() {
        return Ok(());
    }
    Err(unsuitable(format!("bounds are {min} to {max}; expected finite coordinates, the lesser first")))
}

fn replace<T>(setting: &mut T, typed: Option<T>) {
    if let Some(typed) = typed {
        *setting = typed;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DMat4;
    use lookfrom_scene::camera::{Lens, View};

    fn image(width: u32, height: u32, crop: Option<PixelBounds>) -> ImageSettings {
        ImageSettings { width, height, crop, ..ImageSettings::default() }
    }

    fn resized(of: &Options, mut image: ImageSettings) -> Result<ImageSettings> {
        of.apply_to_settings(&mut image, &mut RenderSettings::default()).map(|()| image)
    }

    #[test]
    fn one_side_keeps_the_shape() {
        let of = |width, height| {
            let image =
                resized(&Options { width, height, ..Options::default() }, image(640, 480, None)).unwrap();
            (image.width, image.height)
        };
        assert_eq!(of(Some(320), None), (320, 240));
        assert_eq!(of(None, Some(3)), (4, 3));
        assert_eq!(of(Some(1), None), (1, 1));
        assert_eq!(of(Some(7), Some(9)), (7, 9));
        let flat = Options { height: Some(1), ..Options::default() };
        assert_eq!(resized(&flat, image(1, 1000, None)).unwrap().width, 1);
        let huge = Options { width: Some(u32::MAX), ..Options::default() };
        assert!(matches!(
            resized(&huge, image(1, 1 << 28, None)),
            Err(Error { kind: ErrorKind::Request, .. })
        ));
    }

    #[test]
    fn a_crop_of_the_scene_stays_the_same_part() {
        let crop = Some(PixelBounds { x0: 10, y0: 0, x1: 30, y1: 50 });
        let half = Options { width: Some(50), ..Options::default() };
        let image = resized(&half, image(100, 100, crop)).unwrap();
        assert_eq!(image.crop, Some(PixelBounds { x0: 5, y0: 0, x1: 15, y1: 25 }));
    }

    #[test]
    fn parts_make_the_whole() {
        let of = |samples| RenderSettings { samples, ..RenderSettings::default() };
        for (first, samples, parts) in [(0, 64, 3), (16, 64, 7), (0, 5, 5), (3, 4, 1)] {
            let part =
                |part| Options { first_sample: first, part: Some([part, parts]), ..Options::default() };
            let ranges: Vec<_> = (1..=parts).map(|k| part(k).range(&of(samples)).unwrap()).collect();
            assert_eq!((ranges[0].start, ranges[ranges.len() - 1].end), (first, samples));
            assert!(ranges.windows(2).all(|pair| pair[0].end == pair[1].start));
            let [least, most] = [ranges.iter().map(Range::len).min(), ranges.iter().map(Range::len).max()];
            assert!(most.unwrap() - least.unwrap() <= 1);
        }
        let none = Options { part: Some([2, 6]), ..Options::default() };
        assert!(none.range(&of(5)).is_ok() && Options { part: Some([1, 6]), ..none }.range(&of(5)).is_err());
        for part in [[0, 0], [0, 3], [1, 0], [3, 2]] {
            assert!(Options { part: Some(part), ..Options::default() }.range(&of(5)).is_err(), "{part:?}");
        }
        assert!(Options { first_sample: 5, ..Options::default() }.range(&of(5)).is_err());
        let stop = StopCriteria { noise: Some(0.1), ..StopCriteria::default() };
        assert!(Options { first_sample: 1, stop, ..Options::default() }.range(&of(5)).is_err());
        let adaptive = RenderSettings { allocation: Allocation::Adaptive, ..of(64) };
        assert!(Options::default().range(&adaptive).is_ok());
        assert!(Options { part: Some([1, 2]), ..Options::default() }.range(&adaptive).is_err());
    }

    #[test]
    fn a_crop_beyond_the_picture_is_refused() {
        let crop = Some(PixelBounds { x0: 0, y0: 0, x1: 11, y1: 10 });
        let beyond = Options { crop, ..Options::default() };
        assert!(matches!(resized(&beyond, image(10, 10, None)), Err(Error { kind: ErrorKind::Request, .. })));
        assert!(resized(&beyond, image(11, 10, None)).is_ok());
    }

    fn moved(of: &Options, mut camera: Camera) -> Result<Camera> {
        of.apply_to_camera(&mut camera, Bounds::EMPTY.center()).map(|_| camera)
    }

    #[test]
    fn a_camera_moves_and_keeps_the_rest() {
        let lens = Some(Lens { radius: 0.1, focus_distance: 26.0_f64.sqrt() });
        let away = Options { lookfrom: Some(DVec3::new(0.0, 0.0, -3.0)), ..Options::default() };
        let camera = moved(&away, Camera { lens, ..Camera::default() }).unwrap();
        let View::Look { lookfrom, lookat, up } = camera.view else { panic!("{camera:?}") };
        assert_eq!((lookfrom, lookat, up), (DVec3::new(0.0, 0.0, -3.0), DVec3::ZERO, DVec3::Y));
        assert_eq!(camera.lens.unwrap().focus_distance, 3.0);
    }

    #[test]
    fn a_matrix_that_turns_becomes_a_look_and_one_that_mirrors_still_mirrors() {
        // at (0, 0, 5), looks along −z; x of its space, the viewer's left, is −x
        let turned = DMat4::from_cols(
            DVec3::NEG_X.extend(0.0),
            DVec3::Y.extend(0.0),
            DVec3::NEG_Z.extend(0.0),
            DVec3::new(0.0, 0.0, 5.0).extend(1.0),
        );
        let rise = Options { lookfrom: Some(DVec3::new(0.0, 4.0, 5.0)), ..Options::default() };
        let camera = moved(&rise, Camera { view: View::Matrix(turned), ..Camera::default() }).unwrap();
        let View::Look { lookat, up, .. } = camera.view else { panic!("{camera:?}") };
        assert_eq!((lookat, up), (DVec3::new(0.0, 0.0, 4.0), DVec3::Y));
        let mirrored = turned * DMat4::from_scale(DVec3::new(-1.0, 1.0, 1.0));
        let camera = moved(&rise, Camera { view: View::Matrix(mirrored), ..Camera::default() }).unwrap();
        assert!(camera.is_mirrored());
        let look = camera.look(DVec3::ZERO).unwrap();
        assert_eq!((look.lookfrom, look.up.dot(DVec3::Y) > 0.0), (DVec3::new(0.0, 4.0, 5.0), true));
        // Of the same picture, seen in a mirror.
        let [mirrored, own] =
            [camera, moved(&rise, Camera { view: View::Matrix(turned), ..Camera::default() }).unwrap()]
                .map(|camera| crate::view::camera::Camera::new(&camera, 64, 48).unwrap());
        let [left, right] =
            [(&mirrored, 10.0), (&own, 54.0)].map(|(camera, x)| camera.ray([x, 20.0], [0.5; 2]).direction);
        assert!((left - right).length() < 1e-12, "{left} {right}");
        let sheared = turned
            * DMat4::from_cols_array(&[
                1.0, 0.5, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0,
            ]);
        let camera = Camera { view: View::Matrix(sheared), ..Camera::default() };
        assert!(matches!(moved(&rise, camera), Err(Error { kind: ErrorKind::Request, .. })));
    }

    #[test]
    fn parallel_rays_have_no_field_of_view() {
        let wide = Options { fov: Some(90.0), ..Options::default() };
        let parallel = Camera { projection: Projection::Orthographic { height: 2.0 }, ..Camera::default() };
        assert!(matches!(moved(&wide, parallel), Err(Error { kind: ErrorKind::Request, .. })));
        let camera = moved(&wide, Camera::default()).unwrap();
        assert_eq!(camera.projection, Projection::Perspective { fov: 90.0 });
    }
}
