//! Tests of lights: power, densities, and the choice among them.

use std::f32::consts::PI;
use std::f64::consts::PI as PI64;

use glam::{DMat4, DQuat, DVec3, Vec3};
use lookfrom_scene::Location;
use lookfrom_scene::image::Image;
use lookfrom_scene::light::{Edge, Falloff, Light as Written, LightKind, MapRows, Power, Projected, Sky};
use lookfrom_scene::material::{Color, Material, MaterialKind};
use lookfrom_scene::scene::{CurveId, ImageId, MaterialId, Scene};
use lookfrom_scene::settings::{LightSampler, Sampler as SamplerKind};
use lookfrom_scene::shape::{Emission, Geometry, Shape, Sphere};
use lookfrom_scene::spectrum::Curve;
use lookfrom_scene::texture::TexelFilter;
use rayon::prelude::*;

use super::{IncompletePdf, Light, LightSampleContext};
use crate::core::color::Wavelengths;
use crate::core::math::luminance;
use crate::core::sampler::Sampler;
use crate::core::statistics::{chi_square_deviate, corrected_bound};
use crate::core::warp;
use crate::shading::texture::SpectralMode;
use crate::world::World;

/// The camera's position, the origin of render space: lights are far from the origin of the world.
const EYE: DVec3 = DVec3::new(1000.0, -300.0, 50.0);

fn random(i: u32) -> [f32; 2] {
    Sampler::new(SamplerKind::Independent, 5).two([0, 0], i, 0)
}

/// A world of nothing but these lights.
fn world_of(lights: Vec<(LightKind, Power)>, images: Vec<Image>, curves: Vec<Curve>) -> World {
    let mut scene = Scene { images, curves, ..Scene::default() };
    let view = lookfrom_scene::camera::View::Look { lookfrom: EYE, lookat: EYE + DVec3::X, up: DVec3::Y };
    scene.camera = Some(lookfrom_scene::camera::Camera { view, ..Default::default() });
    scene.lights = lights
        .into_iter()
        .map(|(kind, power)| Written { name: None, at: Location::default(), kind, power })
        .collect();
    World::compile(scene, &mut Vec::new()).expect("a good scene")
}

fn total(total: f32) -> Power {
    Power { total: Some(total), ..Power::AS_WRITTEN }
}

/// A picture with values over many orders of magnitude, some of them black.
fn picture(width: u32, height: u32, seed: u32) -> Image {
    let texels = (0..width * height)
        .map(|i| {
            let [a, b] = random(1_000_000 * seed + i);
            let bright = if a < 0.2 { 0.0 } else { libm::exp2f(10.0 * b - 5.0) };
            [bright, 0.5 * bright, 0.25 * bright * (1.0 + a)]
        })
        .collect();
    Image::from_linear("", width, height, texels)
}

fn turn() -> DMat4 {
    DMat4::from_quat(DQuat::from_axis_angle(DVec3::new(1.0, 2.0, -0.5).normalize(), 0.8))
}

fn environment(sky: Sky, portal: Option<[DVec3; 4]>) -> LightKind {
    LightKind::Environment { sky, portal, illuminates: true }
}

fn latitude_longitude() -> Sky {
    Sky::Image { image: ImageId(0), scale: [1.0, 2.0, 0.5], world_from_light: turn(), rows: MapRows::Bands }
}

fn octahedral() -> Sky {
    Sky::Octahedral { image: ImageId(1), scale: [1.0; 3], world_from_light: turn() }
}

fn gradient() -> Sky {
    Sky::Gradient { zenith: [0.1, 0.2, 1.0], horizon: [0.9, 0.8, 0.7], nadir: [0.0, 0.1, 0.0] }
}

fn pictures() -> Vec<Image> {
    vec![picture(16, 8, 1), picture(8, 8, 2)]
}

/// A rotated window of 2 × 3, a little in front of the camera.
fn window() -> [DVec3; 4] {
    let corners = [[-1.0, -1.5], [1.0, -1.5], [1.0, 1.5], [-1.0, 1.5]];
    corners.map(|[x, y]| EYE + turn().transform_point3(DVec3::new(x, y, -2.0)))
}

