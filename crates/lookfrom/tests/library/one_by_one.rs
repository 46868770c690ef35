//! Steps eight at a time and one by one: the same samples, numbers of rays and events.

use std::path::{Path as FilePath, PathBuf};

use crate::light_paths::layer;
use crate::same_bits::small;
use crate::support::{Compiled, scene};
use lookfrom::integrator::{
    Event, Integrator as Transport, LightSampling, Path, PathTracer, Probe, RayTree, SampleStream,
    ShadowTransparency, StepOutput, Whitted,
};
use lookfrom::render::SampleId;
use lookfrom::world::World;
use lookfrom_bvh::Hit;
use lookfrom_scene::settings::{ColorMode, Integrator, Layers, RenderSettings};
use lookfrom_scene::{Disk, LoadContext, Scene, load};
use lookfrom_test_data::shared;

/// A room of flat, diffuse triangles; lights of every kind, one at a time or all together.
fn room(lights: &[&str], settings: &str) -> Scene {
    const WALLS: &str = r#"
        [image]
        width = 48
        height = 40
        [camera]
        lookfrom = [0, 0, 3.5]
        lookat = [0, 0, 0]
        up = [0, 1, 0]
        fov = 45
        [materials]
        white = { type = "diffuse", reflectance = [0.75, 0.75, 0.75] }
        red = { type = "diffuse", reflectance = [0.6, 0.05, 0.1] }
        black = { type = "diffuse", reflectance = [0, 0, 0] }
        [[mesh]]
        material = "white"
        positions = [[-1, -1, 1], [1, -1, 1], [1, -1, -1], [-1, -1, -1], [1, 1, -1], [-1, 1, -1]]
        triangles = [[0, 1, 2], [0, 2, 3], [3, 2, 4], [3, 4, 5]]
        [[mesh]]
        material = "red"
        positions = [[-1, -1, 1], [-1, -1, -1], [-1, 1, -1], [-1, 1, 1]]
        triangles = [[0, 1, 2], [0, 2, 3]]
        [[mesh]]
        material = "black"
        positions = [[0.2, -0.9, 0], [0.8, -0.9, 0], [0.5, -0.3, 0.1]]
        triangles = [[0, 1, 2]]
    "#;
    let mut scene = scene(&format!("{WALLS}{}", lights.join("\n")));
    scene.render.integrator = Integrator::Path;
    scene.render.samples = 2;
    scene.render.depth = 7;
    if settings == "independent" {
        scene.render.sampler = lookfrom_scene::settings::Sampler::Independent;
    }
    if settings == "spectral" {
        scene.render.color = ColorMode::Spectral;
    }
    scene
}

/// An integrator without its steps in lanes: the slow, obviously right twin.
#[derive(Debug)]
struct OneByOne<I>(I);

impl<I: Transport> Transport for OneByOne<I> {
    type State = I::State;

    fn name(&self) -> &'static str {
        "one by one"
    }

    fn shadow_transparency(&self) -> ShadowTransparency {
        self.0.shadow_transparency()
    }

    fn step<P: Probe>(
        &self,
        world: &World,
        stream: &SampleStream,
        path: &Path<I::State>,
        hit: &Hit,
        output: &mut StepOutput<'_, P, I::State>,
    ) {
        self.0.step(world, stream, path, hit, output);
    }
}

