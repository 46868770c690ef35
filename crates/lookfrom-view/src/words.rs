//! A view in words: as tables of a scene file, and as a command line.

use std::fmt::Write;
use std::path::Path;

use glam::DVec3;
use lookfrom::session::Session;
use lookfrom_scene::camera::{Camera, Look, Projection, View};
use lookfrom_scene::lens::{ApertureShape, LensSystem};
use lookfrom_scene::settings::{Filter, RenderSettings};

use crate::message::ViewRequest;
use crate::source;

/// A view as a scene file: the text of the scene with the camera and the settings of the view, or without that text a file to be saved beside the
/// scene's, which it imports. A scene of pbrt cannot be imported; of that these are all tables but its contents.
pub(crate) fn toml(session: &Session, request: &ViewRequest, source: Option<&str>) -> String {
    let (image, settings, camera) = (session.image(), session.settings(), session.camera());
    let file = Path::new(session.name()).file_name().unwrap_or_default().to_string_lossy();
    let contents = source.and_then(|text| source::without(text, &["camera", "image", "render"]));
    let mut text = match contents {
        Some(contents) => format!("{}\n\n", contents.trim_end()),
        None if has_format_of_pbrt(&file) => format!(
            "# The contents of {} are to be added: pbrt's scenes cannot be imported.\n\n",
            one_line(&file)
        ),
        // Strings of JSON are strings of TOML.
        None => format!(
            "# A view of {}, to be saved in its folder.\nimport = {}\n\n",
            one_line(&file),
            serde_json::Value::from(file.as_ref())
        ),
    };
    let line = |text: &mut String, key: &str, value: &str| {
        let _ = writeln!(text, "{key} = {value}");
    };
    let middle = session.info().bounds.center();
    let look = camera.look(middle);
    if look.is_none() {
        // A matrix that mirrors or shears, as that of many scenes of pbrt.
        text.push_str(
            "# The scene's own picture is mirrored or sheared, which the keys of a camera cannot say.\n",
        );
    }
    if let Some(look) = look.or_else(|| nearest_look(camera, middle)) {
        text.push_str("[camera]\n");
        for (key, vector) in [("lookfrom", look.lookfrom), ("lookat", look.lookat), ("up", look.up)] {
            line(&mut text, key, &list(&vector.to_array()));
        }
        for (key, value) in lens_and_window(camera) {
            line(&mut text, key, &value);
        }
        if camera.medium.is_some() {
            text.push_str("# `medium` of the scene's own camera is to be added.\n");
        }
    }
    let _ = write!(text, "\n[image]\nwidth = {}\nheight = {}\n", image.width, image.height);
    line(&mut text, "exposure", &number(request.exposure.into()));
    line(&mut text, "tonemap", &format!("{:?}", tonemap(session, request)));
    line(&mut text, "filter", &filter(image.filter));
    line(&mut text, "denoise", &request.denoise.to_string());
    text.push_str("\n[render]\n");
    for (key, value) in rendering(settings) {
        line(&mut text, key, &value);
    }
    text
}

/// Keys of `[camera]` besides position and orientation.
fn lens_and_window(camera: &Camera) -> Vec<(&'static str, String)> {
    let mut keys = match &camera.projection {
        Projection::Perspective { fov } => vec![("fov", number(*fov))],
        Projection::Orthographic { height } => {
            vec![("projection", "\"orthographic\"".to_owned()), ("height", number(*height))]
        }
        Projection::Equirectangular | Projection::EquirectangularPbrt => {
            vec![("projection", "\"equirectangular\"".to_owned())]
        }
        Projection::Octahedral => vec![("projection", "\"octahedral\"".to_owned())],
        Projection::LensSystem(system) => lens_system(system),
        Projection::Irradiance { surface } => {
            vec![("projection", "\"irradiance\"".to_owned()), ("surface", format!("{surface:?}"))]
        }
    };
    if matches!(camera.projection, Projection::Perspective { .. } | Projection::Orthographic { .. }) {
        if let Some(lens) = &camera.lens {
            keys.push(("aperture", number(lens.radius)));
            keys.push(("focus_distance", number(lens.focus_distance)));
        }
        if let Some(window) = &camera.window {
            keys.push(("window", format!("{{ x = {}, y = {} }}", list(&window.x), list(&window.y))));
        }
    }
    keys.push(("distance", number(camera.distance)));
    keys.extend(camera.clip.map(|planes| ("clip", list(&planes))));
    keys
}

