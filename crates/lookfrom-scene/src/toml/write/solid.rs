//! Solids: the shapes that are surfaces of one are written as one table.

use std::sync::Arc;

use glam::DMat4;

use super::Writer;
use super::placing::{put_transform, same_bits};
use super::shape::put_name;
use super::text::{Fields, Item};
use crate::error::Result;
use crate::shape::{Geometry, Shape, Sphere};
use crate::solid::{Combination, Form, Operation, Solid};
use crate::toml::solid::OPERATIONS;
use crate::toml::word_of;

/// Whether a shape and the next one are surfaces of one solid, in the order of its bodies.
pub(super) fn is_continued(shape: &Shape, next: &Shape) -> bool {
    let (Geometry::SolidSurface { solid, body }, Geometry::SolidSurface { solid: other, body: later }) =
        (&shape.geometry, &next.geometry)
    else {
        return false;
    };
    Arc::ptr_eq(solid, other)
        && body < later
        && same_bits(&shape.world_from_object, &next.world_from_object)
        && (shape.sides, shape.reverse_orientation, shape.single_sided)
            == (next.sides, next.reverse_orientation, next.single_sided)
}

impl Writer<'_> {
    /// Puts the operation and the operands of a solid with these surfaces.
    pub(super) fn put_solid(&mut self, fields: &mut Fields, solid: &Solid, surfaces: &[Shape]) -> Result<()> {
        match solid.combination() {
            Combination::Combined(operation, operands) => {
                self.put_combined(fields, *operation, operands, (solid, surfaces))
            }
            one @ Combination::Body(_) => {
                self.put_combined(fields, Operation::Union, std::slice::from_ref(one), (solid, surfaces))
            }
        }
    }

    fn put_combined(
        &mut self,
        fields: &mut Fields,
        operation: Operation,
        operands: &[Combination],
        of: (&Solid, &[Shape]),
    ) -> Result<()> {
        fields.put("operation", word_of(OPERATIONS, &operation));
        let mut items = Vec::new();
        for operand in operands {
            let mut item = Fields::default();
            match operand {
                Combination::Body(number) => self.put_body(&mut item, *number, of)?,
                Combination::Combined(operation, operands) => {
                    item.put("type", "solid");
                    self.put_combined(&mut item, *operation, operands, of)?;
                }
            }
            items.push(Item::Table(item));
        }
        fields.put("of", Item::List(items));
        Ok(())
    }

    fn put_body(
        &mut self,
        fields: &mut Fields,
        number: u32,
        (solid, surfaces): (&Solid, &[Shape]),
    ) -> Result<()> {
        let body = &solid.bodies()[number as usize];
        let matrix = body.solid_from_body();
        let mut own = Fields::default();
        let (kind, is_placed) = match *body.form() {
            Form::Ball { center, radius } => {
                self.geometry(&mut own, &Geometry::Sphere(Sphere { center, radius }), matrix)?
            }
            Form::Cylinder { radius, z } => {
                self.geometry(&mut own, &Geometry::Cylinder { radius, z, phi_max: 360.0 }, matrix)?
            }
            Form::Cuboid { min, max } => {
                own.put("min", min);
                own.put("max", max);
                ("box", false)
            }
            Form::Torus { radius, tube } => {
                self.geometry(&mut own, &Geometry::Torus { radius, tube }, matrix)?
            }
        };
        fields.put("type", kind);
        fields.0.append(&mut own.0);
        let is_its_own =
            |shape: &&Shape| matches!(shape.geometry, Geometry::SolidSurface { body, .. } if body == number);
        match surfaces.iter().find(is_its_own) {
            Some(surface) => {
                put_name(fields, surface);
                self.put_look(fields, surface)?;
            }
            // Without its shape, its surface is not there.
            None => fields.put("alpha", 0.0),
        }
        put_transform(fields, if is_placed { &DMat4::IDENTITY } else { matrix });
        Ok(())
    }
}