#[test]
fn steps_eight_at_once_are_steps_one_by_one() {
    const LAMP: &str = r#"
        [materials.glow]
        diffuse = 0
        emission = [9, 8, 6]
        [[mesh]]
        material = "glow"
        positions = [[-0.3, 0.98, -0.3], [0.3, 0.98, -0.3], [0.3, 0.98, 0.3], [-0.3, 0.98, 0.3]]
        triangles = [[0, 1, 2], [0, 2, 3]]
    "#;
    const BULB: &str =
        "[[light]]\ntype = \"sphere\"\ncenter = [0.6, 0.5, 0]\nradius = 0.1\nradiance = [5, 5, 9]";
    const POINT: &str =
        "[[light]]\ntype = \"point\"\nposition = [0.2, 0.5, 0.6]\nintensity = [0.5, 0.4, 0.3]";
    const SUN: &str = "[[light]]\ntype = \"distant\"\nfrom = [-0.3, 1, 0.5]\nintensity = [0.5, 0.5, 0.4]";
    const SKY: &str =
        "[[light]]\ntype = \"environment\"\nzenith = [0.3, 0.4, 0.9]\nhorizon = 0.5\nnadir = 0.1";
    for lights in [&[LAMP][..], &[POINT], &[SUN], &[SKY], &[BULB], &[LAMP, BULB, POINT, SUN, SKY]] {
        for settings in ["", "independent", "spectral"] {
            let lit =
                lit_as_one_by_one(room(lights, settings), path_tracer, &format!("{lights:?} {settings}"));
            assert!(lit > 600, "{lit} samples see light of {lights:?}");
        }
    }
}

/// Path tracing by the settings of a scene.
fn path_tracer(settings: &RenderSettings) -> PathTracer {
    let &RenderSettings { depth, regularize, thin_passages_count, .. } = settings;
    PathTracer { depth, regularize, thin_passages_count, light_sampling: LightSampling::MultipleImportance }
}

/// Whitted's ray tracing by the settings of a scene.
pub(crate) fn whitted(settings: &RenderSettings) -> Whitted {
    let &RenderSettings { depth, min_contribution, transparent_shadows, .. } = settings;
    Whitted { tree: Some(RayTree { depth, min_contribution }), transparent_shadows }
}

/// Asserts that samples of a scene are those of an integrator's steps one by one, and so is what they tell. Returns how many see light.
pub(crate) fn lit_as_one_by_one<I: Transport + 'static>(
    scene: Scene,
    integrator: impl FnOnce(&RenderSettings) -> I,
    of: &str,
) -> usize {
    let [width, height] = [scene.image.width, scene.image.height];
    let scalar = OneByOne(integrator(&scene.render));
    let renderer = Compiled::new(scene).renderer();
    let pixels = (0..height).flat_map(|y| (0..width).map(move |x| [x, y]));
    let ids: Vec<SampleId> = pixels.map(|pixel| SampleId { pixel, sample: 1 }).collect();
    let (in_lanes, rays) = renderer.trace(&ids);
    let scalar = renderer.clone().with_integrator(scalar);
    let (one_by_one, same_rays) = scalar.trace(&ids);
    assert_eq!(rays, same_rays, "{of}");
    for (a, b) in in_lanes.iter().zip(&one_by_one) {
        assert!(a.radiance.0.iter().all(|lane| lane.is_finite()), "{of}: {:?}", a.radiance);
        assert_eq!(a.radiance, b.radiance, "{of}");
    }
    // A watched sample takes the same steps and tells the same of each.
    for id in ids.iter().step_by(97) {
        let (mut events, mut expected) = (Vec::new(), Vec::new());
        let (watched, _) = renderer.trace_events(&[*id], &mut events);
        scalar.trace_events(&[*id], &mut expected);
        assert_eq!(format!("{events:?}"), format!("{expected:?}"), "{of} {id:?}");
        let unwatched = &in_lanes[(id.pixel[1] * width + id.pixel[0]) as usize];
        assert_eq!(watched[0].radiance, unwatched.radiance);
    }
    in_lanes.iter().filter(|sample| !sample.radiance.is_black()).count()
}

/// Asserts that of bodies in a bright room, under a sky and beside a lamp.
fn assert_lit_as_one_by_one(bodies: &str) {
    const LIGHTS: &str = r#"
        [[light]]
        type = "environment"
        color = 0.6
        [[light]]
        type = "point"
        position = [0.2, 0.5, 0.9]
        intensity = 0.5
    "#;
    for settings in ["", "independent", "spectral"] {
        let lit = lit_as_one_by_one(room(&[bodies, LIGHTS], settings), path_tracer, settings);
        assert!(lit > 1500, "{lit} samples see light");
    }
}

