//! `[camera]`, `[image]` and `[render]`.

use glam::DVec3;

use super::value::{Table, Value};
use crate::camera::{Camera, Lens, Projection, View};
use crate::error::{ErrorKind, Result};
use crate::settings::{Crop, Filter, ImageSettings, Integrator, RenderSettings, Sampler, Tonemap};

/// The keys of `[camera]`.
pub(super) const CAMERA: &[&str] = &[
    "lookfrom",
    "lookat",
    "up",
    "projection",
    "fov",
    "height",
    "aperture",
    "focus_distance",
    "focus",
    "distance",
];
/// The keys of `[image]`.
pub(super) const IMAGE: &[&str] = &["width", "height", "exposure", "tonemap", "crop", "filter"];
/// The keys of `filter` as a table.
pub(super) const FILTER: &[&str] = &["type", "radius", "sigma", "b", "c"];
/// The keys of `[render]`.
pub(super) const RENDER: &[&str] =
    &["integrator", "samples", "depth", "min_contribution", "sampler", "seed", "transparent_shadows"];

/// The most pixels of a picture.
const MOST_PIXELS: u64 = 1 << 28;

/// The eye, if it can see.
pub(super) fn camera(table: &Table<'_>) -> Result<Camera> {
    table.allow(&[CAMERA])?;
    let eye = table.need("lookfrom", "[0, 1, 5]")?;
    let lookfrom = eye.vector()?;
    let target = table.need("lookat", "[0, 0, 0]")?;
    let lookat = target.vector()?;
    let up = table.or("up", DVec3::Y, Value::direction)?;

    // Neither the view axis nor the picture's horizontal may vanish.
    let w = (lookat - lookfrom).normalize_or_zero();
    if w == DVec3::ZERO || !w.is_finite() {
        return Err(target
            .error("`lookat` and `lookfrom` are the same point, or too near or too far apart for a direction")
            .hint("look at a point that lies in front of the eye"));
    }
    if up.normalize().cross(w).length_squared() < 1e-20 {
        let value = table.find("up").unwrap_or(target);
        return Err(value
            .error(format!("up {up} is parallel to the view from lookfrom to lookat"))
            .hint("give another `up`, such as [0, 0, 1] for a view straight down"));
    }

    Ok(Camera {
        at: table.at(),
        view: View::Look { lookfrom, lookat, up },
        projection: projection(table)?,
        lens: lens(table, w.dot(lookat - lookfrom), |focus| w.dot(focus - lookfrom))?,
        window: None,
        distance: table.or("distance", 1.0, Value::positive)?,
    })
}

fn projection(table: &Table<'_>) -> Result<Projection> {
    let words = [("perspective", false), ("orthographic", true)];
    let orthographic = table.or("projection", false, |value| value.choice(&words))?;
    match (table.find("fov"), table.find("height")) {
        (Some(value), _) if orthographic => Err(value
            .error("`fov` has no meaning for parallel rays")
            .hint("give `height`, the height of the picture in the world")),
        (_, Some(value)) if !orthographic => Err(value
            .error("`height` in [camera] needs projection = \"orthographic\"")
            .hint("give `fov` here, or the picture's `height` in [image]")),
        (_, None) if orthographic => {
            Ok(Projection::Orthographic { height: table.need("height", "4")?.positive()? })
        }
        (_, Some(value)) => Ok(Projection::Orthographic { height: value.positive()? }),
        (Some(value), None) => {
            let expected = "degrees between 0 and 180, neither of them included";
            let fov = value.number_where(expected, |degrees| degrees > 0.0 && degrees < 180.0)?;
            Ok(Projection::Perspective { fov })
        }
        (None, None) => Ok(Projection::Perspective { fov: 45.0 }),
    }
}

/// The lens; sharp at `lookat_distance` where no focus is given. `along` measures a point along the view axis.
fn lens(table: &Table<'_>, lookat_distance: f64, along: impl Fn(DVec3) -> f64) -> Result<Option<Lens>> {
    let focus = table.one_of(&["focus_distance", "focus"])?;
    let Some(aperture) = table.find("aperture") else {
        return match focus {
            Some(value) => Err(value
                .error(format!("`{}` needs an `aperture`: without one everything is sharp", value.key()))
                .hint("add `aperture = 0.05`, the radius of the lens")),
            None => Ok(None),
        };
    };
    let radius = aperture.not_negative()?;
    let focus_distance = match focus {
        None => lookat_distance,
        Some(value) if value.key() == "focus_distance" => value.positive()?,
        Some(value) => {
            let distance = along(value.vector()?);
            if distance <= 0.0 || !distance.is_finite() {
                return Err(value
                    .error("`focus` lies behind the eye")
                    .hint("give a point that the eye can see"));
            }
            distance
        }
    };
    Ok((radius > 0.0).then_some(Lens { radius, focus_distance }))
}

