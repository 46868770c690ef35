//! Placement of shapes: transforms applied, primitives and area lights made.
//!
//! Shapes of vertices (meshes, patches, curves) become primitives of their own, see `place/vertices`; spheres, disks
//! and quadrics of all shapes are collected, one geometry per kind.

mod displacement;
mod labels;
mod solid;
mod vertices;

use std::f32::consts::PI;
use std::sync::Arc;

use glam::{DMat3, DMat4, DVec3};
use lookfrom_scene::material::{Color, MaterialKind};
use lookfrom_scene::scene::Scene;
use lookfrom_scene::shape::{Emission, Geometry, Shape, Sphere};
use lookfrom_scene::{Error, Location, Result, Warning};

use super::ShapeLabel;
use super::lights::Lights;
use crate::light::{AreaLight, DiskLight, EmissionSpectrum, Light, LightMotion, LightShape, QuadricLight};
use crate::primitive::{
    Disk, Disks, MaterialBinding, Mesh, Primitives, Quadric, QuadricKind, Quadrics, SphereBinding, Spheres,
    Torus,
};
use crate::shading::interior_stack::{InteriorStack, MediumInterface};
use crate::shading::texture::FloatTexture;
pub(super) use labels::Labels;

/// From axes with the poles on z to axes with the poles on y: a rotation.
const Y_FROM_Z: DMat3 = DMat3::from_cols(DVec3::X, DVec3::NEG_Z, DVec3::Y);

/// Primitives that share a BVH, while they are collected.
#[derive(Default)]
pub(super) struct Group {
    /// Meshes, patches and curves: one geometry per shape.
    own: Vec<Primitives>,
    spheres: Spheres,
    disks: Disks,
    /// Quadrics with capsules.
    thin_quadrics: Quadrics,
    quadrics: Quadrics,
    /// Quadrics of which solids leave parts.
    solid_surfaces: Quadrics,
}

impl Group {
    /// The primitives in the order of their geometry ids.
    pub(super) fn into_primitives(self) -> Vec<Primitives> {
        let mut primitives = self.own;
        if !self.spheres.spheres.is_empty() {
            primitives.push(Primitives::Spheres(self.spheres));
        }
        if !self.disks.disks.is_empty() {
            primitives.push(Primitives::Disks(self.disks));
        }
        for quadrics in [self.thin_quadrics, self.quadrics, self.solid_surfaces] {
            if !quadrics.quadrics.is_empty() {
                primitives.push(Primitives::Quadrics(Arc::new(quadrics)));
            }
        }
        primitives
    }
}

/// The inverse of an affine matrix. One that has none is `Invalid`.
pub(super) fn inverse(at: &Location, matrix: &DMat4) -> Result<DMat4> {
    let inverse = matrix.inverse();
    let usable = matrix.is_finite() && inverse.is_finite();
    if usable { Ok(inverse) } else { Err(not_invertible(at)) }
}

fn not_invertible(at: &Location) -> Error {
    Error::invalid(at, "the transform cannot be inverted").hint("no scale may be 0, no number infinite")
}

/// Compiles shapes to primitives and lights, one after another.
pub(super) struct Compiler<'a> {
    pub(super) scene: &'a Scene,
    pub(super) warnings: &'a mut Vec<Warning>,
    pub(super) lights: Lights<'a>,
    /// Labels by shape number.
    pub(super) shapes: Vec<ShapeLabel>,
    /// By material: whether it is anisotropic or bump-mapped, and so needs derivatives by texture coordinates.
    pub(super) grains: Vec<bool>,
    /// Whether an instance gives the object that is being placed such a material.
    pub(super) has_instance_grain: bool,
    /// Whether shapes are those of an object, in its own space.
    pub(super) is_in_object: bool,
    /// The motion of the lights that are placed.
    pub(super) light_motion: Option<LightMotion>,
    /// Alpha textures.
    pub(super) alphas: Vec<FloatTexture>,
    /// Media on the two sides of surfaces.
    pub(super) medium_interfaces: Vec<MediumInterface>,
    /// Meshes with further texture coordinates or opacities.
    pub(super) vertex_data: Vec<Arc<Mesh>>,
}

