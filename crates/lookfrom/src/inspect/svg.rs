//! The rays as a drawing (SVG): a side view of the scene with the camera, one colour for each kind of ray, blocked
//! shadow rays black.

use std::fmt::Write;

use glam::{DVec2, DVec3, Vec3};

use super::{Inspection, RayReport};
use crate::primitive::Primitives;
use crate::render::Renderer;
use crate::view::camera::Camera;
use crate::world::World;

/// Width of the drawing in its own units; the height follows from the scene.
const WIDTH: f64 = 1000.0;

/// Maximum number of triangles of a mesh whose outlines are drawn, at regular steps.
const MOST_TRIANGLES: usize = 600;

/// Draws an inspection in a plane that holds the direction of view (to the right) and up.
pub fn svg(renderer: &Renderer, inspection: &Inspection) -> String {
    let (world, camera) = (renderer.world(), renderer.view().camera());
    let side = SideView::new(camera);
    let segments = segments(&side, inspection);

    // Frame the rays and the camera; the rest is clipped.
    let mut low = side.project(DVec3::from_array(inspection.camera.lookfrom));
    let mut high = low;
    for segment in &segments {
        for point in [segment.from, segment.to] {
            low = low.min(point);
            high = high.max(point);
        }
    }
    let margin = 0.1 * (high - low).max_element().max(1e-9);
    (low, high) = (low - margin, high + margin);
    let aspect = ((high.y - low.y) / (high.x - low.x)).clamp(0.3, 1.2);
    let middle = 0.5 * (low + high);
    let half_width = (0.5 * (high.x - low.x)).max(0.5 * (high.y - low.y) / aspect);
    let scale = WIDTH / (2.0 * half_width);
    let height = WIDTH * aspect;
    let place = |p: DVec2| {
        DVec2::new(WIDTH / 2.0 + (p.x - middle.x) * scale, height / 2.0 - (p.y - middle.y) * scale)
    };

    let mut out = String::new();
    let _ = write!(
        out,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {height:.0}\" font-family=\"sans-serif\" \
         font-size=\"14\">\n<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n"
    );
    draw_scene(&mut out, world, &side, &place, scale);
    for segment in &segments {
        let (a, b) = (place(segment.from), place(segment.to));
        let _ = writeln!(
            out,
            "<line x1=\"{:.1}\" y1=\"{:.1}\" x2=\"{:.1}\" y2=\"{:.1}\" stroke=\"{}\" stroke-width=\"{}\"{}><title>{}</title></line>",
            a.x,
            a.y,
            b.x,
            b.y,
            segment.kind.color(),
            segment.kind.width(),
            segment.kind.dashes(),
            escape(&segment.title)
        );
    }
    if inspection.is_path() {
        draw_numbers(&mut out, &segments, &place);
    }
    let eye = place(side.project(DVec3::from_array(inspection.camera.lookfrom)));
    draw_camera(&mut out, eye, side.project(camera.w()));
    draw_legend(&mut out, height, inspection, &segments);
    out.push_str("</svg>\n");
    out
}

/// A view from the camera's left: forward is to the right, up is up. The world's y is up unless the camera looks along
/// it; then the camera's v is up.
struct SideView {
    forward: DVec3,
    up: DVec3,
}

impl SideView {
    fn new(camera: &Camera) -> Self {
        let axes = &camera.r3;
        let (up, forward) = (axes.y_axis.truncate().normalize(), axes.z_axis.truncate().normalize());
        let level = forward.reject_from_normalized(DVec3::Y);
        if level.length() > 0.3 {
            Self { forward: level.normalize(), up: DVec3::Y }
        } else {
            Self { forward, up }
        }
    }

    fn project(&self, point: DVec3) -> DVec2 {
        DVec2::new(point.dot(self.forward), point.dot(self.up))
    }
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    Camera,
    Mirrored,
    Refracted,
    StraightOn,
    Shadow,
    Blocked,
}

impl Kind {
    const ALL: [Self; 6] =
        [Self::Camera, Self::Mirrored, Self::Refracted, Self::StraightOn, Self::Shadow, Self::Blocked];

    fn of(ray: &RayReport) -> Self {
        match ray.kind {
            "camera" => Self::Camera,
            "reflected" | "scattered" => Self::Mirrored,
            "straight on" => Self::StraightOn,
            _ => Self::Refracted,
        }
    }

    fn color(self) -> &'static str {
        match self {
            Self::Camera => "#2458c5",
            Self::Mirrored => "#1f9d55",
            Self::Refracted => "#d9480f",
            Self::StraightOn => "#8a4fbf",
            Self::Shadow => "#e0a800",
            Self::Blocked => "#000000",
        }
    }

    fn name(self, is_path: bool) -> &'static str {
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

    fn width(self) -> f64 {
        if matches!(self, Self::Shadow | Self::Blocked) { 1.2 } else { 2.4 }
    }

    fn dashes(self) -> &'static str {
        if matches!(self, Self::Shadow | Self::Blocked) { " stroke-dasharray=\"6 4\"" } else { "" }
    }
}

struct Segment {
    /// The ray's address; `None` for a shadow ray.
    address: Option<u64>,
    kind: Kind,
    from: DVec2,
    to: DVec2,
    title: String,
}

