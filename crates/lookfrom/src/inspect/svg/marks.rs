//! Marks of a drawing: lines and arrows.

use std::fmt::Write;

use glam::DVec2;

/// A line with attributes.
pub(super) fn line([a, b]: &[DVec2; 2], style: &str) -> String {
    format!("<line x1=\"{:.1}\" y1=\"{:.1}\" x2=\"{:.1}\" y2=\"{:.1}\" {style}/>", a.x, a.y, b.x, b.y)
}

/// A line with a head, unless it is too short for one.
pub(super) fn arrow(out: &mut String, from: DVec2, to: DVec2, color: &str, width: f64) {
    let _ = writeln!(out, "{}", line(&[from, to], &format!("stroke=\"{color}\" stroke-width=\"{width}\"")));
    if from.distance(to) > 5.0 {
        head(out, to, to - from, color);
    }
}

/// The head of an arrow.
pub(super) fn head(out: &mut String, tip: DVec2, direction: DVec2, color: &str) {
    let along = direction.normalize_or_zero();
    let back = tip - 10.0 * along;
    let [a, b] = [4.0, -4.0].map(|side| back + side * along.perp());
    let _ = writeln!(
        out,
        "<polygon points=\"{:.1},{:.1} {:.1},{:.1} {:.1},{:.1}\" fill=\"{color}\"/>",
        tip.x, tip.y, a.x, a.y, b.x, b.y
    );
}
