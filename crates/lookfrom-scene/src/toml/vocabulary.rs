//! The list of all tables and keys of the format, for documentation, editors and tests.

use super::table::Kinds;
use super::{
    camera, color, keyframes, light, material, medium, physical, principled, settings, shape, spectrum,
    texture, transform, volume,
};

/// The top-level keys of a file, except the kinds of shapes.
pub(super) const TOP: &[&str] = &[
    "import",
    "variables",
    "camera",
    "image",
    "render",
    "materials",
    "media",
    "textures",
    "objects",
    "instance",
    "light",
];

/// The tables that occur at most once, and their keys. A key of several is meant to be in the first: `height` is seldom that of a camera.
pub(super) const SETTINGS: Kinds =
    &[("[image]", settings::IMAGE), ("[camera]", camera::KEYS), ("[render]", settings::RENDER)];

/// Every table of the format, with the keys that it may have: for documentation, editors and tests.
pub fn vocabulary() -> Vec<(String, Vec<&'static str>)> {
    let mut tables = vec![
        ("a scene".to_owned(), [TOP, &shape::kinds()].concat()),
        ("[camera]".to_owned(), camera::KEYS.to_vec()),
        ("window".to_owned(), camera::WINDOW.to_vec()),
        ("[image]".to_owned(), settings::IMAGE.to_vec()),
        ("filter".to_owned(), settings::FILTER.to_vec()),
        ("[render]".to_owned(), settings::RENDER.to_vec()),
        ("a colour by wavelength".to_owned(), [spectrum::KEYS, &["scale", "ends"]].concat()),
        ("a picture".to_owned(), texture::PICTURE.to_vec()),
        ("[media.NAME]".to_owned(), [medium::KEYS, transform::KEYS].concat()),
        (
            "numbers by the place".to_owned(),
            [volume::VOLUME, volume::FILE, volume::ARRAY, volume::KELVIN].concat(),
        ),
        ("densities of colours".to_owned(), volume::COLORS.to_vec()),
        ("a cloud of pbrt".to_owned(), volume::CLOUD.to_vec()),
        ("power".to_owned(), light::POWER.to_vec()),
        ("roughness".to_owned(), physical::ROUGHNESS.to_vec()),
        ("a texture of normals".to_owned(), color::NORMALS.to_vec()),
        ("an angle".to_owned(), principled::ANGLE.to_vec()),
        ("encoding".to_owned(), texture::GAMMA.to_vec()),
        ("sides".to_owned(), shape::SIDES.to_vec()),
        ("[objects.NAME]".to_owned(), shape::kinds()),
        ("[[instance]]".to_owned(), [shape::INSTANCE, transform::KEYS].concat()),
        ("[[solid.of]]".to_owned(), [shape::OPERAND, transform::KEYS].concat()),
        ("transform".to_owned(), transform::STEPS.to_vec()),
        ("rotate".to_owned(), transform::ROTATION.to_vec()),
        ("keyframes".to_owned(), keyframes::KEYS.to_vec()),
    ];
    for &(kind, keys) in shape::KEYS {
        tables.push((format!("[[{kind}]]"), [keys, &shape::common(kind).concat()].concat()));
    }
    for &(kind, keys) in material::KEYS {
        tables.push((format!("[materials.NAME] {kind}"), [keys, &material::common(kind).concat()].concat()));
    }
    for &(kind, keys) in texture::KEYS {
        let common = texture::common(kind).concat();
        tables.push((format!("[textures.NAME] {kind}"), [&["type"], keys, &common].concat()));
    }
    for &(kind, keys) in light::KEYS {
        tables.push((format!("[[light]] {kind}"), [light::COMMON, keys].concat()));
    }
    tables
}

/// The keys with enumerated values, and these values.
#[cfg(test)]
pub(super) fn choices() -> Vec<(&'static str, Vec<&'static str>)> {
    use super::{directional, mapping, physical, sky, solid};
    use crate::settings::{
        Allocation, ColorMode, Filter, Integrator, LightSampler, Portals, Sampler, Tonemap,
    };

    fn words<T>(words: &[(&'static str, T)]) -> Vec<&'static str> {
        words.iter().map(|(word, _)| *word).collect()
    }
    vec![
        ("[materials.NAME]", words(material::KEYS)),
        ("[textures.NAME]", words(texture::KEYS)),
        ("[[light]]", words(light::KEYS)),
        ("projection", words(&camera::PROJECTIONS)),
        ("space", mapping::SPACES.to_vec()),
        ("layout", words(sky::LAYOUTS)),
        ("operation", words(solid::OPERATIONS)),
        ("[[solid.of]]", words(solid::TYPES)),
        ("interpolation", words(keyframes::INTERPOLATIONS)),
        ("falloff", words(light::FALLOFFS)),
        ("edge", words(directional::EDGES)),
        ("quantity", words(directional::QUANTITIES)),
        ("energy", words(physical::ENERGIES)),
        ("distribution", words(physical::DISTRIBUTIONS)),
        ("masking", words(physical::MASKINGS)),
        ("illuminant", words(physical::ILLUMINANTS)),
        ("coat_estimate", words(physical::ESTIMATES)),
        ("ends", words(spectrum::ENDS)),
        ("channel", words(texture::CHANNELS)),
        ("background", words(settings::BACKGROUNDS)),
        ("occlusion_directions", words(settings::OCCLUSION_DIRECTIONS)),
        ("vertex_normals", words(settings::VERTEX_NORMALS)),
        ("lens_convention", words(camera::CONVENTIONS)),
        ("encoding", words(texture::ENCODINGS)),
        ("wrap", words(texture::WRAPS)),
        ("filter", words(texture::FILTERS)),
        ("filter", words(Filter::WORDS)),
        ("tonemap", words(Tonemap::WORDS)),
        ("integrator", words(Integrator::WORDS)),
        ("allocation", words(Allocation::WORDS)),
        ("sampler", words(Sampler::WORDS)),
        ("color", words(ColorMode::WORDS)),
        ("light_sampler", words(LightSampler::WORDS)),
        ("portals", words(Portals::WORDS)),
    ]
}