/// A world of one environment.
struct Around {
    name: &'static str,
    world: World,
    has_portal: bool,
    /// Whether it is sampled by the cosine to the normal.
    by_cosine: bool,
}

fn environments() -> Vec<Around> {
    let even = || Sky::Constant(Color::gray(0.5));
    let skies = [
        ("latitude and longitude", latitude_longitude()),
        ("octahedral", octahedral()),
        ("even", even()),
        ("gradient", gradient()),
    ];
    let around = |(name, sky): &(&'static str, Sky), has_portal: bool| {
        let kind = environment(sky.clone(), has_portal.then(window));
        let world = world_of(vec![(kind, Power::AS_WRITTEN)], pictures(), vec![]);
        let is_picture = matches!(sky, Sky::Image { .. } | Sky::Octahedral { .. });
        Around { name, world, has_portal, by_cosine: !has_portal && !is_picture }
    };
    [false, true].iter().flat_map(|portal| skies.iter().map(|sky| around(sky, *portal))).collect()
}

/// Reference points: far from and near to the portal, one near its edge.
fn places() -> [LightSampleContext; 3] {
    let at = |x, y, z| {
        let n = Vec3::new(0.3, -0.9, 0.2).normalize();
        LightSampleContext { point: turn().transform_point3(DVec3::new(x, y, z)), n, time: 0.0 }
    };
    [at(0.0, 0.0, 0.0), at(0.8, -1.2, -1.95), at(1.5, 0.5, 2.0)]
}

/// Number of cells of equal solid angle, along z and around it.
const CELLS: [usize; 2] = [30, 60];

fn cell(d: Vec3) -> usize {
    let z = ((d.z + 1.0) * 0.5 * CELLS[0] as f32) as usize;
    let phi = ((libm::atan2f(d.y, d.x) / (2.0 * PI) + 0.5) * CELLS[1] as f32) as usize;
    z.min(CELLS[0] - 1) * CELLS[1] + phi.min(CELLS[1] - 1)
}

/// By cell, the integral of a function of the direction over the sphere; `fine`² directions each.
fn integrals(fine: usize, f: impl Fn(Vec3) -> f64 + Sync) -> Vec<f64> {
    let direction = |z: f64, phi: f64| {
        let (sin, cos) = (2.0 * PI64 * (phi - 0.5)).sin_cos();
        let ring = (1.0 - z * z).max(0.0).sqrt();
        DVec3::new(ring * cos, ring * sin, z).as_vec3()
    };
    let middle =
        |cell: usize, k: usize, cells: usize| (cell as f64 + (k as f64 + 0.5) / fine as f64) / cells as f64;
    let cells = CELLS[0] * CELLS[1];
    (0..cells)
        .into_par_iter()
        .map(|index| {
            let sum: f64 = (0..fine * fine)
                .map(|k| {
                    let z = 2.0 * middle(index / CELLS[1], k / fine, CELLS[0]) - 1.0;
                    f(direction(z, middle(index % CELLS[1], k % fine, CELLS[1])))
                })
                .sum();
            sum / (fine * fine) as f64 * 4.0 * PI64 / cells as f64
        })
        .collect()
}

