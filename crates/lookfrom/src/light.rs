//! Where light comes from: each light can be sampled from a point.
//!
//! In radiometric units: a written intensity `I` of a point light is `π I` W/sr here, so that a white diffuse surface
//! (`k_d / π`) that faces it from a distance of 1 is seen with radiance `I` (the convention of `lookfrom_scene::light`).

use std::f32::consts::PI;

use glam::{DVec3, Mat3, Vec2, Vec3};
use lookfrom_bvh::Point;
use lookfrom_scene::light::Falloff;
use lookfrom_scene::material::Color;
use lookfrom_scene::texture::{TexelFilter, Wrap};

use crate::distribution::{Discrete, Piecewise2D};
use crate::shape::Disk;
use crate::spectrum::Spectrum;
use crate::surface::Surface;
use crate::texture::{self, TexturePoint, Textures};
use crate::warp;

/// A light, ready to be sampled. Positions are in render space.
#[derive(Clone, Debug)]
pub enum Light {
    /// From a point to all sides.
    Point {
        /// Where.
        position: DVec3,
        /// W/sr.
        intensity: Spectrum,
        /// How it fades.
        falloff: Falloff,
    },
    /// From infinitely far.
    Distant {
        /// Toward the light, unit length.
        toward: Vec3,
        /// W/m² on a surface that faces it.
        irradiance: Spectrum,
    },
    /// From a point into a cone.
    Spot {
        /// Where.
        position: DVec3,
        /// The axis, away from the light, unit length.
        axis: Vec3,
        /// W/sr on the axis.
        intensity: Spectrum,
        /// Cosine of the angle beyond which it is dark.
        cos_outer: f32,
        /// Cosine of the angle up to which it is full.
        cos_inner: f32,
        /// How it fades.
        falloff: Falloff,
    },
    /// From a surface.
    Area(AreaLight),
    /// From all around.
    Environment(Environment),
}

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

/// Light from infinitely far, all around.
#[derive(Clone, Debug)]
pub struct Environment {
    /// Its colours.
    pub sky: Sky,
    /// Whether surfaces are lit by it; otherwise it is only seen.
    pub illuminates: bool,
}

/// The colours of an environment.
#[derive(Clone, Debug)]
pub enum Sky {
    /// The same everywhere.
    Constant(Spectrum),
    /// Linear in the height y of the unit direction.
    Gradient {
        /// At y = 1.
        zenith: Spectrum,
        /// At y = 0.
        horizon: Spectrum,
        /// At y = −1.
        nadir: Spectrum,
    },
    /// A picture in latitude and longitude.
    Image(Box<SkyImage>),
}

/// A picture of the surroundings.
#[derive(Clone, Debug)]
pub struct SkyImage {
    /// Index of the picture in the world.
    pub image: usize,
    /// Multiplies it.
    pub scale: Spectrum,
    /// Columns: the light's axes in the world; a rotation.
    pub world_from_light: Mat3,
    /// By the light of each part of the picture.
    pub choice: Piecewise2D,
}

/// One way that light reaches a point, if nothing stands in it.
#[derive(Clone, Copy, Debug)]
pub struct LightSample {
    /// Toward the light, unit length.
    pub wi: Vec3,
    /// Radiance that arrives (for a point light: intensity after fall-off; for a distant one: irradiance) …
    pub li: Spectrum,
    /// … to be divided by this density over solid angle (1 where there is only one direction).
    pub pdf: f32,
    /// What the shadow ray aims at.
    pub target: Target,
}

/// What a shadow ray aims at.
#[derive(Clone, Copy, Debug)]
pub enum Target {
    /// A point in space with no surface.
    Point(DVec3),
    /// A point of a surface with its outside normal: the shadow ray ends just before it.
    Surface(Point, DVec3),
    /// Infinitely far in the direction `wi`.
    Infinity,
}

impl Light {
    /// Whether its light comes from infinitely far.
    pub fn is_infinitely_far(&self) -> bool {
        matches!(self, Self::Distant { .. } | Self::Environment(_))
    }

    /// One way from the light to `surface`, or `None` where there is none. `u ∈ [0, 1)²`; `n` is the unit normal that the
    /// light is weighed with, so that light from all around can be sampled by the cosine to it.
    pub fn sample(
        &self,
        textures: &Textures,
        surface: &Surface,
        n: Vec3,
        u: [f32; 2],
    ) -> Option<LightSample> {
        let from = DVec3::from_array(surface.point.position);
        match self {
            Self::Point { position, intensity, falloff } => {
                let (wi, distance) = toward(from, *position)?;
                Some(LightSample {
                    wi,
                    li: *intensity * fade(*falloff, distance),
                    pdf: 1.0,
                    target: Target::Point(*position),
                })
            }
            Self::Distant { toward, irradiance } => {
                Some(LightSample { wi: *toward, li: *irradiance, pdf: 1.0, target: Target::Infinity })
            }
            Self::Spot { position, axis, intensity, cos_outer, cos_inner, falloff } => {
                let (wi, distance) = toward(from, *position)?;
                let cone = smooth_step(*cos_outer, *cos_inner, axis.dot(-wi));
                let li = *intensity * (fade(*falloff, distance) * cone);
                (cone > 0.0).then_some(LightSample { wi, li, pdf: 1.0, target: Target::Point(*position) })
            }
            Self::Area(light) => light.sample(textures, from, u),
            Self::Environment(environment) => environment.sample(textures, n, u),
        }
    }
}

