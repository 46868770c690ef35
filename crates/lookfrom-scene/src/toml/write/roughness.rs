//! Roughness of microfacets: as people write it where that gives the same bits, else as the model has it.

use super::Writer;
use super::text::{Fields, Item};
use crate::material::{Color, Distribution, Masking, Microfacets, Roughness, Scalar};
use crate::scene::{Scene, TextureId};
use crate::texture::TextureKind;
use crate::toml::physical::{DISTRIBUTIONS, MASKINGS};
use crate::toml::word_of;

impl Writer<'_> {
    pub(super) fn roughness(&self, fields: &mut Fields, key: &str, roughness: &Roughness) {
        let &Roughness { u, v, remap, microfacets } = roughness;
        put_microfacets(fields, microfacets);
        let is_smooth = |scalar: Scalar| matches!(scalar, Scalar::Value(value) if value.to_bits() == 0);
        // The root of 0 is 0.
        if is_smooth(u) && is_smooth(v) {
            return;
        }
        let both = |[u, v]: [Item; 2]| if u == v { u } else { Item::List(vec![u, v]) };
        if let (false, Some(u), Some(v)) = (remap, self.perceptual(u), self.perceptual(v)) {
            fields.put(key, both([u, v]));
            return;
        }
        let word = if remap { "alpha_squared" } else { "alpha" };
        fields.put(key, Fields::one(word, both([self.scalar(u), self.scalar(v)])));
    }

    /// The roughness whose square an α is.
    pub(super) fn perceptual(&self, alpha: Scalar) -> Option<Item> {
        match alpha {
            Scalar::Value(alpha) => {
                let root = alpha.sqrt();
                let near = [root, root.next_down(), root.next_up()];
                let is_root = |root: &&f32| (0.0..=1.0).contains(*root) && **root * **root == alpha;
                near.iter().find(is_root).map(|root| (*root).into())
            }
            Scalar::Texture(id) => squared(self.scene, id).map(|id| self.texture_name(id).into()),
        }
    }
}

pub(super) fn put_microfacets(fields: &mut Fields, microfacets: Microfacets) {
    let Microfacets { distribution, masking } = microfacets;
    if distribution != Distribution::default() {
        fields.put("distribution", word_of(DISTRIBUTIONS, &distribution));
    }
    if masking != Masking::default() {
        fields.put("masking", word_of(MASKINGS, &masking));
    }
}

/// The texture whose square another one is, where a roughness is given by a texture.
pub(super) fn squared(scene: &Scene, id: TextureId) -> Option<TextureId> {
    let texture = &scene.textures[id.index()];
    match texture.kind {
        TextureKind::Scale { color: Color::Texture(of), by: Scalar::Texture(by) }
            if of == by && texture.name.ends_with(&format!(" at {}", texture.at)) =>
        {
            Some(of)
        }
        _ => None,
    }
}
