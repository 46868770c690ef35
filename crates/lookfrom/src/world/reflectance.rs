//! Warnings about reflectances above 1: surfaces that would reflect more light than arrives, or colours that were
//! written from 0 to 255.

use lookfrom_scene::material::{Color, MaterialKind};
use lookfrom_scene::scene::Scene;
use lookfrom_scene::spectrum::Curve;
use lookfrom_scene::texture::TextureKind;
use lookfrom_scene::{Location, Warning};

/// Reflectances from here on were probably meant as bytes.
const BYTES: f32 = 2.0;

/// A value above 1, and where it was written.
type Excess<'a> = ([f32; 3], &'a Location);

/// Warns of each material with a reflectance above 1, once. Factors of image textures are not checked.
pub(super) fn check(scene: &Scene, warnings: &mut Vec<Warning>) {
    let mut search = Search { scene, of_textures: vec![None; scene.textures.len()] };
    for material in &scene.materials {
        let found = material.kind.reflectances().into_iter().find_map(|(key, color)| {
            let (color, at) = search.excess(color, &material.at)?;
            Some((key, color, at))
        });
        let Some((key, [r, g, b], at)) = found else { continue };
        let name = &material.name;
        let what_becomes_of_it = match material.kind {
            MaterialKind::Whitted(_) => "the surface gives off more light than arrives",
            _ => "values above 1 are taken as 1",
        };
        let remedy = if r.max(g).max(b) >= BYTES { "; if 0 to 255 was meant, divide by 255" } else { "" };
        let message = format!(
            "the {key} of material `{name}` is [{r}, {g}, {b}], and colours of surfaces go from 0 to 1: \
             {what_becomes_of_it}{remedy}"
        );
        warnings.push(Warning::new(at, message));
    }
}

/// The search for values above 1, which visits each texture once.
struct Search<'a> {
    scene: &'a Scene,
    /// By texture: the result, if it was visited.
    of_textures: Vec<Option<Option<Excess<'a>>>>,
}

impl<'a> Search<'a> {
    /// The first value above 1 that a colour, written at `at`, is made of.
    fn excess(&mut self, color: Color, at: &'a Location) -> Option<Excess<'a>> {
        let value = |rgb: [f32; 3]| rgb.iter().any(|&c| c > 1.0).then_some((rgb, at));
        match color {
            Color::Value(rgb) => value(rgb),
            Color::Curve(id) => match &self.scene.curves[id.index()] {
                Curve::Constant(all) => value([*all; 3]),
                Curve::Tabulated { values, .. } => {
                    value([values.iter().copied().fold(f32::NEG_INFINITY, f32::max); 3])
                }
                // Its largest value is 1.
                Curve::Blackbody { .. } => None,
            },
            Color::Texture(id) => {
                if let Some(known) = self.of_textures[id.index()] {
                    return known;
                }
                let texture = &self.scene.textures[id.index()];
                let found = match &texture.kind {
                    TextureKind::VertexColor { tint } => {
                        tint.iter().any(|&c| c > 1.0).then_some((*tint, &texture.at))
                    }
                    kind => kind.colors().into_iter().find_map(|color| self.excess(color, &texture.at)),
                };
                self.of_textures[id.index()] = Some(found);
                found
            }
        }
    }
}
