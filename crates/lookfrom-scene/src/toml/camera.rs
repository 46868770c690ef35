//! `[camera]`: position, orientation, projection and lens.

use std::sync::Arc;

use glam::{DMat4, DVec3};

use super::table::Table;
use super::value::Value;
use super::{Reader, transform};
use crate::camera::{Camera, Lens, Projection, Target, View, Window, up_across};
use crate::error::Result;
use crate::image;
use crate::lens::{self, ApertureShape, LensConvention, LensSurface, LensSystem};

/// The keys of `[camera]`.
pub(super) const KEYS: &[&str] = &[
    "lookfrom",
    "lookat",
    "up",
    "projection",
    "fov",
    "height",
    "aperture",
    "focus_distance",
    "focus",
    "lens",
    "film",
    "aperture_shape",
    "millimetre",
    "window",
    "distance",
    "clip",
    "medium",
    "shutter",
    "matrix",
    "stop",
    "lens_convention",
    "motion",
    "surface",
];
/// The keys that only a lens system has.
const OF_LENS: [&str; 5] = ["film", "aperture_shape", "millimetre", "stop", "lens_convention"];
/// The words for conventions of lens systems.
pub(super) const CONVENTIONS: &[(&str, LensConvention)] =
    &[("pinhole", LensConvention::AsPinhole), ("pbrt", LensConvention::Pbrt)];
/// The keys of `window`.
pub(super) const WINDOW: &[&str] = &["x", "y"];

impl Reader<'_, '_> {
    /// The camera, if it is valid.
    pub(super) fn camera(&mut self, table: &Table<'_>) -> Result<Camera> {
        let surfaces = table.maybe("lens", |value| self.lens_surfaces(value));
        let shape = table.or("aperture_shape", ApertureShape::Circle, |value| self.aperture_shape(value));
        let lengths = [("millimetre", 1e-3), ("film", 35.0)];
        let [millimetre, film_diagonal] =
            lengths.map(|(key, default)| table.or(key, default, Value::positive));
        let camera = camera(table)?;
        let Some((name, surfaces)) = surfaces else { return Ok(camera) };
        if let Some(value) = ["fov", "window"].iter().find_map(|key| table.find(key)) {
            let message = format!("`{}` has no meaning with a `lens`", value.key());
            return Err(value.error(message).hint("a lens sees as much as its `film` is large"));
        }
        table.one_of(&["aperture", "stop"]);
        let stop_diameter = match table.has("stop") {
            true => table.maybe("stop", Value::positive),
            false => table.maybe("aperture", Value::positive).map(|radius| 2.0 * radius / millimetre),
        };
        let stop_diameter = self.stop_diameter(table, &surfaces, stop_diameter)?;
        let system = LensSystem {
            name,
            surfaces,
            stop_diameter,
            shape,
            focus_distance: camera.lens.map_or(1.0, |lens| lens.focus_distance),
            film_diagonal,
            millimetre,
            convention: table
                .or("lens_convention", LensConvention::AsPinhole, |value| value.choice(CONVENTIONS)),
        };
        Ok(Camera { projection: Projection::LensSystem(Arc::new(system)), lens: None, ..camera })
    }

    /// The diameter of the aperture stop, which may be as wide as in the lens file.
    fn stop_diameter(
        &mut self,
        table: &Table<'_>,
        surfaces: &[LensSurface],
        diameter: Option<f64>,
    ) -> Result<Option<f64>> {
        let Some(value) = ["stop", "aperture", "aperture_shape"].iter().find_map(|key| table.find(key))
        else {
            return Ok(None);
        };
        let Some(widest) = lens::stop_diameter(surfaces) else {
            let message = format!("`{}` has no meaning: the lens file has no aperture stop", value.key());
            return Err(value.error(message).hint(
                "a stop is a row with a radius of curvature and an index of 0, as in `0 4.5 0 17.1`: radius, thickness, index, diameter",
            ));
        };
        // Not for what a radius in units of the world is rounded to.
        if let Some(diameter) = diameter.filter(|&diameter| diameter > widest * (1.0 + 1e-9)) {
            let message = format!(
                "the aperture stop of the lens file is {widest} mm wide, which is used instead of the {diameter} mm of `{}`",
                value.key()
            );
            self.context.warn(&value.at(), message);
        }
        Ok(diameter.map(|diameter| diameter.min(widest)))
    }

    /// The name of a lens file, and its surfaces.
    fn lens_surfaces(&mut self, value: Value<'_>) -> Result<(String, Vec<LensSurface>)> {
        let path = self.resolve(value, "the name of a lens file")?;
        let surfaces = lens::read(&path, self.context).map_err(|error| value.blame(error))?;
        // Without its folders, which differ between machines that render parts of one picture.
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        Ok((name, surfaces))
    }