/// Checks the directions of a million samples against the density, and their estimate of the irradiance against the
/// integral.
fn check_directions(
    around: &Around,
    at: &LightSampleContext,
    incomplete_pdf: IncompletePdf,
    bound: f64,
    what: &str,
) {
    const N: u32 = 1_000_000;
    let Around { world, has_portal, by_cosine, .. } = around;
    let light = &world.lights[0];
    let Light::Environment(sky) = light else { panic!("a sky") };
    let radiance =
        |d: Vec3| f64::from(luminance(sky.radiance(&world.textures, at.point, d, &SpectralMode::Rgb).rgb()));
    let pdf = |wi| f64::from(light.pdf(at, wi, None, incomplete_pdf));
    let mut counts = vec![0; CELLS[0] * CELLS[1]];
    let (mut chosen, mut differ, mut arriving) = (0, 0, 0.0);
    for i in 0..N {
        let sample = light.sample(&world.textures, at, random(i), &SpectralMode::Rgb, incomplete_pdf);
        let Some(sample) = sample else { continue };
        chosen += 1;
        counts[cell(sample.wi)] += 1;
        let li = f64::from(luminance(sample.li.rgb()));
        arriving += li / f64::from(sample.pdf);
        // For some samples, compare with the density and radiance of the same direction evaluated directly.
        if i % 16 == 0 {
            assert!((sample.wi.length() - 1.0).abs() < 1e-5, "{what}");
            let ratios = [pdf(sample.wi) / f64::from(sample.pdf), radiance(sample.wi) / li];
            differ += u32::from(ratios.iter().any(|ratio| (ratio - 1.0).abs() > 1e-2));
        }
    }
    // Only directions on the border of two texels may fall into the neighbour.
    assert!(differ < 100, "{what}: {differ} of 62500");

    // Black directions give no samples.
    let bright = |wi| if radiance(wi) > 0.0 { pdf(wi) } else { 0.0 };
    // Where few texels are sampled, their borders count more.
    let fine = if incomplete_pdf == IncompletePdf::Allowed { 96 } else { 30 };
    let expected = integrals(fine, bright).into_iter().map(|share| share * f64::from(N));
    // The expected counts of cells that bright texels hardly overlap are too inexact.
    let (counts, expected): (Vec<u64>, Vec<f64>) =
        counts.into_iter().zip(expected).filter(|(_, e)| *e > 20.0).unzip();
    let elsewhere = 1.0 - counts.iter().sum::<u64>() as f64 / f64::from(chosen);
    assert!(elsewhere < 1e-2, "{what}: {elsewhere} are where hardly any should be");
    let black = (f64::from(chosen) - expected.iter().sum::<f64>()) / f64::from(N);
    assert!(black.abs() < 3e-3, "{what}: {black} more are bright");
    let deviate = chi_square_deviate(&counts, &expected);
    assert!(deviate < bound, "{what}: {deviate} instead of {bound}");

    // The estimate finds all light that arrives.
    if incomplete_pdf == IncompletePdf::Forbidden || *has_portal {
        let seen = |d: Vec3| if *by_cosine && at.n.dot(d) <= 0.0 { 0.0 } else { radiance(d) };
        let ratio = arriving / f64::from(N) / integrals(24, seen).iter().sum::<f64>();
        assert!((ratio - 1.0).abs() < 0.01, "{what}: {ratio}");
    }
}

#[test]
fn directions_to_environments_are_as_dense_as_they_say() {
    let bound = corrected_bound(16);
    let mut checked = 0;
    for around in &environments() {
        // Without a portal the point does not matter; and portals to environments without a map all sample alike.
        let count = if around.has_portal && around.name != "gradient" { 3 } else { 1 };
        for (place, at) in places().iter().enumerate().take(count) {
            for incomplete_pdf in [IncompletePdf::Forbidden, IncompletePdf::Allowed] {
                // Portals sample alike in both modes; environments sampled by the cosine are left to BSDF sampling.
                if incomplete_pdf == IncompletePdf::Allowed && (around.by_cosine || around.has_portal) {
                    continue;
                }
                let what =
                    format!("{}, portal {}, {incomplete_pdf:?}, {place}", around.name, around.has_portal);
                check_directions(around, at, incomplete_pdf, bound, &what);
                checked += 1;
            }
        }
    }
    assert_eq!(checked, 16);
}

