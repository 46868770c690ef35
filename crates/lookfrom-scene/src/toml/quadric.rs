//! Quadrics: full and partial spheres, disks and cylinders; and the sphereflake.

use std::sync::Arc;

use glam::{DMat4, DVec3};

use super::Reader;
use super::mesh::too_many;
use super::table::Table;
use super::value::Value;
use crate::composite;
use crate::error::Result;
use crate::shape::{Geometry, Sphere};

/// Maximum depth of a sphereflake: 5.4 million spheres.
pub(super) const DEEPEST_FLAKE: u64 = 7;

impl Reader<'_, '_> {
    pub(super) fn sphereflake(&mut self, table: &Table<'_>) -> Result<Geometry> {
        let Sphere { center, radius } = sphere(table);
        let depth = table.or("depth", 4, |value| value.integer(0, DEEPEST_FLAKE)) as u32;
        table.sound(&["center", "radius", "depth"])?;
        // All sphereflakes together: a few lines of text must not exhaust the memory.
        self.flake_spheres = self.flake_spheres.saturating_add(composite::sphereflake_count(depth));
        if self.flake_spheres > self.context.limits.elements {
            return Err(too_many(table, self.flake_spheres, self.context.limits.elements));
        }
        let memory = composite::sphereflake_count(depth) * 2 * size_of::<Sphere>() as u64;
        self.context.keep(memory, "the sphereflake", &table.at())?;
        let spheres = composite::sphereflake(center, radius, depth);
        if spheres.iter().all(|sphere| sphere.radius.is_normal() && sphere.center.is_finite()) {
            return Ok(Geometry::Spheres(Arc::from(spheres)));
        }
        Err(table
            .error("its spheres are too small or too far away to compute with")
            .hint("use moderate numbers"))
    }
}

fn sphere(table: &Table<'_>) -> Sphere {
    Sphere {
        center: table.or("center", DVec3::ZERO, Value::vector),
        radius: table.or("radius", 1.0, Value::positive),
    }
}

/// A full or partial sphere, and the transform from its own space.
pub(super) fn sphere_or_part(table: &Table<'_>) -> Result<(Geometry, DMat4)> {
    let Sphere { center, radius } = sphere(table);
    if !["z_min", "z_max", "phi_max"].iter().any(|key| table.has(key)) {
        return Ok((Geometry::Sphere(Sphere { center, radius }), DMat4::IDENTITY));
    }
    let phi_max = phi_max(table);
    table.sound(&["radius"])?;
    let expected = "a number from -radius to radius";
    let cut = |key, default| {
        table.or(key, default, |value| value.number_where(expected, |z| (-radius..=radius).contains(&z)))
    };
    let z = [cut("z_min", -radius), cut("z_max", radius)];
    table.sound(&["z_min", "z_max"])?;
    if z[0] >= z[1] {
        return Err(table
            .error(format!("nothing is left between z_min = {} and z_max = {}", z[0], z[1]))
            .hint("`z_min` has to be less than `z_max`; both are relative to `center`"));
    }
    let part = Geometry::PartialSphere { radius, z, phi_max };
    Ok((part, DMat4::from_translation(center)))
}

/// A disk, possibly with a hole or partial, and the transform from its own space.
pub(super) fn disk(table: &Table<'_>) -> Result<(Geometry, DMat4)> {
    let center = table.need("center", "[0, 0, 0]", DVec3::ZERO, Value::vector);
    let normal = table.need("normal", "[0, 1, 0]", DVec3::Y, Value::direction);
    let radius = table.need("radius", "1", 1.0, Value::positive);
    let phi_max = phi_max(table);
    table.sound(&["radius"])?;
    if !["inner_radius", "phi_max", "height"].iter().any(|key| table.has(key)) {
        return Ok((Geometry::Disk { center, normal, radius }, DMat4::IDENTITY));
    }
    let inner_radius = table.or("inner_radius", 0.0, |value| {
        value.number_where("a number of at least 0 and less than `radius`", |inner| {
            (0.0..radius).contains(&inner)
        })
    });
    let height = table.or("height", 0.0, Value::number);
    let part = Geometry::PartialDisk { height, radius, inner_radius, phi_max };
    Ok((part, around(center, normal)))
}

/// A cylinder between two points, and the transform from its own space.
pub(super) fn cylinder(table: &Table<'_>) -> Result<(Geometry, DMat4)> {
    let radius = table.need("radius", "0.5", 1.0, Value::positive);
    let phi_max = phi_max(table);
    if table.has("z") {
        for key in ["from", "to"] {
            table.one_of(&["z", key]);
        }
        let z = table.or("z", [0.0, 1.0], |value| {
            let expected = "two numbers, from the lower to the higher";
            let z: [f64; 2] = value.numbers(expected)?;
            if z[0] < z[1] { Ok(z) } else { Err(value.wrong(expected)) }
        });
        return Ok((Geometry::Cylinder { radius, z, phi_max }, DMat4::IDENTITY));
    }
    let from = table.need("from", "[0, 0, 0]", DVec3::ZERO, Value::vector);
    let to = table.need("to", "[0, 1, 0]", DVec3::Y, Value::vector);
    table.sound(&["from", "to"])?;
    let axis = to - from;
    let length = axis.length();
    if !length.is_normal() {
        return Err(table
            .error_at("to", "`to` is the same point as `from`, or too near or too far away")
            .hint("give the centres of both ends of the cylinder"));
    }
    Ok((Geometry::Cylinder { radius, z: [0.0, length], phi_max }, along(from, axis / length)))
}

fn phi_max(table: &Table<'_>) -> f64 {
    table.or("phi_max", 360.0, |value| {
        value.number_where("degrees, more than 0 and at most 360", |phi| phi > 0.0 && phi <= 360.0)
    })
}

/// The space whose origin is `center` and whose z axis goes along `axis`, of any length; exactly its own where they are those.
pub(super) fn around(center: DVec3, axis: DVec3) -> DMat4 {
    let is_own = center == DVec3::ZERO && axis == DVec3::Z;
    if is_own { DMat4::IDENTITY } else { along(center, axis.normalize()) }
}

/// The transform from a space with its origin at a point and z along a unit vector.
pub(super) fn along(origin: DVec3, z: DVec3) -> DMat4 {
    let (x, y) = composite::tangents(z);
    DMat4::from_cols(x.extend(0.0), y.extend(0.0), z.extend(0.0), origin.extend(1.0))
}
