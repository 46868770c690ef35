//! The sensor with its film and sampler, and the integrator.

use std::ops::Range;

use glam::DMat4;

use super::Reader;
use super::plugin::Plugin;
use crate::camera::{Camera, Lens, Projection, View, Window};
use crate::error::{Error, ErrorKind, Result};
use crate::scene::MediumId;
use crate::settings::{
    Background, Band, ColorMode, Filter, FilterShape, Integrator, Layers, PixelBounds, Sampler, SpectralFilm,
};

/// Maximum width and height.
const LARGEST: i64 = 1 << 16;
/// Maximum number of samples per pixel.
const MOST_SAMPLES: i64 = 1 << 24;

/// Maximum number of reflections: so many that Russian roulette alone ends paths, except between perfect mirrors.
const DEEPEST: u32 = 1000;

const SENSORS: &[&str] = &["distant", "orthographic", "perspective", "radiancemeter", "thinlens"];
/// The sensors that are parts of a shape.
const SENSORS_OF_SHAPES: &[&str] = &["irradiancemeter"];
/// The name of shapes without an `id` whose irradiance is measured.
const MEASURED: &str = "measured surface";
/// Films whose pictures are those of `hdrfilm`.
const FILMS: &[&str] = &["hdrfilm", "ldrfilm", "specfilm", "tiledhdrfilm"];
const SAMPLERS: &[&str] =
    &["halton", "hammersley", "independent", "ldsampler", "multijitter", "orthogonal", "sobol", "stratified"];
/// Integrators of Mitsuba 0.6 whose pictures have the same mean.
const OTHERS: &[&str] = &["bdpt", "erpt", "mlt", "photonmapper", "ppm", "pssmlt", "sppm", "vpl"];
const INTEGRATORS: &[&str] =
    &["aov", "depth", "direct", "moment", "path", "prb", "prbvolpath", "ptracer", "volpath", "volpathmis"];
/// Integrators for derivatives, whose pictures are those of others.
const DIFFERENTIABLE: &[(&str, &str)] = &[
    ("direct_projective", "direct"),
    ("direct_reparam", "direct"),
    ("prb", "path"),
    ("prb_basic", "path"),
    ("prb_projective", "path"),
    ("prb_reparam", "path"),
    ("prbvolpath", "volpath"),
];

/// A projection that is one ray.
const ONE_RAY: Projection = Projection::Perspective { fov: 1e-6 };

/// The axis along which a field of view is measured.
#[derive(Clone, Copy)]
enum Axis {
    X,
    Y,
    Diagonal,
    Smaller,
    Larger,
}

impl Reader<'_, '_> {
    /// A sensor, if it is the first one: of the scene, or of those of the scene's shapes that a shape has become.
    pub(super) fn first_sensor(&mut self, plugin: &Plugin, shapes: Option<Range<usize>>) -> Result<()> {
        if self.scene.camera.is_some() {
            self.context.warn(&plugin.at, "only the first sensor is rendered");
            return Ok(());
        }
        match (&*plugin.kind, shapes) {
            ("irradiancemeter", Some(shapes)) => self.irradiance_meter(plugin, shapes),
            ("irradiancemeter", None) => {
                let message = "an irradiancemeter is a part of the shape whose irradiance it measures";
                Err(Error::invalid(&plugin.at, message).hint("write it within a <shape>"))
            }
            (_, Some(_)) => Err(plugin.unsupported(SENSORS_OF_SHAPES)),
            ("distant", None) => self.distant(plugin),
            (_, None) => self.sensor(plugin),
        }
    }

    /// A sensor that measures the irradiance on shapes.
    fn irradiance_meter(&mut self, plugin: &Plugin, shapes: Range<usize>) -> Result<()> {
        let shapes = &mut self.scene.shapes[shapes];
        let Some(first) = shapes.first() else {
            let message = "the irradiance of an instance or a group cannot be measured";
            return Err(Error::new(ErrorKind::Unsupported, &plugin.at, message)
                .hint("measure a shape that is written outside of groups"));
        };
        let surface = first.name.clone().unwrap_or_else(|| MEASURED.to_owned());
        shapes.iter_mut().for_each(|shape| shape.name = Some(surface.clone()));
        let medium = self.film_and_sampler(plugin)?;
        if (self.scene.image.width, self.scene.image.height) != (1, 1) {
            let message = "each pixel of this irradiancemeter measures the whole shape: in Mitsuba each measures a part of it, with the same mean";
            self.warn_once(&plugin.at, message);
        }
        let projection = Projection::Irradiance { surface };
        self.scene.camera = Some(Camera { at: plugin.at.clone(), projection, medium, ..Camera::default() });
        Ok(())
    }