#[test]
fn portals_are_sampled_in_all_wavelengths() {
    for around in environments().iter().filter(|around| around.has_portal) {
        let mode = SpectralMode::Spectral(Wavelengths::sample_visible(0.4));
        let light = &around.world.lights[0];
        let Light::Environment(sky) = light else { panic!("a sky") };
        let at = places()[0];
        let mut bright = 0;
        for i in 0..1000 {
            let textures = &around.world.textures;
            let sample = light.sample(textures, &at, random(i), &mode, IncompletePdf::Allowed);
            let Some(sample) = sample else { continue };
            bright += 1;
            assert_eq!(
                light.pdf(&at, sample.wi, None, IncompletePdf::Forbidden),
                light.pdf(&at, sample.wi, None, IncompletePdf::Allowed)
            );
            assert!(sample.li.0.iter().all(|lane| lane.is_finite() && *lane >= 0.0));
            let seen = sky.radiance(textures, at.point, sample.wi, &mode);
            assert!((seen.0[0] - sample.li.0[0]).abs() <= 1e-3 * seen.0[0] || seen.is_black());
        }
        assert!(bright > 900, "{}: {bright}", around.name);
    }
}

/// Lights with a position, of each kind, of a given power.
fn placed(power: Power) -> Vec<(LightKind, Power)> {
    let here = EYE + DVec3::new(1.0, 2.0, 3.0);
    let world_from_light = DMat4::from_translation(here) * turn();
    let intensity = Color::Value([0.5, 0.4, 0.2]);
    let direction = DVec3::new(0.5, -2.0, 1.0);
    let falloff = Falloff::Quadratic;
    let spot = |cone_angle, inner_angle, edge| LightKind::Spot {
        position: here,
        direction,
        intensity,
        cone_angle,
        inner_angle,
        edge,
        falloff,
    };
    let projection = |image, fov, quantity, cone| LightKind::Projection {
        image: ImageId(image),
        filter: TexelFilter::Nearest,
        quantity,
        intensity: 0.7,
        cone,
        fov,
        world_from_light,
    };
    [
        LightKind::Point { position: here, intensity, falloff },
        spot(40.0, 30.0, Edge::Smooth),
        spot(170.0, 10.0, Edge::Smooth),
        spot(60.0, 10.0, Edge::Linear),
        spot(3.0, 3.0, Edge::Linear),
        projection(0, 50.0, Projected::Intensity, None),
        projection(2, 130.0, Projected::Intensity, None),
        projection(2, 100.0, Projected::Irradiance, None),
        projection(0, 80.0, Projected::Irradiance, Some([35.0, 10.0])),
        LightKind::Goniometric {
            intensity,
            image: ImageId(1),
            filter: TexelFilter::Nearest,
            world_from_light,
        },
        LightKind::Goniometric {
            intensity,
            image: ImageId(1),
            filter: TexelFilter::Bilinear,
            world_from_light,
        },
    ]
    .into_iter()
    .map(|kind| (kind, power))
    .collect()
}

/// Luminance that arrives at a distance of 1 from the light's position, in a direction from it.
fn intensity(world: &World, light: usize, direction: Vec3) -> f64 {
    exact_intensity(world, light, direction.as_dvec3().normalize())
}

/// The same in a direction of unit length.
fn exact_intensity(world: &World, light: usize, direction: DVec3) -> f64 {
    let point = DVec3::new(1.0, 2.0, 3.0) + direction;
    let at = LightSampleContext { point, n: -direction.as_vec3(), time: 0.0 };
    let sample = world.lights[light].sample(
        &world.textures,
        &at,
        [0.5; 2],
        &SpectralMode::Rgb,
        IncompletePdf::Forbidden,
    );
    sample.map_or(0.0, |sample| f64::from(luminance(sample.li.rgb())))
}

#[test]
fn powers_are_what_is_asked() {
    let mut images = pictures();
    images.push(picture(7, 13, 3));
    let world = world_of(placed(total(30.0)), images, vec![]);
    for light in 0..world.lights.len() {
        let power: f64 = integrals(24, |d| intensity(&world, light, d)).iter().sum();
        assert!((power / 30.0 - 1.0).abs() < 0.01, "{}: {power}", world.names.lights[light]);
    }
}

