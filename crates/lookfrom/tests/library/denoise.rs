//! Are pictures of few samples nearer to the truth when they are denoised, and are they then the same bits everywhere?

use crate::support::{Compiled, own_scene, scene};
use lookfrom::film::{Film, Picture};
use lookfrom::post::denoise::denoised;
use lookfrom_scene::Scene;
use lookfrom_scene::settings::{Integrator, PixelBounds};

fn small(name: &str, samples: u32) -> Scene {
    let mut scene = own_scene(name);
    (scene.image.width, scene.image.height) = (96, 72);
    (scene.image.crop, scene.image.denoise) = (None, true);
    (scene.render.samples, scene.render.integrator) = (samples, Integrator::Path);
    scene
}

fn film(name: &str, samples: u32) -> Film {
    Compiled::new(small(name, samples)).film()
}

/// The truth, of other samples.
fn truth(name: &str) -> Picture {
    let mut scene = small(name, 512);
    (scene.render.seed, scene.image.denoise) = (99, false);
    Compiled::new(scene).film().picture()
}

/// The mean of squared errors, relative to the squared truth.
fn relative_error(picture: &Picture, truth: &Picture) -> f64 {
    let of_pixel = |(is, should): (&[f32; 3], &[f32; 3])| {
        let square = |v: [f32; 3]| v.iter().map(|c| f64::from(*c).powi(2)).sum::<f64>();
        square([0, 1, 2].map(|c| is[c] - should[c])) / (square(*should) + 0.03)
    };
    picture.pixels.iter().zip(&truth.pixels).map(of_pixel).sum::<f64>() / truth.pixels.len() as f64
}

fn mean(picture: &Picture) -> f64 {
    picture.pixels.iter().flatten().map(|light| f64::from(*light)).sum::<f64>()
}

#[test]
fn few_samples_come_near_to_many() {
    for (name, factor) in [("cornell.toml", 3.0), ("soft-shadows.toml", 3.0)] {
        let truth = truth(name);
        let film = film(name, 8);
        let noisy = film.picture();
        let clean = denoised(&film, &noisy);
        let [before, after] = [&noisy, &clean].map(|picture| relative_error(picture, &truth));
        assert!(after * factor < before, "{name}: {before} → {after}");
        let share = mean(&clean) / mean(&noisy);
        assert!((share - 1.0).abs() < 0.02, "{name}: of the light, {share} is left");
    }
}

/// A board of bright and dark squares, behind two panes of which one covers half and one a quarter.
const PANES: &str = r#"
[image]
width = 96
height = 72
[camera]
lookfrom = [0, 0, 4]
lookat = [0, 0, 0]
[render]
integrator = "path"
[[light]]
type = "environment"
color = 1
[materials.board]
diffuse = { type = "checker", even = 0.9, odd = 0.05, scale = 0.4 }
[materials.half]
diffuse = [0.8, 0.1, 0.1]
[materials.quarter]
diffuse = [0.1, 0.3, 0.9]
[[quad]]
corner = [-2, -2, 0.1]
edge_u = [4, 0, 0]
edge_v = [0, 4, 0]
material = "board"
[[quad]]
corner = [-2, -1, 1]
edge_u = [2.3, 0, 0]
edge_v = [0, 2, 0.5]
material = "half"
alpha = 0.5
[[quad]]
corner = [-0.3, -1, 0.5]
edge_u = [2.3, 0, 0]
edge_v = [0, 2, 0]
material = "quarter"
alpha = 0.25
"#;

