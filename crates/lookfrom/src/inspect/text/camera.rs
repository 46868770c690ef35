//! The camera as text: from the pixel to the world, each matrix, each product, each point; and the wavelengths.

use std::fmt::{self, Write};

use glam::DVec3;

use super::lens_system::write_lens_system;
use super::{short, vector, vector32};
use crate::inspect::{Inspection, SphereMapping};

impl Inspection {
    pub(super) fn write_camera(&self, f: &mut String) -> fmt::Result {
        let camera = &self.camera;
        if let Some(time) = self.time {
            writeln!(f, "At {time} of the time that the shutter is open: what moves is where it is then\n")?;
        }
        let has_moved = camera.steps.last().is_some_and(|step| step.name == "M");
        let (motion, then) = if has_moved { ("M · ", ", when the shutter opened") } else { ("", "") };
        match &camera.mapping {
            None if camera.lens_system.is_some() => writeln!(
                f,
                "From the pixel to the world: P_world = {motion}T4 · R3 · S2 · T1 · P_k, of a pinhole at the middle of the film that sees \
                 the plane of focus as large"
            )?,
            None => writeln!(f, "From the pixel to the world: P_world = {motion}T4 · R3 · S2 · T1 · P_k")?,
            Some(_) => writeln!(f, "From the pixel to the world: a direction, {}", camera.projection)?,
        }
        writeln!(f, "  P_k      = {}", vector(&camera.p_k))?;
        if let Some(SphereMapping { does, uv, formula, numbers, direction_in_view }) = &camera.mapping {
            writeln!(f, "  (u, v)   = P_k / size = {}: {does}", vector(uv))?;
            let numbers = numbers.iter().map(|(name, number)| format!("{name} = {}", short(*number)));
            writeln!(f, "  {}", numbers.collect::<Vec<_>>().join("   "))?;
            writeln!(f, "  {formula}")?;
            writeln!(f, "  in view space, along u, v, w: {}", vector(direction_in_view))?;
        }
        for step in &camera.steps {
            let has_product = step.name != "T1" && camera.mapping.is_none();
            let product = if has_product {
                format!(" (right: the product up to {})", step.name)
            } else {
                String::new()
            };
            writeln!(f, "  {}: {}{product}", step.name, step.does)?;
            for (matrix, product) in step.matrix.iter().zip(&step.product) {
                let row = |row: &[f64; 4]| row.map(|x| format!("{:>11}", short(x))).join(" ");
                match has_product {
                    true => writeln!(f, "    [{} ]   [{} ]", row(matrix), row(product))?,
                    false => writeln!(f, "    [{} ]", row(matrix))?,
                }
            }
            writeln!(f, "    point  = {}", vector(&step.point))?;
        }
        writeln!(f, "  M_vw = T4 · R3, from view to world{then}")?;
        for row in camera.world_from_view {
            writeln!(f, "    [{} ]", row.map(|x| format!("{:>11}", short(x))).join(" "))?;
        }
        writeln!(f, "  lookfrom = {}", vector(&camera.lookfrom))?;
        let [u, v, w] = [camera.u, camera.v, camera.w].map(DVec3::from_array);
        let mirrored = if w.cross(u).dot(v) < 0.0 { "   (mirrored: u = w × up, v = u × w)" } else { "" };
        writeln!(
            f,
            "  u (left) = {}   v (up) = {}   w (forward) = {}{mirrored}",
            vector(&camera.u),
            vector(&camera.v),
            vector(&camera.w)
        )?;
        let moved = if camera.lens { "   (a point of the lens)" } else { "" };
        writeln!(f, "  a        = {}{moved}", vector(&camera.a))?;
        let on_plane = if camera.lens_system.is_some() || camera.mapping.is_some() {
            "at a distance of 1 along the ray"
        } else if camera.lens {
            "where the ray from the lens crosses the image plane"
        } else {
            "P_world"
        };
        writeln!(f, "  b        = {}   ({on_plane})", vector(&camera.b))?;
        let plane = match (&camera.mapping, &camera.lens_system) {
            (None, None) => "; t = 1 is the image plane",
            _ => "",
        };
        writeln!(f, "  b − a    = {}   p(t) = a + t (b − a){plane}", vector(&camera.direction))?;
        camera.lens_system.as_ref().map_or(Ok(()), |report| write_lens_system(f, report))
    }

    /// Writes the wavelengths of the lanes, in spectral mode.
    pub(super) fn write_wavelengths(&self, f: &mut String) -> fmt::Result {
        let Some(wavelengths) = &self.wavelengths else { return Ok(()) };
        writeln!(f, "Light has four wavelengths; numbers in [brackets] are one for each, in this order")?;
        writeln!(f, "  λ   = {} nm", vector32(&wavelengths.lambda))?;
        writeln!(
            f,
            "  pdf = {} per nm: the density with which each was sampled; the sensor divides by it",
            vector32(&wavelengths.pdf)
        )?;
        if wavelengths.dispersed {
            writeln!(
                f,
                "  Dispersion: each wavelength is refracted differently, so the path follows only the first; the others no\n  \
                 longer count (pdf 0), and the first counts four times (its pdf is divided by four)."
            )?;
        }
        writeln!(f)
    }
}
