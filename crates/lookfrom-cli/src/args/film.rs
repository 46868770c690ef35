//! Arguments about films: keeping them, going on with them, adding and developing them.
//!
//! The doc comments here are the help texts.

use std::path::PathBuf;
use std::time::Duration;

use clap::Args;
use lookfrom::session::{Exposure, Fireflies};
use lookfrom_scene::settings::{Background, Tonemap};

use super::{Common, EncodingArguments, MemoryArguments, VariableArguments};
use crate::scenes;
use crate::values;

pub(super) const RESUME_EXAMPLES: &str = "\
Examples:
  lookfrom resume a.exr                     the rest of a render that was stopped
  lookfrom resume a.exr --samples 4096      more: 4096 samples per pixel in all
  lookfrom resume a.exr --time 1h -o b.exr

The film is the same, byte for byte, as that of one render with as many samples.
Exit codes: as for render.";

pub(super) const MERGE_EXAMPLES: &str = "\
Examples:
  lookfrom merge part-*.exr -o whole.exr
  lookfrom merge part-*.exr --check         names of damaged files, to be rendered again

The film is the same, byte for byte, as that of one render, whatever the parts and their order.
Exit codes: 0 done, 1 a file is damaged or of another picture, 2 usage, 3 output.";

pub(super) const DEVELOP_EXAMPLES: &str = "\
Examples:
  lookfrom develop a.exr -o a.png --exposure 1 --tonemap agx
  lookfrom develop a.exr -o b.exr --denoise
  lookfrom develop *.exr -o 'png/{name}.png'";

/// Keeping the film of a render in a file.
#[derive(Args, Clone, Debug, Default)]
pub(crate) struct KeepArguments {
    /// Keep the film: the EXR also holds the exact sums of the samples, to go on with (resume), add up (merge) and develop
    #[arg(long)]
    pub(crate) film: bool,

    /// Write the film so far at this interval, so that no stop loses more [default with --film: 1m]
    #[arg(long, value_name = "TIME", value_parser = values::duration, requires = "film")]
    pub(crate) checkpoint: Option<Duration>,

    /// Go on with the film if the output exists already; a damaged one is rendered again
    #[arg(long = "continue", requires = "film")]
    pub(crate) go_on: bool,

    /// Render only part I of N of the samples, such as 1/64, to be merged with the others
    ///
    /// Parts are ranges of samples of the whole picture, since these take nearly the same time whatever the picture shows.
    #[arg(long, value_name = "I/N", value_parser = values::part)]
    pub(crate) part: Option<[u32; 2]>,
}

#[derive(Args, Debug)]
pub(crate) struct ResumeArguments {
    /// The film of a render with --film
    #[arg(value_name = "FILM")]
    pub(crate) film: PathBuf,

    /// Output (.exr) [default: the film itself]
    #[arg(short, long, value_name = "OUT")]
    pub(crate) output: Option<PathBuf>,

    /// Samples per pixel in all [default: as many as the render was to have]
    #[arg(long, value_name = "N", value_parser = values::whole(1u32, 1 << 24))]
    pub(crate) samples: Option<u32>,

    /// Stop after the pass over the picture that reaches this time: 60s, 1h
    #[arg(long, value_name = "TIME", value_parser = values::duration)]
    pub(crate) time: Option<Duration>,

    /// Adaptive sampling: stop when the picture's mean relative standard error is at most this
    ///
    /// With a limit other than that of the film, single tiles may get other numbers of samples than in one render.
    #[arg(long, value_name = "ERROR", value_parser = values::between(1e-6f64, 1e6))]
    pub(crate) noise: Option<f64>,

    /// Write the film so far at this interval [default: 1m]
    #[arg(long, value_name = "TIME", value_parser = values::duration)]
    pub(crate) checkpoint: Option<Duration>,

    /// The scene, if it is not where it was
    #[arg(long, value_name = "SCENE")]
    pub(crate) scene_file: Option<PathBuf>,

    /// The environment map of the render's --environment, if it is not where it was
    #[arg(long, value_name = "FILE")]
    pub(crate) environment: Option<PathBuf>,