#[test]
fn illuminances_are_what_is_asked() {
    let skies = [
        Sky::Constant(Color::Value([0.2, 0.5, 3.0])),
        gradient(),
        Sky::Image {
            image: ImageId(0),
            scale: [1.0, 2.0, 0.5],
            world_from_light: DMat4::IDENTITY,
            rows: MapRows::ToPoles,
        },
        // up is z there
        Sky::Octahedral { image: ImageId(1), scale: [3.0, 1.0, 1.0], world_from_light: DMat4::IDENTITY },
    ];
    for (sky, up) in skies.into_iter().zip([Vec3::Y, Vec3::Y, Vec3::Y, Vec3::Z]) {
        let name = format!("{sky:?}");
        let images = vec![picture(256, 128, 1), picture(64, 64, 2)];
        let world = world_of(vec![(environment(sky, None), total(12.0))], images, vec![]);
        let Light::Environment(sky) = &world.lights[0] else { panic!("a sky") };
        let arriving = |d: Vec3| {
            let radiance = sky.radiance(&world.textures, DVec3::ZERO, d, &SpectralMode::Rgb);
            f64::from(luminance(radiance.rgb()) * d.dot(up).max(0.0))
        };
        let sum: f64 = integrals(24, arriving).iter().sum();
        assert!((sum / 12.0 - 1.0).abs() < 0.01, "{name}: {sum}");
    }
    let distant = LightKind::Distant { direction: DVec3::NEG_Y, intensity: Color::Value([0.2, 0.5, 3.0]) };
    let world = world_of(vec![(distant, total(12.0))], vec![], vec![]);
    let at = LightSampleContext { point: DVec3::ZERO, n: Vec3::Y, time: 0.0 };
    let sample = world.lights[0]
        .sample(&world.textures, &at, [0.5; 2], &SpectralMode::Rgb, IncompletePdf::Forbidden)
        .expect("light from above");
    assert!((luminance(sample.li.rgb()) - 12.0).abs() < 1e-3 && sample.wi.dot(Vec3::Y) > 0.9999);
}

#[test]
fn spots_fade_by_a_cubic_of_the_cosine() {
    let world = world_of(placed(Power::AS_WRITTEN), vec![picture(1, 1, 1); 3], vec![]);
    let axis = Vec3::new(0.5, -2.0, 1.0).normalize();
    let across = warp::orthonormal_basis(axis).0;
    let at_cos = |cos: f32| intensity(&world, 1, axis * cos + across * (1.0 - cos * cos).sqrt());
    let [outer, inner] = [40.0_f32, 30.0].map(|degrees| degrees.to_radians().cos());
    // π times Whitted's
    let full = f64::from(PI * luminance([0.5, 0.4, 0.2]));
    for (share, expected) in [(-0.1, 0.0), (0.25, 0.15625), (0.5, 0.5), (0.75, 0.84375), (1.1, 1.0)] {
        let found = at_cos(outer + share * (inner - outer)) / full;
        assert!((found - expected).abs() < 1e-4, "{share}: {found}");
    }
}

/// A picture with a different texel in each corner.
fn corners(width: u32, height: u32) -> Image {
    let mut texels = vec![[0.0; 3]; (width * height) as usize];
    texels[0] = [1.0; 3];
    texels[width as usize - 1] = [2.0; 3];
    texels[(width * (height - 1)) as usize] = [3.0; 3];
    texels[(width * height - 1) as usize] = [4.0; 3];
    Image::from_linear("", width, height, texels)
}

