//! The whole way in a few lines: a scene file to a PNG file.
//!
//! `cargo run --release -p lookfrom --example picture -- scenes/hero.toml hero.png`

use std::error::Error;
use std::path::Path;

use lookfrom::develop;
use lookfrom::render::Frame;
use lookfrom::world::World;
use lookfrom_scene::{Disk, Sources, image, load, studio};

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let (Some(scene_file), Some(picture_file)) = (arguments.next(), arguments.next()) else {
        return Err("usage: picture SCENE PICTURE.png".into());
    };
    let mut sources = Sources::new(&Disk);
    let mut scene = load::scene(Path::new(&scene_file), &mut sources)?;
    studio::furnish(&mut scene, None);
    let (image_settings, render_settings) = (scene.image.clone(), scene.render.clone());

    let world = World::compile(scene, &mut sources.warnings)?;
    let rendered = Frame::new(&world, &image_settings, &render_settings)?.render(None, &())?;

    let picture = rendered.film.picture();
    let pixels = develop::srgb8(&picture, image_settings.exposure, image_settings.tonemap);
    std::fs::write(picture_file, image::encode_png(picture.width, picture.height, &pixels)?)?;
    Ok(())
}
