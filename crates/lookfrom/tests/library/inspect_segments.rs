//! The rays of an inspection as line segments, which the page and the SVG draw.

use glam::DVec3;
use lookfrom::inspect::{RayKind, RaySegment, SvgView, inspect, svg};
use lookfrom::render::SampleId;

use crate::support::{Compiled, scene};

/// A mirror below a ball that shades it from a lamp; a second light has no place.
const BALL: &str = r#"
[camera]
lookfrom = [0, 1, 6]
lookat = [0, 0, 0]
fov = 20

[image]
width = 8
height = 8

[render]
integrator = "whitted"
samples = 1

[materials.floor]
diffuse = 0.5
mirror = 0.25

[[quad]]
corner = [-4, 0, -4]
edge_u = [0, 0, 8]
edge_v = [8, 0, 0]
material = "floor"

[[sphere]]
center = [0, 2, 0]
radius = 0.8

[[light]]
type = "point"
position = [0, 4, 0]
intensity = 5

[[light]]
type = "distant"
direction = [1, -1, 0]
intensity = 1
"#;

/// The length of a segment, and its direction.
fn way(segment: &RaySegment) -> (f64, DVec3) {
    let way = DVec3::from_array(segment.to) - DVec3::from_array(segment.from);
    (way.length(), way.normalize())
}

#[test]
fn rays_and_shadow_rays_are_segments() {
    let compiled = Compiled::new(scene(BALL));
    let renderer = compiled.renderer();
    let inspection = inspect(&renderer, SampleId { pixel: [4, 4], sample: 0 });
    let rays = inspection.segments.iter().filter(|segment| !segment.kind.is_shadow());
    let mut widths = Vec::new();
    for (segment, ray) in rays.clone().zip(&inspection.rays) {
        assert_eq!((segment.address, segment.kind, segment.from), (ray.address, ray.kind, ray.a));
        let met = ray.met.as_ref();
        assert_eq!((segment.is_endless, &segment.name), (met.is_none(), &met.map(|met| met.shape.clone())));
        assert!(met.is_none_or(|met| met.point == segment.to), "{segment:?}");
        widths.push(f64::from(segment.width));
    }
    assert_eq!(rays.count(), inspection.rays.len());
    // A camera ray, and one that carries a quarter.
    assert!(matches!(widths[..], [a, b] if (a - 3.5).abs() < 1e-6 && (b - 2.3).abs() < 1e-6), "{widths:?}");

    // In the ball's shadow the way to the lamp is two segments, bright up to the ball and dark behind it.
    let first: Vec<_> = inspection.segments.iter().filter(|one| one.address == 1).collect();
    let [_, bright, dark, distant] = first[..] else { panic!("four segments: {first:#?}") };
    assert_eq!([bright.kind, dark.kind, distant.kind], [RayKind::Shadow, RayKind::Blocked, RayKind::Shadow]);
    assert_eq!(bright.to, dark.from);
    for (end, from, distance) in
        [(bright.to, DVec3::new(0.0, 2.0, 0.0), 0.8), (dark.to, DVec3::new(0.0, 4.0, 0.0), 0.0)]
    {
        assert!((DVec3::from_array(end).distance(from) - distance).abs() < 1e-6, "{end:?}");
    }
    assert!(way(bright).1.dot(way(dark).1) > 0.999_999, "{bright:?} {dark:?}");
    assert!(bright.name != dark.name && dark.title.starts_with("shadow ray to "), "{bright:?} {dark:?}");

    // What has no end is as long as a good part of the drawing.
    let endless = inspection.segments.iter().filter(|segment| segment.is_endless);
    let farthest = inspection.rays.iter().filter_map(|ray| ray.met.as_ref());
    let farthest = farthest.map(|met| DVec3::from_array(met.point).distance(DVec3::new(0.0, 1.0, 6.0)));
    let farthest = farthest.fold(0.0, f64::max);
    for segment in endless.clone() {
        assert!((way(segment).0 / farthest - 0.4).abs() < 1e-6, "{segment:?}");
    }
    assert!(distant.is_endless && endless.count() > 1);

    // The legend has the kinds that are drawn.
    let drawing = svg(&renderer, &inspection, SvgView::Side).expect("a drawing");
    let legend = [">camera ray<", ">reflected ray<", ">shadow ray, up to", ">shadow ray behind"];
    assert!(
        legend.iter().all(|name| drawing.contains(name)) && !drawing.contains(">refracted ray<"),
        "{drawing}"
    );
}
