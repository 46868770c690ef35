//! Scenes of other people against pictures by pbrt-v4, which are test data (`LOOKFROM_SHARED`).
//!
//! At few samples the variance of a single pixel is badly known, so means over the picture and over blocks are compared;
//! `lookfrom compare` does the test by pixels, at many samples.

use std::path::Path;

use lookfrom::render::Renderer;
use lookfrom_scene::image::compare::{Sampled, compare};
use lookfrom_scene::image::read_exr;
use lookfrom_scene::settings::Layers;
use lookfrom_scene::{Disk, LoadContext, load};

const SAMPLES: u32 = 16;

/// Scene, picture, how many samples the picture has.
const SCENES: &[(&str, &str, u64)] = &[
    ("cornell-box/scene", "cornell-box", 1024),
    ("veach-mis/scene", "veach-mis", 1024),
    ("killeroos/killeroo-simple", "killeroo-simple", 1024),
    ("killeroos/killeroo-gold", "killeroo-gold", 1024),
    ("coffee/scene", "coffee", 1024),
    ("staircase2/scene", "staircase2", 512),
    ("cornell-sensor/scene", "cornell-sensor", 256),
];

/// Our picture of a scene with the variance of each pixel's samples.
fn picture(scene: &Path) -> Sampled {
    let mut context = LoadContext::new(&Disk);
    let mut scene = load::scene(scene, &mut context).unwrap_or_else(|error| panic!("{error}"));
    scene.render.samples = SAMPLES;
    // A camera's noise is known in its own channels where there are layers.
    scene.image.layers = Layers::Geometry;
    let renderer = Renderer::of_scene(scene, &mut context.warnings).unwrap_or_else(|error| panic!("{error}"));
    let film = renderer.render(None, &()).expect("a picture").film;
    assert_eq!(film.dropped(), 0, "samples that are not finite, the first at {:?}", film.first_dropped());
    let channels = |(x, y)| film.channel_variance(x, y).unwrap_or_else(|| film.variance(x, y));
    let places = || (0..film.height()).flat_map(|y| (0..film.width()).map(move |x| (x, y)));
    let of_mean = |(x, y)| channels((x, y)).map(|v| f64::from(v) / f64::from(SAMPLES));
    Sampled {
        width: film.width() as usize,
        pixels: film.picture().pixels,
        not_finite: 0,
        variances: Some(places().map(of_mean).collect()),
        channels_from_rgb: Some(*renderer.sensor().variance_from_rgb()),
    }
}

#[test]
fn pictures_are_pbrts() {
    let Some(shared) = lookfrom_test_data::shared("") else { return };
    for (scene, name, samples) in SCENES {
        let ours = picture(&shared.join(format!("scenes/{scene}.pbrt")));
        let file = read_exr(&shared.join(format!("reference/{name}.exr")), &mut LoadContext::new(&Disk));
        let theirs = Sampled::new(&file.expect("a picture"), Some(*samples)).expect("a picture of RGB");
        let found = compare(&ours, &theirs).expect("pictures of one size");
        let noise = found.noise.as_ref().expect("variances on both sides");
        println!("{name}: means differ by {:?}, {noise:?}", found.relative);
        // Within half a per cent, or within the noise where that is larger.
        for (difference, error) in found.relative.iter().zip(noise.mean) {
            assert!(difference.abs() < 0.005 || error.abs() < 4.0, "{name}: {found:?}");
        }
        assert!(noise.blocks_within > 0.97, "{name}: {found:?}");
    }
}

/// Which part of the pixels has nearly the normal (`N`, `Ns`) of pbrt's picture.
fn alike(scene: &Path, reference: &Path) -> [f64; 2] {
    let theirs = read_exr(reference, &mut LoadContext::new(&Disk)).expect("a picture");
    let mut context = LoadContext::new(&Disk);
    let mut scene = load::scene(scene, &mut context).unwrap_or_else(|error| panic!("{error}"));
    (scene.render.samples, scene.render.depth, scene.image.layers) = (SAMPLES, 0, Layers::Geometry);
    let renderer = Renderer::of_scene(scene, &mut context.warnings).unwrap_or_else(|error| panic!("{error}"));
    let film = renderer.render(None, &()).expect("a picture").film;
    let places = || (0..film.height()).flat_map(|y| (0..film.width()).map(move |x| (x, y)));
    let ours: Vec<_> = places().map(|(x, y)| film.aovs(x, y).unwrap_or_default()).collect();
    ["N", "Ns"].map(|layer| {
        let axes = ["X", "Y", "Z"].map(|axis| theirs.channel(&format!("{layer}.{axis}")).expect("a layer"));
        let cosine = |index: usize| {
            let normal = if layer == "N" { ours[index].ng } else { ours[index].ns };
            let theirs = axes.map(|axis| axis[index]);
            let is_nothing = [normal, theirs].map(|normal| normal == [0.0; 3]);
            if is_nothing == [true; 2] {
                1.0
            } else {
                normal.iter().zip(theirs).map(|(a, b)| a * b).sum::<f32>()
            }
        };
        (0..ours.len()).filter(|&index| cosine(index) > 0.98).count() as f64 / ours.len() as f64
    })
}

#[test]
fn normals_are_pbrts() {
    let Some(shared) = lookfrom_test_data::shared("") else { return };
    // That of the sensor has no `Ns`.
    for (scene, name, _) in SCENES.iter().filter(|(_, name, _)| *name != "cornell-sensor") {
        let reference = shared.join(format!("reference/{name}.exr"));
        let found = alike(&shared.join(format!("scenes/{scene}.pbrt")), &reference);
        println!("{name}: {found:?} of the pixels have pbrt's N, Ns");
        assert!(found.iter().all(|&part| part > 0.97), "{name}: {found:?}");
    }
}
