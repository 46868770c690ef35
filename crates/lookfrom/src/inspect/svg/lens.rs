//! A lens system in section, with the ray: in the plane of the axis and the point of the film, which the ray is projected onto.

use std::fmt::Write;

use glam::DVec2;

use super::marks::{head, line};
use super::{SvgView, kinds};
use crate::inspect::{LensSurfaceReport, LensSystemReport, RayKind};

/// Points of an arc.
const POINTS: usize = 24;

/// A section in the drawing.
pub(super) struct LensPanel<'a> {
    report: &'a LensSystemReport,
    /// Half the film's diagonal.
    film_radius: f64,
    low: DVec2,
    size: DVec2,
    scale: f64,
}

impl<'a> LensPanel<'a> {
    /// The section of a lens system and its film, of a given width.
    pub(super) fn new(report: &'a LensSystemReport, film_radius: f64, width: f64) -> Self {
        let front = report.surfaces.iter().map(|surface| surface.vertex).fold(0.0, f64::max);
        let widest =
            report.surfaces.iter().map(|surface| surface.aperture_radius).fold(film_radius, f64::max);
        let (low, high) = (DVec2::new(-0.06 * front, -1.2 * widest), DVec2::new(1.4 * front, 1.2 * widest));
        let span = high - low;
        let size = DVec2::new(width, width * (span.y / span.x).clamp(0.2, 0.6));
        Self { report, film_radius, low: 0.5 * (low + high), size, scale: (size / span).min_element() }
    }

    pub(super) fn height(&self) -> f64 {
        self.size.y
    }

    /// A point of the panel from one of the section: along the axis and above it.
    fn place(&self, along: f64, above: f64) -> DVec2 {
        let from_middle = (DVec2::new(along, above) - self.low) * self.scale;
        0.5 * self.size + DVec2::new(from_middle.x, -from_middle.y)
    }

    /// Draws the section at a place of the drawing.
    pub(super) fn draw(&self, out: &mut String, at: DVec2) {
        let _ = writeln!(
            out,
            "<clipPath id=\"lens\"><rect width=\"{:.1}\" height=\"{:.1}\"/></clipPath>\n\
             <g transform=\"translate({:.1} {:.1})\"><g clip-path=\"url(#lens)\">",
            self.size.x, self.size.y, at.x, at.y
        );
        let axis = [DVec2::new(0.0, self.place(0.0, 0.0).y), DVec2::new(self.size.x, self.place(0.0, 0.0).y)];
        let _ = writeln!(out, "{}", line(&axis, "stroke=\"#9a9a9a\" stroke-dasharray=\"8 4\""));
        let film = [self.place(0.0, -self.film_radius), self.place(0.0, self.film_radius)];
        let _ = writeln!(out, "{}", line(&film, "stroke=\"#333333\" stroke-width=\"4\""));
        let _ = writeln!(
            out,
            "<text x=\"{:.1}\" y=\"{:.1}\" font-size=\"12\" fill=\"#555555\">film</text>",
            film[0].x + 6.0,
            film[0].y
        );
        self.draw_elements(out);
        self.draw_ray(out);
        let report = self.report;
        let _ = writeln!(
            out,
            "</g>\n<rect width=\"{:.1}\" height=\"{:.1}\" fill=\"none\" stroke=\"#b0b0b0\"/>\n\
             <text x=\"8\" y=\"18\" fill=\"#555555\">{}: focal length {:.4}, working f/{:.2}{}</text>\n</g>",
            self.size.x,
            self.size.y,
            SvgView::Lens.title(),
            report.focal_length,
            report.f_number,
            if report.passes { "" } else { "; the ray is blocked" }
        );
    }

    /// Draws glass between its surfaces, surfaces, and the stop.
    fn draw_elements(&self, out: &mut String) {
        let mut index = 1.0;
        for (place, surface) in self.report.surfaces.iter().enumerate() {
            let Some(ratio) = surface.index_ratio else {
                let open = surface.aperture_radius;
                for side in [-1.0, 1.0] {
                    let blade = [open, open + 0.35 * self.film_radius]
                        .map(|above| self.place(surface.vertex, side * above));
                    let _ = writeln!(out, "{}", line(&blade, "stroke=\"#333333\" stroke-width=\"3\""));
                }
                continue;
            };
            index *= ratio;
            let mut points = self.arc(surface);
            let next = self.report.surfaces.get(place + 1).filter(|next| next.index_ratio.is_some());
            let is_glass = index > 1.0 + 1e-9;
            if let Some(next) = next.filter(|_| is_glass) {
                points.extend(self.arc(next).into_iter().rev());
            }
            let words: Vec<String> = points.iter().map(|p| format!("{:.1},{:.1}", p.x, p.y)).collect();
            let (tag, fill) = match next.is_some() && is_glass {
                true => ("polygon", "#cfe3f2"),
                false => ("polyline", "none"),
            };
            let _ = writeln!(
                out,
                "<{tag} points=\"{}\" fill=\"{fill}\" fill-opacity=\"0.7\" stroke=\"#4a6b85\" stroke-width=\"1\"/>",
                words.join(" ")
            );
        }
    }

    /// The points of a surface from below to above.
    fn arc(&self, surface: &LensSurfaceReport) -> Vec<DVec2> {
        let curvature = surface.curvature_radius.map_or(0.0, |radius| 1.0 / radius);
        let height = surface.aperture_radius.min(1.0 / curvature.abs());
        let point = |place: usize| {
            let above = height * (2.0 * place as f64 / (POINTS - 1) as f64 - 1.0);
            let square = curvature * above * above;
            let sag = -square / (1.0 + (1.0 - curvature * square).max(0.0).sqrt());
            self.place(surface.vertex + sag, above)
        };
        (0..POINTS).map(point).collect()
    }

    /// Draws the ray up to the surface that blocks it, or out of the front.
    fn draw_ray(&self, out: &mut String) {
        let report = self.report;
        let [x, y, _] = report.film;
        let distance = x.hypot(y);
        let up = if distance > 0.0 { [x / distance, y / distance] } else { [0.0, 1.0] };
        let section = |[x, y, z]: [f64; 3]| DVec2::new(z, x * up[0] + y * up[1]);
        let reached = 1 + report.surfaces.iter().take_while(|surface| surface.passes).count();
        let met = report.surfaces.iter().take(reached).filter_map(|surface| surface.point);
        let mut points: Vec<DVec2> = std::iter::once(report.film).chain(met).map(section).collect();
        let leaving = report.surfaces.last().filter(|_| report.passes).and_then(|front| front.direction);
        if let (Some(direction), Some(&last)) = (leaving, points.last()) {
            let way = section(direction);
            points.push(last + way * (0.3 * last.x / way.length().max(1e-9)));
        }
        let color = kinds::color(RayKind::Camera);
        let placed: Vec<DVec2> = points.iter().map(|point| self.place(point.x, point.y)).collect();
        let words: Vec<String> = placed.iter().map(|p| format!("{:.1},{:.1}", p.x, p.y)).collect();
        let _ = writeln!(
            out,
            "<polyline points=\"{}\" fill=\"none\" stroke=\"{color}\" stroke-width=\"2\"/>",
            words.join(" ")
        );
        let Some(&[before, last]) = placed.last_chunk() else { return };
        if report.passes {
            head(out, last, last - before, color);
        } else {
            for side in [-1.0, 1.0] {
                let arm = DVec2::new(6.0, 6.0 * side);
                let _ = writeln!(
                    out,
                    "{}",
                    line(&[last - arm, last + arm], "stroke=\"#b91c1c\" stroke-width=\"2.5\"")
                );
            }
        }
    }
}