/// Asserts that the film of a scene by path tracing is that of steps one by one, with all layers.
pub(crate) fn assert_same_film(scene: Scene, of: &str) {
    let tracer = path_tracer(&scene.render);
    let in_lanes = Compiled::new(scene).renderer();
    let scalar = in_lanes.clone().with_integrator(OneByOne(tracer));
    let [a, b] = [in_lanes, scalar].map(|renderer| renderer.render(Some(1), &()).unwrap().film);
    assert!(a == b, "{of}");
}

/// Alphas and mixed materials, by numbers and by textures, bumps, and media in which light diffuses.
#[test]
fn chance_decides_about_eight_hits_as_about_one() {
    const BODIES: &str = r#"
        [textures]
        dots = { type = "dots", inside = 0.2, outside = 0.9, scale = [6, 4] }
        holes = { type = "dots", inside = 0, outside = 1, scale = [9, 5] }
        waves = { type = "dots", inside = 0, outside = 0.03, scale = [20, 10] }
        [materials.speckled]
        type = "mix"
        materials = ["white", "red"]
        amount = 0.3
        [materials.patched]
        type = "mix"
        materials = ["speckled", "hammered"]
        amount = "dots"
        [materials.hammered]
        type = "conductor"
        metal = "gold"
        roughness = 0.3
        bump = "waves"
        [materials.wax]
        type = "subsurface"
        reflectance = [0.3, 0.7, 0.4]
        mean_free_path = 0.1
        roughness = 0.2
        [[sphere]]
        material = "patched"
        center = [-0.5, -0.5, 0]
        radius = 0.35
        [[sphere]]
        material = "speckled"
        center = [0.3, 0.3, -0.2]
        radius = 0.3
        alpha = 0.6
        [[sphere]]
        material = "wax"
        center = [-0.4, 0.4, 0]
        radius = 0.3
        [[quad]]
        material = "patched"
        corner = [0.1, -0.8, 0.5]
        edge_u = [0.7, 0, -0.2]
        edge_v = [0, 0.7, 0.1]
        alpha = "holes"
        [[quad]]
        material = "red"
        corner = [-0.2, -0.2, 0.8]
        edge_u = [0.4, 0, 0.1]
        edge_v = [0, 0.4, 0]
        alpha = "dots"
    "#;
    assert_lit_as_one_by_one(BODIES);
}

/// Shapes that are neither triangles nor spheres, what is in instances, and what moves.
#[test]
fn points_of_any_shape_are_shaded_eight_at_once_as_one_by_one() {
    const BODIES: &str = r#"
        [textures]
        dots = { type = "dots", inside = 0.2, outside = 0.9, scale = [6, 4] }
        holes = { type = "dots", inside = 0, outside = 1, scale = [9, 5] }
        waves = { type = "dots", inside = 0, outside = 0.03, scale = [20, 10] }
        [materials.dotted]
        type = "diffuse"
        reflectance = "dots"
        [materials.hammered]
        type = "conductor"
        metal = "gold"
        roughness = [0.1, 0.4]
        bump = "waves"
        [materials.glass]
        type = "dielectric"
        [materials.fibre]
        type = "hair"
        eumelanin = 0.3
        [[sphere]]
        material = "hammered"
        radius = 0.3
        scale = [1, 0.5, 0.8]
        translate = [-0.5, -0.6, 0.3]
        [[disk]]
        material = "dotted"
        center = [0, 0.5, -0.5]
        normal = [0.3, 0, 1]
        radius = 0.4
        alpha = "holes"
        [[disk]]
        material = "red"
        center = [0.4, 0, 0.7]
        normal = [0, 0, -1]
        radius = 0.2
        single_sided = true
        [[patch]]
        material = "dotted"
        corners = [[0.1, -0.8, 0.5], [0.8, -0.8, 0.3], [0.2, -0.1, 0.4], [0.8, -0.2, 0.8]]
        [[curve]]
        material = "fibre"
        points = [[-0.7, -0.9, 0.6], [-0.9, 0, 0.2], [-0.3, 0.2, 0], [-0.2, 0.9, 0.3]]
        width = [0.2, 0.05]
        profile = "cylinder"
        [[objects.things.sphere]]
        material = "glass"
        radius = 0.25
        [[objects.things.quad]]
        material = "dotted"
        corner = [0.2, -0.2, 0]
        edge_u = [0.4, 0, 0.1]
        edge_v = [0, 0.4, 0]
        [[instance]]
        object = "things"
        translate = [-0.1, 0.1, 0.5]
        [[instance]]
        object = "things"
        motion = [[1, 0, 0, 0.2, 0, 1, 0, -0.6, 0, 0, 1, 0, 0, 0, 0, 1], [1, 0, 0, 0.2, 0, 1, 0, -0.3, 0, 0, 1, 0.2, 0, 0, 0, 1]]
    "#;
    assert_lit_as_one_by_one(BODIES);
}

