//! Detection of pbrt-v3 scenes, with hints for conversion.
//!
//! Version 4 renamed most of the language. One clear error at the first word that exists only in version 3 is worth more
//! than one for every line after it.

use super::text::Place;
use crate::error::{Error, Result};

/// The error that a scene is written for version 3.
fn old(place: &Place, found: &str, now: &str) -> Error {
    place.invalid(format!("this scene is written for pbrt-v3: {found}; pbrt-v4 {now}")).hint(
        "convert the whole scene with pbrt-v4's own program: pbrt --upgrade old.pbrt > new.pbrt \
         (and again for each file that it includes)",
    )
}

/// Words that exist only in version 3: the directive, the word, and version 4's equivalent.
const WORDS: &[(&str, &str, &str)] = &[
    ("Material", "matte", "calls it \"diffuse\""),
    ("Material", "plastic", "calls it \"coateddiffuse\""),
    ("Material", "metal", "calls it \"conductor\""),
    ("Material", "glass", "calls it \"dielectric\""),
    ("Material", "mirror", "uses \"conductor\" instead"),
    ("Material", "substrate", "calls it \"coateddiffuse\""),
    ("Material", "translucent", "calls it \"diffusetransmission\""),
    ("Material", "uber", "uses \"coateddiffuse\" instead"),
    ("Material", "disney", "does not have it"),
    ("Material", "fourier", "uses \"measured\" instead"),
    ("Material", "kdsubsurface", "calls it \"subsurface\""),
    ("Film", "image", "calls it \"rgb\""),
    ("Camera", "environment", "calls it \"spherical\""),
    ("Sampler", "lowdiscrepancy", "uses \"zsobol\" instead"),
    ("Sampler", "02sequence", "uses \"pmj02bn\" instead"),
    ("Sampler", "maxmindist", "uses \"zsobol\" instead"),
    ("Sampler", "random", "calls it \"independent\""),
    ("Sampler", "bestcandidate", "uses \"zsobol\" instead"),
    ("Sampler", "adaptive", "uses \"zsobol\" instead"),
    ("Integrator", "directlighting", "uses \"path\" instead"),
    ("Integrator", "whitted", "uses \"path\" instead"),
    ("Accelerator", "grid", "does not have it"),
    ("Shape", "cone", "does not have it"),
    ("Shape", "paraboloid", "does not have it"),
    ("Shape", "hyperboloid", "does not have it"),
    ("Shape", "heightfield", "does not have it"),
    ("Shape", "heightfield2", "does not have it"),
    ("Shape", "nurbs", "does not have it"),
    ("Texture", "uv", "does not have it"),
    ("AreaLightSource", "area", "calls it \"diffuse\""),
];

/// Checks for parameter types that exist only in version 3.
pub(super) fn check_kind(word: &str, name: &str, place: &Place) -> Result<()> {
    let now = match word {
        "point" if name == "uv" || name == "st" => "point2",
        "point" => "point3",
        "vector" => "vector3",
        "color" if name.is_empty() => "spectrum",
        "color" => "rgb",
        "xyz" => {
            return Err(old(
                place,
                &format!("\"{word} {name}\" is a colour in XYZ"),
                "has \"rgb\" or \"spectrum\"",
            ));
        }
        _ => return Ok(()),
    };
    let shown = if name.is_empty() { word.to_owned() } else { format!("{word} {name}") };
    Err(old(place, &format!("{shown:?} has a type of version 3"), &format!("calls the type {now:?}")))
}

/// Checks for materials, lights … that exist only in version 3.
pub(super) fn check_word(directive: &str, word: &str, place: &Place) -> Result<()> {
    match WORDS.iter().find(|entry| entry.0 == directive && entry.1 == word) {
        Some(&(_, _, now)) => Err(old(place, &format!("{directive} {word:?}"), now)),
        None => Ok(()),
    }
}

/// Checks for directives that exist only in version 3 or earlier.
pub(super) fn check_directive(word: &[u8], place: &Place) -> Result<()> {
    let now = match word {
        b"WorldEnd" => "has none: the end of the file ends the world",
        b"SurfaceIntegrator" => "calls it Integrator",
        b"VolumeIntegrator" | b"Volume" | b"Renderer" => "uses an Integrator instead",
        _ => return Ok(()),
    };
    Err(old(place, &format!("the directive `{}`", String::from_utf8_lossy(word)), now))
}

/// Checks for parameters that version 4 has renamed, which would otherwise be ignored.
pub(super) fn check_parameter(directive: &str, kind: &str, name: &str, place: &Place) -> Result<()> {
    let now = match (directive, kind, name) {
        ("LightSource", _, "mapname") => "calls it \"filename\"",
        ("Texture", "texture", "Kd") | ("Material", _, "Kd") => "calls it \"reflectance\"",
        ("Material", _, "Ks" | "Kr" | "Kt") => "has none",
        ("Material", _, "bumpmap") => "calls it \"displacement\"",
        ("Material", "float", "sigma") => "has none",
        ("Texture", "bool", "trilinear") => "uses \"string filter\"",
        ("Texture", "float", "gamma") | ("Texture", "bool", "gamma") => "uses \"string encoding\"",
        _ => return Ok(()),
    };
    Err(old(place, &format!("{directive} has \"{kind} {name}\""), now))
}
