//! Command-line arguments as typed. [`crate::overrides`] turns them into options of a session.
//!
//! The doc comments of the fields are the help texts.

mod convert;
mod encoding;
mod farm;
mod film;
mod inspect;
mod memory;
mod model;
mod series;
mod variables;
#[cfg(feature = "view")]
mod view;

use std::ops::Range;
use std::path::{Path, PathBuf};
use std::time::Duration;

use clap::{Args, Parser, Subcommand};
use clap_complete::Shell;
use glam::DVec3;
use lookfrom::session::{Exposure, Fireflies};
use lookfrom_scene::settings::{
    Allocation, ColorMode, CryptomatteKind, Filter, Integrator, Layers, LightPathLayer, LightSampler,
    PixelBounds, Portals, Sampler, Sensor, SpectralFilm, Tonemap,
};

use crate::scenes;
use crate::terminal::{Show, Way};
use crate::values;

pub(crate) use convert::ConvertArguments;
pub(crate) use encoding::EncodingArguments;
pub(crate) use farm::{FarmArguments, Scheduler};
pub(crate) use film::{DevelopArguments, FilesArguments, KeepArguments, MergeArguments, ResumeArguments};
pub(crate) use inspect::{InspectArguments, Samples};
pub(crate) use memory::MemoryArguments;
pub(crate) use model::ModelArguments;
pub(crate) use series::SeriesArguments;
pub(crate) use variables::VariableArguments;
#[cfg(feature = "view")]
pub(crate) use view::ViewArguments;

const EXAMPLES: &str = "\
Examples:
  lookfrom render scene.toml                     render a scene to scene.png
  lookfrom render bunny.ply -o bunny.exr         render a bare model, framed and lit
  lookfrom inspect scene.toml 320 200            trace one sample of that pixel, step by step
  lookfrom render scene.pbrt -o p.exr --time 1m  as many samples per pixel as fit into a minute
  lookfrom resume a.exr --samples 4096           more samples for a picture that was rendered with --film
  lookfrom compare p.exr reference.exr           differences between a picture and its reference
  lookfrom info scene.toml                       contents of a scene
  lookfrom convert scene.pbrt -o scene.toml      the same scene as a text to edit

Exit codes:
  0    done
  1    a scene could not be read or is invalid, or a picture is too far from its reference
  2    wrong usage
  3    the output could not be written
  130  interrupted; the picture so far is written

Manual: docs/guide/command.md, scene files: docs/guide/scene-format.md";

const RENDER_SHORT_EXAMPLES: &str = "\
Examples:
  lookfrom render scene.toml -o picture.exr --samples 64
  lookfrom render model.glb --size 512 --floor --background transparent
  lookfrom render model.obj --lookfrom -3,2,5 --up z
  lookfrom render shop/ --size 256 -o thumbs/            all scenes and models of a folder
  lookfrom render scene.toml --watch --show

All options, and more about each: lookfrom render --help. Manual: docs/guide/command.md";

const RENDER_EXAMPLES: &str = "\
Examples:
  lookfrom render scene.toml -o picture.exr --samples 64
  lookfrom render model.obj --lookfrom -3,2,5 --up z
  lookfrom render model.glb --size 512 --floor --background transparent
  lookfrom render model.obj --up z --turntable 36 -o 'around/{name}.png'
  lookfrom render model.obj --views all --sheet 4x2 -o sides.png
  lookfrom render robot.glb --frames 0..48 -o 'walk/frame-####.png'
  lookfrom render robot.glb --frames 0..48 -o walk.gif
  lookfrom render robot.glb --frames 0..240 --format ppm -o - | ffmpeg -f image2pipe -framerate 24 -i - walk.mp4
  lookfrom render scene.toml -D radius=2 -D paint=tomato
  lookfrom render shop/ --size 256 -o thumbs/            all scenes and models of a folder
  lookfrom render a.toml b.toml -o pictures/             pictures/a.png, pictures/b.png
  lookfrom render */chair.obj -o 'out/{parent}.png'      out/oak.png, out/steel.png
  lookfrom render scene.toml -o - | display
  generate | lookfrom render - -o picture.png
  lookfrom render scene.toml --watch --show
  lookfrom render scene.pbrt --noise 0.02 --write-every 10s
  lookfrom render scene.pbrt --samples 16 --denoise
  lookfrom render scene.pbrt -o a.exr --film --checkpoint 30s     go on after any stop: lookfrom resume a.exr
  lookfrom render scene.pbrt -o part-3.exr --film --part 3/64     one of 64 machines: lookfrom merge part-*.exr

