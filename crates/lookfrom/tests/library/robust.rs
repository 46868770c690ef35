//! No epsilons: the picture does not depend on the scene's unit, nor on where in the world it stands; and nothing that a
//! scene can say makes a number that is not one.

use crate::support::{Compiled, close, own_scene, scene};
use lookfrom::film::Picture;
use lookfrom::world::World;
use lookfrom_scene::settings::Integrator;
use lookfrom_scene::{LoadContext, Memory, image};

/// Glass, a mirror, an instance with a shear, a disk and a mesh over a floor, all times `scale` and moved by `offset`.
fn still_life(scale: f64, offset: [f64; 3]) -> Picture {
    let point = |x: f64, y: f64, z: f64| {
        let [ox, oy, oz] = offset;
        format!("[{:e}, {:e}, {:e}]", x * scale + ox, y * scale + oy, z * scale + oz)
    };
    let vector = |x: f64, y: f64, z: f64| format!("[{:e}, {:e}, {:e}]", x * scale, y * scale, z * scale);
    let length = |x: f64| format!("{:e}", x * scale);
    let toml = format!(
        r#"
        [camera]
        lookfrom = {eye}
        lookat = {target}
        [image]
        width = 64
        height = 48
        [render]
        samples = 4
        [materials.glass]
        diffuse = 0
        transmission = 0.9
        fresnel = true
        [materials.mirror]
        diffuse = 0.2
        mirror = 0.7
        [materials.white]
        diffuse = 0.7
        specular = 0.3
        [[quad]]
        corner = {floor}
        edge_u = {floor_u}
        edge_v = {floor_v}
        material = "white"
        [[sphere]]
        center = {s1}
        radius = {one}
        material = "glass"
        [[sphere]]
        center = {s2}
        radius = {one}
        material = "mirror"
        [[disk]]
        center = {disk}
        normal = [0.2, 0.3, 1]
        radius = {two}
        material = "white"
        [[objects.ball.sphere]]
        material = "glass"
        [[instance]]
        object = "ball"
        scale = {stretched}
        rotate = [10, 20, 30]
        translate = {s3}
        [[light]]
        type = "point"
        position = {lamp}
        intensity = 0.6
        falloff = "none"
        [[light]]
        type = "environment"
        color = 0.3
        "#,
        eye = point(0.5, 2.0, 8.0),
        target = point(0.0, 0.5, 0.0),
        floor = point(-16.0, 0.0, 16.0),
        floor_u = vector(32.0, 0.0, 0.0),
        floor_v = vector(0.0, 0.0, -32.0),
        s1 = point(-1.5, 1.0, 0.0),
        s2 = point(1.5, 1.0, -0.5),
        s3 = point(0.0, 0.5, 2.0),
        disk = point(0.0, 1.5, -3.0),
        lamp = point(3.0, 6.0, 4.0),
        stretched = vector(0.5, 0.25, 0.5),
        one = length(1.0),
        two = length(2.0),
    );
    Compiled::new(scene(&toml)).film().picture()
}

#[test]
fn a_scene_of_any_size_makes_the_same_picture() {
    // Powers of two scale every number of the scene exactly, so the pictures are the same to the last bit.
    let usual = still_life(1.0, [0.0; 3]);
    let brightness: f32 = usual.pixels.iter().map(|rgb| rgb[1]).sum::<f32>() / usual.pixels.len() as f32;
    assert!((0.1..0.9).contains(&brightness), "the still life has something to see: {brightness}");
    for exponent in [-40, -20, -7, 5, 20, 40] {
        let other = still_life(2f64.powi(exponent), [0.0; 3]);
        let different = usual.pixels.iter().zip(&other.pixels).filter(|(a, b)| a != b).count();
        assert_eq!(different, 0, "pixels differ at the scale 2^{exponent}");
    }
}

#[test]
fn a_scene_far_from_the_origin_makes_the_same_picture() {
    // Render space begins at the eye, so only the rounding of the moved numbers themselves is left: some samples at
    // silhouettes fall to the other side.
    let usual = still_life(1.0, [0.0; 3]);
    for offset in [[148_376.0, 1234.0, -223_423.0], [1e8, -3e8, 2e8]] {
        let moved = still_life(1.0, offset);
        let different =
            usual.pixels.iter().zip(&moved.pixels).filter(|(a, b)| !close(**a, **b, 0.02)).count();
        assert!(different < usual.pixels.len() / 100, "{different} pixels differ at {offset:?}");
    }
}

