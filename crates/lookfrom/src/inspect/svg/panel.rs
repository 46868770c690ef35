//! One view of a drawing: the scene, the camera with its image plane, the rays with normals at their hits, and labels.

use std::fmt::Write;

use glam::{DVec2, DVec3, Vec3};

use super::labels::{self, FONT, Label};
use super::marks::{arrow, head, line};
use super::outlines::{Outline, outlines};
use super::projection::Projection;
use super::{SvgView, escape, kinds};
use crate::inspect::expression::without_place;
use crate::inspect::{Inspection, RayKind};
use crate::render::Renderer;

/// Lengths of arrows for axes and normals.
const AXIS: f64 = 46.0;
const NORMAL: f64 = 26.0;

/// Maximum number of rays, and of shapes, with a label.
const MOST_LABELS: usize = 24;

/// Colour of normals.
pub(super) const NORMAL_COLOR: &str = "#0e7490";

/// A view in the drawing.
pub(super) struct Panel<'a> {
    view: SvgView,
    renderer: &'a Renderer,
    inspection: &'a Inspection,
    projection: Projection,
    /// The part of the projection that is shown.
    low: DVec2,
    high: DVec2,
    size: DVec2,
    scale: f64,
}

impl<'a> Panel<'a> {
    /// A view of a given width; `None` for the camera's where it sees all around. The height follows from what is shown,
    /// unless it is given.
    pub(super) fn new(
        view: SvgView,
        (renderer, inspection): (&'a Renderer, &'a Inspection),
        (width, height): (f64, Option<f64>),
    ) -> Option<Self> {
        let camera = renderer.view().camera();
        let eye = camera.lookfrom();
        let projection = Projection::new(camera, view, 0.02 * camera.distance)?;
        let (mut low, mut high) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
        let mut include = |point: DVec3| {
            if let Some(point) = projection.point(point) {
                (low, high) = (low.min(point), high.max(point));
            }
        };
        if view == SvgView::Camera {
            image_plane(renderer, inspection)?.into_iter().for_each(include);
        } else {
            include(eye);
            let ends = inspection.segments.iter().flat_map(|segment| [segment.from, segment.to]);
            ends.map(DVec3::from_array).for_each(include);
            let margin = 0.12 * (high - low).max_element().max(1e-9);
            (low, high) = (low - margin, high + margin);
        }
        let span = high - low;
        let aspect =
            if view == SvgView::Camera { span.y / span.x } else { (span.y / span.x).clamp(0.45, 0.9) };
        let size = DVec2::new(width, height.unwrap_or(width * aspect));
        let scale = (size / span).min_element();
        Some(Self { view, renderer, inspection, projection, low, high, size, scale })
    }

    pub(super) fn height(&self) -> f64 {
        self.size.y
    }

    /// A point of the panel from one of the projection.
    fn place(&self, point: DVec2) -> DVec2 {
        let from_middle = (point - 0.5 * (self.low + self.high)) * self.scale;
        0.5 * self.size + DVec2::new(from_middle.x, -from_middle.y)
    }

    fn point(&self, point: DVec3) -> Option<DVec2> {
        self.projection.point(point).map(|point| self.place(point))
    }

    fn segment(&self, ends: [DVec3; 2]) -> Option<[DVec2; 2]> {
        self.projection.segment(ends).map(|ends| ends.map(|end| self.place(end)))
    }

    /// Whether any of a shape with these points can be seen.
    fn shows(&self, points: &[DVec2]) -> bool {
        let low = points.iter().copied().fold(DVec2::INFINITY, DVec2::min);
        let high = points.iter().copied().fold(DVec2::NEG_INFINITY, DVec2::max);
        low.cmple(self.size).all() && high.cmpge(DVec2::ZERO).all() && (high - low).max_element() > 0.7
    }

    fn is_inside(&self, point: DVec2) -> bool {
        point.cmpge(DVec2::ZERO).all() && point.cmple(self.size).all()
    }

    /// Draws the view at a place of the drawing.
    pub(super) fn draw(&self, out: &mut String, at: DVec2) {
        let (name, size) = (self.view.word(), self.size);
        let _ = writeln!(
            out,
            "<clipPath id=\"{name}\"><rect width=\"{:.1}\" height=\"{:.1}\"/></clipPath>\n\
             <g transform=\"translate({:.1} {:.1})\"><g clip-path=\"url(#{name})\">",
            size.x, size.y, at.x, at.y
        );
        let scene = self.draw_scene(out);
        let mut labels = Vec::new();
        let mut rays = self.draw_camera(out, &mut labels);
        rays.extend(self.draw_rays(out, &mut labels));
        self.draw_labels(out, labels, &rays, &scene);
        let _ = writeln!(
            out,
            "</g>\n<rect width=\"{:.1}\" height=\"{:.1}\" fill=\"none\" stroke=\"#b0b0b0\"/>\n\
             <text x=\"8\" y=\"18\" fill=\"#555555\">{}</text>\n</g>",
            size.x,
            size.y,
            self.view.title()
        );
    }