#[test]
fn projections_stand_upright() {
    for (width, height) in [(4, 2), (2, 2), (2, 6)] {
        let world_from_light = DMat4::from_translation(EYE + DVec3::new(1.0, 2.0, 3.0)) * turn();
        let kind = LightKind::Projection {
            image: ImageId(0),
            filter: TexelFilter::Nearest,
            quantity: Projected::Intensity,
            intensity: 1.0,
            cone: None,
            fov: 60.0,
            world_from_light,
        };
        let world = world_of(vec![(kind, Power::AS_WRITTEN)], vec![corners(width, height)], vec![]);
        // The shorter side is seen under the angle.
        let short = libm::tanf(30.0_f32.to_radians()) / width.min(height) as f32;
        let [right, up] = [width, height].map(|texels| short * (texels - 1) as f32);
        // Its axis is z; y is up, x to the right.
        for (x, y, expected) in [(-right, up, 1.0), (right, up, 2.0), (-right, -up, 3.0), (right, -up, 4.0)] {
            let toward = |x: f32, y: f32| turn().transform_vector3(DVec3::new(x.into(), y.into(), 1.0));
            let found = intensity(&world, 0, toward(x, y).as_vec3()) / PI64;
            assert!((found - expected).abs() < 1e-3, "{width} × {height}: {found} is not {expected}");
            let [x, y] =
                [(x, right), (y, up)].map(|(x, end)| x + (1.01 * short).copysign(x) * (end + 1.0).signum());
            assert_eq!(intensity(&world, 0, toward(x, y).as_vec3()), 0.0, "beyond the corner");
        }
        assert_eq!(intensity(&world, 0, turn().transform_vector3(DVec3::NEG_Z).as_vec3()), 0.0);
    }
}

#[test]
fn goniometric_lights_are_as_bright_by_direction_as_their_picture() {
    let world_from_light = DMat4::from_translation(EYE + DVec3::new(1.0, 2.0, 3.0)) * turn();
    let image = picture(5, 5, 4);
    let light = |filter| {
        let intensity = Color::gray(2.0);
        let kind = LightKind::Goniometric { intensity, image: ImageId(0), filter, world_from_light };
        (kind, Power::AS_WRITTEN)
    };
    let lights = [TexelFilter::Nearest, TexelFilter::Bilinear].map(light);
    let world = world_of(lights.to_vec(), vec![image.clone()], vec![]);
    for (index, texel) in image.texels().enumerate() {
        let place = [index % 5, index / 5].map(|i| (i as f32 + 0.4) / 5.0);
        let direction = turn().transform_vector3(warp::octahedral_direction(place).as_dvec3());
        let found = intensity(&world, 0, direction.as_vec3()) / (2.0 * PI64);
        let expected = f64::from(texel.iter().sum::<f32>() / 3.0);
        assert!((found - expected).abs() <= 1e-4 * expected, "{index}: {found} is not {expected}");
    }
    // Between texels it is smooth: along a great circle through the middle of the map, its edges and the point where its corners meet.
    let blended = |angle: f32| {
        let (sin, cos) = libm::sincosf(angle);
        let direction = turn().transform_vector3(DVec3::new(0.3 * f64::from(sin), sin.into(), cos.into()));
        intensity(&world, 1, direction.as_vec3()) / (2.0 * PI64)
    };
    let steps: Vec<f64> = (0..2000).map(|step| blended(2.0 * PI * step as f32 / 2000.0)).collect();
    let greatest = steps.iter().copied().fold(0.0, f64::max);
    for pair in steps.windows(2) {
        assert!((pair[1] - pair[0]).abs() < 0.02 * greatest, "{pair:?} of {greatest}");
    }
}

#[test]
fn curves_have_luminance_1_unless_they_are_absolute() {
    let curves = vec![
        Curve::Blackbody { kelvin: 2500.0 },
        Curve::Blackbody { kelvin: 9000.0 },
        Curve::Constant(20.0),
        Curve::Tabulated { wavelengths: vec![400.0, 500.0, 700.0], values: vec![0.0, 7.0, 1.0] },
    ];
    for curve in 0..curves.len() as u32 {
        let sky = || environment(Sky::Constant(Color::Curve(CurveId(curve))), None);
        let absolute = Power { absolute: true, ..Power::AS_WRITTEN };
        let scaled = Power { scale: 3.0, ..Power::AS_WRITTEN };
        let lights = [Power::AS_WRITTEN, scaled, absolute, total(5.0)].map(|power| (sky(), power));
        let world = world_of(lights.into(), vec![], curves.clone());
        let y = world.textures.curve(CurveId(curve)).to_xyz()[1];
        for (light, expected) in world.lights.iter().zip([1.0, 3.0, y, 5.0 / PI]) {
            let Light::Environment(sky) = light else { panic!("a sky") };
            let rgb = sky.radiance(&world.textures, DVec3::ZERO, Vec3::Y, &SpectralMode::Rgb).rgb();
            assert!((luminance(rgb) / expected - 1.0).abs() < 2e-3, "{curve}: {rgb:?}, not {expected}");
        }
    }
}

