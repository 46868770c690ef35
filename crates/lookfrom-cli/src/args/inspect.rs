//! Options of `lookfrom inspect`. The doc comments are the help texts.

use std::ops::Range;
use std::path::PathBuf;

use clap::Args;
use lookfrom::inspect::{SvgView, TextPart};

use super::{Common, Overrides};
use crate::scenes;
use crate::values;

/// The parts of the text.
const PARTS: &[(&str, TextPart)] = &[
    ("camera", TextPart::Camera),
    ("tests", TextPart::Tests),
    ("lights", TextPart::Lights),
    ("sums", TextPart::Sums),
];

pub(super) const EXAMPLES: &str = "\
Examples:
  lookfrom inspect scene.toml 320 200
  lookfrom inspect scene.toml 320 200 --sample 5 --json
  lookfrom inspect scene.toml 320 200 --sample all       all samples of the pixel in short, the brightest first
  lookfrom inspect scene.toml 320 200 --sample worst     every step of the brightest
  lookfrom inspect scene.toml 320 200 --ray 3 --only lights
  lookfrom inspect scene.toml 320 200 --svg rays.svg
  lookfrom inspect scene.toml 320 200 --svg rays.svg --svg-view side

Give the same options as for the render: they determine the rays of the sample.";

#[derive(Args, Debug)]
pub(crate) struct InspectArguments {
    #[arg(help = scenes::one(), value_name = "SCENE")]
    pub(crate) scene: PathBuf,

    /// Column of the pixel, counted from 0 at the left
    #[arg(value_name = "X", value_parser = values::whole(0, u32::MAX))]
    pub(crate) x: u32,

    /// Row of the pixel, counted from 0 at the top
    #[arg(value_name = "Y", value_parser = values::whole(0, u32::MAX))]
    pub(crate) y: u32,

    /// Index of the sample in the pixel, from 0; worst (the brightest); several in short, brightest first: all or N..M
    ///
    /// `all` and `N..M` (M excluded) show colour, mean and variance of the pixel, its largest contributions, and a line for
    /// each sample. `N` and `worst` show every step of one sample.
    #[arg(long, value_name = "N|worst|all|N..M", default_value = "0", value_parser = Samples::parse)]
    pub(crate) sample: Samples,

    /// Show only the ray with this number
    #[arg(long, value_name = "N", value_parser = values::whole(1, u64::MAX))]
    pub(crate) ray: Option<u64>,

    /// Show only the rays after this many reflections, refractions and bounces; 0 is the camera ray
    #[arg(long, value_name = "N", value_parser = values::whole(0, u32::MAX))]
    pub(crate) bounce: Option<u32>,

    /// Show only a part: camera, tests (of primitives), lights, sums
    #[arg(long, value_name = "PART", value_parser = values::word(PARTS))]
    pub(crate) only: Option<TextPart>,

    /// Print one JSON object instead of text; it always has everything
    #[arg(long)]
    pub(crate) json: bool,

    /// Also draw the rays into this SVG file
    #[arg(long, value_name = "FILE")]
    pub(crate) svg: Option<PathBuf>,

    /// The views that it has: a sheet of all, side, top, front (from behind the camera), camera
    #[arg(long, value_name = "VIEW", requires = "svg", value_parser = values::word(SvgView::WORDS))]
    pub(crate) svg_view: Option<SvgView>,

    #[command(flatten)]
    pub(crate) common: Common,

    #[command(flatten)]
    pub(crate) overrides: Overrides,
}

/// The samples to inspect.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Samples {
    /// One, by its number.
    One(u32),
    /// The brightest.
    Worst,
    /// All samples of the picture.
    All,
    /// Some of them.
    Range(Range<u32>),
}

impl Samples {
    fn parse(typed: &str) -> Result<Self, String> {
        const EXPECTED: &str = "expected the number of a sample, worst, all, or a range such as 0..16";
        let whole = values::whole(0, u32::MAX - 1);
        match (typed, typed.split_once("..")) {
            ("worst", _) => Ok(Self::Worst),
            ("all", _) => Ok(Self::All),
            (_, None) => whole(typed).map(Self::One).map_err(|_| EXPECTED.into()),
            (_, Some((start, end))) => match (whole(start), whole(end)) {
                (Ok(start), Ok(end)) if start < end => Ok(Self::Range(start..end)),
                (Ok(start), Ok(_)) => Err(format!("expected an end of the range that is above {start}")),
                _ => Err(EXPECTED.into()),
            },
        }
    }
}
