//! The command line as typed. What it means for a scene is in [`crate::overrides`].
//!
//! The doc comments here are the help texts.

mod model;

use std::path::PathBuf;
use std::time::Duration;

use clap::{Args, Parser, Subcommand};
use clap_complete::Shell;
use glam::DVec3;
use lookfrom::session::Fireflies;
use lookfrom_scene::settings::{
    ColorMode, Filter, Integrator, Layers, LightSampler, PixelBounds, Sampler, Sensor, Tonemap,
};

use crate::values;

pub(crate) use model::ModelArguments;

const EXAMPLES: &str = "\
Examples:
  lookfrom render scene.toml                     a picture, scene.png
  lookfrom render bunny.ply -o bunny.exr         a model as it is, lit and framed
  lookfrom inspect scene.toml 320 200            all that happens to a ray of that pixel
  lookfrom render scene.pbrt -o p.exr --time 1m  as good as it gets in a minute
  lookfrom compare p.exr reference.exr           how far one is from the other
  lookfrom info scene.toml                       what is in it

Exit codes:
  0    done
  1    a scene could not be read or is invalid, or a picture is too far from its reference
  2    wrong usage
  3    the output could not be written
  130  interrupted; a picture that was begun is written as far as it is

The manual: docs/guide/command.md, scene files: docs/guide/scene-format.md";

const RENDER_EXAMPLES: &str = "\
Examples:
  lookfrom render scene.toml -o picture.exr --samples 64
  lookfrom render model.obj --lookfrom -3,2,5 --up 0,0,1
  lookfrom render model.glb --size 512 --floor --background transparent
  lookfrom render model.stl --up 0,0,1 --turntable 36 -o 'around/{name}.png'
  lookfrom render a.toml b.toml -o pictures/             pictures/a.png, pictures/b.png
  lookfrom render */chair.obj -o 'out/{parent}.png'      out/oak.png, out/steel.png
  lookfrom render scene.toml -o - | display
  lookfrom render scene.pbrt --noise 0.02 --write-every 10s
  lookfrom render scene.pbrt --samples 16 --denoise

Ctrl-C stops after the tiles that are being worked on and writes the picture so far; a second one ends at once.
Exit codes: 0 done, 1 scene, 2 usage, 3 output, 130 interrupted.";

const INSPECT_EXAMPLES: &str = "\
Examples:
  lookfrom inspect scene.toml 320 200
  lookfrom inspect scene.toml 320 200 --sample 5 --json
  lookfrom inspect scene.toml 320 200 --svg rays.svg

Give the options that the picture was rendered with: they decide where its rays go.";