#[test]
fn own_scenes_drop_no_sample() {
    for entry in std::fs::read_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes")).expect("the scenes")
    {
        let name = entry.expect("an entry").file_name().into_string().expect("a name");
        if !name.ends_with(".toml") || name.starts_with("sphereflake") {
            continue;
        }
        for integrator in [Integrator::Whitted, Integrator::Raycast, Integrator::Depth, Integrator::Uv] {
            let mut scene = own_scene(&name);
            (scene.image.width, scene.image.height, scene.image.crop) = (64, 48, None);
            scene.render.samples = 2;
            scene.render.integrator = integrator;
            let film = Compiled::new(scene).film();
            assert_eq!(film.dropped(), 0, "{name} with {integrator:?}: {:?}", film.first_dropped());
            assert!(film.picture().pixels.iter().any(|rgb| rgb[1] > 0.0), "{name} is black");
        }
    }
}

/// A scene lit by a picture of 16 × 8 texels with a camera of 40° toward `lookat` from the origin.
fn under_sky(texels: &[[f32; 3]], rest: &str) -> lookfrom::film::Film {
    let toml = format!(
        "[image]\nwidth = 9\nheight = 9\nfilter = {{ type = \"box\", radius = 1e-6 }}\n\
         [[light]]\ntype = \"environment\"\nimage = \"sky.pfm\"\n{rest}"
    );
    let sky = image::encode_pfm(16, 8, texels).expect("a small picture");
    let files = Memory([("s.toml".into(), toml.into_bytes()), ("sky.pfm".into(), sky)].into());
    let mut context = LoadContext::new(&files);
    let scene = lookfrom_scene::load::scene("s.toml".as_ref(), &mut context)
        .unwrap_or_else(|error| panic!("{error}"));
    Compiled::new(scene).film()
}

#[test]
fn a_picture_of_the_surroundings_is_seen_where_it_should_be() {
    // Bright only around u = ½, v = ½: toward −z. And a quarter to the right of it: toward +x.
    let bright_at = |column: usize| {
        let mut texels = vec![[0.0; 3]; 16 * 8];
        for row in 3..5 {
            for column in [column, column - 1] {
                texels[row * 16 + column] = [5.0, 3.0, 1.0];
            }
        }
        texels
    };
    let look =
        |to: &str| format!("[camera]\nlookfrom = [0, 0, 0]\nlookat = {to}\nfov = 5\n[render]\nsamples = 1");
    assert!(close(under_sky(&bright_at(8), &look("[0, 0, -1]")).mean(4, 4), [5.0, 3.0, 1.0], 1e-4));
    assert!(close(under_sky(&bright_at(12), &look("[1, 0, 0]")).mean(4, 4), [5.0, 3.0, 1.0], 1e-4));
    assert_eq!(under_sky(&bright_at(12), &look("[-1, 0, 0]")).mean(4, 4), [0.0; 3]);
}

#[test]
fn a_picture_of_the_surroundings_lights_like_its_integral() {
    // A white floor under a sky with L(θ) rows: E/π by the picture's own integral, texel by texel.
    let texels: Vec<[f32; 3]> = (0..16 * 8).map(|i| [1.0 + (i % 5) as f32, 1.0, (i / 16) as f32]).collect();
    let rest = "
        [camera]
        lookfrom = [0, 3, 0]
        lookat = [0, 0, 0]
        up = [0, 0, -1]
        fov = 1
        [render]
        samples = 4096
        [materials.white]
        diffuse = 1
        [[quad]]
        corner = [-5, 0, 5]
        edge_u = [10, 0, 0]
        edge_v = [0, 0, -10]
        material = \"white\"
    ";
    let seen = under_sky(&texels, rest).mean(4, 4);
    // the slow way: midpoints of a fine grid through the same bilinear look-up, by hand
    let picture = image::Image::from_linear("", 16, 8, texels);
    let (columns, rows) = (512, 256);
    let mut expected = [0.0f64; 3];
    for row in 0..rows / 2 {
        let v = (row as f32 + 0.5) / rows as f32;
        let theta = f64::from(v) * std::f64::consts::PI;
        for column in 0..columns {
            use lookfrom_scene::texture::{TexelFilter, Wrap};
            let u = (column as f32 + 0.5) / columns as f32;
            let wrap = [Wrap::Repeat, Wrap::Clamp];
            let rgb = lookfrom::shading::texture::look_up(&picture, [u, v], wrap, TexelFilter::Bilinear);
            let solid_angle = theta.sin() * 2.0 * std::f64::consts::PI.powi(2) / f64::from(columns * rows);
            for (sum, value) in expected.iter_mut().zip(rgb) {
                *sum += f64::from(value) * theta.cos() * solid_angle / std::f64::consts::PI;
            }
        }
    }
    assert!(close(seen, expected.map(|x| x as f32), 0.02 * expected[0] as f32), "{seen:?} {expected:?}");
}

