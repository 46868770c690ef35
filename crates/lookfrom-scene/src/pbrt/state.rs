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
    /// From the space that directives speak in to the world (before `WorldBegin`: from the world to the camera's space).
    pub(super) matrix: DMat4,
    /// Whether transforms reach the start of the shutter's time, which is what is rendered.
    pub(super) at_start: bool,
    /// Whether they reach its end.
    pub(super) at_end: bool,
    pub(super) reverse_orientation: bool,
    pub(super) material: MaterialId,
    pub(super) emission: Option<Emission>,
    /// The names of the media inside and outside; empty is a vacuum.
    pub(super) media: Option<Rc<[String; 2]>>,
    pub(super) attributes: [Inherited; 5],
    pub(super) space: Space,
}

impl Default for State {
    fn default() -> Self {
        Self {
            matrix: DMat4::IDENTITY,
            at_start: true,
            at_end: true,
            reverse_orientation: false,
            material: MaterialId(0),
            emission: None,
            media: None,
            attributes: std::array::from_fn(|_| Rc::default()),
            space: SRGB,
        }
    }
}

/// The kind of block.
pub(super) struct Opened {
    /// `Attribute`, `Transform` or `Object`.
    pub(super) word: &'static str,
    /// The location of its beginning.
    pub(super) place: Place,
    /// The graphics state that is restored at its end.
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
    /// What the last `LookAt` looks at and what is up for it, by the transforms so far: in the camera's space.
    pub(super) look: Option<Target>,
    /// With the matrix from the world to its space.
    pub(super) camera: Option<(Entity, DMat4)>,
    /// The name of the medium around the camera; empty is a vacuum.
    pub(super) camera_medium: String,
    /// The point at the centre of the view.
    pub(super) target: Option<Target>,
    pub(super) film: Option<Entity>,
    pub(super) filter: Option<Entity>,
    pub(super) sampler: Option<Entity>,
    pub(super) integrator: Option<Entity>,
}
