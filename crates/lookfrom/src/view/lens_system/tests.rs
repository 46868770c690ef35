//! Lens systems against the lens maker's equation, a slow tracer with angles, and brute force over film and pupil.

use std::f64::consts::PI;

use lookfrom_scene::image::Image;
use lookfrom_scene::lens::{ApertureShape, parse};

use super::*;

/// A double Gauss lens of 50 mm (Tronnier 1954, US patent 2,673,491).
const DOUBLE_GAUSS: &str = "29.475 3.76 1.67 25.2\n84.83 0.12 1 25.2\n19.275 4.025 1.67 23\n40.77 3.275 1.699 23\n12.75 5.705 1 18\n\
    0 4.5 0 17.1\n-14.495 1.18 1.603 17\n40.77 6.065 1.658 20\n-20.385 0.19 1 20\n437.065 3.22 1.717 20\n-39.73 0 1 20";

fn written(table: &str) -> Written {
    Written {
        name: "test.dat".to_owned(),
        surfaces: parse(table.as_bytes(), &Location::default()).expect("a lens"),
        stop_diameter: None,
        shape: ApertureShape::Circle,
        focus_distance: 3.7,
        film_diagonal: 35.0,
        millimetre: 1e-3,
        convention: LensConvention::Pbrt,
    }
}

/// Lens systems of all kinds.
pub(crate) fn examples() -> Vec<Written> {
    let gauss = || written(DOUBLE_GAUSS);
    vec![
        gauss(),
        Written { stop_diameter: Some(2.0), convention: LensConvention::AsPinhole, ..gauss() },
        Written { shape: ApertureShape::Star, ..gauss() },
        Written { shape: ApertureShape::Pentagon, convention: LensConvention::AsPinhole, ..gauss() },
        Written { film_diagonal: 60.0, ..gauss() },
        Written { shape: corners(), ..gauss() },
        Written { shape: corners(), convention: LensConvention::AsPinhole, ..gauss() },
        Written { shape: ApertureShape::Star, ..written("30 4 1.5 20\n-70 0 1 20") },
    ]
}

/// An image with light in its corners, outside of the stop's circle.
fn corners() -> ApertureShape {
    let texels = [[1.0; 3], [0.0; 3], [1.0; 3], [0.0; 3], [0.5; 3], [0.0; 3], [1.0; 3], [0.0; 3], [0.0; 3]];
    ApertureShape::Image(Image::from_linear("corners.png", 3, 3, texels.into()).into())
}

fn system(written: &Written) -> LensSystem {
    LensSystem::new(written, &Location::default()).expect("a lens system")
}

/// Numbers in [0, 1).
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + self.next() * (high - low)
    }
}

#[test]
fn focal_lengths_are_those_of_the_lens_makers_equation() {
    let mut random = Random(1);
    for _ in 0..200 {
        let scale = random.between(-3.0, 3.0).exp2();
        let (r1, r2, n) = (
            scale * random.between(20.0, 90.0),
            -scale * random.between(20.0, 90.0),
            random.between(1.3, 1.9),
        );
        let d = scale * random.between(0.1, 6.0);
        let power = (n - 1.0) * (1.0 / r1 - 1.0 / r2 + (n - 1.0) * d / (n * r1 * r2));
        let mut lens = written(&format!("{r1} {d} {n} {}\n{r2} 0 1 {}", scale * 4.0, scale * 4.0));
        lens.focus_distance = 0.5 * scale * random.between(1.0, 100.0);
        lens.film_diagonal = 10.0 * scale;
        let system = system(&lens);
        let expected = 1e-3 / power;
        assert!(
            (system.focal_length() / expected - 1.0).abs() < 1e-9,
            "{} {expected}",
            system.focal_length()
        );
        assert_focused(&system, lens.focus_distance);
    }
}

