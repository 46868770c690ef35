//! Skies against what is known of them, and against slow integration.

use super::bands::{bands, rgb, rgb_weights};
use super::*;
use crate::spectrum::space::xyz_of_rec709;

fn sky(degrees: f64, turbidity: f64, has_sun: bool) -> Image {
    let elevation = degrees.to_radians();
    ClearSky { elevation, azimuth: FRAC_PI_2, turbidity, albedo: 0.2, has_sun }.octahedral("sky")
}

/// The illuminance of the ground, in units of 10 000 lx.
fn illuminance(image: &Image) -> f64 {
    let texels = (0..SIDE * SIDE).map(|index| {
        let (up, _) = direction(index % SIDE, index / SIDE);
        let luminance = xyz_of_rec709(image.texel(index as usize).map(f64::from))[1];
        luminance * up.max(0.0)
    });
    texels.sum::<f64>() * 4.0 * PI / (f64::from(SIDE) * f64::from(SIDE))
}

/// The colour towards an elevation and an azimuth from the sun, which is in the east, both in degrees.
fn seen(image: &Image, elevation: f64, around: f64) -> [f64; 3] {
    let (up, level) = libm::sincos(elevation.to_radians());
    let (y, x) = libm::sincos(around.to_radians());
    image.texel(texel_towards(DVec3::new(level * x, level * y, up))).map(f64::from)
}

fn luminance(rgb: [f64; 3]) -> f64 {
    xyz_of_rec709(rgb)[1]
}

#[test]
fn daylight_is_as_bright_as_measured() {
    let (all, diffuse) = (illuminance(&sky(60.0, 2.5, true)), illuminance(&sky(60.0, 2.5, false)));
    assert!((8.0..11.0).contains(&all), "{all}");
    // Clear air scatters about a fifth of the light.
    assert!((0.1..0.25).contains(&(diffuse / all)), "{diffuse} of {all}");
    // Sunset, and the end of civil twilight, when street lamps are lit (some 400 lx and 3.4 lx).
    let sunset = illuminance(&sky(0.0, 2.5, true));
    assert!((0.02..0.12).contains(&sunset), "{sunset}");
    let twilight = illuminance(&sky(-6.0, 2.5, true));
    assert!((0.000_05..0.001).contains(&twilight), "{twilight}");
}

#[test]
fn the_sun_is_reddened_by_its_way_through_the_air() {
    let air = Air::new(2.5);
    let ratio = |degrees: f64| {
        let [r, _, b] = rgb(&air.sunlight(air::GROUND, libm::sin(degrees.to_radians())), &rgb_weights());
        b.max(0.0) / r
    };
    assert!(ratio(90.0) > 0.6 && ratio(10.0) < 0.3 && ratio(1.0) < 0.05);
    assert_eq!(air.sunlight(air::GROUND, -0.01), [0.0; bands::COUNT]);
}

#[test]
fn the_sky_is_blue_and_its_horizon_bright() {
    let clear = sky(50.0, 1.5, false);
    let [r, g, b] = seen(&clear, 89.0, 180.0);
    assert!(b > 1.8 * r && b > g, "{r} {g} {b}");
    let hazy = sky(20.0, 5.0, false);
    let (zenith, horizon) = (seen(&hazy, 89.0, 180.0), seen(&hazy, 3.0, 90.0));
    assert!(luminance(horizon) > 1.4 * luminance(zenith));
    assert!(horizon[2] / horizon[0] < b / r);
    // Towards the sun it is brighter than opposite.
    assert!(luminance(seen(&hazy, 25.0, 5.0)) > 3.0 * luminance(seen(&hazy, 25.0, 180.0)));
    // At sunset the sky above is blue still, by ozone, and the horizon below the sun is red.
    let sunset = sky(0.0, 2.0, false);
    let (above, low) = (seen(&sunset, 89.0, 180.0), seen(&sunset, 1.0, 5.0));
    assert!(above[2] > above[0] && low[0] > 2.0 * low[2], "{above:?} {low:?}");
}

#[test]
fn the_picture_holds_the_sun_where_it_is() {
    let clear = ClearSky { elevation: 0.5, azimuth: 0.75 * PI, turbidity: 2.0, albedo: 0.0, has_sun: true };
    let image = clear.octahedral("sky");
    let brightest = (0..SIDE * SIDE)
        .max_by(|a, b| image.texel(*a as usize)[1].total_cmp(&image.texel(*b as usize)[1]))
        .unwrap();
    let (up, around) = direction(brightest % SIDE, brightest / SIDE);
    assert!((up - libm::sin(0.5)).abs() < 0.005 && (around + 0.25 * PI).abs() < 0.01, "{up} {around}");
    let covered = (0..SIDE * SIDE).filter(|index| image.texel(*index as usize)[1] > 100.0).count();
    assert!((5..16).contains(&covered), "{covered}");
    let below = ClearSky { elevation: -0.5, ..clear }.octahedral("night");
    assert!((0..SIDE * SIDE).all(|index| below.texel(index as usize).iter().all(|value| *value < 1e-4)));
}

#[test]
fn few_steps_are_as_good_as_many() {
    let air = Air::new(3.0);
    let (quick, slow) = (Scattering::new(&air, 0.3), Scattering::new(&air, 0.3).with_steps(2000));
    for sun in [1.2f64, 0.5, 0.05, -0.05] {
        let sun = DVec3::new(libm::cos(sun), 0.0, libm::sin(sun));
        for view in [1.5f64, 0.7, 0.1, 0.01] {
            let view = DVec3::new(0.6 * libm::cos(view), 0.8 * libm::cos(view), libm::sin(view));
            let (few, many) = (quick.radiance(view, sun), slow.radiance(view, sun));
            for (few, many) in few.iter().zip(many) {
                assert!((few - many).abs() < 0.05 * many + 1e-7, "{sun} {view}: {few} {many}");
            }
        }
    }
}

#[test]
fn the_table_of_columns_is_as_good_as_their_integral() {
    let air = Air::new(3.0);
    let zenith = air.transmittance(air::GROUND, 1.0);
    // Rayleigh's thickness at 600 nm, aerosol twice as thick at 550 nm, and ozone.
    let expected = bands(|nm| nm)[10];
    assert_eq!(expected, 600.0);
    let thickness = 0.0686 + 2.0 * 0.0973 * libm::pow(600.0 / 550.0, -1.3) + 0.0403;
    assert!((-libm::log(zenith[10]) - thickness).abs() < 0.01, "{}", -libm::log(zenith[10]));
    // At the horizon there is some 38 times as much air as above (Kasten & Young 1989), less refraction.
    let pure = Air::new(1.0);
    let ratio = libm::log(pure.transmittance(air::GROUND, 0.0)[0])
        / libm::log(pure.transmittance(air::GROUND, 1.0)[0]);
    assert!((34.0..40.0).contains(&ratio), "{ratio}");
}