    /// A sensor that sees a point from far away, in a direction: with one ray, from as far outside of the scene as in Mitsuba.
    fn distant(&mut self, plugin: &Plugin) -> Result<()> {
        let medium = self.film_and_sampler(plugin)?;
        let along = match plugin.vector("direction")? {
            Some(direction) => direction,
            None => plugin.to_world()?.z_axis.truncate(),
        };
        let along =
            along.try_normalize().ok_or_else(|| plugin.refuse("direction", "a vector other than 0"))?;
        let of_shape = plugin.peek("shape", &self.ids)?;
        let target = if of_shape.is_some() { None } else { plugin.vector("target")? };
        let Some(target) = target else {
            let message = "a distant sensor that sees a shape or the whole scene is not supported";
            let error = Error::new(ErrorKind::Unsupported, &plugin.at, message);
            return Err(error.hint(
                "give it a `target`, the <point> that it sees; an orthographic sensor sees the whole scene",
            ));
        };
        let radius = self.scene.bounds().radius();
        let way = if radius > 0.0 { 2.0 * radius } else { 1.0 };
        let from = target - way * along;
        let (x, y) = along.any_orthonormal_pair();
        let axes = [x, y, along].map(|axis| axis.extend(0.0));
        self.scene.camera = Some(Camera {
            at: plugin.at.clone(),
            view: View::Matrix(DMat4::from_cols(axes[0], axes[1], axes[2], from.extend(1.0))),
            projection: ONE_RAY,
            medium,
            ..Camera::default()
        });
        Ok(())
    }

    /// The film and the sampler of a sensor; the medium around it.
    fn film_and_sampler(&mut self, plugin: &Plugin) -> Result<Option<MediumId>> {
        plugin.ignore(&["shutter_open", "shutter_close"]);
        let film = plugin.part("film", &self.ids)?;
        self.film(film.as_deref())?;
        let sampler = plugin.part("sampler", &self.ids)?;
        self.sampler(sampler.as_deref())?;
        plugin.part("medium", &self.ids)?.map(|medium| self.medium(&medium)).transpose()
    }

    fn sensor(&mut self, plugin: &Plugin) -> Result<()> {
        if !SENSORS.contains(&&*plugin.kind) {
            return Err(plugin.unsupported(SENSORS));
        }
        let medium = self.film_and_sampler(plugin)?;
        let aspect = f64::from(self.scene.image.width) / f64::from(self.scene.image.height);
        let projection = match &*plugin.kind {
            "orthographic" => Projection::Orthographic { height: 2.0 / aspect },
            "radiancemeter" => ONE_RAY,
            _ => Projection::Perspective { fov: field_of_view(plugin, aspect)? },
        };
        let lens = match &*plugin.kind {
            "thinlens" => {
                let radius = plugin.positive("aperture_radius", 1.0)?;
                Some(Lens { radius, focus_distance: plugin.positive("focus_distance", 1.0)? })
            }
            _ => {
                plugin.ignore(&["focus_distance"]);
                None
            }
        };
        let (x, y) = match &*plugin.kind {
            "perspective" => {
                let offset = |name: &str| plugin.float(name, 0.0);
                (offset("principal_point_offset_x")?, offset("principal_point_offset_y")?)
            }
            _ => (0.0, 0.0),
        };
        let shifted = Window {
            x: [(2.0 * x - 1.0) * aspect, (2.0 * x + 1.0) * aspect],
            y: [-1.0 - 2.0 * y, 1.0 - 2.0 * y],
        };
        let clip = match &*plugin.kind {
            "radiancemeter" => None,
            _ => Some(clip(plugin)?),
        };
        self.scene.camera = Some(Camera {
            at: plugin.at.clone(),
            view: View::Matrix(plugin.to_world()?),
            projection,
            lens,
            window: ((x, y) != (0.0, 0.0)).then_some(shifted),
            clip,
            medium,
            ..Camera::default()
        });
        Ok(())
    }

