//! The graphics state, and the settings before `WorldBegin`.

use std::rc::Rc;

use glam::DMat4;

use super::params::{Inherited, Parameters};
use super::spectra::{SRGB, Space};
use super::text::Place;
use crate::camera::Target;
use crate::scene::MaterialId;
use crate::shape::Emission;

/// The targets of `Attribute`, in the order of [`State::attributes`].
pub(super) const TARGETS: [&str; 5] = ["shape", "light", "material", "medium", "texture"];

/// The current graphics state.
#[derive(Clone)]
pub(super) struct State {
    /// The current transformation matrix: from object to world space (before `WorldBegin`: from world to camera space).
    /// At the start of the transform times.
    pub(super) matrix: DMat4,
    /// [`Self::matrix`] at their end.
    pub(super) end_matrix: DMat4,
    /// Whether transforms apply to the start.
    pub(super) at_start: bool,
    /// Whether transforms apply to the end.
    pub(super) at_end: bool,
    pub(super) reverse_orientation: bool,
    pub(super) material: MaterialId,
    pub(super) emission: Option<Emission>,
    /// The names of the media inside and outside; an empty name is the vacuum.
    pub(super) media: Option<Rc<[String; 2]>>,
    pub(super) attributes: [Inherited; 5],
    pub(super) space: Space,
}

impl State {
    /// The transformation matrices at the start and at the end.
    pub(super) fn matrices(&self) -> [DMat4; 2] {
        [self.matrix, self.end_matrix]
    }
}

impl Default for State {
    fn default() -> Self {
        Self {
            matrix: DMat4::IDENTITY,
            end_matrix: DMat4::IDENTITY,
            at_start: true,
            at_end: true,
            reverse_orientation: false,
            material: MaterialId(0),
            emission: None,
            media: None,
            attributes: Default::default(),
            space: SRGB,
        }
    }
}

/// An open block.
pub(super) struct Opened {
    /// `Attribute` or `Object`.
    pub(super) word: &'static str,
    /// The location of its `Begin`.
    pub(super) place: Place,
    /// The graphics state to restore at its end.
    pub(super) state: State,
}

/// One of the directives before `WorldBegin`, as it was written.
pub(super) struct Entity {
    /// `perspective`, `rgb`, …
    pub(super) kind: String,
    pub(super) parameters: Parameters,
}

/// Settings before `WorldBegin`.
#[derive(Default)]
pub(super) struct Options {
    /// Look-at point and up vector of the last `LookAt`, in camera space under the transforms so far.
    pub(super) look: Option<Target>,
    /// The camera, and the matrices from world to camera space at the start and the end.
    pub(super) camera: Option<(Entity, [DMat4; 2])>,
    /// The name of the medium around the camera; an empty name is the vacuum.
    pub(super) camera_medium: String,
    /// The camera's target, for orbiting.
    pub(super) target: Option<Target>,
    pub(super) film: Option<Entity>,
    pub(super) filter: Option<Entity>,
    pub(super) sampler: Option<Entity>,
    pub(super) integrator: Option<Entity>,
}
