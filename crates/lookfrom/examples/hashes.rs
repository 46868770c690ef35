//! Hashes of small pictures, to compare machines: one line for each scene. No threads, no session, so that it runs in WebAssembly.
//!
//! `cargo run --release -p lookfrom --no-default-features --example hashes -- scenes/*.toml`

use std::error::Error;
use std::path::Path;
use std::sync::Arc;

use lookfrom::film::Film;
use lookfrom::render::Renderer;
use lookfrom::view::View;
use lookfrom::world::World;
use lookfrom_scene::{Disk, LoadContext, load};

/// The sums of a scene's film, 48 pixels wide, with two samples for each pixel.
fn film(scene: &Path) -> Result<Film, Box<dyn Error>> {
    let mut scene = load::scene(scene, &mut LoadContext::new(&Disk))?;
    (scene.image.width, scene.image.height, scene.image.crop) = (48, 32, None);
    scene.render.samples = 2;
    let (view, settings) = (View::of_scene(&scene)?, scene.render.clone());
    let world = World::compile(scene, &mut Vec::new())?;
    Ok(Renderer::new(Arc::new(world), view, settings)?.render(Some(1), &())?.film)
}

fn main() -> Result<(), Box<dyn Error>> {
    for scene in std::env::args().skip(1) {
        println!("{} {scene}", film(Path::new(&scene))?.hash());
    }
    Ok(())
}