#[test]
fn narrow_beams_have_their_power() {
    let white = Image::from_linear("", 1, 1, vec![[1.0; 3]]);
    let here = EYE + DVec3::new(1.0, 2.0, 3.0);
    let (direction, intensity, falloff) = (DVec3::Y, Color::gray(1.0), Falloff::Quadratic);
    // A pointer of one milliradian, and far less.
    for angle in [1.0_f64, 0.03, 1e-3, 1e-4] {
        let spot = |inner_angle, edge| LightKind::Spot {
            position: here,
            direction,
            intensity,
            cone_angle: angle,
            inner_angle,
            edge,
            falloff,
        };
        let cone = LightKind::Projection {
            image: ImageId(0),
            filter: TexelFilter::Nearest,
            quantity: Projected::Intensity,
            intensity: 1.0,
            cone: Some([angle, 0.5 * angle]),
            fov: 3.0 * angle as f32,
            world_from_light: DMat4::from_translation(here) * DMat4::from_rotation_x(-0.5 * PI64),
        };
        let kinds = [
            spot(0.5 * angle, Edge::Smooth),
            spot(angle, Edge::Smooth),
            spot(0.5 * angle, Edge::Linear),
            cone,
        ];
        let world = world_of(kinds.map(|kind| (kind, total(30.0))).into(), vec![white.clone()], vec![]);
        for light in 0..world.lights.len() {
            let rings = 2000;
            let width = 1.2 * angle.to_radians() / f64::from(rings);
            let in_ring = |ring: u32| {
                let (sin, cos) = libm::sincos((f64::from(ring) + 0.5) * width);
                2.0 * PI64 * sin * width * exact_intensity(&world, light, DVec3::new(sin, cos, 0.0))
            };
            let power: f64 = (0..rings).map(in_ring).sum();
            let name = &world.names.lights[light];
            assert!((power / 30.0 - 1.0).abs() < 0.01, "{name}, {angle}°: {power}");
        }
    }
}

#[test]
fn nothing_black_has_any_power() {
    let black = || Image::from_linear("", 2, 2, vec![[0.0; 3]; 4]);
    let mut lights = placed(total(10.0));
    for (kind, _) in &mut lights {
        match kind {
            LightKind::Point { intensity, .. } | LightKind::Spot { intensity, .. } => {
                *intensity = Color::BLACK;
            }
            _ => {}
        }
    }
    lights.push((LightKind::Distant { direction: DVec3::Y, intensity: Color::BLACK }, total(1.0)));
    let gradient = Sky::Gradient { zenith: [0.0; 3], horizon: [0.0; 3], nadir: [0.0; 3] };
    for sky in [Sky::Constant(Color::BLACK), gradient, latitude_longitude(), octahedral()] {
        for portal in [None, Some(window())] {
            lights.push((environment(sky.clone(), portal), total(1.0)));
        }
    }
    let world = world_of(lights, vec![black(), black(), black()], vec![]);
    let at = places()[0];
    for (index, light) in world.lights.iter().enumerate() {
        let name = &world.names.lights[index];
        for i in 0..20 {
            if let Some(sample) =
                light.sample(&world.textures, &at, random(i), &SpectralMode::Rgb, IncompletePdf::Forbidden)
            {
                assert!(sample.li.is_black(), "{name}: {:?}", sample.li);
            }
        }
        let probability = world.light_choice.probability(&at, index as u32);
        assert!((0.0..=1.0).contains(&probability), "{name}: {probability}");
    }
}