/// The keys of a lens system.
fn lens_system(system: &LensSystem) -> Vec<(&'static str, String)> {
    let mut keys = vec![("lens", format!("{:?}", system.name)), ("film", number(system.film_diagonal))];
    if let Some(diameter) = system.stop_diameter {
        keys.push(("aperture", number(0.5 * diameter * system.millimetre)));
    }
    if system.shape != ApertureShape::Circle {
        keys.push(("aperture_shape", format!("{:?}", system.shape.name())));
    }
    if system.millimetre != 1e-3 {
        keys.push(("millimetre", number(system.millimetre)));
    }
    keys.push(("focus_distance", number(system.focus_distance)));
    keys
}

fn filter(Filter { shape, radius: [x, y] }: Filter) -> String {
    let radius = if x == y { x.to_string() } else { format!("[{x}, {y}]") };
    let parameters = shape.parameters().into_iter().map(|(key, value)| format!(", {key} = {value}"));
    format!("{{ type = {:?}, radius = {radius}{} }}", shape.word(), parameters.collect::<String>())
}

/// Keys of `[render]`; those that only few scenes have, where they are not the default.
fn rendering(settings: &RenderSettings) -> Vec<(&'static str, String)> {
    let default = RenderSettings::default();
    let word = |word: &str| format!("{word:?}");
    let mut keys = vec![
        ("integrator", word(settings.integrator.word())),
        ("samples", settings.samples.to_string()),
        ("depth", settings.depth.to_string()),
        ("min_contribution", settings.min_contribution.to_string()),
    ];
    let rare = [
        ("sampler", settings.sampler != default.sampler, word(settings.sampler.word())),
        ("seed", settings.seed != default.seed, settings.seed.to_string()),
        ("color", settings.color != default.color, word(settings.color.word())),
        (
            "light_sampler",
            settings.light_sampler != default.light_sampler,
            word(settings.light_sampler.word()),
        ),
        ("portals", settings.portals != default.portals, word(settings.portals.word())),
        ("regularize", settings.regularize, "true".to_owned()),
        ("transparent_shadows", !settings.transparent_shadows, "false".to_owned()),
        ("thin_passages_count", !settings.thin_passages_count, "false".to_owned()),
        ("endless_media", settings.endless_media, "true".to_owned()),
        ("open_fronts", settings.open_fronts, "true".to_owned()),
        ("hide_lights", settings.hide_lights, "true".to_owned()),
        (
            "occlusion_distance",
            settings.occlusion_distance.is_finite(),
            number(settings.occlusion_distance.into()),
        ),
    ];
    keys.extend(rare.into_iter().filter(|(_, differs, _)| *differs).map(|(key, _, value)| (key, value)));
    keys
}

fn has_format_of_pbrt(file: &str) -> bool {
    let name = file.to_ascii_lowercase();
    name.ends_with(".pbrt") || name.ends_with(".pbrt.gz")
}

/// A name within a comment.
fn one_line(name: &str) -> String {
    name.replace(char::is_control, " ")
}

/// A number of TOML: without a point or an exponent it would be an integer of 64 bits.
fn number(number: f64) -> String {
    // A negative zero is told as 0.
    let number = number + 0.0;
    if number.abs() < 1e15 { number.to_string() } else { format!("{number:?}") }
}

fn list(numbers: &[f64]) -> String {
    format!("[{}]", numbers.iter().map(|&x| number(x)).collect::<Vec<_>>().join(", "))
}

