//! The animations, material variants, cameras and scenes of a file, from which one of each is selected.

use crate::camera::Projection;

/// What a [`ImportOptions`](crate::ImportOptions) chooses from, in the order of its numbers. Only glTF files have such things.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Contents {
    /// The names of the scenes.
    pub scenes: Vec<Option<String>>,
    /// Number of the scene that was read.
    pub scene: Option<usize>,
    /// The cameras of the scene that was read.
    pub cameras: Vec<CameraEntry>,
    /// The animations.
    pub animations: Vec<AnimationEntry>,
    /// The names of the variants of materials.
    pub variants: Vec<Option<String>>,
}

/// A camera of a file.
#[derive(Clone, Debug, PartialEq)]
pub struct CameraEntry {
    /// The name of its node, or else its own.
    pub name: Option<String>,
    /// Its projection; `None` where its numbers are out of range.
    pub projection: Option<Projection>,
}

/// An animation of a file.
#[derive(Clone, Debug, PartialEq)]
pub struct AnimationEntry {
    /// Its name.
    pub name: Option<String>,
    /// The time of its last key in seconds: ≥ 0; `None` where no key can be read.
    pub duration: Option<f64>,
}
