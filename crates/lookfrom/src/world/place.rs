//! From a written shape to the forms and lights of a world: its transform is applied, its place in the arrays chosen.

use glam::{DMat3, DMat4, DVec3, Vec3};
use lookfrom_scene::material::Color;
use lookfrom_scene::scene::Scene;
use lookfrom_scene::shape::{Emission, Geometry, Mesh as WrittenMesh, Shape, Sphere};
use lookfrom_scene::{Error, ErrorKind, Location, Result, Warning};

use super::Instance;
use super::lights::Lights;
use crate::distribution::Discrete;
use crate::light::{AreaLight, Light, LightForm};
use crate::math;
use crate::shape::{Disk, Disks, Form, Look, Mesh, Spheres};

/// Forms that share a tree, while they are gathered.
#[derive(Default)]
pub(super) struct Group {
    meshes: Vec<Form>,
    spheres: Spheres,
    disks: Disks,
    /// Unevenly scaled spheres: instances of the one unit sphere, which is the last object.
    pub(super) ellipsoids: Vec<Instance>,
    /// Repetitions of the scene's objects.
    pub(super) instances: Vec<Instance>,
}

impl Group {
    /// The forms in the order of their geometry ids.
    pub(super) fn into_forms(self) -> Vec<Form> {
        let mut forms = self.meshes;
        if !self.spheres.spheres.is_empty() {
            forms.push(Form::Spheres(self.spheres));
        }
        if !self.disks.disks.is_empty() {
            forms.push(Form::Disks(self.disks));
        }
        forms
    }
}

impl Instance {
    /// A repetition of an object. A matrix that cannot be inverted is `Invalid`.
    pub(super) fn new(
        at: &Location,
        object: u32,
        matrix: DMat4,
        material: Option<u32>,
        look: Option<Look>,
    ) -> Result<Self> {
        let object_from_render = inverse(at, &matrix)?;
        Ok(Self { object, render_from_object: matrix, object_from_render, material, look })
    }
}

/// The inverse of an affine matrix.
fn inverse(at: &Location, matrix: &DMat4) -> Result<DMat4> {
    let inverse = matrix.inverse();
    if matrix.is_finite() && inverse.is_finite() {
        Ok(inverse)
    } else {
        Err(Error::invalid(at, "the transform cannot be inverted")
            .hint("no scale may be 0, no number infinite"))
    }
}

/// Turns shapes into forms and lights, one after another.
pub(super) struct Compiler<'a> {
    pub(super) scene: &'a Scene,
    pub(super) warnings: &'a mut Vec<Warning>,
    pub(super) lights: Lights,
    /// Names by shape number.
    pub(super) shapes: Vec<String>,
}

