//! Validation of meshes and of shapes, in the world and in objects.

use glam::DVec3;

use super::Part;
use crate::error::{Location, Result};
use crate::scene::Scene;
use crate::shape::{Emission, Geometry, Mesh, Patches, Profile, Shape, Sphere, Strand};
use crate::solid::{self, Body, Form};

pub(super) fn check(scene: &Scene) -> Result<()> {
    let nowhere = Location::default();
    for (index, mesh) in scene.meshes.iter().enumerate() {
        check_mesh(&Part::new(scene, &nowhere, "mesh").numbered(index, Some(&mesh.name)), mesh)?;
    }
    check_shapes(scene, "", &scene.shapes)?;
    for (index, shape) in scene.shapes.iter().enumerate() {
        if let Geometry::Mesh(id) = shape.geometry
            && scene.meshes.get(id.index()).is_some_and(|mesh| !mesh.later.is_empty())
        {
            let part = Part::new(scene, &shape.at, "shape").numbered(index, shape.name.as_deref());
            return Err(part.fault("its mesh changes its form, but it is in no object"));
        }
    }
    for (index, object) in scene.objects.iter().enumerate() {
        check_shapes(scene, &format!("object {index} {:?}: ", object.name), &object.shapes)?;
    }
    Ok(())
}

fn check_shapes(scene: &Scene, prefix: &str, shapes: &[Shape]) -> Result<()> {
    let kind = format!("{prefix}shape");
    for (index, shape) in shapes.iter().enumerate() {
        check_shape(&Part::new(scene, &shape.at, &kind).numbered(index, shape.name.as_deref()), shape)?;
    }
    Ok(())
}

fn check_shape(part: &Part<'_>, shape: &Shape) -> Result<()> {
    part.material(shape.material)?;
    if let Some(alpha) = shape.alpha {
        part.scalar("alpha", alpha)?;
    }
    if let Some(sides) = shape.sides {
        part.medium(sides.inside)?;
        part.medium(sides.outside)?;
    }
    if let Some(Emission { radiance, power, .. }) = shape.emission {
        part.color("radiance", radiance)?;
        part.power(&power)?;
    }
    part.matrix("world_from_object", &shape.world_from_object)?;
    if shape.emission.is_some() && matches!(shape.geometry, Geometry::SolidSurface { .. }) {
        return Err(part.fault("the surface of a solid emits no light; expected a mesh"));
    }
    check_geometry(part, &shape.geometry)
}

fn check_geometry(part: &Part<'_>, geometry: &Geometry) -> Result<()> {
    let vector = |name: &str, v: &DVec3| part.finite(name, &v.to_array());
    match geometry {
        Geometry::Sphere(sphere) => check_spheres(part, std::slice::from_ref(sphere)),
        Geometry::Spheres(spheres) => check_spheres(part, spheres),
        Geometry::Quad { corner, edge_u, edge_v } => {
            vector("corner", corner)?;
            vector("edge_u", edge_u)?;
            vector("edge_v", edge_v)
        }
        Geometry::Disk { center, normal, radius } => {
            vector("center", center)?;
            vector("normal", normal)?;
            part.number(
                "length of normal",
                normal.length(),
                "more than 0",
                normal.try_normalize().is_some(),
            )?;
            part.positive("radius", *radius)
        }
        Geometry::Mesh(mesh) => part.id("mesh", mesh.index(), part.scene.meshes.len()),
        Geometry::PartialSphere { radius, z, phi_max } | Geometry::Cylinder { radius, z, phi_max } => {
            part.positive("radius", *radius)?;
            part.finite("z", z)?;
            check_sweep(part, *phi_max)
        }
        Geometry::PartialDisk { height, radius, inner_radius, phi_max } => {
            part.finite("height", &[*height])?;
            part.positive("radius", *radius)?;
            part.at_least_zero("inner_radius", *inner_radius)?;
            check_sweep(part, *phi_max)
        }
        Geometry::Torus { radius, tube } => {
            part.positive("radius", *radius)?;
            part.positive("tube", *tube)
        }
        Geometry::SolidSurface { solid, body } => {
            if !solid.is_sound() {
                let most = solid::MOST_BODIES;
                return Err(
                    part.fault(format!("its solid does not combine at most {most} bodies, each once"))
                );
            }
            let count = solid.bodies().len();
            if *body as usize >= count {
                return Err(part.fault(format!("there is no body {body}; the solid has {count}, from 0")));
            }
            solid.bodies().iter().try_for_each(|body| check_body(part, body))
        }
        Geometry::Bilinear(patches) => check_patches(part, patches),
        Geometry::Curves(strands) => check_strands(part, strands),
    }
}