/// Rays near the axis from the middle of the film meet on the axis in the plane of focus, and those from elsewhere where a pinhole would
/// show the plane.
fn assert_focused(system: &LensSystem, focus_distance: f64) {
    let at_focus = |film: f64| {
        let (ray, _) = system.toward([film, 0.0], [1e-4 * system.rear_radius, 0.0]);
        let ray: LensRay<f64> = system.crossed(ray);
        (ray.p.x + ray.d.x / ray.d.z * (focus_distance - ray.p.z), ray.p.x)
    };
    let (middle, on_front) = at_focus(0.0);
    assert!(middle.abs() < 1e-5 * on_front.abs(), "{middle} {on_front}");
    let film = 1e-4 * system.film_radius;
    let (elsewhere, _) = at_focus(film);
    let pinhole = -film * focus_distance / system.pinhole_distance();
    assert!((elsewhere / pinhole - 1.0).abs() < 1e-5, "{elsewhere} {pinhole}");
}

#[test]
fn flat_surfaces_refract() {
    for (table, focal_length) in [
        ("25 5 1.5 20\n0 0 1 20", 50.0),
        ("inf 5 1.5 20\n-25 0 1 20", 50.0),
        // A window and a stop change nothing.
        ("0 5 1.5 20\n0 5 1 20\n25 5 1.5 20\n0 1 1 20\n0 0 0 10", 50.0),
        // A stop inside of the glass: 1/f = 0.5 (2 / 40 − 0.5 · 6 / (1.5 · 40²)).
        ("40 2 1.5 20\n0 4 0 10\n-40 0 1 20", 1.0 / (0.5 * (0.05 - 0.00125))),
    ] {
        let lens = written(table);
        let system = system(&lens);
        let found = 1e3 * system.focal_length();
        assert!((found / focal_length - 1.0).abs() < 1e-9, "{table:?} {found}");
        assert_focused(&system, lens.focus_distance);
    }
}

#[test]
fn films_may_be_in_a_medium() {
    // The reduced eye: one surface, and a retina in water.
    let eye = written("5.55 0 1.333 6");
    let system = system(&eye);
    assert!((1e3 * system.focal_length() - 5.55 / 0.333).abs() < 1e-9, "{}", system.focal_length());
    assert_focused(&system, eye.focus_distance);
    // n sin θ' of the film's side is that of a cone in air, in the limit of small pupils.
    let small =
        Written { surfaces: parse(b"5.55 0 1.333 0.01", &Location::default()).expect("an eye"), ..eye };
    let [f_number, expected] = [self::system(&small).f_number(), system.focal_length() / 1e-5];
    assert!((f_number / expected - 1.0).abs() < 0.02, "{f_number} {expected}");
    let near = Written { focus_distance: 0.09, ..small };
    assert_focused(&self::system(&near), near.focus_distance);
    let too_near = Written { focus_distance: 0.07, ..near };
    assert!(LensSystem::new(&too_near, &Location::default()).is_err());
}

/// The ray behind a system by centres of spheres and angles of refraction; `None` where it is blocked.
fn slow(system: &LensSystem, mut p: [f64; 3], mut d: [f64; 3]) -> Option<([f64; 3], [f64; 3])> {
    let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let along = |p: [f64; 3], d: [f64; 3], t: f64| [p[0] + t * d[0], p[1] + t * d[1], p[2] + t * d[2]];
    for section in system.sections() {
        let Some(ratio) = section.index_ratio else {
            p = along(p, d, (section.vertex - p[2]) / d[2]);
            if p[0].hypot(p[1]) > section.radius {
                return None;
            }
            continue;
        };
        let radius = 1.0 / section.curvature;
        let from_center = [p[0], p[1], p[2] - (section.vertex - radius)];
        let b = dot(from_center, d);
        let discriminant = b * b - (dot(from_center, from_center) - radius * radius);
        if discriminant < 0.0 {
            return None;
        }
        let roots = [-b - discriminant.sqrt(), -b + discriminant.sqrt()];
        let t = if radius > 0.0 { roots[1] } else { roots[0] };
        p = along(p, d, t);
        if t < 0.0 || p[0].hypot(p[1]) > section.radius {
            return None;
        }
        // The normal on the scene's side, the part of the direction along the surface, and the angle of refraction.
        let normal = [p[0], p[1], p[2] - (section.vertex - radius)].map(|x| x / radius);
        let cosine = dot(d, normal);
        let across = along(d, normal, -cosine);
        let sine = dot(across, across).sqrt();
        let refracted = sine / ratio;
        if refracted >= 1.0 {
            return None;
        }
        let angle = refracted.asin();
        d = [0, 1, 2].map(|axis| {
            let across = if sine > 0.0 { across[axis] / sine } else { 0.0 };
            angle.sin() * across + angle.cos() * normal[axis]
        });
    }
    Some((p, d))
}

