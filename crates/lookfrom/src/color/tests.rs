use super::*;
use lookfrom_scene::spectrum::{Curve, named};

/// The colour of a spectrum under D65, by summing each nm.
fn color_of(at: impl Fn(&[f32; 4]) -> Spectrum) -> [f32; 3] {
    let light = standard_illuminant().samples();
    let lit = std::array::from_fn(|i| at(&[360.0 + i as f32; 4]).0[0] * light[i]);
    Dense::from_samples(lit).to_rgb()
}

fn far(a: [f32; 3], b: [f32; 3]) -> f32 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
}

/// A lattice over the cube with its faces.
fn cube(steps: usize) -> impl Iterator<Item = [f32; 3]> {
    let level = move |i: usize| i as f32 / (steps - 1) as f32;
    (0..steps.pow(3)).map(move |i| [level(i % steps), level(i / steps % steps), level(i / steps / steps)])
}

#[test]
fn exact_spectra_have_their_colors() {
    let mut worst = (0.0, [0.0; 3]);
    for rgb in cube(9) {
        let sigmoid = Sigmoid::exact_from_rgb(rgb);
        let error = far(color_of(|lambda| sigmoid.at(lambda)), rgb);
        if error > worst.0 {
            worst = (error, rgb);
        }
    }
    assert!(worst.0 < 1e-5, "{worst:?} {:?}", Sigmoid::exact_from_rgb(worst.1));
}

#[test]
fn white_light_is_seen_as_white() {
    let curve = named("stdillum-D65").unwrap();
    assert!(far(Dense::from(&curve).to_rgb(), [1.0; 3]) < 1e-6);
    assert!(far(Dense::from(&Curve::Constant(1.0)).to_rgb_reflectance(), [1.0; 3]) < 1e-6);
}
