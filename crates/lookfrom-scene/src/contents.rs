//! The animations, material variants, cameras and scenes of a file, from which one of each is selected, and its variables.

use crate::camera::Projection;

/// The items that [`ImportOptions`](crate::ImportOptions) selects from, in the order of their numbers, which only glTF files
/// have, and the variables of scenes in our own format and of Mitsuba.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Contents {
    /// The names of the scenes.
    pub scenes: Vec<Option<String>>,
    /// Index of the scene that was read.
    pub scene: Option<usize>,
    /// The cameras of the scene that was read.
    pub cameras: Vec<CameraEntry>,
    /// The animations.
    pub animations: Vec<AnimationEntry>,
    /// The names of the material variants.
    pub variants: Vec<Option<String>>,
    /// The names of the [variables](crate::Variables), with their values: TOML, or long ones in words.
    pub variables: Vec<(String, String)>,
    /// The time of the last keyframe of a scene in our own format, in seconds: 0 if only expressions depend on the time;
    /// `None` if nothing does.
    pub duration: Option<f64>,
    /// The moment that is shown; `None` if nothing depends on it.
    pub moment: Option<Moment>,
}

/// A moment of an animation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moment {
    /// The time in seconds.
    pub time: f64,
    /// Frames per second.
    pub fps: f64,
    /// Frames that the shutter is open, from the time on.
    pub shutter: f64,
}

/// A camera of a file.
#[derive(Clone, Debug, PartialEq)]
pub struct CameraEntry {
    /// The name of its node, or else its own.
    pub name: Option<String>,
    /// Its projection; `None` if its values are out of range.
    pub projection: Option<Projection>,
}

/// An animation of a file.
#[derive(Clone, Debug, PartialEq)]
pub struct AnimationEntry {
    /// Its name.
    pub name: Option<String>,
    /// The time of its last keyframe in seconds: ≥ 0; `None` if no keyframe can be read.
    pub duration: Option<f64>,
}