/// Every ray as a line segment; rays that hit nothing, and shadow rays to lights infinitely far away, get a finite
/// length.
fn segments(side: &SideView, inspection: &Inspection) -> Vec<Segment> {
    let length = length_without_end(inspection);
    let mut segments = Vec::new();
    for ray in &inspection.rays {
        let a = DVec3::from_array(ray.a);
        let direction = Vec3::from_array(ray.direction).as_dvec3();
        let end = match &ray.met {
            Some(met) => DVec3::from_array(met.point),
            None => a + direction.normalize() * length,
        };
        let kind = Kind::of(ray);
        let title = format!("{} ray {}, contributes {:?}", ray.kind, ray.address, ray.subtree.rgb);
        let address = Some(ray.address);
        segments.push(Segment { address, kind, from: side.project(a), to: side.project(end), title });
        shadow_segments(side, ray, length, &mut segments);
    }
    segments
}

fn shadow_segments(side: &SideView, ray: &RayReport, length: f64, segments: &mut Vec<Segment>) {
    let of_lights = ray.lights.iter().map(|light| (&light.shadow, &*light.light, &light.added));
    let of_one = ray.light_sample.iter().map(|light| (&light.shadow, &*light.light, &light.added));
    let of_openness = [(&ray.openness, "the open sky", &ray.added)];
    for (shadow, aim, added) in of_lights.chain(of_one).chain(of_openness) {
        let Some(shadow) = shadow else { continue };
        let [start, end] = [shadow.from, shadow.to].map(DVec3::from_array);
        let end = if shadow.is_endless { start + (end - start).normalize() * length } else { end };
        let kind = if shadow.is_blocked() { Kind::Blocked } else { Kind::Shadow };
        let title = format!("shadow ray to {aim}, contributes {:?}", added.rgb);
        segments.push(Segment {
            address: None,
            kind,
            from: side.project(start),
            to: side.project(end),
            title,
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

fn draw_scene(out: &mut String, world: &World, side: &SideView, place: &impl Fn(DVec2) -> DVec2, scale: f64) {
    out.push_str("<g fill=\"#00000008\" stroke=\"#9a9a9a\" stroke-width=\"0.8\">\n");
    for primitives in &*world.primitives {
        match primitives {
            Primitives::Spheres(spheres) if spheres.spheres.len() <= MOST_TRIANGLES => {
                for sphere in &spheres.spheres {
                    let center = world.origin + Vec3::from_array(sphere.center).as_dvec3();
                    let c = place(side.project(center));
                    let radius = f64::from(sphere.radius) * scale;
                    let _ = writeln!(out, "<circle cx=\"{:.1}\" cy=\"{:.1}\" r=\"{radius:.1}\"/>", c.x, c.y);
                }
            }
            Primitives::Mesh(mesh) => {
                let every = mesh.triangles.len().div_ceil(MOST_TRIANGLES).max(1);
                for index in (0..mesh.triangles.len()).step_by(every) {
                    let points = mesh.corners(index).map(|corner| {
                        let p = place(side.project(world.origin + Vec3::from_array(corner).as_dvec3()));
                        format!("{:.1},{:.1}", p.x, p.y)
                    });
                    let _ = writeln!(out, "<polygon points=\"{}\"/>", points.join(" "));
                }
            }
            Primitives::Spheres(_)
            | Primitives::Disks(_)
            | Primitives::Quadrics(_)
            | Primitives::Patches(_)
            | Primitives::Curves(_) => {}
        }
    }
    out.push_str("</g>\n");
}

/// The addresses of a path's rays, beside their midpoints.
fn draw_numbers(out: &mut String, segments: &[Segment], place: &impl Fn(DVec2) -> DVec2) {
    for segment in segments {
        let Some(address) = segment.address else { continue };
        let middle = 0.5 * (place(segment.from) + place(segment.to));
        let _ = writeln!(
            out,
            "<text x=\"{:.1}\" y=\"{:.1}\" fill=\"{}\" font-weight=\"bold\">{address}</text>",
            middle.x + 6.0,
            middle.y - 6.0,
            segment.kind.color()
        );
    }
}

fn draw_camera(out: &mut String, eye: DVec2, forward: DVec2) {
    let angle = libm::atan2(-forward.y, forward.x).to_degrees();
    let (x, y) = (eye.x, eye.y);
    let _ = writeln!(
        out,
        "<g transform=\"translate({x:.1} {y:.1})\" fill=\"#2458c5\" stroke=\"#2458c5\">\n\
         <path d=\"M 0 0 l 22 -12 v 24 z\" fill-opacity=\"0.25\" transform=\"rotate({angle:.2})\"/>\n\
         <circle r=\"3\"/>\n<text x=\"-10\" y=\"34\" stroke=\"none\">lookfrom</text>\n</g>"
    );
}

fn draw_legend(out: &mut String, height: f64, inspection: &Inspection, segments: &[Segment]) {
    let [x, y] = inspection.pixel;
    let _ = writeln!(
        out,
        "<text x=\"12\" y=\"22\">pixel {x} {y}, sample {}: {:?}</text>",
        inspection.sample, inspection.film
    );
    let is_drawn = |kind: &Kind| segments.iter().any(|segment| segment.kind == *kind);
    for (index, kind) in Kind::ALL.into_iter().rev().filter(is_drawn).enumerate() {
        let line = height - 16.0 - 20.0 * index as f64;
        let _ = writeln!(
            out,
            "<line x1=\"12\" y1=\"{0:.1}\" x2=\"52\" y2=\"{0:.1}\" stroke=\"{1}\" stroke-width=\"{2}\"{3}/><text x=\"60\" y=\"{4:.1}\">{5}</text>",
            line - 5.0,
            kind.color(),
            kind.width(),
            kind.dashes(),
            line,
            kind.name(inspection.is_path())
        );
    }
}

fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}