/// Size, filter and development of the picture.
pub(super) fn image(table: &Table<'_>) -> Result<ImageSettings> {
    table.allow(&[IMAGE])?;
    let default = ImageSettings::default();
    let side = |key, default: u32| table.or(key, default.into(), |value| value.integer(1, u32::MAX.into()));
    let (width, height) = (side("width", default.width)?, side("height", default.height)?);
    if width * height > MOST_PIXELS {
        let mut error =
            table.error(format!("{width}×{height} pixels are more than the limit of {MOST_PIXELS}"));
        error.kind = ErrorKind::Limit;
        return Err(error.hint("make the picture smaller"));
    }
    let (width, height) = (width as u32, height as u32);
    Ok(ImageSettings {
        width,
        height,
        crop: table.or("crop", None, |value| crop(value, width, height).map(Some))?,
        filter: table.or("filter", default.filter, filter)?,
        exposure: table.or("exposure", default.exposure, |value| {
            value.single_where("stops from -64 to 64", |stops| (-64.0..=64.0).contains(&stops))
        })?,
        tonemap: table.or("tonemap", default.tonemap, |value| {
            value.choice(&[
                ("clamp", Tonemap::Clamp),
                ("reinhard", Tonemap::Reinhard),
                ("filmic", Tonemap::Filmic),
            ])
        })?,
        ..default
    })
}

fn crop(value: Value<'_>, width: u32, height: u32) -> Result<Crop> {
    let expected = "four whole numbers, [x0, y0, x1, y1]";
    let mut edges = [0; 4];
    for (edge, item) in edges.iter_mut().zip(value.list_of::<4>(expected)?) {
        *edge = item.integer(0, u32::MAX.into())? as u32;
    }
    let [x0, y0, x1, y1] = edges;
    if x0 < x1 && x1 <= width && y0 < y1 && y1 <= height {
        return Ok(Crop { x0, y0, x1, y1 });
    }
    Err(value
        .error(format!(
            "the crop from ({x0}, {y0}) to ({x1}, {y1}) is no part of a picture of {width}×{height}"
        ))
        .hint("x0 < x1 and y0 < y1 count pixels from the top left"))
}

fn filter(value: Value<'_>) -> Result<Filter> {
    let kinds = [
        ("box", Filter::Box { radius: 0.5 }),
        ("triangle", Filter::Triangle { radius: 1.0 }),
        ("gaussian", Filter::Gaussian { radius: 1.5, sigma: 0.5 }),
        ("mitchell", Filter::Mitchell { radius: 2.0, b: 1.0 / 3.0, c: 1.0 / 3.0 }),
        ("blackman_harris", Filter::BlackmanHarris { radius: 1.5 }),
    ];
    if !value.is_table() {
        return value.choice(&kinds);
    }
    let table = value.table("`filter`")?;
    table.allow(&[FILTER])?;
    let width =
        |value: Value<'_>| value.single_where("pixels, more than 0 and at most 16", |r| r > 0.0 && r <= 16.0);
    let mut chosen = table.need("type", "\"gaussian\"")?.choice(&kinds)?;
    match &mut chosen {
        Filter::Box { radius } | Filter::Triangle { radius } | Filter::BlackmanHarris { radius } => {
            table.allow(&[&["type", "radius"]])?;
            *radius = table.or("radius", *radius, width)?;
        }
        Filter::Gaussian { radius, sigma } => {
            table.allow(&[&["type", "radius", "sigma"]])?;
            *radius = table.or("radius", *radius, width)?;
            *sigma = table.or("sigma", *sigma, width)?;
        }
        Filter::Mitchell { radius, b, c } => {
            table.allow(&[&["type", "radius", "b", "c"]])?;
            *radius = table.or("radius", *radius, width)?;
            let share =
                |value: Value<'_>| value.single_where("a number from 0 to 1", |s| (0.0..=1.0).contains(&s));
            *b = table.or("b", *b, share)?;
            *c = table.or("c", *c, share)?;
        }
    }
    Ok(chosen)
}

/// How light is computed.
pub(super) fn render(table: &Table<'_>) -> Result<RenderSettings> {
    table.allow(&[RENDER])?;
    let default = RenderSettings::default();
    Ok(RenderSettings {
        integrator: table.or("integrator", default.integrator, |value| {
            value.choice(&[
                ("raycast", Integrator::Raycast),
                ("whitted", Integrator::Whitted),
                ("normals", Integrator::Normals),
                ("depth", Integrator::Depth),
                ("uv", Integrator::Uv),
                ("id", Integrator::Id),
            ])
        })?,
        samples: table.or("samples", default.samples.into(), |value| value.integer(1, 1 << 24))? as u32,
        depth: table.or("depth", default.depth.into(), |value| value.integer(0, 256))? as u32,
        min_contribution: table.or("min_contribution", default.min_contribution, |value| {
            value.single_where("a number from 0 to 1", |share| (0.0..=1.0).contains(&share))
        })?,
        sampler: table.or("sampler", default.sampler, |value| {
            value.choice(&[("sobol", Sampler::Sobol), ("independent", Sampler::Independent)])
        })?,
        seed: table.or("seed", default.seed, |value| value.integer(0, u64::MAX))?,
        transparent_shadows: table.or("transparent_shadows", default.transparent_shadows, Value::boolean)?,
        ..default
    })
}