    /// Print nothing but errors
    #[arg(short, long)]
    pub(crate) quiet: bool,

    /// Write a summary to stdout as a JSON object
    #[arg(long)]
    pub(crate) json: bool,

    #[command(flatten)]
    pub(crate) common: Common,
}

#[derive(Args, Debug)]
pub(crate) struct MergeArguments {
    /// Films of parts of one picture, in any order
    #[arg(required = true, value_name = "FILM")]
    pub(crate) films: Vec<PathBuf>,

    /// Output (.exr): the film of all
    #[arg(short, long, value_name = "OUT", required_unless_present = "check")]
    pub(crate) output: Option<PathBuf>,

    /// Write nothing, but print the names of films that are missing, damaged or of another picture, a line each
    #[arg(long, conflicts_with = "output")]
    pub(crate) check: bool,

    /// Print nothing but errors
    #[arg(short, long)]
    pub(crate) quiet: bool,

    #[command(flatten)]
    pub(crate) memory: MemoryArguments,
}

#[derive(Args, Debug)]
pub(crate) struct DevelopArguments {
    /// Films, or other pictures of linear light (.exr, .hdr, .pfm)
    #[arg(required = true, value_name = "PICTURE")]
    pub(crate) pictures: Vec<PathBuf>,

    /// Output: a file (.png, .apng, .gif, .jpg, .webp, .exr, .hdr, .pfm, .ppm), a folder or a pattern with {name}, as for render
    #[arg(short, long, value_name = "OUT")]
    pub(crate) output: Option<PathBuf>,

    #[command(flatten)]
    pub(crate) encoding: EncodingArguments,

    /// Layer of an .exr, by its name, in place of the finished picture: a light path, an AOV, a part of another program's file
    #[arg(long, value_name = "NAME", conflicts_with_all = ["denoise", "fireflies"])]
    pub(crate) layer: Option<String>,

    /// Exposure in stops, or by what the picture shows (auto), for pictures that screens show [default: the film's, or 0]
    #[arg(long, value_name = "STOPS|auto", value_parser = values::exposure, allow_hyphen_values = true)]
    pub(crate) exposure: Option<Exposure>,

    /// Tone map from linear light to what a screen shows [default: the film's, or clamp]
    #[arg(long, value_name = "NAME", value_parser = values::word(Tonemap::WORDS))]
    pub(crate) tonemap: Option<Tonemap>,

    /// Denoise the picture of a film (alone: on) [default: as the film was rendered]
    ///
    /// A film that was rendered without denoising has no first hits of its samples: then light alone guides the denoiser.
    #[arg(long, value_name = "on|off", value_parser = values::word(values::ON_OFF), num_args = 0..=1, default_missing_value = "on")]
    pub(crate) denoise: Option<bool>,

    /// Firefly filter of a film: off or median [default: as the film was rendered]
    #[arg(long, value_name = "NAME", value_parser = values::word(values::FIREFLIES))]
    pub(crate) fireflies: Option<Fireflies>,

    /// Background of a picture with alpha: transparent, white, black or #rrggbb
    #[arg(long, value_name = "BACKGROUND", value_parser = values::background)]
    pub(crate) background: Option<Background>,

    #[command(flatten)]
    pub(crate) memory: MemoryArguments,
}

#[derive(Args, Debug)]
pub(crate) struct FilesArguments {
    #[arg(help = scenes::several(""), required = true, value_name = "SCENE")]
    pub(crate) scenes: Vec<PathBuf>,

    /// End names with a zero byte in place of a new line: lookfrom files scene.pbrt -0 | tar --null -T - -cf scene.tar
    #[arg(short = '0', long)]
    pub(crate) null: bool,

    /// Print one JSON object per line for each file: its path and SHA-256
    #[arg(long, conflicts_with = "null")]
    pub(crate) json: bool,

    #[command(flatten)]
    pub(crate) variables: VariableArguments,

    #[command(flatten)]
    pub(crate) memory: MemoryArguments,
}