#[test]
fn rays_are_those_of_a_slow_tracer() {
    let mut random = Random(2);
    let (mut passed, mut blocked) = (0, 0);
    for written in examples() {
        let system = system(&Written { shape: ApertureShape::Circle, ..written });
        for _ in 0..5000 {
            let reach = 1.5 * system.rear_radius;
            let mut place = |reach: f64| [random.between(-reach, reach), random.between(-reach, reach)];
            let (film, on_rear) = (place(system.film_radius), place(reach));
            let (ray, _) = system.toward(film, on_rear);
            let start = [ray.d.x, ray.d.y, ray.d.z];
            let ray: LensRay<f64> = system.crossed(ray);
            let expected = slow(&system, [film[0], film[1], 0.0], start);
            assert_eq!(ray.passes, expected.is_some(), "{film:?} {on_rear:?}");
            let Some((p, d)) = expected else {
                blocked += 1;
                continue;
            };
            passed += 1;
            for (found, expected) in [ray.p.x, ray.p.y, ray.p.z].into_iter().zip(p) {
                assert!((found - expected).abs() < 1e-10 * system.film_radius, "{found} {expected}");
            }
            for (found, expected) in [ray.d.x, ray.d.y, ray.d.z].into_iter().zip(d) {
                assert!((found - expected).abs() < 1e-10, "{found} {expected}");
            }
        }
    }
    assert!(passed > 2000 && blocked > 2000, "{passed} {blocked}");
}

#[test]
fn no_ray_outside_of_the_pupils_bounds_passes() {
    let mut random = Random(3);
    let (mut inside, mut passed) = (0, 0);
    for written in examples() {
        let system = system(&written);
        // Of a shape as pbrt sees it, only film points on the axis count.
        let is_turned = written.convention == LensConvention::AsPinhole || system.aperture.is_none();
        for _ in 0..40_000 {
            let distance = random.next() * system.film_radius;
            let turn = if is_turned { 2.0 * PI * random.next() } else { 0.0 };
            let reach = SEARCHED_FOR_TEST * system.rear_radius;
            let [along, across] = [0, 1].map(|_| random.between(-reach, reach));
            let turned = |x: f64, y: f64| [turn.cos() * x - turn.sin() * y, turn.sin() * x + turn.cos() * y];
            let (ray, _) = system.toward(turned(distance, 0.0), turned(along, across));
            let ray: LensRay<f64> = system.crossed(ray);
            let passes = ray.passes && system.transmittance::<f32>(ray.on_stop) > 0.0;
            let interval = (distance / system.film_radius * INTERVALS as f64) as usize;
            let [left, right, bottom, top] = system.pupil.bounds(interval).map(f64::from);
            let is_inside = (left..right).contains(&along) && (bottom..top).contains(&across);
            assert!(is_inside || !passes, "{} {distance} {along} {across}", written.shape.name());
            inside += u32::from(is_inside);
            passed += u32::from(passes);
        }
    }
    // The bounds of circles have π/4 of their area in the circle, and cat's eyes and shapes less.
    assert!(passed > 3000 && f64::from(passed) > 0.5 * f64::from(inside), "{passed} of {inside}");
}