Ctrl-C finishes the tiles in progress and writes the picture so far; a second Ctrl-C exits at once.
Exit codes: 0 done, 1 scene, 2 usage, 3 output, 130 interrupted.";

const INFO_EXAMPLES: &str = "\
Examples:
  lookfrom info scene.toml
  lookfrom info models/*.ply --json | jq .triangles";

const COMPARE_EXAMPLES: &str = "\
Examples:
  lookfrom compare picture.exr reference.exr
  lookfrom compare a.exr a-ref.exr b.exr b-ref.exr --html report.html --tolerance 0.005 --within 0.99

Exit codes: 0 all pairs are within the tolerances, 1 one is not, or cannot be read, 2 usage, 3 output.";

const BENCH_EXAMPLES: &str = "\
Examples:
  lookfrom bench scenes/*.toml
  lookfrom bench scene.pbrt --time 10s --reference reference.exr --json";

const MAN_EXAMPLES: &str = "\
Examples:
  lookfrom man | man -l -
  lookfrom man render > ~/.local/share/man/man1/lookfrom-render.1";

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
    /// Render pictures of scenes and models
    #[command(after_help = RENDER_SHORT_EXAMPLES, after_long_help = RENDER_EXAMPLES)]
    Render(RenderArguments),
    /// Go on with a render that was stopped, or take more samples
    #[command(after_help = film::RESUME_EXAMPLES)]
    Resume(ResumeArguments),
    /// Add up films: parts of one picture, from any machines
    #[command(after_help = film::MERGE_EXAMPLES)]
    Merge(MergeArguments),
    /// Make pictures from films and other linear pictures, with another exposure, tone map or denoising, without rendering
    #[command(after_help = film::DEVELOP_EXAMPLES)]
    Develop(DevelopArguments),
    /// Write a scene or model of any format as a scene in our own, to edit: with meshes and pictures beside it, and the same picture
    #[command(after_help = convert::EXAMPLES)]
    Convert(ConvertArguments),
    /// List all files that scenes are read from
    Files(FilesArguments),
    /// Write the files by which a scheduler renders pictures on many machines: OpenJD, Slurm, Dask, HyperQueue
    #[command(after_help = farm::EXAMPLES)]
    Farm(FarmArguments),
    /// Trace samples of a pixel and show every step: intersections, BSDFs, light samples, throughput
    #[command(after_help = inspect::EXAMPLES)]
    Inspect(InspectArguments),
    /// Show a scene in the browser while it renders, and why every pixel is as it is
    #[cfg(feature = "view")]
    #[command(after_help = view::EXAMPLES)]
    View(ViewArguments),
    /// List the contents of scenes, models, pictures and films
    #[command(after_help = INFO_EXAMPLES)]
    Info(InfoArguments),
    /// Compare pictures with references: errors, noise, FLIP
    #[command(after_help = COMPARE_EXAMPLES)]
    Compare(CompareArguments),
    /// Measure rendering speed and remaining noise
    #[command(after_help = BENCH_EXAMPLES)]
    Bench(BenchArguments),
    /// Print the manual page of the command, or of one of its commands
    #[command(after_help = MAN_EXAMPLES)]
    Man {
        /// The command [default: lookfrom itself]
        command: Option<String>,
    },
    /// Print a completion script for a shell
    #[command(after_help = COMPLETIONS_EXAMPLES)]
    Completions {
        /// The shell
        shell: Shell,
    },
}

#[derive(Args, Debug)]
pub(crate) struct RenderArguments {
    #[arg(help = scenes::several(", folders of them, or - for one from stdin"), required = true, value_name = "SCENE")]
    pub(crate) scenes: Vec<PathBuf>,

    /// Output: a file (.png, .jpg, .webp, .exr, .hdr, .pfm, .ppm, .gif, .apng), a folder, a pattern with {name}, or - for stdout
    ///
    /// PNG, JPEG, WebP, PPM and GIF are sRGB after exposure and tone mapping; EXR, HDR and PFM are linear light as computed. Without
    /// this option: NAME.png in the current folder, named after the scene. For several scenes give a folder or a pattern, in which
    /// {name} is the scene's name without folder and extension, {dir} its folder as typed, {parent} the name of that folder,
    /// {n} its number in the call, from 1; {{ and }} are literal braces. Of several pictures of a scene, ### is the number with so
    /// many digits; without it .gif, .apng and .webp are animations. Missing folders are created. Input files of a scene are never
    /// overwritten.
    #[arg(short, long, value_name = "OUT")]
    pub(crate) output: Option<PathBuf>,

    #[command(flatten)]
    pub(crate) encoding: EncodingArguments,

    /// Time limit: stop after the pass over the picture that reaches it (60s, 500ms, 2m, 1h)
    ///
    /// Without --samples, there is no other limit. The picture is bit for bit that of --samples with the number of samples taken.
    #[arg(long, value_name = "TIME", value_parser = values::duration)]
    pub(crate) time: Option<Duration>,

    /// Adaptive sampling: stop when the picture's mean relative standard error is at most this, such as 0.02
    ///
    /// After 16 samples per pixel further ones go where noise is, by the variances of neighbouring pixels, until the limit is
    /// reached. Without --samples, there is no other limit; with it, no pixel gets more.
    #[arg(long, value_name = "ERROR", value_parser = values::between(1e-6f64, 1e6))]
    pub(crate) noise: Option<f64>,

    /// Write a preview (the picture so far) at this interval: 10s, 2m
    #[arg(long, value_name = "TIME", value_parser = values::duration)]
    pub(crate) write_every: Option<Duration>,

    /// Firefly filter: median spreads the excess of pixels that single samples make far too bright over their neighbours
    #[arg(long, value_name = "NAME", value_parser = values::word(values::FIREFLIES), default_value = "off")]
    pub(crate) fireflies: Fireflies,

    #[command(flatten)]
    pub(crate) several: SeriesArguments,

    #[command(flatten)]
    pub(crate) keep: KeepArguments,

    /// Render again when a file of the scenes changes, until Ctrl-C
    #[arg(long, conflicts_with = "skip_existing")]
    pub(crate) watch: bool,

    /// Draw each finished picture in the terminal (stderr), as it can: auto, or kitty, sixel, blocks [default with --watch: auto]
    ///
    /// auto concludes from the environment what the terminal can do: graphics of kitty, sixels, or half blocks in colour. It draws
    /// nothing where stderr is not a terminal.
    #[arg(long, value_name = "WAY", value_parser = values::word(Show::WORDS), num_args = 0..=1, default_missing_value = "auto")]
    pub(crate) show: Option<Show>,

    /// Print nothing but errors
    #[arg(short, long, conflicts_with = "verbose")]
    pub(crate) quiet: bool,

    /// Print also what each scene has, the settings as finally chosen, and the times of all steps; twice: the files, too
    #[arg(short, long, action = clap::ArgAction::Count)]
    pub(crate) verbose: u8,

    /// Write a summary of each scene to stdout, one JSON object per line
    #[arg(long)]
    pub(crate) json: bool,

    #[command(flatten)]
    pub(crate) common: Common,

    #[command(flatten)]
    pub(crate) overrides: Overrides,
}

impl RenderArguments {
    /// The way of drawing finished pictures in the terminal; `None` without drawing.
    pub(crate) fn way(&self) -> Option<Way> {
        let is_watched = self.watch && !self.quiet && self.output.as_deref() != Some(Path::new("-"));
        self.show.unwrap_or(if is_watched { Show::Auto } else { Show::Off }).way()
    }
}

#[derive(Args, Debug)]
pub(crate) struct InfoArguments {
    #[arg(help = scenes::several(", or pictures and films (.exr)"), required = true, value_name = "SCENE")]
    pub(crate) scenes: Vec<PathBuf>,

    /// Print one JSON object per line for each scene
    #[arg(long)]
    pub(crate) json: bool,

    #[command(flatten)]
    pub(crate) common: Common,

    #[command(flatten)]
    pub(crate) variables: VariableArguments,
}

#[derive(Args, Debug)]
pub(crate) struct CompareArguments {
    /// Pictures and their references, alternating; an .exr may contain variances
    #[arg(required = true, num_args = 2.., value_name = "PICTURE REFERENCE")]
    pub(crate) pictures: Vec<PathBuf>,

    /// Write an HTML report with the pictures, their differences and FLIP maps to this file
    #[arg(long, value_name = "FILE")]
    pub(crate) html: Option<PathBuf>,

    /// Layer of both pictures (.exr), by its name, in place of the finished picture; nothing is known of its noise
    #[arg(long, value_name = "NAME")]
    pub(crate) layer: Option<String>,

    /// Samples per pixel of picture and reference [default: as recorded in the files]
    #[arg(long, value_name = "N,M", value_parser = values::sample_counts)]
    pub(crate) samples: Option<[u64; 2]>,

    /// Sensor of the variances in pictures that do not record it: NAME, or NAME,KELVIN with its white balance
    ///
    /// Names are those of scene files: cie1931, canon_eos_5d_mkiv … Pictures of lookfrom record their sensor, those of pbrt do
    /// not. Without this option they are assumed to have the sensor of the other picture, or else cie1931 without a white
    /// balance.
    #[arg(long, value_name = "NAME", value_parser = values::sensor)]
    pub(crate) sensor: Option<Sensor>,

    /// Largest relative difference of a channel's mean from the reference's, unless noise explains more
    #[arg(long, value_name = "FRACTION", value_parser = values::between(0.0f64, 1e6))]
    pub(crate) tolerance: Option<f64>,

    /// Fraction of the pixels that must be within 3.5 standard errors
    #[arg(long, value_name = "FRACTION", value_parser = values::between(0.0f64, 1.0))]
    pub(crate) within: Option<f64>,

    /// Exposure in stops, for FLIP and the report
    #[arg(long, value_name = "STOPS", value_parser = values::between(-64.0f32, 64.0), allow_hyphen_values = true, default_value_t = 0.0)]
    pub(crate) exposure: f32,

    /// Print one JSON object per line for each pair
    #[arg(long)]
    pub(crate) json: bool,

    #[command(flatten)]
    pub(crate) memory: MemoryArguments,
}

#[derive(Args, Debug)]
pub(crate) struct BenchArguments {
    #[arg(help = scenes::several(""), required = true, value_name = "SCENE")]
    pub(crate) scenes: Vec<PathBuf>,

    /// Render for this time instead of 16 samples per pixel (or --samples): 10s, 2m
    #[arg(long, value_name = "TIME", value_parser = values::duration)]
    pub(crate) time: Option<Duration>,

    /// Converged reference picture; without it one is rendered
    #[arg(long, value_name = "FILE")]
    pub(crate) reference: Option<PathBuf>,

    /// Samples per pixel of the reference, where it is rendered
    #[arg(long, value_name = "N", default_value_t = 256, value_parser = values::whole(1u32, 1 << 24))]
    pub(crate) reference_samples: u32,

    /// Print one JSON object per line for each scene
    #[arg(long)]
    pub(crate) json: bool,

    #[command(flatten)]
    pub(crate) common: Common,

    #[command(flatten)]
    pub(crate) overrides: Overrides,
}

#[derive(Args, Clone, Copy, Debug)]
pub(crate) struct Common {
    /// Number of threads to build and render with [default: the number of processors]
    #[arg(long, value_name = "N", value_parser = values::whole(1u16, 1024))]
    pub(crate) threads: Option<u16>,

    /// Treat warnings as errors, except harmless ones (notes)
    #[arg(long)]
    pub(crate) strict: bool,

    #[command(flatten)]
    pub(crate) memory: MemoryArguments,
}

/// Settings of the scene that the command line overrides.
#[derive(Args, Clone, Debug, Default)]
pub(crate) struct Overrides {
    /// Width in pixels; alone it keeps the aspect ratio
    #[arg(long, value_name = "PIXELS", value_parser = values::whole(1, u32::MAX))]
    pub(crate) width: Option<u32>,

    /// Height in pixels; alone it keeps the aspect ratio
    #[arg(long, value_name = "PIXELS", value_parser = values::whole(1, u32::MAX))]
    pub(crate) height: Option<u32>,

    /// Crop window: render only columns X0 to X1 and rows Y0 to Y1 (X1 and Y1 excluded), from the top left
    #[arg(long, value_name = "X0,Y0,X1,Y1", value_parser = values::crop, allow_hyphen_values = true)]
    pub(crate) crop: Option<PixelBounds>,

    /// Samples per pixel; FROM..BEFORE are some of them by number, as a part of a picture, to be merged with others
    #[arg(long, value_name = "N|FROM..BEFORE", value_parser = values::samples)]
    pub(crate) samples: Option<Range<u32>>,

    /// Allocation of samples to pixels: uniform, or adaptive by the variances of a pilot, with --samples in the mean
    ///
    /// Adaptively every pixel gets half of the samples. Their variances decide which pixels get the other half, up to eight
    /// times --samples each: the light of a picture stays right in the mean, as a pixel does not decide about itself. It needs at
    /// least 8 samples per pixel.
    #[arg(long, value_name = "NAME", value_parser = values::word(Allocation::WORDS))]
    pub(crate) allocation: Option<Allocation>,

    /// Integrator (light transport algorithm); the last four show the first hit in false colours
    #[arg(long, value_name = "NAME", value_parser = values::word(Integrator::WORDS))]
    pub(crate) integrator: Option<Integrator>,

    /// Rendering in RGB, or spectral with four wavelengths per sample
    #[arg(long, value_name = "NAME", value_parser = values::word(ColorMode::WORDS))]
    pub(crate) color: Option<ColorMode>,

    /// Choice of one of many lights for next-event estimation: uniform, by power, or by a light tree (bvh)
    #[arg(long, value_name = "NAME", value_parser = values::word(LightSampler::WORDS))]
    pub(crate) light_sampler: Option<LightSampler>,

    /// Openings through which environments are sampled: those that lights name, or found by a pre-pass (auto)
    #[arg(long, value_name = "NAME", value_parser = values::word(Portals::WORDS))]
    pub(crate) portals: Option<Portals>,

    /// AOVs of an EXR besides the picture: geometry is albedo, normals, position, depth, uv and variance
    #[arg(long, value_name = "NAME", value_parser = values::word(Layers::WORDS))]
    pub(crate) layers: Option<Layers>,

    /// A layer of an EXR with the light that came on certain ways: a name and a light-path expression; may be repeated
    ///
    /// "direct=C<RD>[LB]" is light that came from lights to diffuse surfaces and from there to the camera. The notation is that
    /// of Open Shading Language; docs/guide/path-tracing.md explains it.
    #[arg(long, value_name = "NAME=EXPRESSION", value_parser = values::light_path)]
    pub(crate) light_path: Vec<LightPathLayer>,

    /// Cryptomattes of an EXR: masks of every object and material, by name, for compositors: object, material or both
    ///
    /// The layers CryptoObject and CryptoMaterial tell for each pixel the six names that cover most of it, and how much. Camera rays are
    /// traced once more for them, of at most 256 samples of a pixel.
    #[arg(long, value_name = "NAMES", value_delimiter = ',', value_parser = values::word(CryptomatteKind::WORDS))]
    pub(crate) cryptomatte: Vec<CryptomatteKind>,

    /// Spectral film: the light of this number of buckets of wavelengths as layers of an EXR; 0 for colours alone. It needs spectral
    /// light
    ///
    /// The channels S0.374,688nm ... are the mean spectral radiance of a bucket, by the wavelength in its middle, in the layout of
    /// Fichet, Pacanowski & Wilkie (2021). Wavelengths are sampled uniformly.
    #[arg(long, value_name = "N", value_parser = values::whole(0, SpectralFilm::MOST_BUCKETS))]
    pub(crate) spectral_buckets: Option<u32>,

    /// Range of wavelengths of a spectral film in nm, within 360,830: the picture shows only their light
    #[arg(long, value_name = "FROM,TO", value_parser = values::wavelengths)]
    pub(crate) wavelengths: Option<[f32; 2]>,

    /// Denoise the picture (alone: on) [default: the scene's setting; on for models]
    ///
    /// An EXR then also contains the noisy picture in the channels noisy.R, noisy.G and noisy.B; AOVs and variances are those
    /// of the noisy picture. Previews of --write-every are not denoised.
    #[arg(long, value_name = "on|off", value_parser = values::word(values::ON_OFF), num_args = 0..=1, default_missing_value = "on")]
    pub(crate) denoise: Option<bool>,

    /// Maximum path depth: the number of reflections, refractions and scatterings
    #[arg(long, value_name = "N", value_parser = values::whole(0u32, 256))]
    pub(crate) depth: Option<u32>,

    /// Throughput (fraction of the pixel) below which a branch of the ray tree is cut off
    #[arg(long, value_name = "FRACTION", value_parser = values::between(0.0f32, 1.0), allow_hyphen_values = true)]
    pub(crate) min_contribution: Option<f32>,

    /// Sampler: Owen-scrambled Sobol' points, or independent random numbers
    #[arg(long, value_name = "NAME", value_parser = values::word(Sampler::WORDS))]
    pub(crate) sampler: Option<Sampler>,

    /// Seed of the random numbers: another seed gives other noise
    #[arg(long, value_name = "N", value_parser = values::whole(0, u64::MAX))]
    pub(crate) seed: Option<u64>,

    /// Pixel reconstruction filter: box, triangle, gaussian, mitchell, blackman_harris or sinc, and its radius in pixels, or along x and y: box:1:0.5
    #[arg(long, value_name = "NAME[:RADIUS]", value_parser = values::filter)]
    pub(crate) filter: Option<Filter>,

    /// Exposure in stops, for pictures that screens show, or auto [default for models with lights of their own: auto]
    #[arg(long, value_name = "STOPS|auto", value_parser = values::exposure, allow_hyphen_values = true)]
    pub(crate) exposure: Option<Exposure>,

    /// Tone map from linear light to 8 bits
    #[arg(long, value_name = "NAME", value_parser = values::word(Tonemap::WORDS))]
    pub(crate) tonemap: Option<Tonemap>,

    /// Position of the camera
    #[arg(long, value_name = "X,Y,Z", value_parser = values::vector, allow_hyphen_values = true)]
    pub(crate) lookfrom: Option<DVec3>,

    /// Point that the camera looks at
    #[arg(long, value_name = "X,Y,Z", value_parser = values::vector, allow_hyphen_values = true)]
    pub(crate) lookat: Option<DVec3>,

    /// Up vector of the camera, and of a model's studio and floor: an axis (z, -y) or any direction [default for STL and HAIR: z]
    #[arg(long, value_name = "AXIS|X,Y,Z", value_parser = values::direction, allow_hyphen_values = true)]
    pub(crate) up: Option<DVec3>,

    /// Vertical field of view in degrees
    #[arg(long, value_name = "DEGREES", value_parser = values::field_of_view, allow_hyphen_values = true)]
    pub(crate) fov: Option<f64>,

    #[command(flatten)]
    pub(crate) model: ModelArguments,

    #[command(flatten)]
    pub(crate) variables: VariableArguments,
}
