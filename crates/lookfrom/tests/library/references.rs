//! Scenes of other people against reference pictures by pbrt-v4: a z-test of the means of the picture and of its blocks.
//!
//! At few samples the variance of a single pixel is badly known, so means over the picture and over blocks are compared;
//! `lookfrom compare` does the test by pixels, at many samples. The scenes and pictures are test data (`LOOKFROM_SHARED`).

use std::path::Path;

use lookfrom::render::Renderer;
use lookfrom_scene::image::compare::{Sampled, compare};
use lookfrom_scene::image::read_exr;
use lookfrom_scene::settings::{Layers, RenderSettings};
use lookfrom_scene::spectrum::space::apply;
use lookfrom_scene::{Disk, LoadContext, load};

/// Independent pictures of a scene, from which the variance of their mean is measured.
const PICTURES: u32 = 4;

/// Samples a pixel of the pictures of normals.
const SAMPLES: u32 = 16;

/// The largest difference of the mean of a channel from pbrt's, in standard errors.
const MOST_STANDARD_ERRORS: f64 = 4.0;

/// Scene, picture, samples a pixel of the picture and of each of ours, and the largest difference of the mean of a channel in
/// shares of pbrt's: at least two standard errors of both pictures' noise. (The small lights of veach-mis are in the picture.)
const SCENES: &[(&str, &str, u64, u32, f64)] = &[
    ("cornell-box/scene", "cornell-box", 1024, 16, 0.005),
    ("veach-mis/scene", "veach-mis", 1024, 16, 0.015),
    ("killeroos/killeroo-simple", "killeroo-simple", 1024, 32, 0.005),
    ("killeroos/killeroo-gold", "killeroo-gold", 1024, 4, 0.005),
    ("coffee/scene", "coffee", 1024, 4, 0.005),
    ("staircase2/scene", "staircase2", 512, 5, 0.005),
    ("cornell-sensor/scene", "cornell-sensor", 256, 16, 0.005),
    ("medium-fog/scene", "medium-fog", 384, 16, 0.005),
    ("medium-inside/scene", "medium-inside", 384, 16, 0.005),
    ("medium-grid/scene", "medium-grid", 512, 16, 0.005),
    ("medium-rgbgrid/scene", "medium-rgbgrid", 256, 16, 0.005),
    ("medium-cloud/scene", "medium-cloud", 256, 16, 0.005),
    ("subsurface/scene", "subsurface", 256, 16, 0.005),
    ("hair/scene", "hair", 256, 16, 0.005),
    ("measured/scene", "measured", 256, 16, 0.005),
    ("lights-image/scene", "lights-image", 256, 16, 0.005),
    ("lens-realistic/scene", "lens-realistic", 384, 16, 0.005),
    ("motion-blur/scene", "motion-blur", 256, 16, 0.005),
];

/// The mean of [`PICTURES`] pictures of a scene with other random numbers each, and its variance as it is measured from how
/// they differ. (The variance of a picture's samples would be too large, since they are stratified.)
fn picture(path: &Path, samples: u32) -> Sampled {
    let mut context = LoadContext::new(&Disk);
    let scene = load::scene(path, &mut context).unwrap_or_else(|error| panic!("{error}"));
    let renderer = Renderer::of_scene(scene, &mut context.warnings).unwrap_or_else(|error| panic!("{error}"));
    let films = (0..PICTURES).map(|seed| {
        let settings = RenderSettings { samples, seed: u64::from(seed), ..renderer.settings().clone() };
        let renderer = renderer.with_settings(settings).unwrap_or_else(|error| panic!("{error}"));
        let film = renderer.render(None, &()).expect("a picture").film;
        assert_eq!(film.dropped(), 0, "samples that are not finite, the first at {:?}", film.first_dropped());
        film
    });
    let films: Vec<_> = films.collect();
    let width = films[0].width() as usize;
    let pictures: Vec<_> = films.iter().map(|film| film.picture().pixels).collect();
    let matrix = *renderer.sensor().variance_from_rgb();
    let count = f64::from(PICTURES);
    let pixel = |index: usize| -> ([f32; 3], [f64; 3]) {
        let colors = || pictures.iter().map(|picture| picture[index].map(f64::from));
        let mean = |of: &dyn Fn([f64; 3]) -> [f64; 3]| {
            let sums = colors().map(of).fold([0.0; 3], |sum, v| [0, 1, 2].map(|c| sum[c] + v[c]));
            sums.map(|sum| sum / count)
        };
        let center = apply(&matrix, mean(&|rgb| rgb));
        let squares = mean(&|rgb| {
            let channels = apply(&matrix, rgb);
            [0, 1, 2].map(|c| (channels[c] - center[c]).powi(2))
        });
        // Of the mean: an unbiased estimate of the variance of one picture, divided by their number.
        (mean(&|rgb| rgb).map(|v| v as f32), squares.map(|square| square / (count - 1.0)))
    };
    let (pixels, variances) = (0..pictures[0].len()).map(pixel).unzip();
    Sampled { width, pixels, not_finite: 0, variances: Some(variances), channels_from_rgb: Some(matrix) }
}

#[test]
#[ignore = "needs LOOKFROM_SHARED"]
fn pictures_are_pbrts() {
    let shared = lookfrom_test_data::shared("");
    let mut faults = Vec::new();
    for &(scene, name, reference_samples, samples, most) in SCENES {
        let ours = picture(&shared.join(format!("scenes/{scene}.pbrt")), samples);
        let file = read_exr(&shared.join(format!("reference/{name}.exr")), &mut LoadContext::new(&Disk));
        let theirs =
            Sampled::new(&file.expect("a picture"), Some(reference_samples)).expect("a picture of RGB");
        let found = compare(&ours, &theirs).expect("pictures of one size");
        let noise = found.noise.as_ref().expect("variances on both sides");
        println!("{name}: means differ by {:?}, {noise:?}", found.relative);
        let is_within = found.relative.iter().all(|difference| difference.abs() <= most)
            && noise.mean.iter().all(|error| error.abs() <= MOST_STANDARD_ERRORS)
            && noise.blocks_within > 0.97;
        if !is_within {
            faults.push(format!("{name}: {found:?}"));
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
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
#[ignore = "needs LOOKFROM_SHARED"]
fn normals_are_pbrts() {
    let shared = lookfrom_test_data::shared("");
    // Pictures of single features have no `Ns`, and those of media have what is seen where nothing was scattered.
    let without =
        ["cornell-sensor", "subsurface", "hair", "measured", "lights-image", "lens-realistic", "motion-blur"];
    let has_normals = |name: &str| !without.contains(&name) && !name.starts_with("medium-");
    for (scene, name, ..) in SCENES.iter().filter(|(_, name, ..)| has_normals(name)) {
        let reference = shared.join(format!("reference/{name}.exr"));
        let found = alike(&shared.join(format!("scenes/{scene}.pbrt")), &reference);
        println!("{name}: {found:?} of the pixels have pbrt's N, Ns");
        assert!(found.iter().all(|&part| part > 0.97), "{name}: {found:?}");
    }
}