#[test]
fn layers_of_steps_eight_at_once_are_those_of_steps_one_by_one() {
    const SUBSURFACE: &str = "../docs/guide/scenes/material-subsurface.toml";
    let own = ["materials.toml", "textures.toml", "instances.toml", "still-life.toml", "cutouts.toml"];
    for name in own.into_iter().chain([SUBSURFACE]) {
        let mut scene = small(name);
        scene.render.integrator = Integrator::Path;
        (scene.image.layers, scene.image.denoise) = (Layers::Geometry, true);
        let ways = [("td", "C<TD>.*"), ("tg", "C<TG>.*"), ("ts", "C<TS>.*"), ("r", "C<R.>.*")];
        scene.image.light_paths = ways.map(layer).to_vec();
        assert_same_film(scene, name);
    }
}

#[test]
fn trees_grow_eight_at_once_as_one_by_one() {
    let benchmarks = ["spheres", "glass", "textures", "mesh"]
        .map(|name| format!("../docs/benchmarks/whitted/{name}.toml"));
    let own = ["whitted1980.toml", "glass-and-mirror.toml", "textures.toml", "notes-exercise.toml"];
    for name in own.into_iter().chain(benchmarks.iter().map(String::as_str)) {
        for spectral in [false, true] {
            let mut scene = small(name);
            scene.render.integrator = Integrator::Whitted;
            if spectral {
                scene.render.color = ColorMode::Spectral;
            }
            lit_as_one_by_one(scene, whitted, name);
        }
    }
}

