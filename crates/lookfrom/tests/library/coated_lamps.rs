//! A clear coat over what shines takes the part that `KHR_materials_clearcoat` says, whether the light is met or asked for.

use crate::support::{Compiled, SMALL, scene};
use lookfrom_scene::Scene;
use lookfrom_scene::settings::Integrator;

/// What the extension says of emission under a coat.
fn formula(amount: f64, cos: f64) -> f64 {
    1.0 - amount * (0.04 + 0.96 * (1.0 - cos).powi(5))
}

/// A plate that shines with 1, seen from an angle to its normal.
fn plate(look: &str, degrees: f64) -> Scene {
    let (sin, cos) = degrees.to_radians().sin_cos();
    scene(&format!(
        r#"
        [camera]
        projection = "orthographic"
        lookfrom = [0, {y}, {z}]
        lookat = [0, 0, 0]
        up = [1, 0, 0]
        height = 0.5
        {SMALL}
        samples = 4
        [materials.plate]
        type = "principled"
        base_color = 0
        specular = 0
        two_sided = true
        emission = 1
        {look}
        [[quad]]
        corner = [-1, 0, 4]
        edge_u = [2, 0, 0]
        edge_v = [0, 0, -8]
        material = "plate"
    "#,
        y = 5.0 * cos,
        z = 5.0 * sin,
    ))
}

#[test]
fn emission_is_under_the_coat() {
    for degrees in [0.0, 40.0, 70.0, 85.0, 120.0] {
        for (look, amount) in
            [("", 0.0), ("clearcoat = 0.6", 0.6), ("clearcoat = 1\nclearcoat_roughness = 0.4", 1.0)]
        {
            let film = Compiled::new(plate(look, degrees)).film();
            let expected = formula(amount, f64::to_radians(degrees).cos().abs());
            for (x, y) in [(0, 0), (4, 5)] {
                for found in film.mean(x, y) {
                    assert!(
                        (f64::from(found) - expected).abs() < 1e-5,
                        "{look}, {degrees}°: {found}, {expected}"
                    );
                }
            }
        }
    }
}

#[test]
fn the_coat_is_where_its_texture_says() {
    let look = "clearcoat = { type = \"checker\", even = 0, odd = 0.8, space = \"uv\", scale = [1, 2] }";
    let film = Compiled::new(plate(look, 60.0)).film();
    let mut seen: Vec<f32> =
        (0..8).flat_map(|x| (0..8).map(move |y| (x, y))).map(|(x, y)| film.mean(x, y)[0]).collect();
    seen.sort_by(f32::total_cmp);
    let (least, most) = (f64::from(seen[0]), f64::from(seen[63]));
    assert!((least - formula(0.8, 0.5)).abs() < 1e-5 && (most - 1.0).abs() < 1e-5, "{least} {most}");
}

/// Light that is asked for, found by chance, and both: the same, of lamps that are round, smooth and flat, even and patterned.
#[test]
fn coats_are_seen_by_those_who_ask() {
    let lamps = [
        "[[sphere]]\ncenter = [0.3, 1, 0]\nradius = 0.4\nmaterial = \"lamp\"",
        "[[quad]]\ncorner = [-1, 0.3, -0.5]\nedge_u = [0, 1, 0]\nedge_v = [2, 0, 0]\nmaterial = \"lamp\"",
        "[[mesh]]\npositions = [[-1, 0.2, -0.4], [1, 0.2, -0.4], [0, 1.4, -0.8]]\n\
         normals = [[-0.9, 0.1, 0.3], [0.9, 0.1, 0.3], [0, -0.3, 0.9]]\ntriangles = [[0, 1, 2]]\nmaterial = \"lamp\"",
    ];
    let coats = ["1", "{ type = \"checker\", even = 0, odd = 1, space = \"uv\", scale = 3 }"];
    for lamp in lamps {
        for coat in coats {
            let lit = |integrator, coat: &str| {
                let mut scene = scene(&format!(
                    r#"
                    [camera]
                    projection = "orthographic"
                    lookfrom = [0, -1, 0.01]
                    lookat = [0, 0, 0]
                    height = 0.02
                    [image]
                    width = 4
                    height = 4
                    [render]
                    depth = 1
                    [materials]
                    paper = {{ type = "diffuse_transmission", reflectance = 0, transmittance = 1 }}
                    lamp = {{ type = "principled", base_color = 0, specular = 0, two_sided = true, emission = 1, clearcoat = {coat} }}
                    [[quad]]
                    corner = [-1, 0, -1]
                    edge_u = [0, 0, 2]
                    edge_v = [2, 0, 0]
                    material = "paper"
                    {lamp}
                "#
                ));
                scene.render.integrator = integrator;
                scene.render.samples = 1 << 13;
                let film = Compiled::new(scene).film();
                (0..4).flat_map(|x| (0..4).map(move |y| (x, y))).map(|(x, y)| film.mean(x, y)[1]).sum::<f32>()
                    / 16.0
            };
            let expected = lit(Integrator::RandomWalk, coat);
            let bare = lit(Integrator::Path, "0");
            assert!(
                expected < 0.98 * bare,
                "{lamp}\n{coat}: a coat that takes nothing, {expected} of {bare}"
            );
            for integrator in [Integrator::Path, Integrator::SimplePath] {
                let found = lit(integrator, coat);
                assert!(
                    (found / expected - 1.0).abs() < 0.012,
                    "{lamp}\n{coat}: {integrator:?} {found}, {expected}"
                );
            }
        }
    }
}
