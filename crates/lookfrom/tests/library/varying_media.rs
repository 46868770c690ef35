//! Media that vary in space, against what can be computed by hand.

use lookfrom::inspect::inspect;
use lookfrom::render::SampleId;
use lookfrom_scene::Scene;
use lookfrom_scene::settings::Integrator;

use crate::scattering::{AROUND, SPECK, assert_near, mean, scene_of};
use crate::support::{Compiled, scene};

/// Number of cells along each axis of the grids here.
const SIZE: [usize; 3] = [5, 4, 11];

/// A density that varies much, by the cell.
fn value([x, y, z]: [usize; 3]) -> f64 {
    let hash = (x * 7 + y * 13 + z * 29) % 11;
    if hash < 4 { 0.0 } else { hash as f64 * 0.17 }
}

/// All cells of the grids, x fastest.
fn cells() -> impl Iterator<Item = [usize; 3]> {
    let [width, height, depth] = SIZE;
    (0..width * height * depth).map(move |k| [k % width, k / width % height, k / width / height])
}

/// The size of the grids and their numbers as parameters.
fn grid(name: &str, of: impl Fn([usize; 3]) -> f64) -> String {
    let [width, height, depth] = SIZE;
    let values: String = cells().map(|cell| format!("{} ", of(cell))).collect();
    format!(r#""integer nx" {width} "integer ny" {height} "integer nz" {depth} "float {name}" [ {values} ]"#)
}

/// The same without the size.
fn more(name: &str, of: impl Fn([usize; 3]) -> f64) -> String {
    let text = grid(name, of);
    text[text.find("\"float").expect("numbers")..].to_owned()
}

/// The box of the grids: the axis of the camera goes through it, not along cells' centres.
const BOX: &str = r#""point3 p0" [ -1 -1.2 1 ] "point3 p1" [ 1.3 0.9 4 ]"#;

/// The number of the grid at a depth on the axis of the camera, interpolated.
fn on_axis(of: &dyn Fn([usize; 3]) -> f64, z: f64) -> f64 {
    let [low, high] = [[-1.0, -1.2, 1.0], [1.3, 0.9, 4.0]];
    let point = [0.0, 0.0, z];
    let place = [0, 1, 2].map(|k| (point[k] - low[k]) / (high[k] - low[k]) * SIZE[k] as f64 - 0.5);
    let mut sum = 0.0;
    for corner in 0..8_usize {
        let cell = [0, 1, 2].map(|k| place[k].floor() as i64 + (corner >> k & 1) as i64);
        let weight: f64 = (0..3).map(|k| 1.0 - (place[k] - cell[k] as f64).abs()).product();
        if (0..3).all(|k| (0..SIZE[k] as i64).contains(&cell[k])) {
            sum += weight * of(cell.map(|k| k as usize));
        }
    }
    sum
}

/// The integral over depths in the box.
fn integral(mut of: impl FnMut(f64) -> f64) -> f64 {
    const STEPS: u32 = 30_000;
    let width = 3.0 / f64::from(STEPS);
    (0..STEPS).map(|step| of(1.0 + (f64::from(step) + 0.5) * width)).sum::<f64>() * width
}

/// A lamp behind the box.
const LAMP: &str = r#"AttributeBegin Translate 0 0 6 Material "diffuse" "rgb reflectance" [ 0 0 0 ]
    AreaLightSource "diffuse" "rgb L" [ 1 1 1 ] "bool twosided" true Shape "disk" "float radius" 1 AttributeEnd "#;

#[test]
fn what_passes_a_grid_is_its_integral() {
    let sigma = [0.7, 0.2, 1.5];
    let depth = integral(|z| on_axis(&value, z));
    let expected = sigma.map(|sigma| (-sigma * depth).exp());
    let coefficients = |a: &str, s: &str| format!(r#""rgb sigma_a" [ {a} ] "rgb sigma_s" [ {s} ]"#);
    let medium = |split: &str| format!(r#""uniformgrid" {} {BOX} {split}"#, grid("density", value));
    let absorbs = medium(&coefficients("0.7 0.2 1.5", "0 0 0"));
    let scatters = medium(&coefficients("0.3 0 1", "0.4 0.2 0.5"));
    for (medium, what) in [(&absorbs, "absorbs"), (&scatters, "scatters")] {
        let flights = mean(scene_of(0, 1 << 14, medium, AROUND, LAMP));
        assert_near(flights, expected, 0.03, what);
    }
    let mut cast = scene_of(0, 1 << 14, &scatters, AROUND, LAMP);
    cast.render.integrator = Integrator::Raycast;
    let mut clear = scene_of(0, 1, &medium(&coefficients("0 0 0", "0 0 0")), AROUND, LAMP);
    clear.render.integrator = Integrator::Raycast;
    let (cast, clear) = (mean(cast), mean(clear));
    assert_near([0, 1, 2].map(|k| cast[k] / clear[k]), expected, 0.02, "ratio tracking");
}

/// Shadow rays through a grid, from a wall to a lamp of no size.
#[test]
fn shadow_rays_pass_grids() {
    let depth = integral(|z| on_axis(&value, z));
    let world = r#"MediumInterface "fog" "fog" AttributeBegin Translate 0 0 5 Material "diffuse" Shape "disk" "float radius" 1 AttributeEnd
        LightSource "point" "point3 from" [ 0 0 0 ] "rgb I" [ 1 1 1 ]"#;
    let medium = |sigma: f64| {
        format!(
            r#""uniformgrid" {} {BOX} "rgb sigma_a" [ {sigma} {sigma} {sigma} ] "rgb sigma_s" [ 0 0 0 ]"#,
            grid("density", value)
        )
    };
    let [dim, clear] = [0.8, 0.0].map(|sigma| mean(scene_of(1, 1 << 14, &medium(sigma), AROUND, world)));
    // There and back again.
    let passed = (-2.0 * 0.8 * depth).exp();
    assert_near([0, 1, 2].map(|k| dim[k] / clear[k]), [passed; 3], 0.03, "there and back");
}

#[test]
fn a_grid_shines_by_what_it_absorbs() {
    let scale = |[x, y, z]: [usize; 3]| ((x + 2 * y + 3 * z) % 5) as f64 * 0.5;
    let medium = format!(
        r#""uniformgrid" {} {BOX} "rgb sigma_a" [ 0.5 1 0 ] "rgb sigma_s" [ 0 0 0 ] "rgb Le" [ 3 2 1 ] {}"#,
        grid("density", value),
        more("Lescale", scale)
    );
    let expected = [0.5, 1.0].map(|sigma| {
        let mut passed = 0.0_f64;
        integral(|z| {
            let density = sigma * on_axis(&value, z);
            let light = (-passed).exp() * density * on_axis(&scale, z);
            passed += density * 3.0 / 30_000.0;
            light
        })
    });
    let found = mean(scene_of(1, 1 << 14, &medium, AROUND, SPECK));
    assert_near([found[0], found[1], 1.0], [3.0 * expected[0], 2.0 * expected[1], 1.0], 0.02, "shines");
    assert_eq!(found[2], 0.0);
}

#[test]
fn media_that_absorb_nothing_are_unseen_in_a_furnace() {
    let sky = r#"LightSource "infinite" "rgb L" [ 1 1 1 ]"#;
    let colors: String =
        cells().map(|cell| format!("{} {} {} ", value(cell), value(cell) * 3.0, 0.4)).collect();
    let black: String = cells().map(|_| "0 0 0 ").collect();
    let [width, height, depth] = SIZE;
    let size = format!(r#""integer nx" {width} "integer ny" {height} "integer nz" {depth}"#);
    let media = [
        (
            format!(
                r#""uniformgrid" {} {BOX} "rgb sigma_a" [ 0 0 0 ] "rgb sigma_s" [ 2 2 2 ] "float g" 0.5"#,
                grid("density", value)
            ),
            true,
        ),
        (
            format!(
                r#""uniformgrid" {} {BOX} "rgb sigma_a" [ 0 0 0 ] "rgb sigma_s" [ 6 1 0.1 ]"#,
                grid("density", value)
            ),
            false,
        ),
        (
            format!(
                r#""rgbgrid" {size} {BOX} "rgb sigma_a" [ {black} ] "rgb sigma_s" [ {colors} ] "float scale" 2"#
            ),
            false,
        ),
        (format!(r#""cloud" {BOX} "rgb sigma_a" [ 0 0 0 ] "rgb sigma_s" [ 5 5 5 ] "float g" 0.8"#), true),
    ];
    for (medium, is_gray) in media {
        for (before, inside) in [("", true), (AROUND, false)] {
            let ball = r#"AttributeBegin MediumInterface "fog" "" Translate 0.1 0.2 3 Material "interface" Shape "sphere"
                "float radius" 2 AttributeEnd"#;
            let world = format!("{sky}{}", if inside { ball } else { SPECK });
            let seen = mean(scene_of(100_000, if is_gray { 256 } else { 1 << 14 }, &medium, before, &world));
            let sum: f64 = seen.iter().sum();
            assert!((sum / 3.0 - 1.0).abs() < 1e-4, "{medium}: {seen:?}");
            assert_near(seen, [1.0; 3], if is_gray { 1e-4 } else { 0.04 }, &medium);
        }
    }
}

/// A grid of equal numbers is homogeneous where it is full, however it is turned.
#[test]
fn an_even_grid_is_a_homogeneous_medium() {
    let world = r#"LightSource "infinite" "rgb L" [ 0.2 0.3 0.5 ] LightSource "point" "point3 from" [ 1.5 0.5 2 ] "rgb I" [ 4 4 4 ]
        AttributeBegin MediumInterface "fog" "" Translate 0 0 3 Material "interface" Shape "sphere" "float radius" 1 AttributeEnd"#;
    let coefficients = r#""rgb sigma_a" [ 0.1 0.3 0.6 ] "rgb sigma_s" [ 1.1 0.6 0.3 ] "float g" 0.3"#;
    let expected = mean(scene_of(40, 1 << 15, &format!(r#""homogeneous" {coefficients}"#), "", world));
    let ones = "1 ".repeat(1000);
    let even = format!(
        r#""uniformgrid" "integer nx" 10 "integer ny" 10 "integer nz" 10 "float density" [ {ones} ] "float scale" 0.5
        "rgb sigma_a" [ 0.2 0.6 1.2 ] "rgb sigma_s" [ 2.2 1.2 0.6 ] "float g" 0.3 "point3 p0" [ -3 -3 -3 ] "point3 p1" [ 3 3 3 ]"#
    );
    // The medium is placed by the transform where it is made.
    let turned = format!(
        r#"AttributeBegin Translate 0.1 0 3 Rotate 35 1 2 0 Scale 1.2 1 0.9 MakeNamedMedium "grid" "string type" {even} AttributeEnd {}"#,
        world.replace("fog", "grid")
    );
    let found = mean(scene_of(40, 1 << 15, r#""homogeneous""#, "", &turned));
    assert_near(found, expected, 0.02, "turned");
}

/// Smoke before a wall, lit from the side.
fn smoke() -> Scene {
    scene_of(
        8,
        1 << 6,
        &format!(
            r#""uniformgrid" {} {BOX} "rgb sigma_a" [ 0.3 0.4 0.8 ] "rgb sigma_s" [ 2 2.2 2.5 ] "float g" 0.4 {}"#,
            grid("density", value),
            more("temperature", |[_, _, z]| z as f64 * 300.0)
        ),
        AROUND,
        r#"LightSource "infinite" "rgb L" [ 0.2 0.3 0.5 ] LightSource "point" "point3 from" [ 1.5 0.5 2 ] "rgb I" [ 4 4 4 ]
        AttributeBegin Translate 0 0 6 Material "diffuse" Shape "disk" "float radius" 2 AttributeEnd"#,
    )
}

#[test]
fn what_is_told_of_smoke_adds_up() {
    let renderer = Compiled::new(smoke()).renderer();
    let (mut real, mut null, mut shadowed, mut shone) = (0, 0, 0, 0);
    for sample in 0..64 {
        let inspection = inspect(&renderer, SampleId { pixel: [1, 0], sample });
        assert!(inspection.adds_up);
        for ray in &inspection.rays {
            shone += u32::from(ray.medium_emission.as_ref().is_some_and(|light| light.lanes[0] > 0.0));
            let Some(tracking) = &ray.tracking else { continue };
            let mut before = ray.throughput.clone();
            for collision in &tracking.collisions {
                *if collision.is_real { &mut real } else { &mut null } += 1;
                for (k, before) in before.iter().enumerate() {
                    let extinction = collision.absorption[k] + collision.scattering[k];
                    let kept = match collision.is_real {
                        true => collision.scattering[k] / collision.probability,
                        false => (collision.majorant - extinction) / (1.0 - collision.probability),
                    };
                    let expected = before * kept / collision.majorant;
                    let error = (collision.throughput[k] - expected).abs();
                    assert!(error <= 1e-4 * expected + 1e-9, "{collision:?}");
                }
                before.clone_from(&collision.throughput);
            }
            assert_eq!(before, tracking.throughput);
            assert_eq!(
                tracking.scattered_at.is_some(),
                tracking.collisions.last().is_some_and(|last| last.is_real)
            );
            let Some(shadow) = ray.light_sample.as_ref().and_then(|light| light.shadow.as_ref()) else {
                continue;
            };
            shadowed += shadow.collisions.len();
            if let (Some(rest), Some(last)) = (&shadow.rest, shadow.collisions.last()) {
                assert_eq!(*rest, last.transmittance);
            }
        }
    }
    assert!(real > 20 && null > 20 && shadowed > 20 && shone > 20, "{real} {null} {shadowed} {shone}");
}

#[test]
fn russian_roulette_of_shadow_rays_is_told() {
    let thick = scene_of(
        8,
        16,
        &format!(
            r#""uniformgrid" {} {BOX} "rgb sigma_a" [ 1 1 1 ] "rgb sigma_s" [ 20 20 20 ]"#,
            grid("density", value)
        ),
        AROUND,
        r#"LightSource "point" "point3 from" [ 1.5 0.5 2 ] "rgb I" [ 4 4 4 ]"#,
    );
    let renderer = Compiled::new(thick).renderer();
    let mut all = [0; 2];
    for sample in 0..16 {
        let inspection = inspect(&renderer, SampleId { pixel: [1, 0], sample });
        let [mut stronger, mut ended] = [0; 2];
        for shadow in inspection.rays.iter().filter_map(|ray| ray.light_sample.as_ref()?.shadow.as_ref()) {
            let (mut before, mut t) = (1.0, 0.0);
            // Text has the first of them.
            for collision in shadow.collisions.iter().take(24) {
                if collision.t < t {
                    before = 1.0;
                }
                let without = before * (collision.majorant - collision.extinction[0]) / collision.majorant;
                (before, t) = (collision.transmittance[0], collision.t);
                stronger += usize::from(before > 3.9 * without);
                ended += usize::from(before == 0.0 && without > 0.0);
            }
        }
        let text = inspection.to_string();
        let text = text.split_whitespace().collect::<Vec<_>>().join(" ");
        assert_eq!(text.matches("], four times as much by Russian roulette").count(), stronger, "{text}");
        assert_eq!(text.matches("], ended by Russian roulette").count(), ended, "{text}");
        all = [all[0] + stronger, all[1] + ended];
    }
    assert!(all.iter().all(|told| *told > 3), "{all:?}");
}

#[test]
fn pictures_of_smoke_have_the_same_bits_for_any_number_of_threads() {
    let mut scene = smoke();
    (scene.image.width, scene.image.height, scene.render.samples) = (24, 24, 16);
    let compiled = Compiled::new(scene);
    let [one, two] = [1, 2].map(|threads| compiled.render(threads).film.picture().pixels);
    assert_eq!(one, two);
    assert!(one.iter().any(|pixel| pixel[0] > 0.0));
}

/// Densities of all sizes end a picture; none is lost.
#[test]
fn no_density_is_too_large() {
    for (large, scale) in [(1e30, 1.0), (1e30, 1e30), (1.0, 3e38), (1e-30, 1.0)] {
        let density = |cell: [usize; 3]| if cell == [2, 2, 5] { large } else { value(cell) };
        let medium = format!(
            r#""uniformgrid" {} {BOX} "rgb sigma_a" [ 0.3 0.4 0.8 ] "rgb sigma_s" [ 2 2.2 2.5 ] "float scale" {scale}"#,
            grid("density", density)
        );
        let sky = r#"LightSource "infinite" "rgb L" [ 1 1 1 ]"#;
        let seen = mean(scene_of(8, 16, &medium, AROUND, &format!("{sky}{SPECK}")));
        assert!(seen.iter().all(|value| value.is_finite()), "{large}, {scale}: {seen:?}");
    }
}

/// A ball of our own format, filled with a medium, before or around the camera, under a sky of 1.
fn ball(medium: &str, center: f64, more: &str) -> Scene {
    scene(&format!(
        r#"
        camera = {{ lookfrom = [0, 0, 0], lookat = [0, 0, 1], fov = 1 }}
        image = {{ width = 2, height = 2 }}
        render = {{ samples = 4096, depth = 64 }}
        light = [{{ type = "environment", color = 1 }}]
        [[sphere]]
        center = [0, 0, {center}]
        medium = "m"
        [media.m]
        {medium}
        {more}
        "#
    ))
}

#[test]
fn bodies_are_filled_and_the_camera_may_be_in_one() {
    let through = |length: f64| [(-0.7 * length).exp(), (-0.2 * length).exp(), 1.0];
    let medium = "absorption = [0.7, 0.2, 0]";
    assert_near(mean(ball(medium, 3.0, "")), through(2.0), 1e-3, "before");
    assert_near(mean(ball(medium, 0.0, "")), through(1.0), 1e-3, "around");
    // A body in another one, and a glass of the same index as what is around it.
    let inside = r#"
        [[sphere]]
        center = [0, 0, 3]
        radius = 0.5
        material = "glass"
        medium = "m"
        [materials.glass]
        type = "dielectric"
        ior = 1"#;
    assert_near(mean(ball(medium, 3.0, inside)), through(2.0), 1e-3, "one in the other");
    // By a formula and by a texture that are the same everywhere.
    for density in [
        r#"{ formula = "2", min = [-2, -2, 1], max = [2, 2, 5], cells = 3 }"#,
        r#"{ type = "noise", low = 2, high = 2 }"#,
    ] {
        let medium = format!("absorption = [0.35, 0.1, 0]\ndensity = {density}\nmax_density = 3");
        assert_near(mean(ball(&medium, 3.0, "")), through(2.0), 0.02, density);
    }
    let white = r#"scattering = [2, 1, 3]
        density = { type = "noise", low = 0, high = 2 }
        max_density = 2"#;
    let seen = mean(ball(white, 3.0, ""));
    assert_near(seen, [1.0; 3], 0.03, "a furnace");
}
