//! Everything read from or written to disk: scenes, meshes and images, as plain data.
//!
//! A [`scene::Scene`] is a scene as it was written. It keeps names and locations, is validated as far as a file can be
//! validated by itself, and is independent of rendering. Start reading at [`scene`].

// What several readers share is there whichever of them are.
#![cfg_attr(
    not(all(feature = "gltf", feature = "images", feature = "mitsuba", feature = "pbrt")),
    allow(dead_code)
)]

pub mod atmosphere;
mod boolean;
pub mod budget;
mod builder;
pub mod camera;
mod chain;
mod composite;
pub mod contents;
pub mod count;
pub mod digest;
mod disk;
mod duplicates;
pub mod error;
pub mod excerpt;
pub mod files;
mod format;
#[cfg(feature = "gltf")]
pub mod gltf;
pub mod grid;
pub mod hair;
pub mod ies;
pub mod image;
pub mod inputs;
pub mod json;
pub mod lens;
mod level_set;
pub mod light;
pub mod load;
pub mod material;
pub mod measured;
pub mod medium;
#[cfg(feature = "mitsuba")]
pub mod mitsuba;
pub mod model;
pub mod motion;
mod nanovdb;
pub mod npy;
pub mod obj;
mod openvdb;
mod packed;
mod parallel;
#[cfg(feature = "pbrt")]
pub mod pbrt;
pub mod plural;
pub mod ply;
pub mod remedy;
pub mod scene;
pub mod settings;
pub mod shape;
mod shutter;
pub mod solid;
mod source;
pub mod spectrum;
pub mod stamps;
pub mod stl;
pub mod studio;
pub mod subdivision;
pub mod suggest;
mod tessellation;
mod text;
pub mod texture;
pub mod toml;
mod validate;
pub mod variables;
pub mod vdb;
pub mod volume;
pub mod warning;
pub mod watertight;

pub use budget::Budget;
pub use disk::Disk;
pub use error::{Error, ErrorKind, Location, Result};
pub use files::{CameraChoice, Files, ImportOptions, Limits, LoadContext, Memory};
pub use inputs::Inputs;
pub use remedy::Remedy;
pub use scene::Scene;
pub use variables::Variables;
pub use warning::{Warning, WarningGroup, WarningKind};
