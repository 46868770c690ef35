//! A room with a window: the sky lights it as before when the window is named as its portal, and with less noise.

use std::sync::Arc;

use lookfrom::session::{Options, Session};
use lookfrom_scene::settings::ImageSettings;

use crate::support::{Compiled, scene};

/// A room of 4 × 4 × 4 around the origin, open on a window of 1 × 1 in the wall at z = −2; the camera looks at its back wall.
fn room(integrator: &str, color: &str, sky: &str, portal: bool) -> [f64; 3] {
    let film = compiled(integrator, color, sky, portal, "named").film();
    assert_eq!(film.dropped(), 0);
    let pixels = film.picture().pixels;
    let mean = |c: usize| pixels.iter().map(|pixel| f64::from(pixel[c])).sum::<f64>() / pixels.len() as f64;
    std::array::from_fn(mean)
}

/// That room, with portals as named or found.
fn compiled(integrator: &str, color: &str, sky: &str, portal: bool, portals: &str) -> Compiled {
    Compiled::new(scene(&text(integrator, color, sky, portal, portals)))
}

/// The file of that room.
fn text(integrator: &str, color: &str, sky: &str, portal: bool, portals: &str) -> String {
    let portal = if portal {
        "portal = [[-0.5, -0.5, -2], [0.5, -0.5, -2], [0.5, 0.5, -2], [-0.5, 0.5, -2]]"
    } else {
        ""
    };
    let quad = |corner: [f64; 3], u: [f64; 3], v: [f64; 3]| {
        format!("[[quad]]\ncorner = {corner:?}\nedge_u = {u:?}\nedge_v = {v:?}\nmaterial = \"wall\"\n")
    };
    let (x, y, z) = ([4.0, 0.0, 0.0], [0.0, 4.0, 0.0], [0.0, 0.0, 4.0]);
    let walls = [
        quad([-2.0, -2.0, 2.0], x, y),
        quad([-2.0, -2.0, -2.0], x, z),
        quad([-2.0, 2.0, -2.0], x, z),
        quad([-2.0, -2.0, -2.0], y, z),
        quad([2.0, -2.0, -2.0], y, z),
        // around the window
        quad([-2.0, -2.0, -2.0], [1.5, 0.0, 0.0], y),
        quad([0.5, -2.0, -2.0], [1.5, 0.0, 0.0], y),
        quad([-0.5, -2.0, -2.0], [1.0, 0.0, 0.0], [0.0, 1.5, 0.0]),
        quad([-0.5, 0.5, -2.0], [1.0, 0.0, 0.0], [0.0, 1.5, 0.0]),
    ];
    format!(
        r#"
[image]
width = 12
height = 12
[render]
integrator = "{integrator}"
color = "{color}"
portals = "{portals}"
samples = 256
depth = 3
[camera]
lookfrom = [0, 0, 0]
lookat = [0, 0, 1]
fov = 80
[materials.wall]
type = "diffuse"
reflectance = [0.8, 0.6, 0.4]
{}
[[light]]
type = "environment"
{sky}
{portal}
"#,
        walls.concat()
    )
}

/// A window that is found lets in as much light as one that is not, and there is less noise, with the same bits for any number
/// of threads.
#[test]
fn a_window_is_found() {
    let sky = "zenith = [1, 2, 6]\nhorizon = [3, 3, 3]";
    // Brightness of each pixel: means of all, and the mean squared difference of pairs that are seen alike, left and right.
    let measure = |portals: &str| {
        let compiled = compiled("path", "rgb", sky, false, portals);
        let film = compiled.render(1).film;
        assert!(film == compiled.render(2).film, "{portals}");
        let pixels: Vec<f64> = film.picture().pixels.iter().map(|pixel| f64::from(pixel[1])).collect();
        let pairs = (0..72).map(|k| (pixels[k / 6 * 12 + k % 6], pixels[k / 6 * 12 + 11 - k % 6]));
        let noise = pairs.map(|(a, b)| (a - b) * (a - b)).sum::<f64>() / 144.0;
        (pixels.iter().sum::<f64>() / 144.0, noise)
    };
    let (named, noise) = measure("named");
    let (found, noise_of_found) = measure("auto");
    // The mean of 144 pixels, each with half the variance of a difference.
    let z = (named - found) / ((noise + noise_of_found) / 144.0).sqrt();
    assert!(z.abs() < 4.0, "{named} {found}, {z} standard deviations");
    assert!(noise_of_found < 0.5 * noise, "{noise_of_found}, not far below {noise}");
}