    fn film(&mut self, film: Option<&Plugin>) -> Result<()> {
        let image = &mut self.scene.image;
        (image.width, image.height) = (768, 576);
        image.filter = FilterShape::Gaussian { sigma: 0.5 }.of_radius(2.0);
        let Some(film) = film else { return Ok(()) };
        if !FILMS.contains(&&*film.kind) {
            return Err(film.unsupported(FILMS));
        }
        // The format of the picture is that of the file that is asked for.
        film.ignore(&[
            "file_format",
            "pixel_format",
            "component_format",
            "sample_border",
            "banner",
            "compensate",
        ]);
        image.width = film.integer("width", 768, 1, LARGEST)? as u32;
        image.height = film.integer("height", 576, 1, LARGEST)? as u32;
        let (width, height) = (i64::from(image.width), i64::from(image.height));
        let x0 = film.integer("crop_offset_x", 0, 0, width - 1)?;
        let y0 = film.integer("crop_offset_y", 0, 0, height - 1)?;
        let columns = film.integer("crop_width", width - x0, 1, width - x0)?;
        let rows = film.integer("crop_height", height - y0, 1, height - y0)?;
        if (columns, rows) != (width, height) {
            let [x0, y0, x1, y1] = [x0, y0, x0 + columns, y0 + rows].map(|edge| edge as u32);
            image.crop = Some(PixelBounds { x0, y0, x1, y1 });
        }
        if let Some(filter) = film.part("rfilter", &self.ids)? {
            let warn = |told| self.context.warn(&filter.at, told);
            self.scene.image.filter = reconstruction(&filter)?.narrowed(warn);
        }
        if film.kind == "specfilm" {
            self.scene.render.color = ColorMode::Spectral;
            self.scene.image.spectral_film = Some(self.spectral_film(film)?);
        }
        Ok(())
    }

    /// The bands of a film, and the wavelengths at which any has a response.
    fn spectral_film(&mut self, film: &Plugin) -> Result<SpectralFilm> {
        let mut measuring = SpectralFilm::NONE;
        let mut range = [f32::INFINITY, 0.0_f32];
        for (property, response) in self.spectra(film)? {
            let [from, to] = response.support();
            if from < SpectralFilm::ALL[0] || to > SpectralFilm::ALL[1] {
                let message = "a band is measured from 360 to 830 nm, without the rest of its response";
                self.warn_once(&property.at, message);
            }
            let band = Band { name: property.name.clone(), response };
            if band.width(SpectralFilm::ALL) == 0.0 {
                self.warn_once(&property.at, "a band without response from 360 to 830 nm is left out");
                continue;
            }
            range = [range[0].min(from), range[1].max(to)];
            measuring.add(band).map_err(|message| Error::invalid(&property.at, message))?;
        }
        if measuring.bands.is_empty() {
            let message = "a specfilm has a spectrum for each of its bands, its response";
            return Err(Error::invalid(&film.at, message)
                .hint("add <spectrum name=\"red\" value=\"600:0, 650:1, 700:0\"/>"));
        }
        let [from, to] = [range[0].max(SpectralFilm::ALL[0]), range[1].min(SpectralFilm::ALL[1])];
        // At least 1 nm.
        let from = from.min(SpectralFilm::ALL[1] - 1.0);
        Ok(SpectralFilm { range: [from, to.max(from + 1.0)], ..measuring })
    }

    fn sampler(&mut self, sampler: Option<&Plugin>) -> Result<()> {
        let render = &mut self.scene.render;
        (render.samples, render.sampler) = (4, Sampler::Independent);
        let Some(sampler) = sampler else { return Ok(()) };
        if !SAMPLERS.contains(&&*sampler.kind) {
            return Err(sampler.unsupported(SAMPLERS));
        }
        sampler.ignore(&["jitter"]);
        render.samples = sampler.integer("sample_count", 4, 1, MOST_SAMPLES)? as u32;
        render.seed = sampler.integer("seed", 0, 0, i64::from(u32::MAX))? as u64;
        if sampler.kind != "independent" {
            render.sampler = Sampler::Sobol;
        }
        Ok(())
    }

    pub(super) fn integrator(&mut self, integrator: Option<&Plugin>) -> Result<()> {
        let render = &mut self.scene.render;
        (render.integrator, render.depth, render.media) = (Integrator::Path, DEEPEST, false);
        let Some(plugin) = integrator else { return Ok(()) };
        let same = DIFFERENTIABLE.iter().find(|(name, _)| *name == plugin.kind).map(|(_, same)| *same);
        match same.unwrap_or(&plugin.kind) {
            "moment" | "aov" => {
                if plugin.kind == "aov" && plugin.string("aovs")?.is_some_and(|aovs| !aovs.trim().is_empty())
                {
                    self.scene.image.layers = Layers::Geometry;
                }
                let inner = plugin.part("integrator", &self.ids)?;
                return self.within_integrator(plugin, inner.as_ref());
            }
            "depth" => {
                render.integrator = Integrator::Depth;
                let message = "the depth is that along the axis of view, in Mitsuba along each ray from its `near_clip`";
                self.warn_once(&plugin.at, message);
                return Ok(());
            }
            "direct" => {
                plugin.ignore(&["shading_samples", "emitter_samples", "bsdf_samples"]);
                render.depth = 1;
            }
            "path" | "ptracer" | "volpath" | "volpathmis" => {
                plugin.ignore(&["rr_depth", "samples_per_pass"]);
                // Segments of a path, one more than its reflections.
                let most = if same.is_some() { 6 } else { -1 };
                let segments = plugin.integer("max_depth", most, -1, i64::from(u32::MAX))?;
                if segments == 0 {
                    return Err(plugin.refuse(
                        "max_depth",
                        "at least 1, since with 0 the picture is black, or −1 for no limit",
                    ));
                }
                render.depth = u32::try_from(segments - 1).map_or(DEEPEST, |depth| depth.min(DEEPEST));
                render.media = plugin.kind.contains("volpath");
                render.thin_passages_count = !render.media;
            }
            other if OTHERS.contains(&other) => {
                let message = format!("the integrator {other:?} is replaced by path tracing");
                self.warn_once(&plugin.at, message);
                return Ok(());
            }
            _ => return Err(plugin.unsupported(INTEGRATORS)),
        }
        if plugin.boolean("hide_emitters", false)? {
            self.scene.render.hide_lights = true;
            self.scene.image.background = Background::Transparent;
        }
        Ok(())
    }

