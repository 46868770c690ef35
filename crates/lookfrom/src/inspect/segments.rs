//! The rays of a sample as line segments in the world, as drawings show them.

use std::fmt;

use glam::{DVec3, Vec3};
use serde::{Serialize, Serializer};

use super::{Inspection, RayReport, ShadowReport};

/// The width of lines of shadow rays, and of rays that carry nothing, in pixels.
const THINNEST: f32 = 1.1;

/// The kinds of rays, each of which has a colour in drawings.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RayKind {
    /// From the camera.
    Camera,
    /// Along a mirrored direction; along a path, sampled on the side that it came from.
    Reflected,
    /// Through a surface of Whitted's tree.
    Refracted,
    /// Through a surface, along a path.
    Transmitted,
    /// Along a direction of a random walk.
    Scattered,
    /// Past a surface that it passes by alpha or as an interface.
    StraightOn,
    /// Toward a light, up to it or to what blocks it.
    Shadow,
    /// Toward a light, behind what blocks it.
    Blocked,
}

/// A line segment of a drawing: a ray, or a part of a shadow ray.
#[derive(Clone, Debug, Serialize)]
pub struct RaySegment {
    /// Address of the ray; for a shadow ray, of the ray whose hit cast it.
    pub address: u64,
    /// The kind of ray.
    pub kind: RayKind,
    /// Its start.
    pub from: [f64; 3],
    /// Its end; without one, a point so far away that the ray is seen.
    pub to: [f64; 3],
    /// Whether it has no end.
    pub is_endless: bool,
    /// The width of its line in pixels, which grows with the throughput.
    pub width: f32,
    /// The name at its end: of the shape, or of the light of a shadow ray.
    pub name: Option<String>,
    /// Its description with its contribution.
    pub title: String,
}

impl RayKind {
    /// All kinds, in the order of a legend.
    pub const ALL: [Self; 8] = [
        Self::Camera,
        Self::Reflected,
        Self::Refracted,
        Self::Transmitted,
        Self::Scattered,
        Self::StraightOn,
        Self::Shadow,
        Self::Blocked,
    ];

    /// Whether it is a shadow ray.
    pub fn is_shadow(self) -> bool {
        matches!(self, Self::Shadow | Self::Blocked)
    }
}

impl fmt::Display for RayKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Camera => "camera",
            Self::Reflected => "reflected",
            Self::Refracted => "refracted",
            Self::Transmitted => "transmitted",
            Self::Scattered => "scattered",
            Self::StraightOn => "straight on",
            Self::Shadow => "shadow",
            Self::Blocked => "blocked",
        })
    }
}

impl Serialize for RayKind {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

/// The segments of every ray, each followed by those of its shadow rays.
pub(super) fn segments(inspection: &Inspection) -> Vec<RaySegment> {
    let length = length_without_end(inspection);
    let mut segments = Vec::new();
    for ray in &inspection.rays {
        let direction = Vec3::from_array(ray.direction).as_dvec3();
        segments.push(RaySegment {
            address: ray.address,
            kind: ray.kind,
            from: ray.a,
            to: ray.end().unwrap_or_else(|| along(ray.a, direction, length)),
            is_endless: ray.end().is_none(),
            width: width(&ray.throughput),
            name: ray.met.as_ref().map(|met| met.shape.clone()),
            title: format!("{} ray {}, contributes {:?}", ray.kind, ray.address, ray.subtree.rgb),
        });
        let of_lights = ray.lights.iter().map(|light| (&light.shadow, &*light.light, &light.added));
        let of_one = ray.light_sample.iter().map(|light| (&light.shadow, &*light.light, &light.added));
        let of_openness = [(&ray.openness, "the open sky", &ray.added)];
        for (shadow, light, added) in of_lights.chain(of_one).chain(of_openness) {
            if let Some(shadow) = shadow {
                let title = format!("shadow ray to {light}, contributes {:?}", added.rgb);
                shadow_segments(ray, shadow, (light, title), length, &mut segments);
            }
        }
    }
    segments
}

/// A shadow ray up to its light; or up to what blocks it, and from there on.
fn shadow_segments(
    ray: &RayReport,
    shadow: &ShadowReport,
    (light, title): (&str, String),
    length: f64,
    segments: &mut Vec<RaySegment>,
) {
    let part = |kind, from, to, is_endless, name: &str| RaySegment {
        address: ray.address,
        kind,
        from,
        to,
        is_endless,
        width: THINNEST,
        name: Some(name.to_owned()),
        title: title.clone(),
    };
    let (mut kind, mut start) = (RayKind::Shadow, shadow.from);
    if let Some(blocker) = shadow.blocker() {
        segments.push(part(kind, start, blocker.point, false, &blocker.shape));
        (kind, start) = (RayKind::Blocked, blocker.point);
    }
    let direction = DVec3::from_array(shadow.to) - DVec3::from_array(shadow.from);
    let end = if shadow.is_endless { along(start, direction, length) } else { shadow.to };
    segments.push(part(kind, start, end, shadow.is_endless, light));
}

/// The point at a distance in a direction of any length.
fn along(from: [f64; 3], direction: DVec3, distance: f64) -> [f64; 3] {
    (DVec3::from_array(from) + direction.normalize() * distance).to_array()
}

/// The width of a ray's line by the mean of its throughput.
fn width(throughput: &[f32]) -> f32 {
    let mean = throughput.iter().sum::<f32>() / throughput.len() as f32;
    THINNEST + 2.4 * mean.clamp(0.0, 1.0).sqrt()
}

/// The length at which a ray without an end is drawn: a considerable part of the drawing.
fn length_without_end(inspection: &Inspection) -> f64 {
    let eye = DVec3::from_array(inspection.camera.lookfrom);
    let points = inspection.rays.iter().filter_map(RayReport::end).map(DVec3::from_array);
    let farthest = points.map(|point| point.distance(eye)).fold(0.0, f64::max);
    if farthest > 0.0 {
        0.4 * farthest
    } else {
        4.0 * DVec3::from_array(inspection.camera.direction).length()
    }
}