/// A shape that is being placed in a group.
#[derive(Clone, Copy)]
struct Placing<'a> {
    shape: &'a Shape,
    /// From the shape's space to the group's.
    matrix: &'a DMat4,
    binding: MaterialBinding,
}

impl Placing<'_> {
    /// Whether the transform changes handedness.
    fn mirrors(&self) -> bool {
        self.matrix.determinant() < 0.0
    }
}

impl<'a> Compiler<'a> {
    /// Before any shape; `grains` by material.
    pub(super) fn new(
        scene: &'a Scene,
        warnings: &'a mut Vec<Warning>,
        lights: Lights<'a>,
        grains: Vec<bool>,
    ) -> Self {
        Self {
            scene,
            warnings,
            lights,
            shapes: Vec::new(),
            grains,
            has_instance_grain: false,
            is_in_object: false,
            light_motion: None,
            alphas: Vec::new(),
            medium_interfaces: Vec::new(),
            vertex_data: Vec::new(),
        }
    }
}

impl Compiler<'_> {
    /// Adds a shape with its label to a group; `group_from_parent` transforms to the group's space.
    pub(super) fn place(
        &mut self,
        (shape, label): (&Shape, &ShapeLabel),
        group_from_parent: &DMat4,
        material: Option<u32>,
        group: &mut Group,
    ) -> Result<()> {
        let matrix = *group_from_parent * shape.world_from_object;
        inverse(&shape.at, &matrix)?;
        let number = self.shapes.len() as u32;
        self.shapes.push(label.clone());
        let has_opacities = match &shape.geometry {
            Geometry::Mesh(id) => !self.scene.meshes[id.index()].opacities.is_empty(),
            _ => false,
        };
        let alpha = shape.alpha.map(FloatTexture::from);
        let alpha = alpha.filter(|alpha| !self.lights.textures.is_one(*alpha, has_opacities)).map(|alpha| {
            self.alphas.push(alpha);
            self.alphas.len() as u32 - 1
        });
        let sides = shape.sides.filter(|_| self.scene.render.media);
        let medium_interface = sides.map(|sides| {
            let [inside, outside] = [sides.inside, sides.outside].map(InteriorStack::in_space);
            self.medium_interfaces.push(MediumInterface { inside, outside });
            self.medium_interfaces.len() as u32 - 1
        });
        let material = material.unwrap_or(shape.material.0);
        // The back of a solid transmissive body is visible from inside.
        let is_body = matches!(
            self.scene.materials.get(material as usize).map(|material| &material.kind),
            Some(MaterialKind::Principled(principled)) if principled.is_solid
        ) || matches!(
            self.scene.materials.get(material as usize).map(|material| &material.kind),
            Some(MaterialKind::OpenPbr(look)) if look.is_body()
        );
        let single_sided = shape.single_sided && !is_body;
        let binding = MaterialBinding {
            material,
            light: None,
            shape: number,
            alpha,
            medium_interface,
            vertex_data: None,
            single_sided,
        };
        let placing = Placing { shape, matrix: &matrix, binding };
        match &shape.geometry {
            Geometry::Sphere(sphere) => self.spheres(placing, &[*sphere], Y_FROM_Z, group),
            Geometry::Spheres(spheres) => self.spheres(placing, spheres, Y_FROM_Z, group),
            Geometry::Disk { center, normal, radius } => {
                self.disk(placing, [*center, *normal], *radius, group);
                Ok(())
            }
            Geometry::Quad { corner, edge_u, edge_v } => {
                self.mesh(placing, &vertices::quad(*corner, *edge_u, *edge_v), group)
            }
            Geometry::PartialSphere { radius, z: [z0, z1], phi_max } => {
                let whole = z0.min(*z1) <= -radius && z0.max(*z1) >= *radius && *phi_max >= 360.0;
                if whole {
                    let sphere = Sphere { center: DVec3::ZERO, radius: *radius };
                    return self.spheres(placing, &[sphere], DMat3::IDENTITY, group);
                }
                let kind = QuadricKind::Sphere { radius: *radius, z: [*z0, *z1] };
                self.quadric(placing, kind, *phi_max, group)
            }
            &Geometry::PartialDisk { height, radius, inner_radius, phi_max } => {
                self.quadric(placing, QuadricKind::Disk { height, radius, inner_radius }, phi_max, group)
            }
            &Geometry::Cylinder { radius, z, phi_max } => {
                self.quadric(placing, QuadricKind::Cylinder { radius, z }, phi_max, group)
            }
            &Geometry::Torus { radius, tube } => {
                self.quadric(placing, QuadricKind::Torus(Torus { radius, tube }), 360.0, group)
            }
            Geometry::SolidSurface { solid, body } => self.solid_surface(placing, solid, *body, group),
            Geometry::Bilinear(patches) => self.patches(placing, patches, group),
            Geometry::Curves(strands) => self.curves(placing, strands, group),
            Geometry::Mesh(id) => {
                let mesh = &self.scene.meshes[id.index()];
                let Some(amount) = mesh.displacement else { return self.mesh(placing, mesh, group) };
                let (textures, to_world) = (self.lights.textures, &shape.world_from_object);
                let mesh = displacement::displaced(mesh, amount, textures, to_world);
                self.mesh(placing, &mesh, group)
            }
        }
    }

    /// Spheres of one shape whose poles are on z after `pole`.
    fn spheres(
        &mut self,
        placing: Placing,
        spheres: &[Sphere],
        pole: DMat3,
        group: &mut Group,
    ) -> Result<()> {
        let Placing { shape, matrix, binding } = placing;
        let linear = DMat3::from_mat4(*matrix);
        let as_quadric = |compiler: &mut Self, sphere: &Sphere, group: &mut Group| {
            let own = *matrix * DMat4::from_translation(sphere.center) * DMat4::from_mat3(pole);
            let own = Placing { matrix: &own, ..placing };
            compiler.quadric(own, whole_sphere(sphere.radius), 360.0, group)
        };
        let Some(scale) = even_scale(&linear) else {
            // With a non-uniform scale they are ellipsoids.
            return spheres.iter().try_for_each(|sphere| as_quadric(self, sphere, group));
        };
        let render_from_z = orthonormal(&linear) * pole;
        let first_binding = group.spheres.bindings.len() as u32;
        let flip = shape.reverse_orientation;
        let sphere_binding = SphereBinding {
            binding,
            object_from_sphere: (Y_FROM_Z * render_from_z.transpose()).as_mat3(),
            flip,
        };
        group.spheres.bindings.push(sphere_binding);
        for sphere in spheres {
            let center = matrix.transform_point3(sphere.center);
            if !self.is_in_object && is_planet(center, sphere.radius * scale) {
                as_quadric(self, sphere, group)?;
                continue;
            }
            let center = center.as_vec3();
            let radius = (sphere.radius * scale) as f32;
            let light = self.area_light(placing, |two_sided| {
                let kind = whole_sphere(f64::from(radius));
                let own = DMat4::from_translation(center.as_dvec3()) * DMat4::from_mat3(render_from_z);
                let quadric = Quadric::new(kind, 360.0, &own, flip)?;
                Some(LightShape::Quadric(Box::new(QuadricLight::new(quadric, two_sided)?)))
            });
            let mut own_binding = first_binding;
            if light.is_some() {
                own_binding = group.spheres.bindings.len() as u32;
                group
                    .spheres
                    .bindings
                    .push(SphereBinding { binding: MaterialBinding { light, ..binding }, ..sphere_binding });
            }
            group.spheres.spheres.push(lookfrom_bvh::Sphere { center: center.to_array(), radius });
            group.spheres.binding_of.push(own_binding);
        }
        Ok(())
    }

    fn disk(&mut self, placing: Placing, [center, normal]: [DVec3; 2], radius: f64, group: &mut Group) {
        let Placing { shape, matrix, binding } = placing;
        let (axis_u, axis_v) = normal.normalize().any_orthonormal_pair();
        let disk = Disk {
            center: matrix.transform_point3(center),
            axis_u: matrix.transform_vector3(radius * axis_u),
            axis_v: matrix.transform_vector3(radius * axis_v),
            flip: placing.mirrors() != shape.reverse_orientation,
        };
        let light = self.area_light(placing, |_| Some(LightShape::Disk(Box::new(DiskLight::new(disk)?))));
        group.disks.disks.push(disk);
        group.disks.bindings.push(MaterialBinding { light, ..binding });
    }

    fn quadric(
        &mut self,
        placing: Placing,
        kind: QuadricKind,
        phi_max: f64,
        group: &mut Group,
    ) -> Result<()> {
        let Placing { shape, matrix, binding } = placing;
        let quadric = Quadric::new(kind, phi_max, matrix, shape.reverse_orientation)
            .ok_or_else(|| not_invertible(&shape.at))?;
        let light = self.area_light(placing, |two_sided| {
            QuadricLight::new(quadric, two_sided).map(|light| LightShape::Quadric(Box::new(light)))
        });
        let quadrics = match quadric.capsule() {
            Some(_) => &mut group.thin_quadrics,
            None => &mut group.quadrics,
        };
        quadrics.quadrics.push(quadric);
        quadrics.bindings.push(MaterialBinding { light, ..binding });
        Ok(())
    }

    /// The area light of a shape that emits light, of its geometry, given whether both sides do.
    fn area_light(
        &mut self,
        placing: Placing,
        shape_of_light: impl FnOnce(bool) -> Option<LightShape>,
    ) -> Option<u32> {
        let Placing { shape, binding, .. } = placing;
        let Emission { radiance, power, two_sided } = shape.emission?;
        if radiance == Color::BLACK {
            return None;
        }
        let shape_of_light = shape_of_light(two_sided)?;
        let coat = match self.scene.materials.get(binding.material as usize).map(|material| &material.kind) {
            Some(MaterialKind::Principled(principled)) => Some(FloatTexture::from(principled.clearcoat)),
            _ => None,
        };
        // power of a white radiance of 1
        let sides = if two_sided { 2.0 } else { 1.0 };
        let of_white = sides * PI * shape_of_light.area() as f32;
        let written = self.lights.scale(radiance, &power, of_white);
        let light = AreaLight {
            radiance: EmissionSpectrum { color: self.lights.illuminant(radiance), scale: written.value() },
            written,
            alpha: shape.alpha.map(FloatTexture::from),
            two_sided,
            coat: coat.filter(|amount| !amount.is(0.0)),
            shape: shape_of_light,
            origin: self.lights.origin,
            motion: self.light_motion.clone(),
        };
        let brightness = match light.mean_of_pattern() {
            Some(mean) => light.radiance.scale * mean,
            None => self.lights.brightness_of(&light.radiance),
        };
        let label = self.shapes[binding.shape as usize].to_string();
        Some(self.lights.push(Light::Area(light), brightness, label))
    }

    /// The index that the next light will have.
    fn next_light(&self) -> u32 {
        self.lights.lights.len() as u32
    }

    /// Whether a shape needs derivatives by texture coordinates.
    fn has_grain(&self, placing: Placing) -> bool {
        let of_shape = self.grains.get(placing.binding.material as usize).copied();
        self.has_instance_grain || of_shape.unwrap_or(false)
    }
}

