//! A view in words: as tables of a scene file, and as a command line.

use std::fmt::Write;
use std::path::Path;

use lookfrom::session::Session;
use lookfrom_scene::camera::{Camera, Projection};
use lookfrom_scene::settings::{ImageSettings, PixelBounds};
use lookfrom_scene::toml::write::{Sources, write_view};
use lookfrom_scene::{Budget, Disk, Result, Scene};

use crate::document::Loaded;
use crate::message::ViewRequest;
use crate::source;

/// A view as a scene file: the text of the scene with the camera and the settings of the view, or a file to be saved beside the scene's, which it
/// imports. A scene of pbrt cannot be imported; of that these are all tables but its contents. What no table says is in comments. `source` is
/// the text of a scene in our own format.
///
/// # Errors
/// As those of [`write_view`].
pub(crate) fn toml(
    session: &Session,
    own: &Loaded,
    request: &ViewRequest,
    source: Option<&str>,
    is_whole: bool,
) -> Result<String> {
    let file = Path::new(session.name()).file_name().unwrap_or_default().to_string_lossy();
    let contents = source.filter(|_| is_whole);
    let contents = contents.and_then(|text| source::without(text, &["camera", "image", "render"]));
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
    let typed = &own.options.import;
    let with = |number: Option<f64>, unit| number.map(|number| format!("{number}{unit}"));
    let animation = request.animation.map(|number| number.to_string());
    for (what, value) in [
        ("animation", animation.or_else(|| typed.animation.clone())),
        ("variant", request.variant.clone().or_else(|| typed.variant.clone())),
        ("time", with(request.at.or(typed.at), " s")),
        ("turntable", with(request.turn.or(own.options.turn), "°")),
        (
            "turn of the surroundings",
            with(request.rotate_environment.or(own.options.rotate_environment), "°"),
        ),
    ] {
        if let Some(value) = value {
            let _ = writeln!(text, "# No table says the {what}: {}.", one_line(&value));
        }
    }
    if source.is_none() && own.session.info().added.contains(&"lights") {
        text.push_str("# The lights of the studio are to be added: `lookfrom convert` writes them.\n");
    }
    let camera = session.camera();
    if camera.medium.is_some() {
        text.push_str("# `medium` of the scene's own camera is to be added.\n");
    }
    let (image, layers) = (session.image(), own.session.image());
    let view = Scene {
        camera: Some(Camera { medium: None, ..camera.clone() }),
        image: ImageSettings {
            exposure: request.exposure,
            tonemap: request.tonemap(image.tonemap)?,
            denoise: request.denoise,
            layers: layers.layers,
            spectral_film: layers.spectral_film.clone(),
            ..image.clone()
        },
        render: session.settings().clone(),
        ..Scene::default()
    };
    let sources = Sources { files: &Disk, paths: Vec::new(), budget: Budget::default() };
    let written = write_view(&view, "", &sources)?;
    for line in written.text.lines() {
        // A file beside the scene's, under the name that the scene has for it.
        let key = ["lens", "aperture_shape"].into_iter().find(|key| {
            let names_file = line.strip_prefix(key).is_some_and(|rest| rest.starts_with(" = \"/"));
            names_file && !written.files.is_empty()
        });
        let _ = match key {
            None => writeln!(text, "{line}"),
            Some(key) => match source.and_then(|text| source::line_of(text, "camera", key)) {
                Some(line) => writeln!(text, "{line}"),
                None => writeln!(text, "# `{key}` of the scene's own camera is to be added."),
            },
        };
    }
    let of_contents = ["add_light", "vertex_normals"];
    for line in
        source.into_iter().flat_map(|text| of_contents.map(|key| source::line_of(text, "render", key)))
    {
        line.into_iter().for_each(|line| text.extend([&line, "\n"]));
    }
    Ok(text)
}

fn has_format_of_pbrt(file: &str) -> bool {
    let name = file.to_ascii_lowercase();
    name.ends_with(".pbrt") || name.ends_with(".pbrt.gz")
}

/// A name within a comment.
fn one_line(name: &str) -> String {
    name.replace(char::is_control, " ")
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
            if let Projection::Perspective { fov: degrees } = session.camera().projection {
                options.push(("fov", degrees.to_string()));
            }
        }
    }
    let crop = image.crop.map(|PixelBounds { x0, y0, x1, y1 }| format!("{x0},{y0},{x1},{y1}"));
    let optional = [
        ("crop", crop),
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
