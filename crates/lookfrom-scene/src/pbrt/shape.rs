//! The `Shape` directive.

use glam::DMat4;

use super::params::Parameters;
use super::{Reader, transform};
use crate::error::Result;
use crate::material::Scalar;
use crate::motion::Motion;
use crate::remedy::Remedy;
use crate::scene::{Object, ObjectId};
use crate::shape::{Geometry, Shape};
use crate::warning::Warning;

const KINDS: &[&str] =
    &["bilinearmesh", "curve", "cylinder", "disk", "loopsubdiv", "plymesh", "sphere", "trianglemesh"];

impl Reader<'_, '_> {
    pub(super) fn shape(&mut self, kind: &str, p: &Parameters) -> Result<()> {
        let geometry = match kind {
            "trianglemesh" => self.triangle_mesh(p)?,
            "plymesh" => Some(self.ply_mesh(p)?),
            "sphere" => Some(sphere(p)?),
            "disk" => Some(disk(p)?),
            "cylinder" => Some(cylinder(p)?),
            "bilinearmesh" => self.bilinear_mesh(p)?,
            "loopsubdiv" => self.loop_subdivision(p)?,
            "curve" => Some(self.curve_shape(p)?),
            "cone" | "paraboloid" | "hyperboloid" | "heightfield" | "nurbs" if self.is_old() => {
                self.old_shape(kind, p)?
            }
            _ => return Err(Self::unknown(&p.place, "shape", kind, KINDS.iter().copied())),
        };
        let alpha = self.scalar_or_none(p, "alpha")?.filter(|&alpha| alpha != Scalar::Value(1.0));
        let Some(geometry) = geometry else { return Ok(()) };
        let matrices @ [matrix, end] = self.state.matrices();
        if !matrices.iter().all(transform::is_invertible) {
            self.context.warn(&p.place.location(), "left out: its transform flattens it to nothing");
            return Ok(());
        }
        let mut emission = self.state.emission;
        if emission.is_some() && self.object.is_some() && !self.context.import.instanced_lights {
            if self.warned.insert("light in object".to_owned()) {
                let message = "area lights in objects do not emit light, as in pbrt";
                let warning = Warning::new(&p.place.location(), message).remedy(Remedy::InstancedLights);
                self.context.warnings.push(warning);
            }
            emission = None;
        }
        let sides = self.sides(&p.place)?;
        let shape = Shape {
            emission,
            alpha,
            sides,
            reverse_orientation: self.state.reverse_orientation,
            world_from_object: matrix,
            ..Shape::new(p.place.location(), geometry, self.state.material)
        };
        self.context.keep(shape.bytes(), "the shape", &shape.at)?;
        match matrix == end {
            true => self.push_shape(shape),
            false => self.push_moving_shape(shape, matrices),
        }
        Ok(())
    }

    /// Adds a shape that moves: as an object of its own with an instance.
    fn push_moving_shape(&mut self, shape: Shape, matrices: [DMat4; 2]) {
        let object = ObjectId(self.scene.objects.len() as u32);
        let at = shape.at.clone();
        let shapes = vec![Shape { world_from_object: DMat4::IDENTITY, ..shape }];
        self.scene.objects.push(Object {
            name: format!("moving shape {}", object.0 + 1),
            at: at.clone(),
            shapes,
        });
        let Some(outer) = self.object else { return self.push_instance(at, object, matrices) };
        // Placed with the instances of the object that it is in.
        let [start, end] = matrices;
        let motion = Motion::between(&start, &end, self.shutter_fractions());
        let motion = motion.unwrap_or_else(|| Motion::standing(start));
        self.moving.entry(outer).or_default().push((object, motion));
    }

    /// Adds a shape to the world, or to the open object.
    fn push_shape(&mut self, shape: Shape) {
        match self.object {
            Some(object) => self.scene.objects[object.index()].shapes.push(shape),
            None => self.scene.shapes.push(shape),
        }
    }
}

/// The sweep angle in degrees.
fn phi_max(p: &Parameters) -> Result<f64> {
    p.float_where("phimax", 360.0, "an angle in (0, 360]", |phi| phi > 0.0 && phi <= 360.0).map(f64::from)
}

fn sphere(p: &Parameters) -> Result<Geometry> {
    let radius = p.positive("radius", 1.0)?;
    let (low, high) = (p.float("zmin", -radius)?, p.float("zmax", radius)?);
    let z = [low.min(high), low.max(high)].map(|z| f64::from(z.clamp(-radius, radius)));
    if z[0] >= z[1] {
        return Err(p.refuse("zmin", "a part of the sphere between \"zmin\" and \"zmax\""));
    }
    Ok(Geometry::PartialSphere { radius: radius.into(), z, phi_max: phi_max(p)? })
}

fn disk(p: &Parameters) -> Result<Geometry> {
    let radius = p.positive("radius", 1.0)?;
    let inside = |inner: f32| inner >= 0.0 && inner < radius;
    let inner_radius = p.float_where("innerradius", 0.0, "at least 0 and less than \"radius\"", inside)?;
    Ok(Geometry::PartialDisk {
        height: p.float("height", 0.0)?.into(),
        radius: radius.into(),
        inner_radius: inner_radius.into(),
        phi_max: phi_max(p)?,
    })
}

fn cylinder(p: &Parameters) -> Result<Geometry> {
    let radius = p.positive("radius", 1.0)?;
    let (low, high) = (p.float("zmin", -1.0)?, p.float("zmax", 1.0)?);
    if low == high {
        return Err(p.refuse("zmin", "another number than \"zmax\""));
    }
    let z = [low.min(high).into(), low.max(high).into()];
    Ok(Geometry::Cylinder { radius: radius.into(), z, phi_max: phi_max(p)? })
}
