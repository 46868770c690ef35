//! Report on a lens system: the way of a sample's ray from the film through each surface.

use lookfrom_scene::camera::Projection;

use super::report::{LensSurfaceReport, LensSystemReport};
use crate::render::{Renderer, SampleId};

/// The way of a sample's ray with the factor of its light, if the camera has a lens system.
pub(super) fn report(renderer: &Renderer, id: SampleId, weight: f32) -> Option<LensSystemReport> {
    let camera = renderer.view().camera();
    let (Some(system), Projection::LensSystem(written)) = (&camera.lens_system, &camera.projection) else {
        return None;
    };
    let crossings = renderer.crossings(id)?;
    let (start, crossings) = crossings.split_first()?;
    let finite = |v: [f64; 3]| v.iter().all(|x| x.is_finite()).then_some(v);
    let surfaces = system.sections().enumerate().map(|(place, section)| {
        let crossing = crossings.get(place);
        LensSurfaceReport {
            vertex: section.vertex,
            curvature_radius: (section.curvature != 0.0).then(|| 1.0 / section.curvature),
            aperture_radius: section.radius,
            index_ratio: section.index_ratio,
            point: crossing.and_then(|crossing| finite(crossing.point)),
            direction: crossing
                .filter(|crossing| crossing.passes)
                .and_then(|crossing| finite(crossing.direction)),
            passes: crossing.is_some_and(|crossing| crossing.passes),
        }
    });
    Some(LensSystemReport {
        name: written.name.clone(),
        focal_length: system.focal_length(),
        f_number: system.f_number(),
        focus_distance: written.focus_distance,
        film: start.point,
        direction: start.direction,
        surfaces: surfaces.collect(),
        passes: weight != 0.0,
        weight,
    })
}