fn check_body(part: &Part<'_>, body: &Body) -> Result<()> {
    part.matrix("solid_from_body", body.solid_from_body())?;
    match *body.form() {
        Form::Ball { center, radius } => {
            part.finite("center", &center.to_array())?;
            part.positive("radius", radius)
        }
        Form::Cylinder { radius, z } => {
            part.positive("radius", radius)?;
            part.number("z", z[1], "more than the minimum", z[0] < z[1])?;
            part.finite("z", &z)
        }
        Form::Cuboid { min, max } => {
            part.finite("min", &min.to_array())?;
            part.finite("max", &max.to_array())?;
            part.number("max", max.max_element(), "beyond `min` along every axis", min.cmplt(max).all())
        }
        Form::Torus { radius, tube } => {
            part.positive("radius", radius)?;
            part.positive("tube", tube)
        }
    }
}

fn check_sweep(part: &Part<'_>, phi_max: f64) -> Result<()> {
    part.number("phi_max", phi_max, "degrees above 0 and up to 360", phi_max > 0.0 && phi_max <= 360.0)
}

fn check_spheres(part: &Part<'_>, spheres: &[Sphere]) -> Result<()> {
    let is_valid =
        |Sphere { center, radius }: &Sphere| center.is_finite() && *radius > 0.0 && radius.is_finite();
    part.all("spheres", spheres, "a sphere with a finite centre and a positive radius", is_valid)
}

fn check_strands(part: &Part<'_>, strands: &[Strand]) -> Result<()> {
    let is_valid = |strand: &Strand| {
        strand.points.iter().all(|point| point.is_finite())
            && strand.width.iter().all(|width| *width > 0.0 && width.is_finite())
            && match strand.profile {
                Profile::Ribbon(normals) => normals.iter().all(|normal| normal.is_finite()),
                Profile::Flat | Profile::Cylinder | Profile::PbrtCylinder => true,
            }
    };
    part.all("curves", strands, "a curve of finite points with positive widths", is_valid)
}

fn check_patches(part: &Part<'_>, patches: &Patches) -> Result<()> {
    let vertices = patches.positions.len();
    part.all("positions", &patches.positions, "finite", |position| position.is_finite())?;
    let is_valid = |patch: &[u32; 4]| patch.iter().all(|vertex| (*vertex as usize) < vertices);
    part.all("patches", &patches.patches, &format!("of the {vertices} vertices"), is_valid)?;
    part.none_or_as_many("normals", patches.normals.len(), vertices)?;
    part.none_or_as_many("uvs", patches.uvs.len(), vertices)?;
    part.all("normals", &patches.normals, "finite", |normal| normal.is_finite())?;
    part.all("uvs", &patches.uvs, "finite", |uv| uv.is_finite())
}

fn check_mesh(part: &Part<'_>, mesh: &Mesh) -> Result<()> {
    if !mesh.later.is_empty() && !mesh.later.len().is_power_of_two() {
        return Err(part.fault(format!("it has {} later times; expected a power of two", mesh.later.len())));
    }
    for pose in &mesh.later {
        part.as_many("later positions", pose.positions.len(), "positions", mesh.positions.len())?;
        part.as_many("later normals", pose.normals.len(), "normals", mesh.normals.len())?;
        part.all("later positions", &pose.positions, "finite", |position| position.is_finite())?;
        part.all("later normals", &pose.normals, "finite", |normal| normal.is_finite())?;
    }
    if let Some(displacement) = mesh.displacement {
        part.scalar("displacement", displacement)?;
    }
    let vertices = mesh.positions.len();
    part.all("positions", &mesh.positions, "finite", |position| position.is_finite())?;
    let is_valid = |triangle: &[u32; 3]| triangle.iter().all(|vertex| (*vertex as usize) < vertices);
    part.all("triangles", &mesh.triangles, &format!("of the {vertices} vertices"), is_valid)?;
    let attributes = [
        ("normals", mesh.normals.len()),
        ("uvs", mesh.uvs.len()),
        ("colors", mesh.colors.len()),
        ("opacities", mesh.opacities.len()),
        ("tangents", mesh.tangents.len()),
    ];
    attributes.into_iter().try_for_each(|(name, count)| part.none_or_as_many(name, count, vertices))?;
    part.all("normals", &mesh.normals, "finite", |normal| normal.is_finite())?;
    part.all("colors", mesh.colors.as_flattened(), "finite", |color| color.is_finite())?;
    part.all("opacities", &mesh.opacities, "finite", |opacity| opacity.is_finite())?;
    part.all("tangents", &mesh.tangents, "finite", |tangent| tangent.is_finite())?;
    for uvs in &mesh.more_uvs {
        part.as_many("more_uvs", uvs.len(), "vertices", vertices)?;
    }
    let mut sets = std::iter::once(&mesh.uvs).chain(&mesh.more_uvs);
    sets.try_for_each(|uvs| part.all("uvs", uvs, "finite", |uv| uv.is_finite()))
}
