//! Scenes of pbrt-v3, which version 4 does not read: it renamed most of the language.
//!
//! The first word that only one of the two versions has decides. Words of version 3 that version 4 has by other names are
//! [translated](translation) as they are read; materials and shapes that it lacks have files of their own. Facts are those of pbrt-v3's
//! sources, and of `pbrt --upgrade`.

mod material;
mod shape;
mod translation;

use super::Reader;
use super::params::Parameter;
use super::text::Place;
use crate::error::{Error, Result};
use crate::settings::ColorMode;

/// The version of pbrt that a scene is written for, as far as its words have told.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Version {
    #[default]
    Unknown,
    Three,
    Four,
}

/// The error that words of version 3 are among those of version 4.
fn mixed(place: &Place, found: &str, now: &str) -> Error {
    place.invalid(format!("a word of pbrt-v3 in a scene of pbrt-v4: {found}; pbrt-v4 {now}")).hint(
        "write what version 4 calls it, or convert files of version 3 with pbrt's own program: \
         pbrt --upgrade old.pbrt > new.pbrt",
    )
}

/// Words that exist only in version 3: the directive, the word, and version 4's equivalent.
const OLD: &[(&str, &str, &str)] = &[
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
    ("LightSource", "exinfinite", "calls it \"infinite\""),
    ("Shape", "cone", "does not have it"),
    ("Shape", "paraboloid", "does not have it"),
    ("Shape", "hyperboloid", "does not have it"),
    ("Shape", "heightfield", "does not have it"),
    ("Shape", "nurbs", "does not have it"),
    ("Texture", "uv", "does not have it"),
    ("AreaLightSource", "area", "calls it \"diffuse\""),
];

/// Words that exist only in version 4.
const NEW: &[(&str, &[&str])] = &[
    ("Camera", &["spherical"]),
    ("Film", &["rgb", "gbuffer", "spectral"]),
    ("Integrator", &["function", "lightpath", "randomwalk", "simplepath", "simplevolpath"]),
    (
        "Material",
        &[
            "coatedconductor",
            "coateddiffuse",
            "conductor",
            "dielectric",
            "diffuse",
            "diffusetransmission",
            "interface",
            "measured",
            "thindielectric",
        ],
    ),
    ("Sampler", &["independent", "paddedsobol", "pmj02bn", "zsobol"]),
    ("Shape", &["bilinearmesh"]),
    ("Texture", &["directionmix"]),
];

/// A type of parameters that only version 3 has, and the name that version 4 has for it.
pub(super) fn new_kind(word: &str, name: &str) -> Option<(&'static str, &'static str)> {
    Some(match word {
        "point" if name == "uv" || name == "st" => ("point", "point2"),
        "point" => ("point", "point3"),
        "vector" => ("vector", "vector3"),
        "color" => ("color", "rgb"),
        "xyz" => ("xyz", "rgb"),
        _ => return None,
    })
}

impl Reader<'_, '_> {
    /// Whether the scene is written for version 3.
    pub(super) fn is_old(&self) -> bool {
        self.version == Version::Three
    }

    /// Notes a word that only version 3 has.
    ///
    /// # Errors
    /// `Invalid` in a scene of version 4.
    pub(super) fn note_old(&mut self, place: &Place, found: &str, now: &str) -> Result<()> {
        match self.version {
            Version::Four => return Err(mixed(place, found, now)),
            Version::Three => {}
            Version::Unknown => {
                self.version = Version::Three;
                self.scene.render.color = ColorMode::Rgb;
                let message = format!(
                    "this scene is written for pbrt-v3 ({found}): it is read with what is nearest in version 4, in RGB as there"
                );
                self.context.notice(&place.location(), message);
            }
        }
        Ok(())
    }

    /// Notes a material, a light … that only one of the versions has.
    ///
    /// # Errors
    /// As [`Self::note_old`].
    pub(super) fn note_word(&mut self, directive: &str, word: &str, place: &Place) -> Result<()> {
        if let Some(&(_, _, now)) = OLD.iter().find(|entry| entry.0 == directive && entry.1 == word) {
            return self.note_old(place, &format!("{directive} {word:?}"), now);
        }
        let is_new = NEW.iter().any(|(of, words)| *of == directive && words.contains(&word));
        if is_new && self.version == Version::Unknown {
            self.version = Version::Four;
        }
        Ok(())
    }

    /// Notes the type `color` of a texture.
    ///
    /// # Errors
    /// As [`Self::note_old`].
    pub(super) fn note_texture_kind(&mut self, word: &str, place: &Place) -> Result<()> {
        match word {
            "color" => {
                self.note_old(place, "\"color\" has a type of version 3", "calls the type \"spectrum\"")
            }
            _ => Ok(()),
        }
    }

    /// Notes directives that only one of the versions has; returns whether it is one that has no effect.
    ///
    /// # Errors
    /// As [`Self::note_old`]; `Invalid` for directives of version 2.
    pub(super) fn note_directive(&mut self, word: &[u8], place: &Place) -> Result<bool> {
        let now = match word {
            b"WorldEnd" => "has none: the end of the file ends the world",
            b"SurfaceIntegrator" => "calls it Integrator",
            b"VolumeIntegrator" | b"Volume" | b"Renderer" => "uses an Integrator instead",
            _ => return Ok(false),
        };
        let found = format!("the directive `{}`", String::from_utf8_lossy(word));
        if word == b"WorldEnd" {
            return self.note_old(place, &found, now).map(|()| true);
        }
        let error = place.invalid(format!("this scene is written for pbrt-v2: {found}; pbrt-v4 {now}"));
        Err(error.hint("scenes of pbrt-v3 and pbrt-v4 are read"))
    }

    /// Notes parameters whose types or names only version 3 has.
    ///
    /// # Errors
    /// As [`Self::note_old`].
    pub(super) fn note_parameter(&mut self, directive: &str, parameter: &Parameter) -> Result<()> {
        let (kind, name, place) = (parameter.kind.word(), &*parameter.name, &parameter.place);
        if let Some(old) = parameter.old_kind {
            let now = match old {
                "xyz" => "has \"rgb\" or \"spectrum\"".to_owned(),
                _ => format!("calls the type {kind:?}"),
            };
            return self.note_old(place, &format!("\"{old} {name}\" has a type of version 3"), &now);
        }
        let now = match (directive, kind, name) {
            ("LightSource", _, "mapname") => "calls it \"filename\"",
            ("Texture", "texture", "Kd") | ("Material", _, "Kd") => "calls it \"reflectance\"",
            ("Material", _, "Ks" | "Kr" | "Kt") => "has none",
            ("Material" | "MakeNamedMaterial", _, "bumpmap") => "calls it \"displacement\"",
            ("Material" | "MakeNamedMaterial", _, "namedmaterial1") => "calls it \"materials\"",
            ("Material", "float", "sigma") => "has none",
            ("Texture", "bool", "trilinear") => "uses \"string filter\"",
            ("Texture", "float" | "bool", "gamma") => "uses \"string encoding\"",
            _ => return Ok(()),
        };
        self.note_old(place, &format!("{directive} has \"{kind} {name}\""), now)
    }

    /// Warns once of a part of version 3 that is left out.
    fn leave_out(&mut self, place: &Place, what: &str) {
        if self.warned.insert(format!("pbrt-v3 {what}")) {
            self.context.warn(&place.location(), what);
        }
    }
}