#[test]
fn surfaces_of_fractional_alpha_are_smooth() {
    let picture = |panes: &str, samples, seed| {
        let mut scene = scene(panes);
        (scene.render.samples, scene.render.seed, scene.image.denoise) = (samples, seed, true);
        Compiled::new(scene).film()
    };
    let (truth, film) = (picture(PANES, 1024, 9).picture(), picture(PANES, 8, 0));
    let noisy = film.picture();
    let [before, after] = [&noisy, &denoised(&film, &noisy)].map(|picture| relative_error(picture, &truth));
    // Without the mean features the factor is about 2.
    assert!(after * 6.0 < before, "{before} → {after}");
    // The features of a pixel are those of all its surfaces, however few samples there are.
    let even = PANES.replace(r#"{ type = "checker", even = 0.9, odd = 0.05, scale = 0.4 }"#, "0.6");
    let film = picture(&even, 1, 3);
    for (x, red, panes) in [(20, 0.7, "half"), (48, 0.6375, "both"), (75, 0.475, "quarter")] {
        let albedo = film.denoiser_features(x, 36).map(|features| features.aovs.albedo[0]);
        assert!(albedo.is_some_and(|albedo| (albedo - red).abs() < 1e-5), "{panes}: {albedo:?}");
    }
}

#[test]
fn many_samples_are_not_made_worse() {
    for name in ["cornell.toml", "textures.toml"] {
        let truth = truth(name);
        let film = film(name, 256);
        let noisy = film.picture();
        let [before, after] =
            [&noisy, &denoised(&film, &noisy)].map(|picture| relative_error(picture, &truth));
        assert!(after <= before, "{name}: {before} → {after}");
    }
}

#[test]
fn threads_and_splits_do_not_matter() {
    let compiled = Compiled::new(small("soft-shadows.toml", 3));
    let one = compiled.render(1).film;
    assert!(one == compiled.render(3).film);
    let picture = one.picture();
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| denoised(&one, &picture))
    };
    assert_eq!(on(1), on(3));
}

#[test]
fn a_crop_is_denoised_as_the_whole_is_where_it_knows_as_much() {
    let name = "soft-shadows.toml";
    let whole = film(name, 4);
    let whole = denoised(&whole, &whole.picture());
    let mut scene = small(name, 4);
    let crop = PixelBounds { x0: 20, y0: 10, x1: 70, y1: 60 };
    scene.image.crop = Some(crop);
    let part = Compiled::new(scene).film();
    let part = denoised(&part, &part.picture());
    // As far as the filter looks, and what it looks at looks at its neighbours.
    const REACH: u32 = 8;
    for y in crop.y0 + REACH..crop.y1 - REACH {
        for x in crop.x0 + REACH..crop.x1 - REACH {
            let index = (y * 96 + x) as usize;
            assert_eq!(part.pixels[index], whole.pixels[index], "({x}, {y})");
        }
    }
    assert_eq!(part.pixels[0], [0.0; 3]);
}

/// For each integrator: the largest ratio of the relative errors after and before, and the largest relative change of the mean light.
///
/// Noise falls. Pictures without noise have the variance of their edges, which the filter takes for noise: they become little
/// worse. The light of a random walk comes by fireflies, which are mostly lost.
const OF_INTEGRATORS: &[(Integrator, f64, f64)] = &[
    (Integrator::Path, 0.5, 0.01),
    (Integrator::SimplePath, 0.5, 0.01),
    (Integrator::AmbientOcclusion { cosine: true }, 0.5, 0.01),
    (Integrator::RandomWalk, 0.1, 0.6),
    (Integrator::Whitted, 1.25, 0.005),
    (Integrator::Raycast, 1.25, 0.005),
];

#[test]
fn pictures_of_every_integrator_become_better_and_keep_their_light() {
    let mut faults = Vec::new();
    for &(word, integrator) in Integrator::WORDS {
        let of_it = OF_INTEGRATORS.iter().find(|(other, ..)| *other == integrator);
        // Views of the first hit.
        let (most_error, most_change) = of_it.map_or((2.0, 0.001), |&(_, error, change)| (error, change));
        let mut scene = small("soft-shadows.toml", 8);
        (scene.image.width, scene.image.height) = (48, 36);
        scene.render.integrator = integrator;
        let film = Compiled::new(scene.clone()).film();
        (scene.render.samples, scene.render.seed, scene.image.denoise) = (512, 99, false);
        let truth = Compiled::new(scene).film().picture();
        let noisy = film.picture();
        let clean = denoised(&film, &noisy);
        let [before, after] = [&noisy, &clean].map(|picture| relative_error(picture, &truth));
        let share = mean(&clean) / mean(&noisy);
        if !(after <= most_error * before && (share - 1.0).abs() <= most_change) {
            faults.push(format!("{word}: relative error {before} → {after}, light × {share}"));
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}
