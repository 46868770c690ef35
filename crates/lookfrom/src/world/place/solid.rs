//! Surfaces of solids: quadrics, of which a solid leaves a part.

use std::sync::Arc;

use glam::{DMat4, DVec3, DVec4};
use lookfrom_scene::Result;
use lookfrom_scene::solid::{Form, Solid};

use super::{Compiler, Group, Placing, Y_FROM_Z, not_invertible, whole_sphere};
use crate::primitive::{Clip, Quadric, QuadricKind, Torus};

/// A piece of a body's surface: its kind, the map from its object space to that of the body, and whether it faces inward.
type SurfacePiece = (QuadricKind, DMat4, bool);

impl Compiler<'_> {
    /// Places the part of a body's surface that is left.
    pub(super) fn solid_surface(
        &self,
        placing: Placing<'_>,
        solid: &Arc<Solid>,
        number: u32,
        group: &mut Group,
    ) -> Result<()> {
        let Placing { shape, matrix, binding } = placing;
        let body = &solid.bodies()[number as usize];
        let (constraints, is_turned) = solid.constraints(number);
        let bounds = solid.bounds_of_surface(number, matrix);
        let error =
            64.0 * f64::EPSILON * (bounds.min.abs().max(bounds.max.abs()) + matrix.w_axis.truncate().abs());
        let bounds = [bounds.min - error, bounds.max + error];
        for (kind, body_from_object, faces_inward) in pieces(body.form()) {
            let solid_from_object = *body.solid_from_body() * body_from_object;
            let reverse = (shape.reverse_orientation != is_turned) != faces_inward;
            let quadric = Quadric::new(kind, 360.0, &(*matrix * solid_from_object), reverse)
                .ok_or_else(|| not_invertible(&shape.at))?;
            let [min, max] = quadric.bounds();
            if min.max(bounds[0]).cmpgt(max.min(bounds[1])).any() {
                // Nothing of it can be left.
                continue;
            }
            let surfaces = &mut group.solid_surfaces;
            surfaces.quadrics.push(quadric);
            surfaces.bindings.push(binding);
            surfaces.clips.push(Clip::new(solid.clone(), constraints.clone(), &solid_from_object, bounds));
        }
        Ok(())
    }
}

/// The surface of a body.
fn pieces(form: &Form) -> Vec<SurfacePiece> {
    match *form {
        Form::Ball { center, radius } => {
            let upright = DMat4::from_translation(center) * DMat4::from_mat3(Y_FROM_Z);
            vec![(whole_sphere(radius), upright, false)]
        }
        Form::Cylinder { radius, z } => {
            let end = |height| QuadricKind::Disk { height, radius, inner_radius: 0.0 };
            let side = QuadricKind::Cylinder { radius, z };
            [(side, false), (end(z[0]), true), (end(z[1]), false)]
                .map(|(kind, faces_inward)| (kind, DMat4::IDENTITY, faces_inward))
                .to_vec()
        }
        Form::Cuboid { min, max } => {
            let sides = (0..3).flat_map(|axis| [(axis, min), (axis, max)]);
            sides.map(|(axis, side)| face([min, max], axis, side[axis])).collect()
        }
        Form::Torus { radius, tube } => {
            vec![(QuadricKind::Torus(Torus { radius, tube }), DMat4::IDENTITY, false)]
        }
    }
}

/// A side of a box, perpendicular to an axis.
fn face([min, max]: [DVec3; 2], axis: usize, height: f64) -> SurfacePiece {
    // x × y points along the axis; on the lower side they are swapped.
    let is_lower = height == min[axis];
    let (mut x, mut y) = ((axis + 1) % 3, (axis + 2) % 3);
    if is_lower {
        (x, y) = (y, x);
    }
    let mut corner = min;
    corner[axis] = height;
    let normal = if is_lower { -DVec4::AXES[axis] } else { DVec4::AXES[axis] };
    let body_from_object = DMat4::from_cols(DVec4::AXES[x], DVec4::AXES[y], normal, corner.extend(1.0));
    (QuadricKind::Rectangle { size: [max[x] - min[x], max[y] - min[y]] }, body_from_object, false)
}
