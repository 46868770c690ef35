//! Dispersion in RGB mode: does each colour go where its own index of refraction sends it, is nothing won or lost by leaving
//! only one, and does nothing change where nothing disperses?

use crate::support::{Compiled, SMALL, scene};
use lookfrom::inspect::inspect;
use lookfrom::render::SampleId;

/// A ball before a sky that is brighter above, close up.
fn ball(look: &str, samples: u32) -> Compiled {
    let toml = format!(
        r#"
        [camera]
        lookfrom = [0, 0.3, 4]
        lookat = [0, 0.3, 0]
        fov = 24
        {SMALL}
        samples = {samples}
        depth = 16
        [materials.ball]
        type = "principled"
        base_color = 1
        roughness = 0
        {look}
        [[sphere]]
        radius = 1
        material = "ball"
        [[light]]
        type = "environment"
        zenith = [4, 3, 2]
        horizon = [0.2, 0.5, 0.3]
        nadir = 0
    "#
    );
    Compiled::new(scene(&toml))
}

const GLASS: &str = "transmission = 1\nsolid = true\n";

/// The mean by channel and row.
fn rows(compiled: &Compiled) -> Vec<[f32; 3]> {
    let film = compiled.film();
    let mean = |y| {
        let sum = (0..8).map(|x| film.mean(x, y)).fold([0.0; 3], |sum, c| [0, 1, 2].map(|k| sum[k] + c[k]));
        sum.map(|sum| sum / 8.0)
    };
    (0..8).map(mean).collect()
}

#[test]
fn each_colour_has_its_index() {
    let dispersion = 12.0;
    let dispersed = rows(&ball(&format!("{GLASS} ior = 1.6\n dispersion = {dispersion}"), 4096));
    let mut differs = false;
    for channel in 0..3 {
        let ior = 1.6 + 0.6 * 0.025 * dispersion * (channel as f64 - 1.0);
        let expected = rows(&ball(&format!("{GLASS} ior = {ior}"), 1024));
        let green = rows(&ball(&format!("{GLASS} ior = 1.6"), 1024));
        for (row, (found, expected)) in dispersed.iter().zip(&expected).enumerate() {
            let (found, expected) = (found[channel], expected[channel]);
            assert!((found - expected).abs() < 0.04, "channel {channel}, row {row}: {found}, {expected}");
            differs |= (expected - green[row][channel]).abs() > 0.2;
        }
    }
    assert!(differs, "a test that cannot fail: the colours go the same way");
}

#[test]
fn less_and_less_dispersion_becomes_none() {
    let none = rows(&ball(GLASS, 1024));
    let hardly = rows(&ball(&format!("{GLASS} dispersion = 1e-5"), 4096));
    for (found, expected) in hardly.iter().flatten().zip(none.iter().flatten()) {
        assert!((found - expected).abs() < 0.04, "{found}, {expected}");
    }
}

#[test]
fn what_lets_no_colour_go_its_own_way_keeps_its_bits() {
    for look in [
        "ior = 1.8",
        "ior = 1.8\nmetallic = 1\ntransmission = 1\nsolid = true",
        "ior = 1.8\ntransmission = 1",
        "ior = 1\ntransmission = 1\nsolid = true",
    ] {
        let [plain, dispersing] = ["", "\ndispersion = 3"].map(|more| ball(&format!("{look}{more}"), 4));
        assert_eq!(plain.film().picture().pixels, dispersing.film().picture().pixels, "{look}");
    }
}

#[test]
fn the_inspector_tells_which_colour_is_left() {
    let compiled = ball(&format!("{GLASS} ior = 1.6\n dispersion = 4"), 4);
    let renderer = compiled.renderer();
    let mut told = std::collections::BTreeSet::new();
    for (x, y, sample) in (0..8).flat_map(|x| (0..8).flat_map(move |y| (0..3).map(move |s| (x, y, s)))) {
        let inspection = inspect(&renderer, SampleId { pixel: [x, y], sample });
        assert!(inspection.adds_up);
        let mut lane = None;
        for ray in &inspection.rays {
            let Some(scattering) = &ray.scattering else { continue };
            let share = ray.throughput_there.as_ref().expect("a share");
            if let Some(color) = ray.only_color {
                // Only once, and for all three.
                assert!(lane.is_none() && ray.throughput == [1.0; 3]);
                lane = ["red", "green", "blue"].iter().position(|name| *name == color);
                told.insert(color);
                assert!(inspection.to_string().contains(&format!("{color} goes on alone")));
            }
            let lane = lane.expect("a colour was chosen at the first surface");
            assert!(share.iter().enumerate().all(|(k, share)| (*share != 0.0) == (k == lane)));
            let eta = scattering.numbers.iter().find(|(name, _)| *name == "eta").expect("an index").1[0];
            assert!((eta - (1.6 + 0.06 * (lane as f32 - 1.0))).abs() < 1e-6, "{eta} in lane {lane}");
        }
        if let Some(first) = inspection.rays.first().filter(|ray| ray.met.is_some()) {
            let share = first.throughput_there.as_ref().expect("a share");
            assert_eq!(share.iter().sum::<f32>(), 3.0);
        }
    }
    assert_eq!(told.len(), 3, "{told:?}");
}
