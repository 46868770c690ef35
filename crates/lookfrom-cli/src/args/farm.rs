//! Arguments of `lookfrom farm`.
//!
//! The doc comments here are the help texts.

use std::ops::Range;
use std::path::PathBuf;

use clap::Args;
use lookfrom::session::Series;

use super::{MemoryArguments, Overrides};
use crate::scenes;
use crate::values;

pub(super) const EXAMPLES: &str = "\
Examples:
  lookfrom farm slurm scene.pbrt --parts 64 --samples 4096 -o /shared/job && sh /shared/job/submit.sh
  lookfrom farm openjd scene.toml --parts 16 -o job
  lookfrom farm hyperqueue chair.glb --turntable 120 --parts 1 --floor -o job
  lookfrom farm dask robot.glb --frames 0..48 --fps 24 --parts 4 -o job

Each ends in pictures with the same bytes as those of one machine. Guide: docs/guide/farm.md";

/// A scheduler that we write files for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Scheduler {
    /// Open Job Description: AWS Deadline Cloud, and `openjd run`.
    OpenJd,
    /// Slurm: an array job and a dependent merge.
    Slurm,
    /// Dask's `distributed`.
    Dask,
    /// HyperQueue, on its own or inside Slurm and PBS.
    HyperQueue,
}

impl Scheduler {
    /// The words for them.
    pub(crate) const WORDS: &'static [(&'static str, Self)] = &[
        ("openjd", Self::OpenJd),
        ("slurm", Self::Slurm),
        ("dask", Self::Dask),
        ("hyperqueue", Self::HyperQueue),
    ];
}

#[derive(Args, Debug)]
pub(crate) struct FarmArguments {
    /// Scheduler to write files for
    #[arg(value_name = "SCHEDULER", value_parser = values::word(Scheduler::WORDS))]
    pub(crate) scheduler: Scheduler,

    #[arg(help = scenes::one(), value_name = "SCENE")]
    pub(crate) scene: PathBuf,

    /// Folder of the job, which all machines share: scripts, parts and pictures
    #[arg(short, long, value_name = "FOLDER")]
    pub(crate) output: PathBuf,

    /// Number of parts of each picture; --samples should be a multiple of it
    #[arg(long, value_name = "N", default_value_t = 16, value_parser = values::whole(1u32, 100_000))]
    pub(crate) parts: u32,

    /// This many pictures, evenly around the scene, as lookfrom render --turntable
    #[arg(long, value_name = "N", value_parser = values::whole(1u32, 100_000), conflicts_with = "bounds")]
    pub(crate) turntable: Option<u32>,

    /// Frames of the animations of the scene or model, FROM..BEFORE, as lookfrom render --frames
    #[arg(long, value_name = "FROM..BEFORE", value_parser = values::frames, conflicts_with_all = ["turntable", "at"])]
    pub(crate) frames: Option<Range<u32>>,

    #[command(flatten)]
    pub(crate) memory: MemoryArguments,

    #[command(flatten)]
    pub(crate) overrides: Overrides,
}

impl FarmArguments {
    /// The pictures of the scene.
    pub(crate) fn series(&self) -> Series {
        let fps = self.overrides.variables.fps;
        match (self.turntable, &self.frames) {
            (Some(count), _) => Series::Turntable(count),
            (None, Some(frames)) => Series::Frames { frames: frames.clone(), fps },
            (None, None) => Series::One,
        }
    }
}
