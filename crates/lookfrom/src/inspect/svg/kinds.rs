//! The kinds of rays in a drawing: their colours, dashes and names.

use crate::inspect::{RayKind, RaySegment};

/// The colour of a kind.
pub(super) fn color(kind: RayKind) -> &'static str {
    match kind {
        RayKind::Camera => "#2458c5",
        RayKind::Reflected | RayKind::Scattered => "#1a7f45",
        RayKind::Refracted | RayKind::Transmitted => "#c2410c",
        RayKind::StraightOn => "#8a4fbf",
        RayKind::Shadow => "#b88a00",
        RayKind::Blocked => "#000000",
    }
}

/// Attributes of a line.
pub(super) fn stroke(RaySegment { kind, width, .. }: &RaySegment) -> String {
    let dashes = if kind.is_shadow() { " stroke-dasharray=\"6 4\"" } else { "" };
    format!("stroke=\"{}\" stroke-width=\"{width:.1}\"{dashes}", color(*kind))
}

/// The name of a kind in the legend.
pub(super) fn name(kind: RayKind) -> String {
    match kind {
        RayKind::StraightOn => "ray that passed a surface (interface or alpha)".into(),
        RayKind::Shadow => "shadow ray, up to its light or what blocks it".into(),
        RayKind::Blocked => "shadow ray behind what blocks it".into(),
        kind => format!("{kind} ray"),
    }
}