impl Compiler<'_> {
    /// Adds a shape to a group whose space `group_from_parent` leads to.
    pub(super) fn place(
        &mut self,
        shape: &Shape,
        group_from_parent: &DMat4,
        material: Option<u32>,
        group: &mut Group,
    ) -> Result<()> {
        let matrix = *group_from_parent * shape.world_from_object;
        inverse(&shape.at, &matrix)?;
        let number = self.shapes.len() as u32;
        self.shapes.push(self.name_of(shape));
        let look = Look { material: material.unwrap_or(shape.material.0), light: None, shape: number };
        match &shape.geometry {
            Geometry::Sphere(sphere) => self.spheres(shape, &[*sphere], &matrix, look, group)?,
            Geometry::Spheres(spheres) => self.spheres(shape, spheres, &matrix, look, group)?,
            Geometry::Disk { center, normal, radius } => {
                let (axis_u, axis_v) = normal.normalize().any_orthonormal_pair();
                let disk = Disk {
                    center: matrix.transform_point3(*center),
                    axis_u: matrix.transform_vector3(*radius * axis_u),
                    // a mirror turns the normal over; the outside stays the outside
                    axis_v: matrix.transform_vector3(*radius * axis_v) * matrix.determinant().signum(),
                };
                let light = self.shine(shape, || Some(LightForm::Disk(disk)));
                group.disks.disks.push(disk);
                group.disks.looks.push(Look { light, ..look });
            }
            Geometry::Quad { corner, edge_u, edge_v } => {
                let mesh = quad(*corner, *edge_u, *edge_v);
                self.mesh(shape, &mesh, &matrix, look, group)?;
            }
            Geometry::PartialSphere { .. }
            | Geometry::PartialDisk { .. }
            | Geometry::Cylinder { .. }
            | Geometry::Bilinear(_)
            | Geometry::Curves(_) => self.warn(&shape.at, "this shape is not rendered yet"),
            Geometry::Mesh(id) => self.mesh(shape, &self.scene.meshes[id.index()], &matrix, look, group)?,
        }
        Ok(())
    }

    fn name_of(&self, shape: &Shape) -> String {
        let kind = match &shape.geometry {
            Geometry::Sphere(_) => "sphere",
            Geometry::Spheres(_) => "spheres",
            Geometry::Quad { .. } => "quad",
            Geometry::Disk { .. } => "disk",
            Geometry::PartialSphere { .. } => "partial sphere",
            Geometry::PartialDisk { .. } => "partial disk",
            Geometry::Cylinder { .. } => "cylinder",
            Geometry::Bilinear(_) => "bilinear patches",
            Geometry::Curves(_) => "curves",
            Geometry::Mesh(id) => &self.scene.meshes[id.index()].name,
        };
        shape.name.clone().unwrap_or_else(|| format!("{kind} ({})", shape.at))
    }

    fn spheres(
        &mut self,
        shape: &Shape,
        spheres: &[Sphere],
        matrix: &DMat4,
        look: Look,
        group: &mut Group,
    ) -> Result<()> {
        let linear = DMat3::from_mat4(*matrix);
        let Some(scale) = even_scale(&linear) else {
            if shape.emission.is_some() {
                self.warn(&shape.at, "an unevenly scaled sphere cannot shine; its emission is left out");
            }
            let unit_sphere_object = self.scene.objects.len() as u32;
            for sphere in spheres {
                let own =
                    DMat4::from_translation(sphere.center) * DMat4::from_scale(DVec3::splat(sphere.radius));
                let instance = Instance::new(&shape.at, unit_sphere_object, *matrix * own, None, Some(look))?;
                group.ellipsoids.push(instance);
            }
            return Ok(());
        };
        let object_from_render = (linear * (1.0 / scale)).transpose().as_mat3();
        let first_look = group.spheres.looks.len() as u32;
        group.spheres.looks.push((look, object_from_render));
        for sphere in spheres {
            let center = matrix.transform_point3(sphere.center).as_vec3();
            let radius = (sphere.radius * scale) as f32;
            let placed = lookfrom_bvh::Sphere { center: center.to_array(), radius };
            let light = self.shine(shape, || Some(LightForm::Sphere { sphere: placed, object_from_render }));
            let mut own_look = first_look;
            if light.is_some() {
                own_look = group.spheres.looks.len() as u32;
                group.spheres.looks.push((Look { light, ..look }, object_from_render));
            }
            group.spheres.spheres.push(placed);
            group.spheres.look_of.push(own_look);
        }
        Ok(())
    }

    fn mesh(
        &mut self,
        shape: &Shape,
        mesh: &WrittenMesh,
        matrix: &DMat4,
        look: Look,
        group: &mut Group,
    ) -> Result<()> {
        if u32::try_from(mesh.positions.len().max(mesh.triangles.len())).is_err() {
            return Err(Error::new(
                ErrorKind::Limit,
                &shape.at,
                "more than 2³² vertices or triangles in one mesh",
            ));
        }
        let inverse = inverse(&shape.at, matrix)?;
        let normal = |n: &Vec3| math::transform_normal(&inverse, n.as_dvec3()).normalize_or_zero().as_vec3();
        let mut placed = Mesh {
            positions: mesh
                .positions
                .iter()
                .map(|p| matrix.transform_point3(p.as_dvec3()).as_vec3().to_array())
                .collect(),
            triangles: mesh.triangles.clone(),
            normals: mesh.normals.iter().map(normal).collect(),
            uvs: mesh.uvs.clone(),
            colors: mesh.colors.clone(),
            flip: matrix.determinant() < 0.0,
            look,
        };
        placed.look.light = self.shine(shape, || triangles_that_shine(&placed));
        group.meshes.push(Form::Mesh(Box::new(placed)));
        Ok(())
    }

    /// The light of a shape that shines, made from its form.
    fn shine(&mut self, shape: &Shape, form: impl FnOnce() -> Option<LightForm>) -> Option<u32> {
        let Emission { radiance, two_sided, .. } = shape.emission?;
        if radiance == Color::BLACK {
            return None;
        }
        let form = form()?;
        Some(self.lights.push(Light::Area(AreaLight { radiance, two_sided, form }), self.name_of(shape)))
    }

    fn warn(&mut self, at: &Location, message: &str) {
        self.warnings.push(Warning { at: at.clone(), message: message.to_owned() });
    }
}

/// The scale of a matrix that only turns, mirrors and scales evenly (to within rounding).
fn even_scale(linear: &DMat3) -> Option<f64> {
    let scale = linear.x_axis.length();
    let product = linear.transpose() * *linear * (1.0 / (scale * scale));
    let error = product - DMat3::IDENTITY;
    let largest = [error.x_axis, error.y_axis, error.z_axis].map(|column| column.abs().max_element());
    (largest.into_iter().all(|e| e < 1e-9)).then_some(scale)
}

fn quad(corner: DVec3, edge_u: DVec3, edge_v: DVec3) -> WrittenMesh {
    let corners = [corner, corner + edge_u, corner + edge_u + edge_v, corner + edge_v];
    WrittenMesh {
        name: "quad".into(),
        positions: corners.map(DVec3::as_vec3).to_vec(),
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        uvs: [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(Into::into).to_vec(),
        ..WrittenMesh::default()
    }
}

/// The triangles of a mesh by area, wound so that the outside is counter-clockwise; `None` for a mesh without area.
fn triangles_that_shine(mesh: &Mesh) -> Option<LightForm> {
    let corner =
        |index: usize, k: usize| (Vec3::from_array(mesh.corners(index)[k]), mesh.corner_uvs(index)[k]);
    let mut triangles = Vec::new();
    let mut areas = Vec::new();
    for index in 0..mesh.triangles.len() {
        let order = if mesh.flip { [0, 2, 1] } else { [0, 1, 2] };
        let triangle = order.map(|k| corner(index, k));
        let [p0, p1, p2] = triangle.map(|(p, _)| p.as_dvec3());
        let area = 0.5 * (p1 - p0).cross(p2 - p0).length();
        if area > 0.0 && area.is_finite() {
            triangles.push(triangle);
            areas.push(area as f32);
        }
    }
    let area = areas.iter().map(|&area| f64::from(area)).sum();
    (area > 0.0).then(|| LightForm::Triangles { triangles, choice: Discrete::new(&areas), area })
}
