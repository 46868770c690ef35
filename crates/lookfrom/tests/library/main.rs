//! The library as a program uses it: scenes in; pictures, films and reasons out.
//!
//! One program for all files, since each would compile and link the renderer for itself.

mod analytic;
mod architecture;
mod area_lights;
mod bump_maps;
mod by_code;
mod changed;
mod coated_lamps;
mod denoise;
mod dispersion;
mod enough;
mod films;
mod gltf_and_pbrt;
mod gltf_media;
mod inspect;
mod inspect_lifts;
mod inspect_lights;
mod inspect_microfacets;
mod inspect_numbers;
mod inspect_segments;
mod labels;
mod layers;
mod lens_systems;
mod light_paths;
mod media;
mod nested;
mod own_integrator;
mod path;
mod portal;
mod references;
mod robust;
mod same_bits;
mod scattering;
mod seen_media;
mod sensor;
mod session;
mod shapes;
mod sides;
mod smooth_meshes;
mod subsurface;
mod support;
mod surfaces;
mod valid;
mod varying_media;
mod warnings;
