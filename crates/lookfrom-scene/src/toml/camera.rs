//! `[camera]`: where the eye stands and how it flattens space.

use glam::DVec3;

use super::table::Table;
use super::value::Value;
use crate::camera::{Camera, Lens, Projection, View, Window};
use crate::error::Result;

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
    "window",
    "distance",
];
/// The keys of `window`.
pub(super) const WINDOW: &[&str] = &["x", "y"];

/// The eye, if it can see.
pub(super) fn camera(table: &Table<'_>) -> Result<Camera> {
    table.allow(&[KEYS])?;
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

    let projection = projection(table)?;
    Ok(Camera {
        at: table.at(),
        view: View::Look { lookfrom, lookat, up },
        target: None,
        projection,
        lens: lens(table, w.dot(lookat - lookfrom), |focus| w.dot(focus - lookfrom))?,
        window: table.or("window", None, |value| window(value).map(Some))?,
        distance: table.or("distance", 1.0, Value::positive)?,
        medium: None,
    })
}

fn projection(table: &Table<'_>) -> Result<Projection> {
    // Each with the keys that mean something in it, of those that do not mean something in all.
    let kinds: [(&str, &[&str]); 4] = [
        ("perspective", &["fov", "aperture", "focus", "focus_distance", "window"]),
        ("orthographic", &["height", "aperture", "focus", "focus_distance", "window"]),
        ("equirectangular", &[]),
        ("octahedral", &[]),
    ];
    let (word, keys) = table
        .or("projection", kinds[0], |value| value.choice(&kinds.map(|(word, keys)| (word, (word, keys)))))?;
    for key in ["fov", "height", "aperture", "focus", "focus_distance", "window"] {
        let Some(value) = table.find(key).filter(|_| !keys.contains(&key)) else { continue };
        let error = value.error(format!("`{key}` has no meaning in projection = {word:?}"));
        return Err(error.hint(match (word, key) {
            ("perspective", _) => "give `fov` here, or the picture's `height` in [image]",
            ("orthographic", _) => "give `height`, the height of the picture in the world",
            _ => "it sees all around, and everything sharp: leave it out",
        }));
    }
    Ok(match word {
        "perspective" => {
            let expected = "degrees between 0 and 180, neither of them included";
            let fov = table.or("fov", 45.0, |value| {
                value.number_where(expected, |degrees| degrees > 0.0 && degrees < 180.0)
            })?;
            Projection::Perspective { fov }
        }
        "orthographic" => Projection::Orthographic { height: table.need("height", "4")?.positive()? },
        "equirectangular" => Projection::Equirectangular,
        _ => Projection::Octahedral,
    })
}

/// A part of the image plane that is not empty.
fn window(value: Value<'_>) -> Result<Window> {
    let table = value.table("`window`")?;
    table.allow(&[WINDOW])?;
    let side = |key| {
        let value = table.need(key, "[-1, 1]")?;
        let [low, high] = value.numbers("two numbers, from the lower to the higher")?;
        let size = high - low;
        if size > 0.0 && size.is_finite() {
            return Ok([low, high]);
        }
        Err(value
            .error(format!("`{key}` of `window` goes from {low} to {high}: nothing is between"))
            .hint("give the lower one first; x runs to the right, y up"))
    };
    Ok(Window { x: side("x")?, y: side("y")? })
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
