//! Arguments of `view`.

use std::net::IpAddr;
use std::path::PathBuf;

use clap::Args;

use super::{Common, Overrides};
use crate::scenes;
use crate::values;

pub(crate) const EXAMPLES: &str = "\
Examples:
  lookfrom view scene.toml --open
  lookfrom view bunny.ply --size 960x540
  lookfrom view scene.pbrt --reference reference.exr
  lookfrom view scene.toml --export handout.html --pixel 120,240
  ssh -L 8000:localhost:8000 machine lookfrom view scene.toml --port 8000     from another machine

The first line of the output is the address of the page, with a token: who has it sees the scene.
Ctrl-C ends the server. Exit codes: 130 interrupted, 1 scene, 2 usage, 3 the port cannot be had, or the page not be written; 0 with --export.";

#[derive(Args, Debug)]
pub(crate) struct ViewArguments {
    #[arg(help = scenes::one(), value_name = "SCENE")]
    pub(crate) scene: PathBuf,

    /// Port of the server; 0 for any that is free
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub(crate) port: u16,

    /// Address of the server, where others shall reach it: 0.0.0.0, or one of this machine's [default: 127.0.0.1]
    #[arg(long, value_name = "ADDRESS")]
    pub(crate) host: Option<IpAddr>,

    /// Open the page in the browser
    #[arg(long)]
    pub(crate) open: bool,

    /// Picture to compare with: side by side, difference, FLIP, standard errors
    #[arg(long, value_name = "FILE")]
    pub(crate) reference: Option<PathBuf>,

    /// Write a hand-out instead: a page as a single file (.html; otherwise index.html in this folder) that opens without a server, with the
    /// picture and one pixel
    #[arg(long, value_name = "PAGE", conflicts_with_all = ["port", "host", "open", "reference"])]
    pub(crate) export: Option<PathBuf>,

    /// The pixel of the hand-out, from the top left [default: the middle]
    #[arg(long, value_name = "X,Y", requires = "export", value_parser = values::pixel)]
    pub(crate) pixel: Option<[u32; 2]>,

    /// The sample of the pixel that the hand-out shows first [default: the brightest]; it holds the rays of 8, the brightest
    #[arg(long, value_name = "N", requires = "export")]
    pub(crate) sample: Option<u32>,

    #[command(flatten)]
    pub(crate) common: Common,

    #[command(flatten)]
    pub(crate) overrides: Overrides,
}
