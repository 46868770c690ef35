//! OpenPBR in pictures: white in white light stays white, glass is that of glTF with its dispersion, media and light below the
//! surface arrive.

use crate::support::{Compiled, SMALL, scene};

/// A ball in light from everywhere, or before a sky that is brighter above.
fn ball(look: &str, settings: &str, sky: &str) -> Compiled {
    let toml = format!(
        r#"
        [camera]
        lookfrom = [0, 0.3, 4]
        lookat = [0, 0.3, 0]
        fov = 24
        {SMALL}
        depth = 40
        {settings}
        [materials.ball]
        {look}
        [[sphere]]
        radius = 1
        material = "ball"
        [[light]]
        type = "environment"
        {sky}
    "#
    );
    Compiled::new(scene(&toml))
}

const EVEN: &str = "color = 1";
const SKY: &str = "zenith = [4, 3, 2]\nhorizon = [0.2, 0.5, 0.3]\nnadir = 0";

/// The mean of all pixels.
fn mean(compiled: &Compiled) -> [f32; 3] {
    let film = compiled.film();
    let mut sum = [0.0; 3];
    for (x, y) in (0..64).map(|k| (k % 8, k / 8)) {
        let pixel = film.mean(x, y);
        (0..3).for_each(|k| sum[k] += pixel[k] / 64.0);
    }
    sum
}

#[test]
fn white_in_white_light_stays_white() {
    for (look, least) in [
        ("base_color = 1", 0.99),
        ("base_color = 1\nbase_diffuse_roughness = 1\nspecular_weight = 0", 0.99),
        ("base_color = 1\nbase_diffuse_roughness = 1", 0.98),
        ("base_color = 1\nbase_metalness = 1\nspecular_roughness = 0.8", 0.98),
        ("base_color = 1\nfuzz_weight = 1", 0.98),
        ("base_color = 1\ntransmission_weight = 1\nspecular_roughness = 0.5", 0.97),
        ("base_color = 1\ngeometry_thin_walled = true\nsubsurface_weight = 1\nsubsurface_color = 1", 0.97),
        // A coat takes what it does not reflect, by the larger of two albedos.
        ("base_color = 1\ncoat_weight = 1\ncoat_roughness = 0.3", 0.95),
    ] {
        let [r, g, b] = mean(&ball(&format!("type = \"openpbr\"\n{look}"), "samples = 256", EVEN));
        for lane in [r, g, b] {
            assert!(lane > least && lane < 1.01, "{look}: {lane}");
        }
    }
}

#[test]
fn glass_is_gltfs() {
    let spectral = "samples = 256\ncolor = \"spectral\"";
    for (settings, is_dispersed) in [("samples = 256", false), (spectral, false), (spectral, true)] {
        let (ours, gltfs) = match is_dispersed {
            true => ("transmission_dispersion_scale = 0.5", "dispersion = 0.5"),
            false => ("", ""),
        };
        let ours = format!(
            "type = \"openpbr\"\nspecular_ior = 1.6\ntransmission_weight = 1\nspecular_roughness = 0\n{ours}"
        );
        let gltfs = format!(
            "type = \"principled\"\nbase_color = 1\nroughness = 0\nior = 1.6\ntransmission = 1\nsolid = true\n{gltfs}"
        );
        let [ours, gltfs] = [ours, gltfs].map(|look| mean(&ball(&look, settings, SKY)));
        for k in 0..3 {
            assert!((ours[k] - gltfs[k]).abs() < 1e-4 * gltfs[k], "{settings}: {ours:?} {gltfs:?}");
        }
    }
}

#[test]
fn layers_and_media_have_their_effect() {
    let of = |look: &str| mean(&ball(&format!("type = \"openpbr\"\n{look}"), "samples = 128", EVEN));
    let plain = of("");
    // A coloured coat, a darkening one, one that does not darken.
    let coats = ["coat_color = [1, 0.4, 0.1]", "", "coat_darkening = 0"]
        .map(|coat| of(&format!("coat_weight = 1\n{coat}")));
    assert!(coats[0][2] < 0.7 * coats[1][2], "{coats:?}");
    assert!(coats[1][1] < 0.97 * coats[2][1], "{coats:?}");
    // A medium inside: white light takes its colour.
    let honey = of("transmission_weight = 1\ntransmission_color = [0.9, 0.5, 0.1]\ntransmission_depth = 1");
    assert!(honey[0] > honey[1] + 0.05 && honey[1] > honey[2] + 0.05, "{honey:?}");
    // One that scatters reflects some of it.
    let milky = of(
        "transmission_weight = 1\ntransmission_color = [0.9, 0.5, 0.1]\ntransmission_depth = 1\ntransmission_scatter = 0.6",
    );
    assert!(milky != honey);
    // Light below the surface, in part and as a whole.
    let wax = ["1", "0.5"].map(|part| {
        of(&format!(
            "subsurface_weight = {part}\nsubsurface_color = [0.9, 0.3, 0.3]\nsubsurface_radius = 0.01"
        ))
    });
    assert!(wax[0][0] > 1.3 * wax[0][1], "{wax:?}");
    assert!(wax[1][1] > wax[0][1] && wax[1][1] < plain[1], "{wax:?} {plain:?}");
    // Of the light behind a black ball, half passes its front, and half of that its back.
    let ghost = of("base_weight = 0\nspecular_weight = 0\ngeometry_opacity = 0.5");
    let black = of("base_weight = 0\nspecular_weight = 0");
    assert!((ghost[0] - black[0] - 0.25 * (1.0 - black[0])).abs() < 0.03, "{ghost:?} {black:?}");
}
