//! Shapes that version 4 does not have: surfaces of revolution, and heights over a square, as meshes.

use std::f64::consts::TAU;

use glam::{DVec3, Vec2};

use crate::error::Result;
use crate::pbrt::Reader;
use crate::pbrt::params::{ParameterType, Parameters};
use crate::shape::{Geometry, Mesh};

/// Pieces around the axis of a surface of revolution, and along it.
const AROUND: usize = 128;
const ALONG: usize = 32;

impl Reader<'_, '_> {
    /// A shape that version 4 does not have; `None` for one without a surface.
    ///
    /// # Errors
    /// Those of its parameters.
    pub(in crate::pbrt) fn old_shape(&mut self, kind: &str, p: &Parameters) -> Result<Option<Geometry>> {
        let phi_max = f64::from(
            p.float_where("phimax", 360.0, "an angle in (0, 360]", |phi| phi > 0.0 && phi <= 360.0)?,
        );
        let phi_max = phi_max / 360.0 * TAU;
        let mesh = match kind {
            "cone" => {
                let (radius, height) =
                    (f64::from(p.positive("radius", 1.0)?), f64::from(p.float("height", 1.0)?));
                revolved(phi_max, |v| DVec3::new(radius * (1.0 - v), 0.0, height * v))
            }
            "paraboloid" => {
                let radius = f64::from(p.positive("radius", 1.0)?);
                let [a, b] = [f64::from(p.float("zmin", 0.0)?), f64::from(p.float("zmax", 1.0)?)];
                let (low, high) = (a.min(b), a.max(b));
                if !(high > 0.0) {
                    return Err(p.refuse("zmax", "a number greater than 0"));
                }
                revolved(phi_max, |v| {
                    let z = low + (high - low) * v;
                    DVec3::new(radius * (z / high).max(0.0).sqrt(), 0.0, z)
                })
            }
            "hyperboloid" => {
                let p1 = p.vector("p1", ParameterType::Point3, DVec3::ZERO)?;
                let p2 = p.vector("p2", ParameterType::Point3, DVec3::ONE)?;
                revolved(phi_max, |v| p1.lerp(p2, v))
            }
            "heightfield" => heightfield(p)?,
            _ => {
                self.leave_out(&p.place, "shapes of the type \"nurbs\" are left out");
                p.ignore(&[
                    "nu", "nv", "uorder", "vorder", "uknots", "vknots", "u0", "v0", "u1", "v1", "P", "Pw",
                ]);
                return Ok(None);
            }
        };
        Ok(self.push_mesh(mesh))
    }
}

/// A curve from v = 0 to 1, turned about the z axis.
fn revolved(phi_max: f64, curve: impl Fn(f64) -> DVec3) -> Mesh {
    let mut mesh = Mesh { name: "revolution".into(), ..Mesh::default() };
    let step = 1e-5;
    for j in 0..=ALONG {
        let v = j as f64 / ALONG as f64;
        let point = curve(v);
        let along = curve((v + step).min(1.0)) - curve((v - step).max(0.0));
        // On the axis the curve is turned about what is beside it.
        let beside =
            if point.truncate().length() > 0.0 { point } else { curve((v - step).clamp(0.5 * step, 1.0)) };
        let around = DVec3::Z.cross(beside);
        let normal = around.cross(along).try_normalize().unwrap_or(DVec3::Z);
        for i in 0..=AROUND {
            let u = i as f64 / AROUND as f64;
            let (sin, cos) = (libm::sin(phi_max * u), libm::cos(phi_max * u));
            let turned = |a: DVec3| DVec3::new(cos * a.x - sin * a.y, sin * a.x + cos * a.y, a.z).as_vec3();
            mesh.positions.push(turned(point));
            mesh.normals.push(turned(normal));
            mesh.uvs.push(Vec2::new(u as f32, v as f32));
        }
    }
    mesh.triangles = grid([AROUND + 1, ALONG + 1]);
    mesh
}

/// Heights `Pz` over the unit square.
fn heightfield(p: &Parameters) -> Result<Mesh> {
    let mut size = [0_usize; 2];
    for (name, size) in ["nu", "nv"].into_iter().zip(&mut size) {
        *size = p.integer(name, 0, 2, 1 << 15)?.unsigned_abs() as usize;
    }
    let heights = p.floats("Pz", ParameterType::Float)?.unwrap_or_default();
    if heights.len() != size[0] * size[1] {
        return Err(p.refuse("Pz", &format!("{} · {} numbers, found {}", size[0], size[1], heights.len())));
    }
    let place = |index: usize| {
        let at = |axis: usize, index: usize| index as f32 / (size[axis] - 1) as f32;
        Vec2::new(at(0, index % size[0]), at(1, index / size[0]))
    };
    let uvs: Vec<Vec2> = (0..heights.len()).map(place).collect();
    let positions = uvs.iter().zip(heights).map(|(uv, z)| uv.extend(*z)).collect();
    Ok(Mesh { name: "heightfield".into(), positions, uvs, triangles: grid(size), ..Mesh::default() })
}

/// The triangles between the points of a grid, row by row.
fn grid([columns, rows]: [usize; 2]) -> Vec<[u32; 3]> {
    let corner = |column: usize, row: usize| (row * columns + column) as u32;
    let cell = |column: usize, row: usize| {
        let [a, b, c, d] = [[0, 0], [1, 0], [1, 1], [0, 1]].map(|[i, j]| corner(column + i, row + j));
        [[a, b, c], [a, c, d]]
    };
    (0..rows - 1).flat_map(|row| (0..columns - 1).flat_map(move |column| cell(column, row))).collect()
}