/// The command that renders the view of a scene; `typed` are the options that its session was opened with.
pub(crate) fn command(session: &Session, request: &ViewRequest, typed: &[String]) -> String {
    let (image, settings) = (session.image(), session.settings());
    let mut options = vec![
        ("width", image.width.to_string()),
        ("height", image.height.to_string()),
        ("samples", settings.samples.to_string()),
        ("integrator", settings.integrator.word().to_owned()),
        ("depth", settings.depth.to_string()),
        ("min-contribution", settings.min_contribution.to_string()),
        ("exposure", request.exposure.to_string()),
        ("tonemap", tonemap(session, request).to_owned()),
        ("denoise", if request.denoise { "on" } else { "off" }.to_owned()),
    ];
    // A camera on a turntable is where the turntable says.
    match (request.turn, &request.camera) {
        (Some(degrees), None) => options.push(("turn", degrees.to_string())),
        (_, None) => {}
        (_, Some(camera)) => {
            for (name, vector) in
                [("lookfrom", camera.lookfrom), ("lookat", camera.lookat), ("up", camera.up)]
            {
                options.push((name, joined(vector, ",")));
            }
            if let Some(("fov", degrees)) = projection(session.camera()) {
                options.push(("fov", degrees.to_string()));
            }
        }
    }
    let optional = [
        ("rotate-environment", request.rotate_environment.map(|degrees| degrees.to_string())),
        ("animation", request.animation.map(|number| number.to_string())),
        ("at", request.at.map(|seconds| seconds.to_string())),
        ("variant", request.variant.clone()),
    ];
    options.extend(optional.into_iter().filter_map(|(name, value)| Some((name, value?))));
    let is_replaced = |typed: &str| {
        let name = typed.trim_start_matches("--").split('=').next().unwrap_or_default();
        name == "size" || options.iter().any(|(option, _)| *option == name)
    };
    let kept = typed.iter().filter(|typed| !is_replaced(typed)).cloned();
    let words = kept.chain(options.iter().map(|(name, value)| format!("--{name}={value}")));
    let mut text = format!("lookfrom render {}", quoted(session.name()));
    words.for_each(|word| {
        let _ = write!(text, " {}", quoted(&word));
    });
    text
}

fn tonemap(session: &Session, request: &ViewRequest) -> &'static str {
    let own = session.image().tonemap;
    request.tonemap(own).unwrap_or(own).word()
}

/// Position and direction of a camera that is given by a matrix, without what else the matrix does.
fn nearest_look(camera: &Camera, middle: DVec3) -> Option<Look> {
    let View::Matrix(matrix) = camera.view else { return None };
    let lookfrom = matrix.w_axis.truncate();
    let forward = matrix.z_axis.truncate().try_normalize()?;
    let distance = (middle - lookfrom).dot(forward);
    let distance = if distance > 0.0 { distance } else { 1.0 };
    Some(Look {
        lookfrom,
        lookat: lookfrom + forward * distance,
        up: matrix.y_axis.truncate().try_normalize()?,
    })
}

/// The number of a projection, with its key.
fn projection(camera: &Camera) -> Option<(&'static str, f64)> {
    match camera.projection {
        Projection::Perspective { fov } => Some(("fov", fov)),
        Projection::Orthographic { height } => Some(("height", height)),
        _ => None,
    }
}

fn joined(numbers: [f64; 3], between: &str) -> String {
    // A negative zero is told as 0.
    numbers.map(|number| (number + 0.0).to_string()).join(between)
}

/// A word for a POSIX shell.
fn quoted(word: &str) -> String {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "-_./=,:+@%".contains(c);
    match !word.is_empty() && word.chars().all(is_plain) {
        true => word.to_owned(),
        false => format!("'{}'", word.replace('\'', r"'\''")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_survive_a_shell() {
        assert_eq!(quoted("--lookfrom=-1,2,3"), "--lookfrom=-1,2,3");
        assert_eq!(quoted("my scene.toml"), "'my scene.toml'");
        assert_eq!(quoted("it's; rm"), r"'it'\''s; rm'");
    }
}
