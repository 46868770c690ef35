//! What a sensor makes of whole samples: the limit of their brightness, and the noise of its own channels.

use crate::support::{Compiled, close, scene};
use lookfrom::core::color::{rgb_from_xyz, xyz_of};
use lookfrom::film::Film;
use lookfrom::render::SampleId;
use lookfrom::shading::texture::SpectralMode;

/// A ball of glass that disperses, before a bright sky.
fn prism(image: &str, color: &str) -> Compiled {
    let toml = format!(
        r#"
        [camera]
        lookfrom = [0, 0.3, 4]
        lookat = [0, 0.3, 0]
        fov = 24
        [image]
        width = 8
        height = 8
        filter = "box"
        {image}
        [render]
        integrator = "path"
        samples = 32
        color = "{color}"
        [materials.ball]
        type = "dielectric"
        ior = "SF11"
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

#[test]
fn brightness_is_limited_in_the_sensors_channels() {
    const MOST: f32 = 1.5;
    for color in ["spectral", "rgb"] {
        let [limited, free] =
            [format!("max_component = {MOST}"), String::new()].map(|image| prism(&image, color));
        let ids: Vec<SampleId> =
            (0..64 * 8).map(|i| SampleId { pixel: [i % 8, i / 8 % 8], sample: i / 64 }).collect();
        let (limited, free) = (limited.renderer().trace(&ids).0, free.renderer().trace(&ids).0);
        let mut darkened = 0;
        for (limited, free) in limited.iter().zip(&free) {
            assert_eq!(limited.radiance, free.radiance);
            let xyz = match free.mode {
                SpectralMode::Spectral(wavelengths) => xyz_of(free.radiance, &wavelengths),
                SpectralMode::Rgb => lookfrom::core::color::xyz_from_rgb(free.rgb),
            };
            // The same colour, darker where X, Y or Z is too bright.
            let brightest = xyz.into_iter().fold(0.0, f32::max);
            darkened += usize::from(brightest > MOST);
            let expected = rgb_from_xyz(xyz.map(|value| value * (MOST / brightest).min(1.0)));
            let size = expected.into_iter().fold(1.0, |most: f32, c| most.max(c.abs()));
            assert!(close(limited.rgb, expected, 2e-5 * size), "{color}: {:?} ≠ {expected:?}", limited.rgb);
        }
        assert!((20..ids.len() - 20).contains(&darkened), "{color}: {darkened}");
    }
}

/// The variance in X, Y and Z, and in the sensor's channels.
fn variances(film: &Film) -> Vec<([f32; 3], Option<[f32; 3]>)> {
    let places = (0..8).flat_map(|y| (0..8).map(move |x| (x, y)));
    places.map(|(x, y)| (film.variance(x, y), film.channel_variance(x, y))).collect()
}

#[test]
fn noise_is_known_in_the_channels_of_the_sensor() {
    let plain = prism("layers = true", "spectral").film();
    assert!(variances(&plain).iter().all(|(_, channels)| channels.is_none()));
    // The observer's channels are X, Y and Z before the balance: those of the plain picture.
    let warm = prism("layers = true\nwhite_balance = 3000", "spectral").film();
    let mut differ = false;
    for ((plain, _), (balanced, channels)) in variances(&plain).into_iter().zip(variances(&warm)) {
        let channels = channels.expect("layers");
        let size = plain.into_iter().fold(1e-6, f32::max);
        // X, Y and Z of Rec. 709 by seven digits and by the spectrum of its white differ a little.
        assert!(close(channels, plain, 1e-3 * size), "{channels:?} ≠ {plain:?}");
        differ |= !close(balanced, plain, 0.01 * size);
    }
    assert!(differ);
    // Without layers there is nothing beside the picture, which is the same.
    let alone = prism("white_balance = 3000", "spectral").film();
    assert_eq!(alone.picture().pixels, warm.picture().pixels);
    assert_eq!(alone.channel_variance(3, 3), None);
}
