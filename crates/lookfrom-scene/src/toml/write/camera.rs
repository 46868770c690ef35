//! The camera, its lens and its motion.

use std::fmt::Write;

use glam::DVec3;

use super::Writer;
use super::names::spoken;
use super::picture::For;
use super::placing::{put_matrix, put_motion};
use super::text::Fields;
use crate::camera::{Camera, Lens, Projection, Target, View, Window};
use crate::error::Result;
use crate::lens::{ApertureShape, LensConvention, LensSurface, LensSystem};
use crate::toml::camera::CONVENTIONS;
use crate::toml::word_of;

impl Writer<'_> {
    pub(super) fn camera(&mut self, camera: &Camera) -> Result<Fields> {
        let Camera { at: _, view, target, projection, lens, window, distance, clip, medium, shutter, motion } =
            camera;
        let mut fields = Fields::default();
        match *view {
            _ if projection.is_measurement() && *view == Camera::default().view => {}
            View::Look { lookfrom, lookat, up } => {
                fields.put("lookfrom", lookfrom);
                fields.put("lookat", lookat);
                fields.put_unless("up", up, DVec3::Y);
            }
            View::Matrix(matrix) => {
                put_matrix(&mut fields, "matrix", &matrix);
                if let Some(Target { lookat, up }) = *target {
                    fields.put("lookat", lookat);
                    fields.put_unless("up", up, DVec3::Y);
                }
            }
        }
        self.projection(&mut fields, projection)?;
        if let Some(Lens { radius, focus_distance }) = lens.filter(|lens| lens.radius > 0.0) {
            fields.put("aperture", radius);
            fields.put("focus_distance", focus_distance);
        }
        if let Some(Window { x, y }) = *window {
            let mut sides = Fields::one("x", x);
            sides.put("y", y);
            fields.put("window", sides);
        }
        fields.put_unless("distance", *distance, 1.0);
        if let Some(clip) = *clip {
            fields.put("clip", clip);
        }
        if let Some(medium) = medium {
            fields.put("medium", self.media.of(medium.index()));
        }
        fields.put_unless("shutter", *shutter, 0.0);
        put_motion(&mut fields, motion.as_deref());
        Ok(fields)
    }

    fn projection(&mut self, fields: &mut Fields, projection: &Projection) -> Result<()> {
        match projection {
            Projection::Perspective { fov } => fields.put("fov", *fov),
            Projection::Orthographic { height } => {
                fields.put("projection", "orthographic");
                fields.put("height", *height);
            }
            Projection::Equirectangular => fields.put("projection", "equirectangular"),
            Projection::EquirectangularPbrt => fields.put("projection", "equirectangular_pbrt"),
            Projection::Octahedral => fields.put("projection", "octahedral"),
            Projection::LensSystem(system) => self.lens_system(fields, system)?,
            Projection::Irradiance { surface } => {
                fields.put("projection", "irradiance");
                fields.put("surface", spoken("shape", surface));
            }
        }
        Ok(())
    }

    fn lens_system(&mut self, fields: &mut Fields, system: &LensSystem) -> Result<()> {
        let LensSystem {
            name,
            surfaces,
            stop_diameter,
            shape,
            focus_distance,
            film_diagonal,
            millimetre,
            convention,
        } = system;
        let mut table = "# radius of curvature, thickness, index of refraction, diameter: mm\n".to_owned();
        for LensSurface { curvature_radius, thickness, index, diameter } in surfaces {
            // Writing to a string cannot fail.
            let _ = writeln!(table, "{curvature_radius:?} {thickness:?} {index:?} {diameter:?}");
        }
        let file = self.file(name, "dat", table.into_bytes());
        fields.put("lens", file);
        fields.put("focus_distance", *focus_distance);
        fields.put_unless("film", *film_diagonal, 35.0);
        if let Some(diameter) = stop_diameter {
            fields.put("stop", *diameter);
        }
        match shape {
            ApertureShape::Circle => {}
            ApertureShape::Gaussian
            | ApertureShape::Square
            | ApertureShape::Pentagon
            | ApertureShape::Star => {
                fields.put("aperture_shape", shape.name());
            }
            ApertureShape::Image(image) => {
                let picture = self.picture_of(image, For::Light)?;
                fields.put("aperture_shape", picture.file);
            }
        }
        fields.put_unless("millimetre", *millimetre, 1e-3);
        if *convention != LensConvention::AsPinhole {
            fields.put("lens_convention", word_of(CONVENTIONS, convention));
        }
        Ok(())
    }
}
