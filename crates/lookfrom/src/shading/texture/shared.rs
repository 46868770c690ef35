//! Textures that others use more than once: in a graph of many uses each is evaluated once per point.
//!
//! A tree of uses may grow exponentially with the number of textures, as where each mixes the one before with a scaled copy of
//! itself. Values are kept only where there are many uses; in small graphs it costs less to evaluate a texture again.

use std::cell::RefCell;
use std::collections::BTreeMap;

use lookfrom_scene::material::Color;
use lookfrom_scene::scene::TextureId;
use lookfrom_scene::texture::TextureKind;

use super::SpectrumType;
use crate::core::spectrum::Spectrum;

/// The number of uses from which on values are kept.
const MANY: u64 = 64;

/// Whether the values of each texture's parts are kept while it is evaluated. The graph has no circles.
pub(super) fn keeps_values(kinds: &[TextureKind]) -> Vec<bool> {
    let mut uses = vec![None; kinds.len()];
    (0..kinds.len()).map(|index| count_uses(kinds, index, &mut uses) > MANY).collect()
}

/// The number of textures that one is made of, itself included, each as often as it is used.
fn count_uses(kinds: &[TextureKind], index: usize, known: &mut [Option<u64>]) -> u64 {
    if let Some(uses) = known[index] {
        return uses;
    }
    let uses = kinds[index].parts().into_iter().fold(1_u64, |uses, part| match part {
        Color::Texture(id) => uses.saturating_add(count_uses(kinds, id.index(), known)),
        Color::Value(_) | Color::Curve(_) => uses,
    });
    known[index] = Some(uses);
    uses
}

/// The values of textures at one point, by texture and use.
#[derive(Debug, Default)]
pub(crate) struct Values(RefCell<BTreeMap<Use, Spectrum>>);

/// A texture, and what it is evaluated as: a spectrum, or `None` for a number.
type Use = (u32, Option<SpectrumType>);

/// A value that can be kept among those of other types.
pub(super) trait Kept: Copy {
    fn keep(self) -> Spectrum;
    fn kept(spectrum: Spectrum) -> Self;
}

impl Kept for f32 {
    fn keep(self) -> Spectrum {
        Spectrum([self; 4])
    }

    fn kept(spectrum: Spectrum) -> Self {
        spectrum.0[0]
    }
}

impl Kept for Spectrum {
    fn keep(self) -> Spectrum {
        self
    }

    fn kept(spectrum: Spectrum) -> Self {
        spectrum
    }
}

impl Values {
    /// The value of a use; `evaluate` is called the first time.
    pub(super) fn get<V: Kept>(
        &self,
        id: TextureId,
        as_type: Option<SpectrumType>,
        evaluate: impl FnOnce() -> V,
    ) -> V {
        let key = (id.0, as_type);
        if let Some(&known) = self.0.borrow().get(&key) {
            return V::kept(known);
        }
        let value = evaluate();
        self.0.borrow_mut().insert(key, value.keep());
        value
    }
}
