//! A lens system as text: the way of the ray from the film through each surface.

use std::fmt::{self, Write};

use super::{short, vector};
use crate::inspect::LensSystemReport;

pub(super) fn write_lens_system(f: &mut String, report: &LensSystemReport) -> fmt::Result {
    writeln!(f, "Through the lens system {:?}, from the film to the scene", report.name)?;
    let [focal_length, f_number, focus] =
        [report.focal_length, report.f_number, report.focus_distance].map(short);
    writeln!(f, "  focal length {focal_length}, working f/{f_number}, focused at {focus} from the film")?;
    writeln!(f, "  in lens space: x to the viewer's right, y up, z to the scene, the film in z = 0")?;
    writeln!(f, "  film       point {}   direction {}", vector(&report.film), vector(&report.direction))?;
    let mut is_reached = true;
    for (place, surface) in report.surfaces.iter().enumerate() {
        let kind = match (surface.curvature_radius, surface.index_ratio) {
            (Some(radius), Some(ratio)) => format!("radius {}, index ratio {}", short(radius), short(ratio)),
            (None, Some(ratio)) => format!("flat, index ratio {}", short(ratio)),
            (_, None) => "the aperture stop".to_owned(),
        };
        let aperture = short(surface.aperture_radius);
        writeln!(
            f,
            "  surface {place:>2} at z = {}: {kind}, aperture radius {aperture}",
            short(surface.vertex)
        )?;
        if !is_reached {
            continue;
        }
        let point = surface.point.map_or("misses it".to_owned(), |point| format!("point {}", vector(&point)));
        match surface.direction {
            Some(direction) => writeln!(f, "             {point}   direction {}", vector(&direction))?,
            None => writeln!(f, "             {point}   blocked here")?,
        }
        is_reached = surface.passes;
    }
    writeln!(
        f,
        "  weight {}: cos⁴ θ at the film · area of the pupil's bounds / (z of surface 0)² · exposure",
        short(f64::from(report.weight))
    )
}
