//! The rays of an inspection as line segments in the world.

use glam::{DVec3, Vec3};

use crate::inspect::{Inspection, RayReport};

/// The kind of a ray, which has a colour.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Camera,
    Mirrored,
    Refracted,
    StraightOn,
    Shadow,
    Blocked,
}

impl Kind {
    pub(super) const ALL: [Self; 6] =
        [Self::Camera, Self::Mirrored, Self::Refracted, Self::StraightOn, Self::Shadow, Self::Blocked];

    fn of(ray: &RayReport) -> Self {
        match ray.kind {
            "camera" => Self::Camera,
            "reflected" | "scattered" => Self::Mirrored,
            "straight on" => Self::StraightOn,
            _ => Self::Refracted,
        }
    }

    pub(super) fn color(self) -> &'static str {
        match self {
            Self::Camera => "#2458c5",
            Self::Mirrored => "#1a7f45",
            Self::Refracted => "#c2410c",
            Self::StraightOn => "#8a4fbf",
            Self::Shadow => "#b88a00",
            Self::Blocked => "#000000",
        }
    }

    pub(super) fn name(self, is_path: bool) -> &'static str {
        match self {
            Self::Camera => "camera ray",
            Self::Mirrored if is_path => "reflected or scattered ray",
            Self::Mirrored => "reflected ray",
            Self::Refracted if is_path => "transmitted ray",
            Self::Refracted => "refracted ray",
            Self::StraightOn => "ray that passed a surface (interface or alpha)",
            Self::Shadow => "shadow ray that reaches its light",
            Self::Blocked => "shadow ray that is blocked",
        }
    }

    /// Attributes of its lines.
    pub(super) fn stroke(self) -> String {
        let line = match self {
            Self::Shadow | Self::Blocked => "stroke-width=\"1.2\" stroke-dasharray=\"6 4\"",
            _ => "stroke-width=\"2.2\"",
        };
        format!("stroke=\"{}\" {line}", self.color())
    }
}

/// A ray.
pub(super) struct Segment {
    /// Its address; `None` for a shadow ray.
    pub(super) address: Option<u64>,
    pub(super) kind: Kind,
    pub(super) ends: [DVec3; 2],
    pub(super) title: String,
    /// The name of the shape at its end, or of the light of a shadow ray.
    pub(super) name: Option<String>,
}

/// Every ray; those that hit nothing, and shadow rays to lights infinitely far away, get a finite length.
pub(super) fn segments(inspection: &Inspection) -> Vec<Segment> {
    let length = length_without_end(inspection);
    let mut segments = Vec::new();
    for ray in &inspection.rays {
        let a = DVec3::from_array(ray.a);
        let direction = Vec3::from_array(ray.direction).as_dvec3();
        let end = match &ray.met {
            Some(met) => DVec3::from_array(met.point),
            None => a + direction.normalize() * length,
        };
        segments.push(Segment {
            address: Some(ray.address),
            kind: Kind::of(ray),
            ends: [a, end],
            title: format!("{} ray {}, contributes {:?}", ray.kind, ray.address, ray.subtree.rgb),
            name: ray.met.as_ref().map(|met| met.shape.clone()),
        });
        shadow_segments(ray, length, &mut segments);
    }
    segments
}

fn shadow_segments(ray: &RayReport, length: f64, segments: &mut Vec<Segment>) {
    let of_lights = ray.lights.iter().map(|light| (&light.shadow, &*light.light, &light.added));
    let of_one = ray.light_sample.iter().map(|light| (&light.shadow, &*light.light, &light.added));
    let of_openness = [(&ray.openness, "the open sky", &ray.added)];
    for (shadow, aim, added) in of_lights.chain(of_one).chain(of_openness) {
        let Some(shadow) = shadow else { continue };
        let [start, end] = [shadow.from, shadow.to].map(DVec3::from_array);
        let end = if shadow.is_endless { start + (end - start).normalize() * length } else { end };
        segments.push(Segment {
            address: None,
            kind: if shadow.is_blocked() { Kind::Blocked } else { Kind::Shadow },
            ends: [start, end],
            title: format!("shadow ray to {aim}, contributes {:?}", added.rgb),
            name: Some(aim.to_owned()),
        });
    }
}

/// The length at which a ray without an end is drawn: a considerable part of the drawing.
fn length_without_end(inspection: &Inspection) -> f64 {
    let eye = DVec3::from_array(inspection.camera.lookfrom);
    let points =
        inspection.rays.iter().filter_map(|ray| ray.met.as_ref()).map(|met| DVec3::from_array(met.point));
    let farthest = points.map(|point| point.distance(eye)).fold(0.0, f64::max);
    if farthest > 0.0 {
        0.4 * farthest
    } else {
        4.0 * DVec3::from_array(inspection.camera.direction).length()
    }
}
