//! Rendering a scene or model file to a picture file.
//!
//! `cargo run --release -p lookfrom --example picture -- scenes/hero.toml hero.png`

use std::error::Error;
use std::path::Path;

use lookfrom::session::{Format, Options, Session};

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let (Some(scene), Some(picture)) = (arguments.next(), arguments.next()) else {
        return Err("usage: picture SCENE PICTURE.{png,exr,hdr,pfm,ppm}".into());
    };
    let format =
        Format::of_path(Path::new(&picture)).ok_or("the picture's extension is of no known format")?;
    let session = Session::open(&scene, &Options { format: Some(format), ..Options::default() })?;
    session.warnings().iter().for_each(|warning| eprintln!("warning: {warning}"));
    session.render(&())?.save(&picture)?;
    Ok(())
}