/// A guide is learned for the rays of a picture, so again for another size, but not for another development (exposure, denoising).
#[test]
fn what_is_developed_otherwise_is_not_learned_again() {
    let text = text("path", "rgb", "zenith = [1, 2, 6]\nhorizon = [3, 3, 3]", false, "auto");
    let mut session = Session::of_scene(scene(&text), &Options::default()).expect("a scene");
    let learned = session.world().clone();
    let developed = ImageSettings { exposure: 1.0, denoise: true, ..session.image().clone() };
    session.set_image(developed.clone()).expect("an image");
    assert!(Arc::ptr_eq(&learned, session.world()));
    session.set_image(ImageSettings { width: 13, ..developed }).expect("an image");
    assert!(!Arc::ptr_eq(&learned, session.world()));
}

/// A guide that is given up: a notice, and the bits of the picture without one.
#[test]
fn what_is_given_up_is_told() {
    let under_a_sky = |more: &str| {
        let text = format!(
            "[image]\nwidth = 8\nheight = 8\n[render]\nintegrator = \"path\"\nsamples = 4\n{more}\n\
             [materials.m]\ntype = \"diffuse\"\n[[sphere]]\ncenter = [0, 0, -4]\nradius = 1\nmaterial = \"m\"\n\
             [[light]]\ntype = \"environment\"\nzenith = [1, 2, 6]\nhorizon = [3, 3, 3]"
        );
        Session::of_scene(scene(&text), &Options::default()).expect("a scene")
    };
    let told = |session: &Session| {
        session
            .warnings()
            .iter()
            .filter(|warning| warning.message.starts_with("no openings are sampled"))
            .count()
    };
    let [named, auto] = ["", "portals = \"auto\""].map(under_a_sky);
    assert_eq!([&named, &auto].map(told), [0, 1]);
    let [named, auto] =
        [named, auto].map(|session| session.render(&()).expect("a picture").rendered.film.picture().pixels);
    assert!(named == auto);
}

#[test]
fn a_window_lets_in_what_came_in_before() {
    let skies = ["color = [2, 3, 5]", "zenith = [1, 2, 6]\nhorizon = [3, 3, 3]\nnadir = [0.5, 0.5, 0.2]"];
    for sky in skies {
        for color in ["rgb", "spectral"] {
            let expected = room("path", color, sky, false);
            for integrator in ["path", "simple_path", "whitted"] {
                let found = room(integrator, color, sky, true);
                if integrator == "whitted" {
                    assert!(found.iter().all(|c| c.is_finite() && *c >= 0.0));
                    continue;
                }
                for c in 0..3 {
                    let ratio = found[c] / expected[c];
                    assert!(
                        (ratio - 1.0).abs() < 0.05,
                        "{sky}, {integrator}, {color}: {found:?}, not {expected:?}"
                    );
                }
            }
        }
    }
}

#[test]
fn outside_of_the_window_there_is_nothing() {
    // The same room without walls: only the window shines.
    let text = |lookat: &str| {
        format!(
            "[image]\nwidth = 8\nheight = 8\n[render]\nintegrator = \"path\"\nsamples = 16\n[camera]\nlookfrom = [0, 0, 0]\n\
             lookat = {lookat}\nfov = 20\n[[sphere]]\ncenter = [0, 9, 0]\nradius = 1\n[[light]]\ntype = \"environment\"\n\
             color = [1, 1, 1]\nportal = [[-0.5, -0.5, -2], [0.5, -0.5, -2], [0.5, 0.5, -2], [-0.5, 0.5, -2]]\n"
        )
    };
    for (lookat, seen) in [("[0, 0, -1]", 1.0), ("[0, 0, 1]", 0.0), ("[1, 0, -1]", 0.0)] {
        let pixels = Compiled::new(scene(&text(lookat))).film().picture().pixels;
        assert!(pixels.iter().flatten().all(|c| (c - seen).abs() < 1e-3), "{lookat}: {:?}", pixels[0]);
    }
}