#[test]
fn shadow_rays_pass_surfaces_eight_at_once_as_one_by_one() {
    const BODIES: &str = r#"
        [image]
        width = 48
        height = 40
        [camera]
        lookfrom = [0, 1.2, 4]
        lookat = [0, 0.4, 0]
        [materials]
        floor = { diffuse = 0.7 }
        glass = { diffuse = 0, transmission = 0.9, mirror = 0.1, ior = 1.5, absorption = [0.8, 0.1, 0.3] }
        bubble = { diffuse = 0, transmission = [0.9, 0.8, 0.7], ior = 0.6667 }
        pane = { diffuse = 0.1, transmission = { type = "checker", even = [0.9, 0.2, 0.1], odd = 0 } }
        red = { diffuse = 0.2, transmission = [0.8, 0, 0] }
        green = { diffuse = 0.2, transmission = [0, 0.8, 0] }
        [[plane]]
        size = 20
        material = "floor"
        [[sphere]]
        center = [-0.8, 0.5, 0]
        radius = 0.5
        material = "glass"
        [[sphere]]
        center = [-0.8, 0.5, 0]
        radius = 0.3
        material = "bubble"
        [[mesh]]
        material = "glass"
        positions = [[0.2, 0.1, 0], [1, 0.1, 0.3], [0.7, 0.1, -0.6], [0.6, 0.9, 0]]
        triangles = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]
        [[mesh]]
        material = "pane"
        positions = [[-1.5, 1.3, -1], [1.5, 1.3, -1], [1.5, 1.3, 1], [-1.5, 1.3, 1]]
        triangles = [[0, 1, 2], [0, 2, 3]]
        [[mesh]]
        material = "red"
        positions = [[-1.5, 1.5, -1], [0, 1.5, -1], [0, 1.5, 1], [-1.5, 1.5, 1]]
        triangles = [[0, 1, 2], [0, 2, 3]]
        [[mesh]]
        material = "green"
        positions = [[-1.2, 1.6, -1], [-0.9, 1.6, -1], [-0.9, 1.6, 1], [-1.2, 1.6, 1]]
        triangles = [[0, 1, 2], [0, 2, 3]]
        [[light]]
        type = "point"
        position = [0.3, 3, 1]
        intensity = 5
        [[light]]
        type = "distant"
        from = [-0.5, 1, 0.3]
        intensity = 0.5
    "#;
    for color in [ColorMode::Rgb, ColorMode::Spectral] {
        let mut scene = scene(BODIES);
        scene.render.integrator = Integrator::Whitted;
        scene.render.color = color;
        let compiled = Compiled::new(scene);
        let renderer = compiled.renderer();
        let pixels = (0..40).flat_map(|y| (0..48).map(move |x| [x, y]));
        let ids: Vec<SampleId> = pixels.map(|pixel| SampleId { pixel, sample: 1 }).collect();
        let (together, _) = renderer.trace(&ids);
        // The shadow rays of watched samples go on one by one.
        let mut passed = 0;
        for (id, traced) in ids.iter().zip(&together) {
            let mut events = Vec::new();
            let (watched, _) = renderer.trace_events(&[*id], &mut events);
            assert_eq!(watched[0].radiance, traced.radiance, "{id:?}");
            let is_crossing = |event: &Event| matches!(event, Event::Shadow { hit, passed, .. } if hit.is_hit() && !passed.is_black());
            passed += events.iter().filter(|event| is_crossing(event)).count();
        }
        assert!(passed > 1000, "{passed} surfaces were passed");
    }
}

/// Those of other programs, or of the folder that `LOOKFROM_SCENES` names: docs/benchmarks/same_bits.py writes random ones.
#[test]
#[ignore = "needs LOOKFROM_SHARED"]
fn scenes_of_a_folder_are_traced_eight_at_once_as_one_by_one() {
    let folder = std::env::var_os("LOOKFROM_SCENES").map_or_else(|| shared("scenes"), PathBuf::from);
    let mut count = 0;
    for file in scenes_in(&folder) {
        // Parts of scenes are none alone.
        let Ok(mut scene) = load::scene(&file, &mut LoadContext::new(&Disk)) else { continue };
        count += 1;
        let image = &mut scene.image;
        (image.width, image.height, image.crop) = (48, (48 * image.height / image.width).max(1), None);
        scene.render.samples = 2;
        let name = file.display().to_string();
        scene.render.integrator = Integrator::Whitted;
        lit_as_one_by_one(scene.clone(), whitted, &name);
        scene.render.integrator = Integrator::Path;
        lit_as_one_by_one(scene, path_tracer, &name);
    }
    assert!(count > 0, "no scenes in {}", folder.display());
}

/// The files of scenes and models in a folder, and in its folders.
fn scenes_in(folder: &FilePath) -> Vec<PathBuf> {
    let mut entries: Vec<PathBuf> =
        std::fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry").path()).collect();
    entries.sort();
    let is_scene = |path: &PathBuf| {
        path.extension()
            .is_some_and(|extension| ["glb", "pbrt", "toml", "xml"].iter().any(|it| extension == *it))
    };
    let (folders, files): (Vec<_>, Vec<_>) = entries.into_iter().partition(|entry| entry.is_dir());
    files.into_iter().filter(is_scene).chain(folders.iter().flat_map(|folder| scenes_in(folder))).collect()
}