    /// A shape by its name, or the picture of one.
    fn aperture_shape(&mut self, value: Value<'_>) -> Result<ApertureShape> {
        let name = value.as_text();
        if let Some((_, shape)) = ApertureShape::NAMED.into_iter().find(|(word, _)| Some(*word) == name) {
            return Ok(shape);
        }
        let path = self.resolve(
            value,
            "\"circle\", \"gaussian\", \"square\", \"pentagon\", \"star\", or the name of a picture",
        )?;
        let image = image::read(&path, self.context).map_err(|error| {
            let names = ApertureShape::NAMED.map(|(name, _)| format!("{name:?}")).join(", ");
            value.blame(error).hint(format!("give the name of a picture, or one of {names}"))
        })?;
        Ok(ApertureShape::Image(Arc::new(image)))
    }
}

/// The distances between which a camera sees.
fn clip(value: Value<'_>) -> Result<[f64; 2]> {
    let what = "two distances along the view axis, at least 0 and rising";
    let [near, far] = value.numbers::<2>(what)?;
    if near >= 0.0 && far > near { Ok([near, far]) } else { Err(value.wrong(what)) }
}

/// The camera without a lens system.
fn camera(table: &Table<'_>) -> Result<Camera> {
    table.allow(&[KEYS]);
    if table.has("matrix") {
        return camera_by_matrix(table);
    }
    let projection = projection(table);
    let (lookfrom, lookat) = match projection {
        // What is measured does not depend on them.
        Projection::Irradiance { .. } => {
            let or = |key, default| table.or(key, default, Value::vector);
            (or("lookfrom", DVec3::new(0.0, 1.0, 5.0)), or("lookat", DVec3::ZERO))
        }
        _ => (
            table.need("lookfrom", "[0, 1, 5]", DVec3::Z, Value::vector),
            table.need("lookat", "[0, 0, 0]", DVec3::ZERO, Value::vector),
        ),
    };
    let up = table.or("up", DVec3::Y, Value::direction);
    let window = table.maybe("window", window);
    let distance = table.or("distance", 1.0, Value::positive);
    let aperture = table.maybe("aperture", Value::not_negative);
    let focus = focus(table);
    let shutter = table.or("shutter", 0.0, Value::not_negative);
    table.sound(&["lookfrom", "lookat", "up", "aperture", "focus", "focus_distance"])?;

    // Neither the view axis nor the horizontal axis of the image may be 0.
    let w = (lookat - lookfrom).normalize_or_zero();
    if w == DVec3::ZERO || !w.is_finite() {
        return Err(table
            .error_at(
                "lookat",
                "`lookat` and `lookfrom` are the same point, or too near or too far apart for a direction",
            )
            .hint("give a `lookat` that is in front of the camera"));
    }
    if up.normalize().cross(w).length_squared() < 1e-20 {
        let key = if table.has("up") { "up" } else { "lookat" };
        return Err(table
            .error_at(key, format!("up {up} is parallel to the view from lookfrom to lookat"))
            .hint(format!("give another `up`, such as {}", up_across(w))));
    }

    let focus_distance = match focus {
        Some(Focus::Distance(distance)) => distance,
        Some(Focus::Point(point)) => w.dot(point - lookfrom),
        None => w.dot(lookat - lookfrom),
    };
    Ok(Camera {
        at: table.at(),
        view: View::Look { lookfrom, lookat, up },
        target: None,
        projection,
        lens: thin_lens(table, aperture, focus_distance)?,
        window,
        distance,
        clip: table.maybe("clip", clip),
        medium: None,
        shutter,
        motion: table.maybe("motion", transform::motion),
    })
}

/// A thin lens, or the focus of a lens system.
fn thin_lens(table: &Table<'_>, aperture: Option<f64>, focus_distance: f64) -> Result<Option<Lens>> {
    if !(focus_distance > 0.0 && focus_distance.is_finite()) {
        return Err(table
            .error_at("focus", "`focus` is behind the camera")
            .hint("give a point in front of the camera"));
    }
    // A lens system is focused as a thin lens is.
    let radius = aperture.filter(|&radius| radius > 0.0).or(table.has("lens").then_some(0.0));
    Ok(radius.map(|radius| Lens { radius, focus_distance }))
}

/// The camera of a `matrix`, for which `lookat` and `up` are the target of a turntable.
fn camera_by_matrix(table: &Table<'_>) -> Result<Camera> {
    table.one_of(&["matrix", "lookfrom"]);
    table.one_of(&["matrix", "focus"]);
    let matrix = table.or("matrix", DMat4::IDENTITY, transform::invertible_rows);
    let lookat = table.maybe("lookat", Value::vector);
    let up = table.or("up", DVec3::Y, Value::direction);
    let projection = projection(table);
    let window = table.maybe("window", window);
    let distance = table.or("distance", 1.0, Value::positive);
    let aperture = table.maybe("aperture", Value::not_negative);
    focus(table);
    let focus_distance = table.or("focus_distance", 1.0, Value::positive);
    let shutter = table.or("shutter", 0.0, Value::not_negative);
    table.sound(&["matrix", "aperture", "focus_distance"])?;
    Ok(Camera {
        at: table.at(),
        view: View::Matrix(matrix),
        target: lookat.map(|lookat| Target { lookat, up }),
        projection,
        lens: thin_lens(table, aperture, focus_distance)?,
        window,
        distance,
        clip: table.maybe("clip", clip),
        medium: None,
        shutter,
        motion: table.maybe("motion", transform::motion),
    })
}

