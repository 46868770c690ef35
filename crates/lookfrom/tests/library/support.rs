//! What the tests of this crate share: scenes written in the test, and short ways to a picture.

pub(crate) mod forms;

use std::path::{Path, PathBuf};
use std::sync::Arc;

use lookfrom::film::Film;
use lookfrom::render::{Rendered, Renderer};
use lookfrom::view::View;
use lookfrom::world::World;
use lookfrom_scene::{LoadContext, Memory, Scene};

/// The scene that a TOML text means.
pub(crate) fn scene(toml: &str) -> Scene {
    let name = PathBuf::from("test.toml");
    let files = Memory([(name.clone(), toml.as_bytes().to_vec())].into());
    lookfrom_scene::load::scene(&name, &mut LoadContext::new(&files))
        .unwrap_or_else(|error| panic!("{error}"))
}

/// Settings of a small path-traced picture in TOML; what follows adds to `[render]`.
pub(crate) const SMALL: &str = r#"
        [image]
        width = 8
        height = 8
        filter = "box"
        [render]
        integrator = "path""#;

/// A scene from the repository's `scenes/`.
pub(crate) fn own_scene(name: &str) -> Scene {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes").join(name);
    let mut context = LoadContext::new(&lookfrom_scene::Disk);
    lookfrom_scene::load::scene(&path, &mut context).unwrap_or_else(|error| panic!("{error}"))
}

/// A scene with the settings that its frame needs.
pub(crate) struct Compiled {
    /// What light meets.
    pub(crate) world: Arc<World>,
    view: View,
    render: lookfrom_scene::settings::RenderSettings,
}

impl Compiled {
    /// Compiles a scene.
    pub(crate) fn new(scene: Scene) -> Self {
        let render = scene.render.clone();
        let view = View::of_scene(&scene).unwrap_or_else(|error| panic!("{error}"));
        let world = World::compile(scene, &mut Vec::new()).unwrap_or_else(|error| panic!("{error}"));
        Self { world: Arc::new(world), view, render }
    }

    /// The renderer.
    pub(crate) fn renderer(&self) -> Renderer {
        Renderer::new(self.world.clone(), self.view.clone(), self.render.clone())
            .unwrap_or_else(|error| panic!("{error}"))
    }

    /// Renders on a number of threads.
    pub(crate) fn render(&self, threads: usize) -> Rendered {
        self.renderer().render(Some(threads), &()).unwrap_or_else(|error| panic!("{error}"))
    }

    /// Renders.
    pub(crate) fn film(&self) -> Film {
        self.render(2).film
    }
}

/// Whether two colours differ by at most `tolerance` in every channel.
pub(crate) fn close(a: [f32; 3], b: [f32; 3], tolerance: f32) -> bool {
    a.iter().zip(b).all(|(a, b)| (a - b).abs() <= tolerance)
}
