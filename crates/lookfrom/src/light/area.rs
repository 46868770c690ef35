//! Shapes that shine: a point of one is chosen by area, or by the cone in which a sphere is seen.

use std::f32::consts::PI;

use glam::{DVec3, Mat3, Vec2, Vec3};
use lookfrom_bvh::Point;
use lookfrom_scene::material::Color;

use super::{LightSample, Target, toward};
use crate::distribution::Discrete;
use crate::shape::Disk;
use crate::spectrum::Spectrum;
use crate::texture::{self, TexturePoint, Textures};
use crate::warp;

/// A shape that shines.
#[derive(Clone, Debug)]
pub struct AreaLight {
    /// Emitted radiance.
    pub radiance: Color,
    /// Whether both sides shine.
    pub two_sided: bool,
    /// Where it shines from.
    pub form: LightForm,
}

/// The form of a shape that shines.
#[derive(Clone, Debug)]
pub enum LightForm {
    /// Seen as a cone from outside.
    Sphere {
        /// As the kernel has it.
        sphere: lookfrom_bvh::Sphere,
        /// To the sphere's own axes: a rotation.
        object_from_render: Mat3,
    },
    /// A round plate.
    Disk(Disk),
    /// Triangles, chosen by area.
    Triangles {
        /// Corners with their texture coordinates, wound so that the shining side is counter-clockwise.
        triangles: Vec<LightTriangle>,
        /// By area.
        choice: Discrete,
        /// All areas together.
        area: f64,
    },
}

/// Three corners with their texture coordinates.
pub type LightTriangle = [(Vec3, Vec2); 3];

impl AreaLight {
    /// Radiance that leaves a point of the light on the side of its normal (`front`) or on the other.
    pub fn emitted(&self, textures: &Textures, at: &TexturePoint, front: bool) -> Spectrum {
        if front || self.two_sided { textures.color(self.radiance, at) } else { Spectrum::BLACK }
    }

    /// One way from the light to a point.
    pub(super) fn sample(&self, textures: &Textures, from: DVec3, u: [f32; 2]) -> Option<LightSample> {
        let chosen = match &self.form {
            LightForm::Sphere { sphere, object_from_render } => {
                self.choose_on_sphere(from, sphere, object_from_render, u)?
            }
            LightForm::Disk(disk) => choose_on_disk(disk, u).seen_from(from)?,
            LightForm::Triangles { triangles, choice, area } => {
                choose_on_triangles(triangles, choice, *area, u).seen_from(from)?
            }
        };
        let Chosen { point, normal, uv, wi, pdf } = chosen;
        let front = normal.dot(wi.as_dvec3()) < 0.0;
        // The colour of a patterned light is looked up without its place in the world: only uv and the normal matter to it.
        let at = TexturePoint { uv, world: DVec3::ZERO, color: [1.0; 3], n: normal.as_vec3() };
        let li = self.emitted(textures, &at, front);
        (!li.is_black()).then_some(LightSample { wi, li, pdf, target: Target::Surface(point, normal) })
    }

    /// Uniformly over the cone in which the sphere is seen; from inside, over all directions.
    fn choose_on_sphere(
        &self,
        from: DVec3,
        sphere: &lookfrom_bvh::Sphere,
        object_from_render: &Mat3,
        u: [f32; 2],
    ) -> Option<Chosen> {
        let center = Vec3::from_array(sphere.center).as_dvec3();
        let radius = f64::from(sphere.radius);
        let to_center = center - from;
        let distance2 = to_center.length_squared();
        let inside = distance2 <= radius * radius;
        if inside && !self.two_sided {
            return None;
        }
        let (wi, pdf) = if inside {
            (warp::uniform_sphere(u), 0.25 / PI)
        } else {
            let sin2_max = (radius * radius / distance2) as f32;
            // 1 − cos without cancellation for far spheres
            let one_minus_cos = sin2_max / (1.0 + (1.0 - sin2_max).max(0.0).sqrt());
            let local = warp::uniform_cone(u, one_minus_cos);
            let axis = (to_center / distance2.sqrt()).as_vec3();
            let (s, t) = warp::orthonormal_basis(axis);
            ((local.x * s + local.y * t + local.z * axis).normalize(), warp::uniform_cone_pdf(one_minus_cos))
        };
        // Where the direction meets the sphere; a direction that rounding made miss touches it.
        let d = wi.as_dvec3();
        let along = to_center.dot(d);
        let nearest2 = (to_center - along * d).length_squared();
        let half_chord = (radius * radius - nearest2).max(0.0).sqrt();
        let t = if inside { along + half_chord } else { along - half_chord };
        let point = Point::on_sphere(sphere.center, sphere.radius, (from + t * d).to_array());
        let normal = (DVec3::from_array(point.position) - center).normalize();
        let uv = texture::sphere_uv(*object_from_render * normal.as_vec3());
        // a sphere so small and far that its cone has no measure in f32
        pdf.is_finite().then_some(Chosen { point, normal, uv, wi, pdf })
    }
}

/// A point of a light, the direction toward it and the density over solid angle.
struct Chosen {
    point: Point,
    normal: DVec3,
    uv: Vec2,
    wi: Vec3,
    pdf: f32,
}

/// A point of a flat light and the density over area.
struct ChosenByArea {
    point: Point,
    normal: DVec3,
    uv: Vec2,
    pdf: f64,
}

impl ChosenByArea {
    /// With the density over solid angle: `pdf · r² / cos θ`.
    fn seen_from(self, from: DVec3) -> Option<Chosen> {
        let Self { point, normal, uv, pdf } = self;
        let (wi, distance) = toward(from, DVec3::from_array(point.position))?;
        let cos_light = normal.dot(wi.as_dvec3()).abs();
        let pdf = (pdf * distance * distance / cos_light) as f32;
        pdf.is_finite().then_some(Chosen { point, normal, uv, wi, pdf })
    }
}

fn choose_on_disk(disk: &Disk, u: [f32; 2]) -> ChosenByArea {
    let on_disk = warp::concentric_disk(u);
    let normal = disk.normal();
    let pdf = 1.0 / (std::f64::consts::PI * normal.length());
    ChosenByArea { point: disk.at(on_disk), normal: normal.normalize(), uv: 0.5 + 0.5 * on_disk, pdf }
}

fn choose_on_triangles(
    triangles: &[LightTriangle],
    choice: &Discrete,
    area: f64,
    [u0, u1]: [f32; 2],
) -> ChosenByArea {
    let (index, _, u0) = choice.sample(u0);
    let [(p0, uv0), (p1, uv1), (p2, uv2)] = triangles[index];
    let [alpha, beta, gamma] = warp::uniform_triangle([u0, u1]);
    let point = Point::on_triangle(p0.to_array(), p1.to_array(), p2.to_array(), beta, gamma);
    let [p0, p1, p2] = [p0, p1, p2].map(Vec3::as_dvec3);
    let normal = (p1 - p0).cross(p2 - p0).normalize();
    ChosenByArea { point, normal, uv: alpha * uv0 + beta * uv1 + gamma * uv2, pdf: 1.0 / area }
}