/// The words for projections, each with those of its keys that not all projections have.
pub(super) const PROJECTIONS: [(&str, &[&str]); 6] = [
    (
        "perspective",
        &[
            "fov",
            "aperture",
            "focus",
            "focus_distance",
            "window",
            "lens",
            "film",
            "aperture_shape",
            "millimetre",
            "stop",
            "lens_convention",
        ],
    ),
    ("orthographic", &["height", "aperture", "focus", "focus_distance", "window"]),
    ("equirectangular", &[]),
    ("equirectangular_pbrt", &[]),
    ("octahedral", &[]),
    ("irradiance", &["surface"]),
];

fn projection(table: &Table<'_>) -> Projection {
    let words = PROJECTIONS.map(|(word, keys)| (word, (word, keys)));
    let Some((word, keys)) = table.or("projection", Some(PROJECTIONS[0]), |value| {
        // With an unknown projection, no key can be checked.
        let choice = value.choice(&words);
        Ok(value.noting(choice.map(Some), None))
    }) else {
        return Projection::Octahedral;
    };
    let keys_of_some = ["fov", "height", "aperture", "focus", "focus_distance", "window", "lens", "surface"];
    for key in keys_of_some.into_iter().chain(OF_LENS) {
        let Some(value) = table.find(key).filter(|_| !keys.contains(&key)) else { continue };
        let error = value.error(format!("`{key}` has no meaning in projection = {word:?}"));
        table.assume(match word {
            "orthographic" => &["height"],
            "irradiance" => &["surface"],
            _ => &[],
        });
        value.note(error.hint(match (word, key) {
            (_, "surface") => "it is for projection = \"irradiance\"",
            ("irradiance", _) => "a measurement has no image plane: leave it out",
            ("perspective", _) => "give `fov` here, or the picture's `height` in [image]",
            (
                "orthographic",
                "lens" | "film" | "aperture_shape" | "millimetre" | "stop" | "lens_convention",
            ) => "a lens makes the projection \"perspective\"",
            ("orthographic", _) => "give `height`, the height of the picture in the world",
            _ => "a panoramic camera has no lens: leave it out",
        }));
    }
    if !table.has("lens")
        && !table.means(&["lens"])
        && let Some(value) = OF_LENS.iter().find_map(|key| table.find(key)).filter(|_| word == "perspective")
    {
        let message = format!("`{}` needs a `lens`", value.key());
        value.note(value.error(message).hint("add `lens = \"lens.dat\"`, the name of a lens file"));
    }
    match word {
        "perspective" => {
            let expected = "degrees between 0 and 180, exclusive";
            let fov = table.or("fov", 45.0, |value| {
                value.number_where(expected, |degrees| degrees > 0.0 && degrees < 180.0)
            });
            Projection::Perspective { fov }
        }
        "orthographic" => {
            Projection::Orthographic { height: table.need("height", "4", 4.0, Value::positive) }
        }
        "equirectangular" => Projection::Equirectangular,
        "equirectangular_pbrt" => Projection::EquirectangularPbrt,
        "irradiance" => {
            let surface = |value: Value<'_>| value.text("the name of shapes").map(str::to_owned);
            Projection::Irradiance { surface: table.need("surface", "\"floor\"", String::new(), surface) }
        }
        _ => Projection::Octahedral,
    }
}

/// A non-empty part of the image plane.
fn window(value: Value<'_>) -> Result<Window> {
    let table = value.table("`window`")?;
    table.allow(&[WINDOW]);
    let side = |key| {
        table.need(key, "[-1, 1]", [-1.0, 1.0], |value| {
            let [low, high] = value.numbers("two numbers, from the lower to the higher")?;
            let size = high - low;
            if size > 0.0 && size.is_finite() {
                return Ok([low, high]);
            }
            Err(value
                .error(format!("`{key}` of `window` goes from {low} to {high}: it is empty"))
                .hint("give the lower one first; x runs to the right, y up"))
        })
    };
    Ok(Window { x: side("x"), y: side("y") })
}

/// The focus distance.
enum Focus {
    /// A distance along the view axis.
    Distance(f64),
    /// The plane through a point.
    Point(DVec3),
}

fn focus(table: &Table<'_>) -> Option<Focus> {
    let value = table.one_of(&["focus_distance", "focus"])?;
    if !table.has("aperture") && !table.has("lens") && !table.means(&["aperture", "lens"]) {
        let message = format!("`{}` needs an `aperture`: without one the camera is a pinhole", value.key());
        value.note(value.error(message).hint("add `aperture = 0.05`, the radius of the lens"));
    }
    match value.key() {
        "focus_distance" => table.maybe("focus_distance", Value::positive).map(Focus::Distance),
        _ => table.maybe("focus", Value::vector).map(Focus::Point),
    }
}
