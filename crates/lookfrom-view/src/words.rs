//! A view in words: as tables of a scene file, and as a command line.

use std::fmt::Write;

use glam::DVec3;
use lookfrom::session::Session;
use lookfrom_scene::camera::{Camera, Look, Projection, View};

use crate::message::ViewRequest;

/// The camera and the settings of a view as TOML.
pub(crate) fn toml(session: &Session, request: &ViewRequest) -> String {
    let (image, settings) = (session.image(), session.settings());
    let mut text = String::from("[camera]\n");
    let middle = session.info().bounds.center();
    let look = session.camera().look(middle);
    if look.is_none() {
        // A matrix that mirrors or shears, as that of many scenes of pbrt.
        text.push_str(
            "# The scene's own picture is mirrored or sheared, which the keys of a camera cannot say.\n",
        );
    }
    if let Some(look) = look.or_else(|| nearest_look(session.camera(), middle)) {
        for (name, vector) in [("lookfrom", look.lookfrom), ("lookat", look.lookat), ("up", look.up)] {
            let _ = writeln!(text, "{name} = [{}]", joined(vector.to_array(), ", "));
        }
    }
    if let Some((name, value)) = projection(session.camera()) {
        let _ = writeln!(text, "{name} = {value}");
    }
    let _ = write!(text, "\n[image]\nwidth = {}\nheight = {}\n", image.width, image.height);
    let _ = write!(text, "exposure = {}\ntonemap = {:?}\n", request.exposure, tonemap(session, request));
    let _ = write!(
        text,
        "denoise = {}\n\n[render]\nintegrator = {:?}\nsamples = {}\ndepth = {}\nmin_contribution = {}\n",
        request.denoise,
        settings.integrator.word(),
        settings.samples,
        settings.depth,
        settings.min_contribution
    );
    text
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
