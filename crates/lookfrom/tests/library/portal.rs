//! A room with a window: the sky lights it as before when the window is named as its portal, and with less noise.

use crate::support::{Compiled, scene};

/// A room of 4 × 4 × 4 around the origin, open on a window of 1 × 1 in the wall at z = −2; the camera looks at its back wall.
fn room(integrator: &str, color: &str, sky: &str, portal: bool) -> [f64; 3] {
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
    let text = format!(
        r#"
[image]
width = 12
height = 12
[render]
integrator = "{integrator}"
color = "{color}"
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
    );
    let film = Compiled::new(scene(&text)).film();
    assert_eq!(film.dropped(), 0);
    let pixels = film.picture().pixels;
    let mean = |c: usize| pixels.iter().map(|pixel| f64::from(pixel[c])).sum::<f64>() / pixels.len() as f64;
    std::array::from_fn(mean)
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