/// Whether the surface of a sphere in render space is so near to the eye, by its radius, that the rounding of its centre and radius to
/// single precision would be seen. Quadrics are in double precision.
fn is_planet(center: DVec3, radius: f64) -> bool {
    const RADII_PER_DISTANCE: f64 = 4096.0;
    radius > RADII_PER_DISTANCE * (center.length() - radius).abs() && radius.is_finite()
}

fn whole_sphere(radius: f64) -> QuadricKind {
    QuadricKind::Sphere { radius, z: [-radius, radius] }
}

/// The scale of a matrix that is a rotation or reflection with a uniform scale (up to rounding).
fn even_scale(linear: &DMat3) -> Option<f64> {
    let scale = linear.x_axis.length();
    let product = linear.transpose() * *linear * (1.0 / (scale * scale));
    let error = product - DMat3::IDENTITY;
    let largest = [error.x_axis, error.y_axis, error.z_axis].map(|column| column.abs().max_element());
    (largest.into_iter().all(|e| e < 1e-9)).then_some(scale)
}

/// The rotation (or reflection) of a matrix with a uniform scale, orthonormalised.
fn orthonormal(linear: &DMat3) -> DMat3 {
    let x = linear.x_axis.normalize();
    let y = (linear.y_axis - linear.y_axis.dot(x) * x).normalize();
    let z = x.cross(y);
    DMat3::from_cols(x, y, if linear.determinant() < 0.0 { -z } else { z })
}