/// All kinds of lights at once, compiled with one light sampler.
fn many(light_sampler: LightSampler) -> World {
    let mut scene = Scene { images: pictures(), ..Scene::default() };
    scene.images.push(picture(7, 13, 3));
    scene.render.light_sampler = light_sampler;
    let view = lookfrom_scene::camera::View::Look { lookfrom: EYE, lookat: EYE + DVec3::X, up: DVec3::Y };
    scene.camera = Some(lookfrom_scene::camera::Camera { view, ..Default::default() });
    let mut lights = placed(Power::AS_WRITTEN);
    lights.push((environment(octahedral(), None), Power::AS_WRITTEN));
    lights.push((environment(gradient(), None), Power::AS_WRITTEN));
    lights.push((environment(gradient(), Some(window())), Power::AS_WRITTEN));
    lights.push((LightKind::Distant { direction: DVec3::Y, intensity: Color::gray(0.1) }, Power::AS_WRITTEN));
    scene.lights = lights
        .into_iter()
        .map(|(kind, power)| Written { name: None, at: Location::default(), kind, power })
        .collect();
    let kind = MaterialKind::Diffuse { reflectance: Color::gray(0.5) };
    scene.materials.push(Material::new("grey", Location::default(), kind));
    for k in 0..5 {
        let center = EYE + DVec3::new(3.0 * f64::from(k), 5.0, -2.0);
        let geometry = Geometry::Sphere(Sphere { center, radius: 0.1 + 0.3 * f64::from(k) });
        let mut shape = Shape::new(Location::default(), geometry, MaterialId(0));
        shape.emission = Some(Emission::new(Color::gray(0.5), k % 2 == 0));
        scene.shapes.push(shape);
    }
    World::compile(scene, &mut Vec::new()).expect("a good scene")
}

#[test]
fn lights_are_chosen_as_often_as_they_say() {
    const N: u32 = 200_000;
    let bound = corrected_bound(9);
    for kind in [LightSampler::Uniform, LightSampler::Power, LightSampler::Bvh] {
        let world = many(kind);
        let count = world.lights.len() as u32;
        for (place, at) in places().iter().enumerate() {
            let probability = |light| world.light_choice.probability(at, light);
            let sum: f32 = (0..count).map(probability).sum();
            assert!((sum - 1.0).abs() < 1e-5, "{kind:?}: {sum}");
            let (mut counts, mut rests) = (vec![0; count as usize], 0.0);
            for i in 0..N {
                let chosen = world.light_choice.sample(at, random(i)[0]).expect("some light");
                let (light, found) = (chosen.light, chosen.probability);
                assert!((found / probability(light) - 1.0).abs() < 1e-5, "{kind:?}, {light}");
                assert!((0.0..1.0).contains(&chosen.rest), "{kind:?}, {light}: {}", chosen.rest);
                counts[light as usize] += 1;
                rests += f64::from(chosen.rest);
            }
            let mean = rests / f64::from(N);
            assert!((mean - 0.5).abs() < 0.003, "{kind:?}: the rests are 0.5 in the mean, not {mean}");
            let expected: Vec<f64> = (0..count).map(|l| f64::from(probability(l)) * f64::from(N)).collect();
            let deviate = chi_square_deviate(&counts, &expected);
            assert!(deviate < bound, "{kind:?}, {place}: {deviate}, {counts:?} {expected:?}");
            // Every light that can be sampled is chosen sometimes.
            for (index, light) in world.lights.iter().enumerate() {
                let emits = (0..50).any(|i| {
                    light
                        .sample(&world.textures, at, random(i), &SpectralMode::Rgb, IncompletePdf::Allowed)
                        .is_some()
                });
                assert!(!emits || expected[index] > 0.0, "{kind:?}: {}", world.names.lights[index]);
            }
        }
    }
}

#[test]
fn no_lights_are_no_trouble() {
    let world = world_of(vec![], vec![], vec![]);
    assert!(world.light_choice.sample(&places()[0], 0.5).is_none());
}
