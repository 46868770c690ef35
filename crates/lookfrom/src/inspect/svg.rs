//! The rays as a drawing (SVG): views from the side, from above, from behind, and the camera's own, with one colour for
//! each kind of ray; and a lens system in section.

mod kinds;
mod labels;
mod lens;
mod marks;
mod outlines;
mod panel;
mod projection;

use std::fmt::Write;

use glam::DVec2;
use lookfrom_scene::{Error, ErrorKind, Location, Result};

use super::{Inspection, RayKind};
use crate::render::Renderer;
use lens::LensPanel;
use panel::{NORMAL_COLOR, Panel};

/// Width of a drawing of one view, and of a sheet of them, in units of the drawing.
const WIDTH: f64 = 1000.0;
const SHEET: f64 = 1400.0;

/// Space around panels.
const GAP: f64 = 12.0;

/// Height of the line above the panels.
const HEADER: f64 = 30.0;

/// The views of a drawing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SvgView {
    /// All views.
    #[default]
    Sheet,
    /// From the camera's right: forward is to the right, up is up.
    Side,
    /// From above: forward is to the right.
    Top,
    /// From behind the camera.
    Front,
    /// The scene as the camera sees it.
    Camera,
    /// The camera's lens system in section.
    Lens,
}

impl SvgView {
    /// The words for the views.
    pub const WORDS: &'static [(&'static str, Self)] = &[
        ("sheet", Self::Sheet),
        ("side", Self::Side),
        ("top", Self::Top),
        ("front", Self::Front),
        ("camera", Self::Camera),
        ("lens", Self::Lens),
    ];

    /// The word for this view.
    pub fn word(self) -> &'static str {
        Self::WORDS.iter().find(|(_, view)| *view == self).map_or("", |(word, _)| *word)
    }

    fn title(self) -> &'static str {
        match self {
            Self::Sheet => "",
            Self::Side => "side: from the camera's right",
            Self::Top => "top: from above, forward is to the right",
            Self::Front => "front: from behind the camera",
            Self::Camera => "what the camera sees",
            Self::Lens => "the lens in section",
        }
    }
}

/// Draws an inspection.
///
/// # Errors
/// `Request` for the camera's view where the camera sees all around, and for the section of a camera without a lens system.
pub fn svg(renderer: &Renderer, inspection: &Inspection, view: SvgView) -> Result<String> {
    let of = (renderer, inspection);
    let mut panels = Vec::new();
    let film_radius = renderer.view().camera().lens_system.as_ref().map(|system| system.film_radius());
    let lens_of = |width: f64| {
        let (report, film_radius) = inspection.camera.lens_system.as_ref().zip(film_radius)?;
        Some(LensPanel::new(report, film_radius, width - 2.0 * GAP))
    };
    let mut lens = None;
    let (width, height) = if view == SvgView::Lens {
        let Some(panel) = lens_of(WIDTH) else {
            let message = "this camera has no lens system to draw: choose another view";
            return Err(Error::new(ErrorKind::Request, &Location::default(), message));
        };
        let height = HEADER + panel.height() + GAP;
        lens = Some((panel, DVec2::new(GAP, HEADER)));
        (WIDTH, height)
    } else if view == SvgView::Sheet {
        let cell = DVec2::new(0.5 * (SHEET - 3.0 * GAP), 0.3 * SHEET);
        let views = [SvgView::Top, SvgView::Camera, SvgView::Side, SvgView::Front];
        for (index, view) in views.into_iter().enumerate() {
            // A camera that sees all around has no view to draw.
            let Some(panel) = Panel::new(view, of, (cell.x, Some(cell.y))) else { continue };
            let place = DVec2::new((index % 2) as f64, (index / 2) as f64);
            panels.push((panel, DVec2::new(GAP, HEADER) + place * (cell + GAP)));
        }
        let mut height = HEADER + 2.0 * (cell.y + GAP);
        if let Some(panel) = lens_of(SHEET) {
            let at = DVec2::new(GAP, height);
            height += panel.height() + GAP;
            lens = Some((panel, at));
        }
        (SHEET, height)
    } else {
        let Some(panel) = Panel::new(view, of, (WIDTH - 2.0 * GAP, None)) else {
            let message = "a camera that sees all around, or measures, has no image plane to draw rays in: choose the side, the \
                           top or the front";
            return Err(Error::new(ErrorKind::Request, &Location::default(), message));
        };
        let height = HEADER + panel.height() + GAP;
        panels.push((panel, DVec2::new(GAP, HEADER)));
        (WIDTH, height)
    };

    let mut legend = String::new();
    // A section has no ray but that of the camera.
    let rows = match view {
        SvgView::Lens => 0.0,
        _ => draw_legend(&mut legend, (width, height), inspection),
    };
    let total = height + 22.0 * rows + GAP;
    let mut out = String::new();
    let _ = writeln!(
        out,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {total:.0}\" width=\"{width}\" height=\"{total:.0}\" \
         font-family=\"DejaVu Sans, Verdana, Arial, sans-serif\" font-size=\"14\">\n\
         <rect width=\"{width}\" height=\"{total:.0}\" fill=\"#ffffff\"/>"
    );
    let [x, y] = inspection.pixel;
    let film = inspection.film.map(|c| c.to_string()).join(" ");
    let _ = writeln!(
        out,
        "<text x=\"{GAP}\" y=\"20\">pixel {x} {y}, sample {}: [{film}]</text>",
        inspection.sample
    );
    for (panel, at) in panels {
        panel.draw(&mut out, at);
    }
    if let Some((panel, at)) = lens {
        panel.draw(&mut out, at);
    }
    out.push_str(&legend);
    out.push_str("</svg>\n");
    Ok(out)
}

/// Draws the meanings of lines below the panels, in columns, and returns the number of rows.
fn draw_legend(out: &mut String, (width, top): (f64, f64), inspection: &Inspection) -> f64 {
    let first = |kind: RayKind| inspection.segments.iter().find(|segment| segment.kind == kind);
    let drawn = RayKind::ALL.into_iter().filter_map(first);
    let mut lines: Vec<(String, String)> =
        drawn.map(|segment| (kinds::stroke(segment), kinds::name(segment.kind))).collect();
    if inspection.rays.iter().any(|ray| ray.met.is_some()) {
        let stroke = format!("stroke=\"{NORMAL_COLOR}\" stroke-width=\"1.2\"");
        lines.push((stroke, "shading normal at a hit".into()));
    }
    let columns = (width / 400.0).floor();
    for (index, (stroke, name)) in lines.iter().enumerate() {
        let (row, column) = ((index as f64 / columns).floor(), index as f64 % columns);
        let (x, y) = (GAP + column * width / columns, top + 16.0 + 22.0 * row);
        let _ = writeln!(
            out,
            "<line x1=\"{x:.1}\" y1=\"{0:.1}\" x2=\"{1:.1}\" y2=\"{0:.1}\" {stroke}/><text x=\"{2:.1}\" y=\"{y:.1}\">{name}</text>",
            y - 5.0,
            x + 40.0,
            x + 48.0
        );
    }
    (lines.len() as f64 / columns).ceil()
}

/// Text in XML, which has no control characters, not even as references.
fn escape(text: &str) -> String {
    let text = text.replace(char::is_control, "\u{fffd}");
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    #[test]
    fn names_stay_text_of_xml() {
        assert_eq!(super::escape("a\u{1b}\u{1}<b>&"), "a\u{fffd}\u{fffd}&lt;b&gt;&amp;");
    }
}