/// What brute force searches, in radii of the rear surface.
const SEARCHED_FOR_TEST: f64 = 1.5;

#[test]
fn a_pinholes_brightness_is_that_of_the_middle() {
    for written in examples() {
        let written = Written { convention: LensConvention::AsPinhole, ..written };
        let system = system(&written);
        let count = 200;
        let u = |place: u32| (place as f32 + 0.5) / count as f32;
        let weights = (0..count * count)
            .map(|place| system.leaving::<f32>([0.0; 2], [u(place % count), u(place / count)]).weight);
        let mean = weights.map(f64::from).sum::<f64>() / f64::from(count * count);
        assert!((mean - 1.0).abs() < 0.01, "{} {mean}", written.shape.name());
    }
    let f_number = system(&written(DOUBLE_GAUSS)).f_number();
    assert!((f_number - 2.0).abs() < 0.1, "an f/2 lens focused near, not f/{f_number}");
}

#[test]
fn larger_worlds_have_the_same_rays() {
    let mut random = Random(4);
    for written in examples() {
        let small = system(&written);
        for _ in 0..10 {
            // Powers of two, so that nothing is rounded anew.
            let factor = random.between(-60.0, 60.0).round().exp2();
            let large = system(&written.scaled(factor));
            for _ in 0..50 {
                let film = [0, 1].map(|_| random.between(-1.0, 1.0) * small.film_radius);
                let u = [0, 1].map(|_| random.next() as f32);
                let a = small.leaving::<f32>(film, u);
                let b = large.leaving::<f32>(film.map(|x| x * factor), u);
                assert_eq!(a.weight, b.weight);
                if a.weight == 0.0 {
                    continue;
                }
                assert_eq!(a.direction, b.direction);
                assert_eq!(
                    [a.origin.x, a.origin.y, a.origin.z].map(|x| x * factor),
                    [b.origin.x, b.origin.y, b.origin.z]
                );
            }
        }
    }
}

#[test]
fn crossings_end_where_the_ray_leaves() {
    for written in examples() {
        let system = system(&written);
        let mut random = Random(5);
        for _ in 0..500 {
            let film = [0, 1].map(|_| random.between(-0.7, 0.7) * system.film_radius);
            let u = [0, 1].map(|_| random.next() as f32);
            let (ray, crossings) = (system.leaving::<f32>(film, u), system.crossings(film, u));
            let last = crossings.last().expect("the film, at least");
            assert_eq!(last.passes, ray.weight > 0.0);
            assert!(crossings.iter().rev().skip(1).all(|crossing| crossing.passes));
            if last.passes {
                assert_eq!(crossings.len(), written.surfaces.len() + 1);
                assert_eq!(last.point, [ray.origin.x, ray.origin.y, ray.origin.z]);
                assert_eq!(last.direction, [ray.direction.x, ray.direction.y, ray.direction.z]);
            }
        }
    }
}