    /// Draws the shapes, and returns their lines.
    fn draw_scene(&self, out: &mut String) -> Vec<[DVec2; 2]> {
        let mut lines = Vec::new();
        out.push_str("<g fill=\"#000000\" fill-opacity=\"0.03\" stroke=\"#9a9a9a\" stroke-width=\"0.7\">\n");
        for outline in outlines(self.renderer.world(), self.projection.viewer()) {
            let (tag, points) = match &outline {
                Outline::Polygon(corners) => {
                    let corners = self.projection.polygon(corners);
                    ("polygon", corners.into_iter().map(|corner| self.place(corner)).collect::<Vec<_>>())
                }
                Outline::Line(points) => {
                    let points = points.iter().map(|point| self.point(*point)).collect::<Option<Vec<_>>>();
                    ("polyline", points.unwrap_or_default())
                }
            };
            if points.len() < 2 || !self.shows(&points) {
                continue;
            }
            lines.extend(points.windows(2).map(|pair| [pair[0], pair[1]]));
            let words: Vec<String> = points.iter().map(|p| format!("{:.1},{:.1}", p.x, p.y)).collect();
            let fill = if tag == "polyline" { " fill=\"none\"" } else { "" };
            let _ = writeln!(out, "<{tag} points=\"{}\"{fill}/>", words.join(" "));
        }
        out.push_str("</g>\n");
        lines
    }

    /// Draws the image plane and the axes u, v, w, and returns their lines; in the camera's own view, the place of the
    /// sample.
    fn draw_camera(&self, out: &mut String, labels: &mut Vec<Label>) -> Vec<[DVec2; 2]> {
        let mut lines = Vec::new();
        let camera = &self.inspection.camera;
        let color = kinds::color(RayKind::Camera);
        let eye = DVec3::from_array(camera.lookfrom);
        if self.view == SvgView::Camera {
            // Of the pinhole's ray: one from a lens crosses the image plane elsewhere, and meets it in the plane of focus.
            if let Some(at) = self.point(DVec3::from_array(camera.p_world)) {
                let _ = writeln!(
                    out,
                    "<circle cx=\"{:.1}\" cy=\"{:.1}\" r=\"9\" fill=\"none\" stroke=\"{color}\" stroke-width=\"1.5\"/>",
                    at.x, at.y
                );
                labels.push(label(at, "the pixel", color));
            }
            return lines;
        }
        let Some(start) = self.point(eye) else { return lines };
        if let Some(corners) = image_plane(self.renderer, self.inspection) {
            let flat: Vec<DVec2> = corners.iter().filter_map(|corner| self.point(*corner)).collect();
            let words: Vec<String> = flat.iter().map(|p| format!("{:.1},{:.1}", p.x, p.y)).collect();
            let _ = writeln!(
                out,
                "<g stroke=\"{color}\"><polygon points=\"{}\" fill=\"{color}\" fill-opacity=\"0.12\" stroke-width=\"1.2\"/>",
                words.join(" ")
            );
            for edge in self.edges(&corners) {
                lines.push(edge);
                let _ = writeln!(out, "{}", line(&edge, "stroke-width=\"0.6\" stroke-opacity=\"0.6\""));
            }
            out.push_str("</g>\n");
            let highest = flat.iter().copied().min_by(|a, b| a.y.total_cmp(&b.y));
            labels.extend(highest.map(|corner| label(corner, "image plane, t = 1", color)));
        }
        let axes = [("u", camera.u), ("v", camera.v), ("w", camera.w)];
        for (name, axis) in axes {
            let axis = DVec3::from_array(axis).normalize();
            let Some(tip) = self.point(eye + axis * (AXIS / self.scale)) else { continue };
            if start.distance(tip) > 0.12 * AXIS {
                arrow(out, start, tip, color, 1.4);
                lines.push([start, tip]);
                labels.push(label(tip, name, color));
            }
        }
        let _ =
            writeln!(out, "<circle cx=\"{:.1}\" cy=\"{:.1}\" r=\"3.5\" fill=\"{color}\"/>", start.x, start.y);
        labels.push(label(start, "lookfrom", color));
        lines
    }

    /// The edges of what the camera sees, up to the corners of the image plane: from the eye, or parallel to each other.
    fn edges(&self, corners: &[DVec3; 4]) -> Vec<[DVec2; 2]> {
        let camera = &self.inspection.camera;
        let forward = DVec3::from_array(camera.w).normalize() * self.renderer.view().camera().distance;
        let from = |corner: DVec3| match camera.projection {
            "orthographic" => corner - forward,
            _ => DVec3::from_array(camera.lookfrom),
        };
        corners.iter().filter_map(|&corner| Some([self.point(from(corner))?, self.point(corner)?])).collect()
    }