#[test]
fn empty_and_odd_scenes_are_pictures_too() {
    // Nothing at all; the eye inside a sphere; the eye on a surface; a mirror that only sees itself.
    for toml in [
        "",
        "[[sphere]]\ncenter = [0, 1, 5]\nradius = 1\n[[light]]\ntype = \"point\"\nposition = [0, 1, 5]\nintensity = 1",
        "[[quad]]\ncorner = [-1, 0, 5]\nedge_u = [2, 0, 0]\nedge_v = [0, 2, 0]\n[[light]]\ntype = \"environment\"\ncolor = 1",
        "[materials.m]\nmirror = 1\ndiffuse = 0\n[[box]]\nmin = [-9, -9, -9]\nmax = [9, 9, 9]\nmaterial = \"m\"",
    ] {
        let mut scene = scene(toml);
        (scene.image.width, scene.image.height, scene.render.samples) = (8, 6, 2);
        let film = Compiled::new(scene).film();
        assert_eq!(film.dropped(), 0);
        assert_eq!(film.samples(3, 3), 2);
    }
    let mut warnings = Vec::new();
    let singular = "[[sphere]]\ncenter = [0, 0, 0]\nradius = 1";
    let mut bad = scene(singular);
    bad.shapes[0].world_from_object = glam::DMat4::from_scale(glam::DVec3::new(1.0, 0.0, 1.0));
    assert!(World::compile(bad, &mut warnings).expect_err("not invertible").to_string().contains("inverted"));
}

/// The distance of a parallel camera changes nothing.
#[test]
fn a_parallel_camera_may_be_far_away() {
    let picture = |distance: f64, forward: [f64; 3]| {
        let [x, y, z] = forward.map(|w| -w * distance);
        let scene = scene(&format!(
            r#"
            [camera]
            lookfrom = [{x}, {y}, {z}]
            lookat = [0, 0, 0]
            projection = "orthographic"
            height = 0.3
            [image]
            width = 40
            height = 40
            filter = "box"
            [render]
            integrator = "path"
            samples = 4
            [[sphere]]
            radius = 0.1
            material = "m"
            [materials.m]
            type = "diffuse"
            [[light]]
            type = "distant"
            direction = [-1, -0.3, -1]
            intensity = 1
            "#
        ));
        Compiled::new(scene).film().picture()
    };
    for forward in [[0.0, 0.0, -1.0], [0.6, -0.64, 0.48]] {
        let near = picture(1.0, forward);
        for distance in [1e3, 1e5, 1e7] {
            let far = picture(distance, forward);
            let differ = |(a, b): (&[f32; 3], &[f32; 3])| (a[1] - b[1]).abs() > 0.02;
            let count = near.pixels.iter().zip(&far.pixels).filter(|pair| differ(*pair)).count();
            assert!(count < 8, "{forward:?} from {distance}: {count} pixels differ");
        }
    }
}

/// The way of light through a medium is as long from a parallel camera as from any other, however far away that is.
#[test]
fn a_parallel_camera_far_away_sees_through_all_of_a_medium() {
    let passed = |distance: f64, absorption: f64, integrator: &str| {
        let scene = scene(&format!(
            r#"
            [camera]
            lookfrom = [0, 0, {distance}]
            lookat = [0, 0, 0]
            projection = "orthographic"
            height = 0.5
            medium = "fog"
            [media.fog]
            absorption = {absorption}
            [image]
            width = 2
            height = 2
            [render]
            integrator = "{integrator}"
            samples = 1
            [[quad]]
            corner = [-0.5, -0.5, 0]
            edge_u = [1, 0, 0]
            edge_v = [0, 1, 0]
            emission = 1
            "#
        ));
        Compiled::new(scene).film().picture().pixels[0][1]
    };
    for distance in [1.0, 50.0, 1e4] {
        for integrator in ["path", "whitted"] {
            let found = passed(distance, 1.0 / distance, integrator);
            assert!((found - (-1.0_f32).exp()).abs() < 1e-5, "{integrator} from {distance}: {found}");
        }
    }
}

/// The ground below an eye is where it is on a sphere of any size.
#[test]
fn the_ground_of_planets_is_where_it_is() {
    for radius in [1e4, 1e5, 6.371e6, 1e8, 3e9] {
        let scene = scene(&format!(
            r#"
            [camera]
            lookfrom = [0, 1.7, 0]
            lookat = [0, 0, 0]
            up = [0, 0, 1]
            fov = 1
            [image]
            width = 4
            height = 4
            [render]
            integrator = "depth"
            samples = 1
            [[sphere]]
            center = [0, -{radius}, 0]
            radius = {radius}
            "#
        ));
        let depths = Compiled::new(scene).film().picture().pixels;
        assert!(depths.iter().all(|depth| (depth[0] - 1.7).abs() < 2e-3), "{radius}: {depths:?}");
    }
}
