//! Thumbnails of many models in one process; an error in one does not stop the others.
//!
//! `cargo run --release -p lookfrom --example thumbnails -- thumbnails/ scenes/models/*.obj scenes/models/*.ply`

use std::error::Error;
use std::path::Path;

use lookfrom::session::{Format, Options, Session};

fn thumbnail(model: &Path, folder: &Path) -> Result<(), Box<dyn Error>> {
    let options = Options { width: Some(160), height: Some(120), ..Options::default() };
    let bytes = Session::open(model, &options)?.render(&())?.encode(Format::Png)?;
    let name = model.file_stem().ok_or("a model without a name")?;
    std::fs::write(folder.join(name).with_extension("png"), bytes)?;
    Ok(())
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let folder = arguments.next().ok_or("usage: thumbnails FOLDER MODEL…")?;
    std::fs::create_dir_all(&folder)?;
    for model in arguments {
        if let Err(error) = thumbnail(Path::new(&model), Path::new(&folder)) {
            eprintln!("{model}: {error}");
        }
    }
    Ok(())
}
