//! Lists of the animations, variants, cameras and scenes from which [`choose`](super::choose) selects.

use std::collections::HashMap;

use super::camera::Cameras;
use super::file::Document;
use super::json::{Animation, Whole};
use super::node::Tree;
use crate::contents::{AnimationEntry, Contents};

/// The maximum number of keyframes read to find durations of animations, to bound the cost of the list.
const MOST_KEYS: u64 = 1 << 22;

/// The content of the file. Faults in animations that are not requested are not errors.
pub(super) fn contents(document: &Document, tree: &Tree, cameras: &Cameras<'_>) -> Contents {
    let root = &document.root;
    let variants = root.extensions.variants.as_ref().map_or(&[][..], |variants| &variants.variants);
    let mut clock = Clock { document, last_keys: HashMap::new(), left: MOST_KEYS };
    let entry = |animation: &Animation| AnimationEntry {
        name: animation.name.clone(),
        duration: clock.duration(animation),
    };
    Contents {
        scenes: root.scenes.iter().map(|scene| scene.name.clone()).collect(),
        scene: tree.scene,
        cameras: cameras.entries(),
        animations: root.animations.iter().map(entry).collect(),
        variants: variants.iter().map(|variant| variant.name.clone()).collect(),
        ..Contents::default()
    }
}

/// Durations of animations; channels often share the times of their keyframes.
struct Clock<'d> {
    document: &'d Document,
    /// Time of the last keyframe, by accessor.
    last_keys: HashMap<Whole, Option<f64>>,
    /// Number of keyframes that may still be read.
    left: u64,
}

impl Clock<'_> {
    fn duration(&mut self, animation: &Animation) -> Option<f64> {
        let samplers = animation.samplers.iter();
        samplers.filter_map(|sampler| self.last_key(sampler.input)).reduce(f64::max)
    }

    fn last_key(&mut self, times: Whole) -> Option<f64> {
        if let Some(&known) = self.last_keys.get(&times) {
            return known;
        }
        let accessor = self.document.root.accessors.get(times.index())?;
        // Keyframes without a buffer view are all 0, and would count against the limits of the file.
        let mut keys = Vec::new();
        if accessor.buffer_view.is_some() && accessor.count.0 <= self.left {
            self.left -= accessor.count.0;
            keys = self.document.scalars(times, "/animations").unwrap_or_default();
        }
        let keys = keys.into_iter().map(f64::from);
        let last = keys.filter(|key| key.is_finite() && *key >= 0.0).reduce(f64::max);
        self.last_keys.insert(times, last);
        last
    }
}
