//! One and the same picture, bit for bit, however the work is divided – and the inspector tells the truth about it.

use crate::support::{Compiled, own_scene};
use lookfrom::film::FilmTile;
use lookfrom::inspect::{SvgView, inspect, svg};
use lookfrom::render::SampleId;
use lookfrom_scene::Scene;
use lookfrom_scene::settings::{Integrator, PixelBounds};

const SCENES: [&str; 6] = [
    "whitted1980.toml",
    "glass-and-mirror.toml",
    "soft-shadows.toml",
    "textures.toml",
    "instances.toml",
    "depth-of-field.toml",
];

/// A small picture of a scene of ours.
pub(crate) fn small(name: &str) -> Scene {
    let mut scene = own_scene(name);
    (scene.image.width, scene.image.height) = (72, 50);
    scene.image.crop = None;
    scene.render.samples = 3;
    scene
}

#[test]
fn any_number_of_threads() {
    for name in SCENES {
        let compiled = Compiled::new(small(name));
        let one = compiled.render(1);
        for threads in [2, 3] {
            let many = compiled.render(threads);
            assert!(one.film == many.film, "{name} differs on {threads} threads");
            assert_eq!(one.rays, many.rays);
        }
    }
}

#[test]
fn with_and_without_the_feature_parallel() {
    // FNV-1a of the bits of all pixels. The gate runs this test with the feature and without it.
    let hash = |name: &str| {
        let bytes = Compiled::new(small(name))
            .film()
            .picture()
            .pixels
            .into_iter()
            .flatten()
            .flat_map(f32::to_le_bytes);
        bytes.fold(0xcbf2_9ce4_8422_2325_u64, |hash, byte| {
            (hash ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3)
        })
    };
    assert_eq!(
        ["glass-and-mirror.toml", "soft-shadows.toml"].map(hash),
        [0x9fb1_66e5_afda_5882, 0x566c_fb31_c1f7_74d5]
    );
}

#[test]
fn any_split_of_pixels_and_samples() {
    let compiled = Compiled::new(small("glass-and-mirror.toml"));
    let whole = compiled.film();
    let renderer = compiled.renderer();
    let mut merged = lookfrom::film::Film::new(72, 50, None).expect("a small film");
    for (samples, columns) in [(2..3, 0..41), (0..2, 41..72), (0..1, 0..41), (2..3, 41..72), (1..2, 0..41)] {
        let area = PixelBounds { x0: columns.start, y0: 0, x1: columns.end, y1: 50 };
        let mut tile = FilmTile::new(area).expect("a small tile");
        renderer.render_tile(samples, &mut tile).expect("an empty tile");
        merged.add_tile(&tile).expect("samples that it lacks");
    }
    assert!(whole == merged);
}

#[test]
fn a_crop_is_a_part_of_the_picture() {
    let mut scene = small("textures.toml");
    let whole = Compiled::new(scene.clone()).film();
    scene.image.crop = Some(PixelBounds { x0: 13, y0: 7, x1: 60, y1: 44 });
    let part = Compiled::new(scene).film();
    for (x, y) in [(13, 7), (59, 43), (30, 20)] {
        assert_eq!(whole.mean(x, y), part.mean(x, y));
    }
    assert_eq!(part.samples(12, 7), 0);
}

#[test]
fn what_the_inspector_shows_adds_up_to_what_the_film_received() {
    for name in SCENES {
        let mut scene = small(name);
        for integrator in [Integrator::Whitted, Integrator::Raycast, Integrator::Normals] {
            scene.render.integrator = integrator;
            let compiled = Compiled::new(scene.clone());
            let renderer = compiled.renderer();
            for (x, y) in [(20, 12), (36, 25), (50, 30), (25, 40), (64, 20)] {
                let inspection = inspect(&renderer, SampleId { pixel: [x, y], sample: 2 });
                // the additions that are shown, in their order …
                let mut sum = [0.0f32; 3];
                for addition in &inspection.additions {
                    for (sum, value) in sum.iter_mut().zip(&addition.value.lanes) {
                        *sum += value;
                    }
                }
                assert_eq!(sum.as_slice(), inspection.radiance.lanes);
                assert!(inspection.adds_up, "{name} at {x} {y}");
                // … are what a tile with all of its other pixels gave to the film
                let area = PixelBounds { x0: x / 32 * 32, y0: 0, x1: (x / 32 * 32 + 32).min(72), y1: 50 };
                let mut tile = FilmTile::new(area).expect("a small tile");
                renderer.render_tile(2..3, &mut tile).expect("an empty tile");
                let mut film = lookfrom::film::Film::new(72, 50, None).expect("a small film");
                film.add_tile(&tile).expect("of this film");
                assert_eq!(film.mean(x, y), inspection.film, "{name} at {x} {y}");
                let text = inspection.to_string();
                assert!(text.contains("the same, bit for bit"), "{text}");
                let drawing = svg(&renderer, &inspection, SvgView::Sheet);
                assert!(drawing.is_ok_and(|drawing| drawing.ends_with("</svg>\n")));
            }
        }
    }
}

#[test]
fn the_inspector_shows_every_number_of_the_notes() {
    let compiled = Compiled::new(small("notes-exercise.toml"));
    let renderer = compiled.renderer();
    let texts: Vec<String> = [(36, 25), (20, 25), (50, 25), (30, 15), (44, 35), (55, 20)]
        .into_iter()
        .map(|(x, y)| inspect(&renderer, SampleId { pixel: [x, y], sample: 0 }).to_string())
        .collect();
    let all = texts.concat();
    for word in
        ["T1", "S2", "R3", "T4", "P_k", "P_world", "b − a", "D1", "D2", "D3", "α", "β", "γ", "t = D3/D"]
    {
        assert!(all.contains(word), "{word} is missing");
    }
    for word in ["A  ", "B  ", "C  ", "Δ (stable)", "B² − AC", "q  ", "t₁", "t₂", "matching bits", "root"]
    {
        assert!(all.contains(word), "{word} is missing");
    }
}
