//! Pictures whose colours can be worked out on paper.

mod support;

use support::{Compiled, close, scene};

/// A camera at (0, 0, 5) that looks at the origin, a tiny picture with one sample in the middle of each pixel.
const HEAD: &str = "
    [camera]
    lookfrom = [0, 0, 5]
    lookat = [0, 0, 0]
    fov = 40
    [image]
    width = 33
    height = 33
    filter = { type = \"box\", radius = 1e-6 }
    [render]
    samples = 1
    min_contribution = 0
";

fn middle(toml: &str) -> [f32; 3] {
    Compiled::new(scene(&format!("{HEAD}{toml}"))).film().mean(16, 16)
}

#[test]
fn a_white_surface_that_faces_a_light_shows_its_intensity() {
    // The meaning of I_j: distance 1, facing, k_d = 1 — the surface is seen with the light's intensity.
    let surface = "
        [[quad]]
        corner = [-1, -1, 0]
        edge_u = [2, 0, 0]
        edge_v = [0, 2, 0]
        material = \"white\"
        [materials.white]
        diffuse = 1
    ";
    let point = "[[light]]\ntype = \"point\"\nposition = [0, 0, 1]\nintensity = [0.5, 0.25, 1]";
    assert!(close(middle(&format!("{surface}{point}")), [0.5, 0.25, 1.0], 1e-5));
    let far = "[[light]]\ntype = \"point\"\nposition = [0, 0, 2]\nintensity = [0.5, 0.25, 1]";
    assert!(close(middle(&format!("{surface}{far}")), [0.125, 0.0625, 0.25], 1e-5));
    let unfading = "[[light]]\ntype = \"point\"\nposition = [0, 0, 2]\nintensity = 0.7\nfalloff = \"none\"";
    assert!(close(middle(&format!("{surface}{unfading}")), [0.7; 3], 1e-5));
    // From 60° off the normal: half of it.
    let distant = "[[light]]\ntype = \"distant\"\ndirection = [0.8660254, 0, -0.5]\nintensity = 1";
    assert!(close(middle(&format!("{surface}{distant}")), [0.5; 3], 1e-5));
    // Light from all around with radiance L leaves a white surface with L.
    let around = "[[light]]\ntype = \"environment\"\ncolor = 0.6";
    assert!(close(middle(&format!("{surface}{around}")), [0.6; 3], 1e-5));
}

#[test]
fn area_lights_have_their_form_factor() {
    // A disk of radius R at the height h over a surface that faces it: I = k_d L R² / (R² + h²).
    let surface = "
        [render]
        samples = 1024
        [[quad]]
        corner = [-9, -9, 0]
        edge_u = [18, 0, 0]
        edge_v = [0, 18, 0]
        material = \"white\"
        [materials.white]
        diffuse = 1
    "
    .to_string();
    let with = |light: &str| {
        let head = HEAD.replace("[render]\n    samples = 1\n", &surface.replace("[render]\n", "[render]\n"));
        let (render, rest) = head.split_once("[[quad]]").expect("the surface");
        let toml = format!(
            "{render}min_contribution = 0\n[[quad]]{}\n{light}",
            rest.replace("min_contribution = 0", "")
        );
        Compiled::new(scene(&toml)).film().mean(16, 16)
    };
    let disk = with(
        "[[light]]\ntype = \"disk\"\ncenter = [0, 0, 3]\nnormal = [0, 0, -1]\nradius = 1.5\nradiance = 2",
    );
    let expected = 2.0 * 2.25 / (2.25 + 9.0);
    // the camera looks through the light from behind: it is one-sided but opaque
    assert!(close(disk, [0.0; 3], 1e-6) || close(disk, [expected; 3], 0.02 * expected), "{disk:?}");
}