    /// The integrator in another one that only measures it.
    fn within_integrator(&mut self, outer: &Plugin, inner: Option<&std::rc::Rc<Plugin>>) -> Result<()> {
        match inner {
            Some(inner) => self.within(inner, |reader| reader.integrator(Some(inner))),
            None => Err(Error::invalid(&outer.at, format!("the {} has no integrator in it", outer.title()))),
        }
    }
}

fn reconstruction(filter: &Plugin) -> Result<Filter> {
    Ok(match &*filter.kind {
        "box" => FilterShape::Box.of_radius(0.5),
        "tent" => FilterShape::Triangle.of_radius(filter.positive("radius", 1.0)? as f32),
        "gaussian" => {
            let sigma = filter.positive("stddev", 0.5)? as f32;
            FilterShape::Gaussian { sigma }.of_radius(4.0 * sigma)
        }
        "mitchell" => {
            let [b, c] = [filter.float("B", 1.0 / 3.0)?, filter.float("C", 1.0 / 3.0)?];
            FilterShape::Mitchell { b: b as f32, c: c as f32 }.of_radius(2.0)
        }
        "catmullrom" => FilterShape::Mitchell { b: 0.0, c: 0.5 }.of_radius(2.0),
        "lanczos" => {
            let lobes = filter.integer("lobes", 3, 1, 16)? as f32;
            FilterShape::Sinc { tau: lobes }.of_radius(lobes)
        }
        _ => {
            return Err(filter.unsupported(&[
                "box",
                "catmullrom",
                "gaussian",
                "lanczos",
                "mitchell",
                "tent",
            ]));
        }
    })
}

/// The distances between which a camera sees.
fn clip(plugin: &Plugin) -> Result<[f64; 2]> {
    let (near, far) = (plugin.positive("near_clip", 1e-2)?, plugin.positive("far_clip", 1e4)?);
    if near < far { Ok([near, far]) } else { Err(plugin.refuse("near_clip", "less than `far_clip`")) }
}

/// The vertical field of view in degrees.
pub(super) fn field_of_view(plugin: &Plugin, aspect: f64) -> Result<f64> {
    let half = |degrees: f64| libm::tan((0.5 * degrees).to_radians());
    let (tangent, axis) = if plugin.find("fov").is_some() {
        let degrees =
            plugin.float_where("fov", 0.0, "an angle between 0 and 180 degrees", |a| a > 0.0 && a < 180.0)?;
        let axes = [
            ("x", Axis::X),
            ("y", Axis::Y),
            ("diagonal", Axis::Diagonal),
            ("smaller", Axis::Smaller),
            ("larger", Axis::Larger),
        ];
        (half(degrees), plugin.choice("fov_axis", Axis::X, &axes)?)
    } else {
        // The focal length in mm of a camera for film of 36 mm × 24 mm.
        let focal = match plugin.string("focal_length")? {
            None => 50.0,
            Some(written) => {
                let number = written.trim().trim_end_matches("mm").trim().parse::<f64>().ok();
                let number = number.filter(|number| *number > 0.0 && number.is_finite());
                number.ok_or_else(|| plugin.refuse("focal_length", "a length in mm, such as 50mm"))?
            }
        };
        (0.5 * (36.0_f64 * 36.0 + 24.0 * 24.0).sqrt() / focal, Axis::Diagonal)
    };
    let vertical = match axis {
        Axis::X => tangent / aspect,
        Axis::Y => tangent,
        Axis::Diagonal => tangent / (1.0 + aspect * aspect).sqrt(),
        Axis::Smaller => {
            if aspect > 1.0 {
                tangent
            } else {
                tangent / aspect
            }
        }
        Axis::Larger => {
            if aspect > 1.0 {
                tangent / aspect
            } else {
                tangent
            }
        }
    };
    Ok((2.0 * libm::atan(vertical)).to_degrees())
}
