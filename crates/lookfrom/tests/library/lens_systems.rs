//! Cameras with lens systems: brightness and alpha, samples that the lens blocks, what the inspector tells, and first hits.

use std::path::Path;

use lookfrom::inspect::{SvgView, inspect, svg};
use lookfrom::render::{Renderer, SampleId};
use lookfrom_scene::settings::{Background, Layers, PixelBounds};
use lookfrom_scene::{LoadContext, Memory, Scene, load};

/// A wide lens on a film whose corners its image does not reach.
const LENS: &str = "30 4 1.5 20\n-70 3 1 20\n0 60 0 12\n";

/// A white sky around a wall that fills a part of the picture.
const SCENE: &str = r#"
[camera]
lookfrom = [0, 0, 5]
lookat = [0, 0, 0]
lens = "lens.dat"
film = 60
[image]
width = 48
height = 32
[render]
integrator = "path"
samples = 16
[materials.wall]
diffuse = 0
emission = 1
[[quad]]
corner = [-9, -9, 0]
edge_u = [18, 0, 0]
edge_v = [0, 18, 0]
material = "wall"
[[light]]
type = "environment"
color = 1
"#;

fn scene(change: impl FnOnce(&mut String)) -> Scene {
    let mut text = SCENE.to_owned();
    change(&mut text);
    let files = Memory([("s.toml".into(), text.into_bytes()), ("lens.dat".into(), LENS.into())].into());
    load::scene(Path::new("s.toml"), &mut LoadContext::new(&files)).unwrap_or_else(|error| panic!("{error}"))
}

fn renderer(scene: Scene) -> Renderer {
    Renderer::of_scene(scene, &mut Vec::new()).unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn the_middle_is_as_bright_as_a_pinholes_and_corners_are_dark() {
    for aperture in ["", "aperture = 0.001\n", "aperture_shape = \"pentagon\"\n"] {
        let mut scene = scene(|text| *text = text.replace("film = 60\n", &format!("film = 60\n{aperture}")));
        scene.render.samples = 256;
        let film = renderer(scene).render(None, &()).expect("a picture").film;
        assert_eq!(film.dropped(), 0);
        let middle = film.mean(24, 16)[0];
        assert!((middle - 1.0).abs() < 0.05, "{aperture:?}: {middle}");
        let corner = film.mean(0, 0)[0];
        assert!(corner < 0.75 * middle, "{aperture:?}: {corner}");
    }
}

#[test]
fn an_opaque_wall_is_opaque_whatever_the_lens_lets_through() {
    let mut scene = scene(|_| ());
    scene.image.background = Background::Transparent;
    let renderer = renderer(scene);
    let film = renderer.render(None, &()).expect("a picture").film;
    let picture = film.picture();
    let alpha = |x: usize, y: usize| picture.alpha[48 * y + x];
    for (x, y) in [(24, 16), (30, 12), (0, 0), (47, 31)] {
        assert_eq!(alpha(x, y), 1.0, "{x} {y}");
    }
}

#[test]
fn inspected_samples_add_up_and_tell_the_lens() {
    let renderer = renderer(scene(|_| ()));
    let (mut passed, mut blocked) = (0, 0);
    for pixel in [[0, 0], [24, 16], [40, 3], [2, 29], [47, 31]] {
        for sample in 0..16 {
            let id = SampleId { pixel, sample };
            let inspection = inspect(&renderer, id);
            assert!(inspection.adds_up);
            let (traced, rays) = renderer.trace(&[id]);
            assert_eq!(inspection.film, traced[0].rgb);
            let lens = inspection.camera.lens_system.as_ref().expect("a lens system");
            assert_eq!((lens.passes, lens.surfaces.len()), (rays.camera == 1, 3));
            assert_eq!(lens.passes, lens.surfaces.iter().all(|surface| surface.passes));
            if lens.passes {
                passed += 1;
                assert!(inspection.film[0] > 0.0 && lens.weight > 0.0);
                let front = lens.surfaces[2].point.expect("a point");
                let a = inspection.camera.a;
                // The camera looks along −z, and x is to the viewer's right.
                for (found, expected) in a.into_iter().zip([front[0], front[1], 5.0 - front[2]]) {
                    assert!((found - expected).abs() < 1e-12, "{a:?} {front:?}");
                }
            } else {
                blocked += 1;
                assert_eq!((inspection.film, inspection.rays.len()), ([0.0; 3], 0));
            }
            for view in [SvgView::Lens, SvgView::Sheet] {
                let drawing = svg(&renderer, &inspection, view).expect("a drawing");
                assert!(drawing.contains("the lens in section") && !drawing.contains("NaN"), "{drawing}");
                assert_eq!(drawing.contains("blocked"), !lens.passes);
            }
            let text = inspection.to_string();
            assert!(text.contains("Through the lens system") && !text.contains("NaN"), "{text}");
        }
    }
    assert!(passed > 20 && blocked > 5, "{passed} {blocked}");
}

#[test]
fn a_pinhole_has_no_lens_to_draw() {
    let renderer = renderer(scene(|text| *text = text.replace("lens = \"lens.dat\"\nfilm = 60\n", "")));
    let inspection = inspect(&renderer, SampleId { pixel: [3, 4], sample: 0 });
    assert!(inspection.camera.lens_system.is_none());
    let error = svg(&renderer, &inspection, SvgView::Lens).expect_err("no lens");
    assert!(error.to_string().contains("no lens system"), "{error}");
}

/// A sample does not depend on those beside it, though blocked ones leave the batch.
#[test]
fn batches_and_single_samples_agree() {
    let mut scene = scene(|_| ());
    scene.image.layers = Layers::Geometry;
    let renderer = renderer(scene);
    let area = PixelBounds { x0: 0, y0: 0, x1: 48, y1: 32 };
    let ids: Vec<SampleId> = (area.y0..area.y1)
        .flat_map(|y| (area.x0..area.x1).map(move |x| SampleId { pixel: [x, y], sample: 3 }))
        .collect();
    let (together, rays) = renderer.trace(&ids);
    let mut unblocked = 0;
    for (id, traced) in ids.iter().zip(&together) {
        let (alone, rays) = renderer.trace(&[*id]);
        assert_eq!((alone[0].rgb, alone[0].weight), (traced.rgb, traced.weight), "{id:?}");
        unblocked += rays.camera;
    }
    assert_eq!(rays.camera, unblocked);
    assert!(unblocked < ids.len() as u64, "the lens blocks some");
    // The wall is at the same depth in every pixel that sees it.
    let film = renderer.render(None, &()).expect("a picture").film;
    let depth = film.aovs(24, 16).expect("the wall").position[2];
    assert!((depth - 5.0).abs() < 1e-3, "{depth}");
}
