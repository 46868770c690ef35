//! The readers as a program uses them: files in; scenes, pictures and errors out.
//!
//! One program for all files, since each would link the readers for itself.

mod arrays;
mod convert;
mod gltf;
mod gltf_corpus;
mod gltf_hostile;
#[cfg(feature = "gltf")]
mod gltf_odd;
#[cfg(feature = "gltf")]
mod gltf_pose;
mod graphs;
mod image;
mod image_exr;
mod image_radiance;
#[cfg(feature = "images")]
mod image_tiff;
mod left_out;
#[cfg(feature = "mitsuba")]
mod mitsuba;
#[cfg(feature = "mitsuba")]
mod mitsuba_scenes;
mod models_corpus;
mod models_errors;
mod models_formats;
mod models_hostile;
mod models_places;
mod named_files;
mod nanovdb;
mod openvdb;
mod pbrt;
mod pbrt_errors;
mod pbrt_hostile;
mod pbrt_old;
mod pbrt_scenes;
#[cfg(unix)]
mod pipes;
mod secrets;
mod solids;
mod subdivision;
mod support;
mod text;
mod toml;
mod toml_docs;
mod toml_hostile;
mod toml_physical;
mod toml_variables;
