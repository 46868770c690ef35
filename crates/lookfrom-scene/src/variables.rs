//! Values from outside for the variables of a scene, and its frames per second.

use std::collections::BTreeMap;

/// Values for the variables of a scene, which replace those in its `[variables]`, or those of the `default` elements of Mitsuba. The time of its animations is
/// [`ImportOptions::at`](crate::ImportOptions::at).
#[derive(Clone, Debug, PartialEq)]
pub struct Variables {
    /// Values by name: TOML, or where that cannot be read as TOML, the text itself.
    pub values: BTreeMap<String, String>,
    /// Frames per second, > 0.
    pub fps: f64,
}

/// Frames per second unless another number is given: that of films.
pub const FPS: f64 = 24.0;

impl Default for Variables {
    fn default() -> Self {
        Self { values: BTreeMap::new(), fps: FPS }
    }
}