    /// Draws the rays and the normals at their hits, and returns their lines.
    fn draw_rays(&self, out: &mut String, labels: &mut Vec<Label>) -> Vec<[DVec2; 2]> {
        let mut lines = Vec::new();
        let (mut numbered, mut names) = (0, Vec::new());
        for segment in &self.inspection.segments {
            let Some(ends) = self.segment([segment.from, segment.to].map(DVec3::from_array)) else {
                continue;
            };
            let kind = segment.kind;
            let color = kinds::color(kind);
            // The camera sees its own ray as a point.
            if self.view != SvgView::Camera || kind != RayKind::Camera {
                let title = escape(&segment.title);
                let _ =
                    writeln!(out, "<g><title>{title}</title>{}</g>", line(&ends, &kinds::stroke(segment)));
                if !kind.is_shadow() && ends[0].distance(ends[1]) > 40.0 {
                    head(out, ends[0].lerp(ends[1], 0.55), ends[1] - ends[0], color);
                }
                lines.push(ends);
                let anchor = ends[0].midpoint(ends[1]);
                if !kind.is_shadow() && numbered < MOST_LABELS && self.is_inside(anchor) {
                    numbered += 1;
                    let text = segment.address.to_string();
                    labels.push(Label { anchor, text, color, is_bold: true });
                }
            }
            if let Some(name) = segment.name.as_deref().map(without_place)
                && self.point(DVec3::from_array(segment.to)).is_some_and(|end| self.is_inside(end))
                && names.len() < MOST_LABELS
                && !names.contains(&name)
            {
                names.push(name);
                labels.push(label(ends[1], name, "#222222"));
            }
        }
        for ray in &self.inspection.rays {
            let Some(met) = &ray.met else { continue };
            let point = DVec3::from_array(met.point);
            let Some(from) = self.point(point) else { continue };
            if self.view != SvgView::Camera {
                let n = Vec3::from_array(met.n).as_dvec3();
                if let Some(to) = self.point(point + n * (NORMAL / self.scale)) {
                    arrow(out, from, to, NORMAL_COLOR, 1.2);
                    lines.push([from, to]);
                }
            }
            let _ = writeln!(
                out,
                "<circle cx=\"{:.1}\" cy=\"{:.1}\" r=\"2.6\" fill=\"{NORMAL_COLOR}\"/>",
                from.x, from.y
            );
        }
        lines
    }

    fn draw_labels(&self, out: &mut String, labels: Vec<Label>, rays: &[[DVec2; 2]], scene: &[[DVec2; 2]]) {
        // Below the title.
        let frame = [DVec2::new(4.0, 24.0), self.size - 4.0];
        for placed in labels::place(labels, frame, rays, scene) {
            let nearest = placed.nearest();
            let label = &placed.label;
            if nearest.distance(label.anchor) > 12.0 {
                let style = format!("stroke=\"{}\" stroke-width=\"0.7\" stroke-opacity=\"0.7\"", label.color);
                let _ = writeln!(out, "{}", line(&[label.anchor, nearest], &style));
            }
            let box_size = placed.high - placed.low;
            let weight = if label.is_bold { " font-weight=\"bold\"" } else { "" };
            let _ = writeln!(
                out,
                "<rect x=\"{:.1}\" y=\"{:.1}\" width=\"{:.1}\" height=\"{:.1}\" fill=\"#ffffff\" fill-opacity=\"0.8\"/>\
                 <text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"middle\" font-size=\"{FONT}\" fill=\"{}\"{weight}>{}</text>",
                placed.low.x,
                placed.low.y,
                box_size.x,
                box_size.y,
                0.5 * (placed.low.x + placed.high.x),
                placed.high.y - 5.0,
                label.color,
                escape(&label.text)
            );
        }
    }
}

/// The corners of the image plane in the world; `None` where there is none.
fn image_plane(renderer: &Renderer, inspection: &Inspection) -> Option<[DVec3; 4]> {
    let camera = renderer.view().camera();
    let [nx, ny] = camera.size.map(f64::from);
    let corners = [[0.0, 0.0], [nx, 0.0], [nx, ny], [0.0, ny]];
    let is_flat = inspection.camera.mapping.is_none();
    is_flat.then(|| corners.map(|corner| camera.ray(corner, [0.5; 2]).p_world))
}

fn label(anchor: DVec2, text: &str, color: &'static str) -> Label {
    Label { anchor, text: text.to_owned(), color, is_bold: false }
}