#[test]
fn shapes_have_the_light_of_a_circle() {
    let white = Image::from_linear("white.png", 3, 2, vec![[1.0; 3]; 6]);
    let named = ApertureShape::NAMED.into_iter().skip(1).map(|(_, shape)| shape);
    for shape in named.chain([ApertureShape::Image(white.into())]) {
        let image = ApertureImage::new(&shape, &Location::default()).expect("light").expect("no circle");
        let (count, radius) = (1000, 0.01);
        // On a square that is larger, since interpolation reaches beyond.
        let place =
            |place: u32| radius * (4.0 * (f64::from(place) + 0.5) / f64::from(count) - 2.0) as f32 as f64;
        let mut sum = 0.0;
        let mut farthest = 0.0_f64;
        for index in 0..count * count {
            let [x, y] = [place(index % count), place(index / count)];
            let passed = image.at([x as f32, y as f32], radius);
            sum += f64::from(passed);
            if passed > 0.0 {
                farthest = farthest.max(x.hypot(y) / radius);
            }
        }
        let mean = 4.0 * sum / f64::from(count * count);
        assert!((mean - PI / 4.0).abs() < 0.005, "{} {mean}", shape.name());
        assert!(farthest <= image.reach() + 1e-6, "{} {farthest} {}", shape.name(), image.reach());
    }
    // Row 0 is on top.
    let half = Image::from_linear("half.png", 1, 2, vec![[1.0; 3], [0.0; 3]]);
    let half = ApertureImage::new(&ApertureShape::Image(half.into()), &Location::default());
    let half = half.expect("light").expect("no circle");
    assert!(half.at([0.0, 0.5], 1.0) > 1.0 && half.at([0.0, -0.51], 1.0) == 0.0);
    assert_eq!(half.at([f32::NAN, 0.0], 1.0), 0.0);
}

#[test]
fn systems_without_an_image_are_clear_errors() {
    let of = |written: Written| {
        LensSystem::new(&written, &Location::default()).map(|_| ()).expect_err("no lens system").to_string()
    };
    let gauss = || written(DOUBLE_GAUSS);
    let near = of(Written { focus_distance: 0.1, ..gauss() });
    assert!(near.contains("cannot be focused at 0.1, but only farther away than 0.1959"), "{near}");
    assert!(of(written("-50 2 1.5 20\n50 0 1 20")).contains("makes no image"));
    assert!(of(written("50 2 1 20\n50 0 1 20")).contains("makes no image"));
    let black = Image::from_linear("black.png", 2, 2, vec![[0.0; 3]; 4]);
    let black = of(Written { shape: ApertureShape::Image(black.into()), ..gauss() });
    assert!(black.contains("\"black.png\" lets no light through"), "{black}");
    // Too small a sphere for the ray to meet.
    assert!(of(written("20 30 1.5 20\n-0.001 0 1 20")).contains("lens system"));
    for value in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(of(Written { focus_distance: value, ..gauss() }).contains("focus distance"));
        assert!(of(Written { film_diagonal: value, ..gauss() }).contains("diagonal"));
        assert!(of(Written { millimetre: value, ..gauss() }).contains("millimetre"));
        assert!(of(Written { stop_diameter: Some(value), ..gauss() }).contains("aperture"));
    }
}

/// Tables of numbers of any size: a system or an error, and rays that are finite or blocked.
#[test]
fn random_tables_end() {
    let mut random = Random(6);
    let mut systems = 0;
    for _ in 0..300 {
        let range = if random.next() < 0.5 { 3.0 } else { 30.0 };
        let mut table = String::new();
        for _ in 0..1 + (4.0 * random.next()) as usize {
            let mut size = || random.between(-range, range).min(29.0).exp2();
            let (radius, thickness, index, diameter) =
                (30.0 * size(), size(), size().clamp(0.1, 5.0), 20.0 * size());
            let sign = if random.next() < 0.4 { -1.0 } else { 1.0 };
            table.push_str(&format!("{} {thickness} {index} {diameter}\n", sign * radius));
        }
        let Ok(surfaces) = parse(table.as_bytes(), &Location::default()) else { continue };
        let written = Written { surfaces, ..written(DOUBLE_GAUSS) };
        let Ok(system) = LensSystem::new(&written, &Location::default()) else { continue };
        systems += 1;
        for _ in 0..100 {
            let film = [0, 1].map(|_| random.between(-1.0, 1.0) * system.film_radius);
            let ray = system.leaving::<f32>(film, [0, 1].map(|_| random.next() as f32));
            let is_finite = ray.weight.is_finite() && ray.origin.length().is_finite();
            assert!(ray.weight == 0.0 || is_finite && (ray.direction.length() - 1.0).abs() < 1e-6, "{table}");
        }
    }
    assert!(systems > 10, "{systems}");
}