/// The unit direction and the distance, or `None` between equal points.
fn toward(from: DVec3, to: DVec3) -> Option<(Vec3, f64)> {
    let distance = (to - from).length();
    (distance > 0.0).then(|| (((to - from) / distance).as_vec3(), distance))
}

fn fade(falloff: Falloff, distance: f64) -> f32 {
    match falloff {
        Falloff::None => 1.0,
        Falloff::Linear => (1.0 / distance) as f32,
        Falloff::Quadratic => (1.0 / (distance * distance)) as f32,
    }
}

/// 0 up to `low`, 1 from `high`, a cubic between.
fn smooth_step(low: f32, high: f32, x: f32) -> f32 {
    if x >= high {
        return 1.0;
    }
    let s = ((x - low) / (high - low)).clamp(0.0, 1.0);
    s * s * (3.0 - 2.0 * s)
}

impl AreaLight {
    /// Radiance that leaves a point of the light on the side of its normal (`front`) or on the other.
    pub fn emitted(&self, textures: &Textures, at: &TexturePoint, front: bool) -> Spectrum {
        if front || self.two_sided { textures.color(self.radiance, at) } else { Spectrum::BLACK }
    }

    fn sample(&self, textures: &Textures, from: DVec3, u: [f32; 2]) -> Option<LightSample> {
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
        // The colour of a patterned light is looked up without its place in the world: only uv matters to it.
        let at = TexturePoint { uv, world: DVec3::ZERO, color: [1.0; 3] };
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

impl Environment {
    /// Radiance from a unit direction.
    pub fn radiance(&self, textures: &Textures, direction: Vec3) -> Spectrum {
        match &self.sky {
            Sky::Constant(color) => *color,
            Sky::Gradient { zenith, horizon, nadir } => {
                let y = direction.y.clamp(-1.0, 1.0);
                let end = if y >= 0.0 { *zenith } else { *nadir };
                *horizon * (1.0 - y.abs()) + end * y.abs()
            }
            Sky::Image(sky) => {
                let uv = sky.uv(direction);
                let wrap = [Wrap::Repeat, Wrap::Clamp];
                let rgb = texture::look_up(textures.image(sky.image), uv, wrap, TexelFilter::Bilinear);
                Spectrum::from_rgb(rgb) * sky.scale
            }
        }
    }

    fn sample(&self, textures: &Textures, n: Vec3, u: [f32; 2]) -> Option<LightSample> {
        if !self.illuminates {
            return None;
        }
        let (wi, pdf) = match &self.sky {
            Sky::Constant(_) | Sky::Gradient { .. } => {
                let wi = warp::cosine_hemisphere(u, n);
                (wi, warp::cosine_hemisphere_pdf(n.dot(wi)))
            }
            Sky::Image(sky) => {
                let ([s, t], pdf) = sky.choice.sample(u);
                // the picture's area element is 2π² sin θ of the sphere's
                let sin_theta = libm::sinf(t * PI);
                (sky.direction([s, t]), pdf / (2.0 * PI * PI * sin_theta))
            }
        };
        if !(pdf > 0.0 && pdf.is_finite()) {
            return None;
        }
        Some(LightSample { wi, li: self.radiance(textures, wi), pdf, target: Target::Infinity })
    }
}

impl SkyImage {
    /// Where in the picture a unit direction lies; row 0 is +y of the light's space, u = ½ is −z, u grows toward +x.
    fn uv(&self, direction: Vec3) -> [f32; 2] {
        let d = self.world_from_light.transpose() * direction;
        let u = 0.5 + libm::atan2f(d.x, -d.z) / (2.0 * PI);
        let v = libm::acosf(d.y.clamp(-1.0, 1.0)) / PI;
        [u, v]
    }

    /// The inverse of [`SkyImage::uv`].
    fn direction(&self, [u, v]: [f32; 2]) -> Vec3 {
        let (phi, theta) = ((u - 0.5) * 2.0 * PI, v * PI);
        let sin_theta = libm::sinf(theta);
        self.world_from_light
            * Vec3::new(libm::sinf(phi) * sin_theta, libm::cosf(theta), -libm::cosf(phi) * sin_theta)
    }
}