const INFO_EXAMPLES: &str = "\
Examples:
  lookfrom info scene.toml
  lookfrom info models/*.ply --json | jq .triangles";

const COMPARE_EXAMPLES: &str = "\
Examples:
  lookfrom compare picture.exr reference.exr
  lookfrom compare a.exr a-ref.exr b.exr b-ref.exr --html report.html --tolerance 0.005 --within 0.99

Exit codes: 0 no pair is farther away than allowed, 1 one is, or cannot be read, 2 usage, 3 output.";

const BENCH_EXAMPLES: &str = "\
Examples:
  lookfrom bench scenes/*.toml
  lookfrom bench scene.pbrt --time 10s --reference reference.exr --json";

const COMPLETIONS_EXAMPLES: &str = "\
Examples:
  lookfrom completions bash > ~/.local/share/bash-completion/completions/lookfrom
  lookfrom completions fish > ~/.config/fish/completions/lookfrom.fish";

/// A ray tracer whose every ray can be inspected.
#[derive(Debug, Parser)]
#[command(name = "lookfrom", version, after_help = EXAMPLES, arg_required_else_help = true)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    pub(crate) command: Command,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Make pictures of scenes and models
    #[command(after_help = RENDER_EXAMPLES)]
    Render(RenderArguments),
    /// Show all that happens on the way of one sample
    #[command(after_help = INSPECT_EXAMPLES)]
    Inspect(InspectArguments),
    /// Say what is in scenes and models
    #[command(after_help = INFO_EXAMPLES)]
    Info(InfoArguments),
    /// Say how far pictures are from references
    #[command(after_help = COMPARE_EXAMPLES)]
    Compare(CompareArguments),
    /// Measure how fast scenes are rendered and how much noise is left
    #[command(after_help = BENCH_EXAMPLES)]
    Bench(BenchArguments),
    /// Print a script that completes this command in a shell
    #[command(after_help = COMPLETIONS_EXAMPLES)]
    Completions {
        /// For which shell
        shell: Shell,
    },
}

#[derive(Args, Debug)]
pub(crate) struct RenderArguments {
    /// Scenes (.toml, .pbrt) or models (.gltf, .glb, .obj, .ply, .stl)
    #[arg(required = true, value_name = "SCENE")]
    pub(crate) scenes: Vec<PathBuf>,

    /// Where to: a file (.png, .exr, .hdr, .pfm, .ppm), a folder, a pattern with {name}, or - for a PNG to stdout
    ///
    /// PNG and PPM are 8-bit sRGB after exposure and tone map; EXR, HDR and PFM are linear light as it was computed. Without
    /// it: NAME.png in the current folder, by the name of the scene. For several scenes give a folder or a pattern, in which
    /// {name} is the scene's name without folder and extension, {dir} its folder as typed, {parent} the name of that folder,
    /// {n} its number in the call, from 1, and {{ and }} are braces. Folders that are missing are made. No file that a scene
    /// is made of is ever written over.
    #[arg(short, long, value_name = "OUT")]
    pub(crate) output: Option<PathBuf>,

    /// Stop after the pass over the picture that reaches this time: 60s, 500ms, 2m, 1h
    ///
    /// Without --samples, there is no other limit. The picture is that of the samples that were taken, bit for bit.
    #[arg(long, value_name = "TIME", value_parser = values::duration)]
    pub(crate) time: Option<Duration>,

    /// Stop when every part of the picture is as clean as this: the standard error in shares of the light, as 0.02
    ///
    /// Tiles of 32 × 32 pixels get no more samples when they are (after 16 samples at least). Without --samples, there is no
    /// other limit.
    #[arg(long, value_name = "ERROR", value_parser = values::between(1e-6f64, 1e6))]
    pub(crate) noise: Option<f64>,

    /// Take no more samples than asked for, and fewer where the picture is clean: --noise 0.02 with a limit
    #[arg(long)]
    pub(crate) adaptive: bool,

    /// Write the picture so far at this interval: 10s, 2m
    #[arg(long, value_name = "TIME", value_parser = values::duration)]
    pub(crate) write_every: Option<Duration>,

    /// What becomes of pixels that single samples make far too bright: median spreads their excess over the pixels around
    #[arg(long, value_name = "NAME", value_parser = values::word(values::FIREFLIES), default_value = "off")]
    pub(crate) fireflies: Fireflies,

    /// Make this many pictures of each scene, evenly around it, as if it stood on a turntable: NAME-000.png, NAME-001.png …
    ///
    /// The camera goes around an upright axis, against the clock as seen from above; light from all around goes with it, and
    /// lamps stay with the scene. The axis goes through what a scene's camera looks at (or --lookat), else through the
    /// middle of what is visible. A model is framed so that nothing is cut at any angle.
    #[arg(long, value_name = "N", value_parser = values::whole(1u32, 100_000))]
    pub(crate) turntable: Option<u32>,

    /// Say nothing but errors
    #[arg(short, long)]
    pub(crate) quiet: bool,

    /// Write a summary of each scene to stdout, one JSON object a line
    #[arg(long)]
    pub(crate) json: bool,

    #[command(flatten)]
    pub(crate) common: Common,

    #[command(flatten)]
    pub(crate) overrides: Overrides,
}

#[derive(Args, Debug)]
pub(crate) struct InspectArguments {
    /// A scene (.toml, .pbrt) or a model (.gltf, .glb, .obj, .ply, .stl)
    #[arg(value_name = "SCENE")]
    pub(crate) scene: PathBuf,

    /// Column of the pixel, from the left, from 0
    #[arg(value_name = "X", value_parser = values::whole(0, u32::MAX))]
    pub(crate) x: u32,

    /// Row of the pixel, from the top, from 0
    #[arg(value_name = "Y", value_parser = values::whole(0, u32::MAX))]
    pub(crate) y: u32,

    /// Which sample of the pixel, from 0
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = values::whole(0, u32::MAX))]
    pub(crate) sample: u32,

    /// Answer with one JSON object
    #[arg(long)]
    pub(crate) json: bool,

    /// Draw the rays into this file as well
    #[arg(long, value_name = "FILE")]
    pub(crate) svg: Option<PathBuf>,

    #[command(flatten)]
    pub(crate) common: Common,

    #[command(flatten)]
    pub(crate) overrides: Overrides,
}

#[derive(Args, Debug)]
pub(crate) struct InfoArguments {
    /// Scenes (.toml, .pbrt) or models (.gltf, .glb, .obj, .ply, .stl)
    #[arg(required = true, value_name = "SCENE")]
    pub(crate) scenes: Vec<PathBuf>,

    /// Answer with one JSON object a line for each scene
    #[arg(long)]
    pub(crate) json: bool,

    #[command(flatten)]
    pub(crate) common: Common,
}

#[derive(Args, Debug)]
pub(crate) struct CompareArguments {
    /// Pictures and their references, in turn; those of .exr may know their noise
    #[arg(required = true, num_args = 2.., value_name = "PICTURE REFERENCE")]
    pub(crate) pictures: Vec<PathBuf>,

    /// Write a report with the pictures, their differences and FLIP to this file
    #[arg(long, value_name = "FILE")]
    pub(crate) html: Option<PathBuf>,

    /// Samples a pixel of picture and reference, where the files do not say them
    #[arg(long, value_name = "N,M", value_parser = crate::compare::samples)]
    pub(crate) samples: Option<[u64; 2]>,

    /// The sensor of pictures that do not say which one their variances are of: NAME, or NAME,KELVIN with its white balance
    ///
    /// As in a scene file: cie1931, canon_eos_5d_mkiv … Ours say it; pbrt's do not, and are taken for the same as the other
    /// picture's, or for cie1931 without a white balance.
    #[arg(long, value_name = "NAME", value_parser = crate::compare::sensor)]
    pub(crate) sensor: Option<Sensor>,

    /// A channel's mean may be farther from the reference's than this share only if noise explains it
    #[arg(long, value_name = "SHARE", value_parser = values::between(0.0f64, 1e6))]
    pub(crate) tolerance: Option<f64>,

    /// This share of the pixels must be within 3.5 standard errors
    #[arg(long, value_name = "SHARE", value_parser = values::between(0.0f64, 1.0))]
    pub(crate) within: Option<f64>,

    /// Brighter (or darker) by this many stops, for FLIP and the report
    #[arg(long, value_name = "STOPS", value_parser = values::between(-64.0f32, 64.0), allow_hyphen_values = true, default_value_t = 0.0)]
    pub(crate) exposure: f32,

    /// Answer with one JSON object a line for each pair
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Args, Debug)]
pub(crate) struct BenchArguments {
    /// Scenes (.toml, .pbrt) or models (.gltf, .glb, .obj, .ply, .stl)
    #[arg(required = true, value_name = "SCENE")]
    pub(crate) scenes: Vec<PathBuf>,

    /// Render for this time instead of 16 samples a pixel (or --samples): 10s, 2m
    #[arg(long, value_name = "TIME", value_parser = values::duration)]
    pub(crate) time: Option<Duration>,

    /// The picture without noise; without it one is rendered
    #[arg(long, value_name = "FILE")]
    pub(crate) reference: Option<PathBuf>,

    /// Samples a pixel of a reference that is rendered
    #[arg(long, value_name = "N", default_value_t = 256, value_parser = values::whole(1u32, 1 << 24))]
    pub(crate) reference_samples: u32,

    /// Answer with one JSON object a line for each scene
    #[arg(long)]
    pub(crate) json: bool,

    #[command(flatten)]
    pub(crate) common: Common,

    #[command(flatten)]
    pub(crate) overrides: Overrides,
}

#[derive(Args, Debug)]
pub(crate) struct Common {
    /// Threads to build and render with [default: as many as there are processors]
    #[arg(long, value_name = "N", value_parser = values::whole(1u16, 1024))]
    pub(crate) threads: Option<u16>,

    /// Treat warnings as errors, but for harmless ones (notes)
    #[arg(long)]
    pub(crate) strict: bool,
}

/// What the command line says in place of the scene.
#[derive(Args, Clone, Debug, Default)]
#[command(next_help_heading = "In place of what the scene says")]
pub(crate) struct Overrides {
    /// Columns; alone it keeps the shape of the picture
    #[arg(long, value_name = "PIXELS", value_parser = values::whole(1, u32::MAX))]
    pub(crate) width: Option<u32>,

    /// Rows; alone it keeps the shape of the picture
    #[arg(long, value_name = "PIXELS", value_parser = values::whole(1, u32::MAX))]
    pub(crate) height: Option<u32>,

    /// Compute only this part: columns X0 to before X1, rows Y0 to before Y1, from the top left
    #[arg(long, value_name = "X0,Y0,X1,Y1", value_parser = values::crop, allow_hyphen_values = true)]
    pub(crate) crop: Option<PixelBounds>,

    /// Samples a pixel
    #[arg(long, value_name = "N", value_parser = values::whole(1u32, 1 << 24))]
    pub(crate) samples: Option<u32>,

    /// How light is computed; the last four show what is there
    #[arg(long, value_name = "NAME", value_parser = values::word(Integrator::WORDS))]
    pub(crate) integrator: Option<Integrator>,

    /// Whether light is red, green and blue or four wavelengths
    #[arg(long, value_name = "NAME", value_parser = values::word(ColorMode::WORDS))]
    pub(crate) color: Option<ColorMode>,

    /// How one of many lights is chosen
    #[arg(long, value_name = "NAME", value_parser = values::word(LightSampler::WORDS))]
    pub(crate) light_sampler: Option<LightSampler>,

    /// What an EXR holds besides the picture: geometry is albedo, normals, position, depth, uv and variance
    #[arg(long, value_name = "NAME", value_parser = values::word(values::LAYERS))]
    pub(crate) layers: Option<Layers>,

    /// Whether noise is filtered out of the picture (alone: on) [default: what the scene says; on for models]
    ///
    /// An EXR then keeps the light as it was computed, too, in the channels noisy.R, noisy.G and noisy.B, and layers are
    /// those of that light. Pictures of --write-every are filtered only at the end.
    #[arg(long, value_name = "on|off", value_parser = values::word(values::ON_OFF), num_args = 0..=1, default_missing_value = "on")]
    pub(crate) denoise: Option<bool>,

    /// How many times a ray may be mirrored, refracted or scattered
    #[arg(long, value_name = "N", value_parser = values::whole(0u32, 256))]
    pub(crate) depth: Option<u32>,

    /// Share of the pixel below which a branch of the tree of rays is cut off
    #[arg(long, value_name = "SHARE", value_parser = values::between(0.0f32, 1.0), allow_hyphen_values = true)]
    pub(crate) min_contribution: Option<f32>,

    /// Where random numbers come from
    #[arg(long, value_name = "NAME", value_parser = values::word(Sampler::WORDS))]
    pub(crate) sampler: Option<Sampler>,

    /// Another seed, other noise
    #[arg(long, value_name = "N", value_parser = values::whole(0, u64::MAX))]
    pub(crate) seed: Option<u64>,

    /// How a pixel weighs the light around it: box, triangle, gaussian, mitchell or blackman_harris, and its radius in
    /// pixels
    #[arg(long, value_name = "NAME[:RADIUS]", value_parser = values::filter)]
    pub(crate) filter: Option<Filter>,

    /// Brighter (or darker) by this many stops, in PNG and PPM
    #[arg(long, value_name = "STOPS", value_parser = values::between(-64.0f32, 64.0), allow_hyphen_values = true)]
    pub(crate) exposure: Option<f32>,

    /// From linear light to 8 bits
    #[arg(long, value_name = "NAME", value_parser = values::word(Tonemap::WORDS))]
    pub(crate) tonemap: Option<Tonemap>,

    /// Where the eye is
    #[arg(long, value_name = "X,Y,Z", value_parser = values::vector, allow_hyphen_values = true)]
    pub(crate) lookfrom: Option<DVec3>,

    /// What it looks at
    #[arg(long, value_name = "X,Y,Z", value_parser = values::vector, allow_hyphen_values = true)]
    pub(crate) lookat: Option<DVec3>,

    /// What is up
    #[arg(long, value_name = "X,Y,Z", value_parser = values::vector, allow_hyphen_values = true)]
    pub(crate) up: Option<DVec3>,

    /// Vertical field of view in degrees
    #[arg(long, value_name = "DEGREES", value_parser = values::field_of_view, allow_hyphen_values = true)]
    pub(crate) fov: Option<f64>,

    #[command(flatten)]
    pub(crate) model: ModelArguments,
}
