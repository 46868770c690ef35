//! Area lights: sampling of points as seen from a reference point, and densities.
//!
//! [`AreaLight::sample_point`] and [`AreaLight::pdf`] have the same solid angle density, as multiple importance
//! sampling requires. The sampling of each kind of shape is in a file of its own.

mod curve;
mod derivation;
mod disk;
mod lanes;
mod mesh;
mod moving;
mod patch;
mod quadric;

use glam::{DVec3, Vec2, Vec3};
use lookfrom_bvh::Point;
use lookfrom_simd::{Float, Mask, Real};

use super::{EmissionSpectrum, LightSample, Scale, Target, toward};
use crate::core::math;
use crate::core::points::Points;
use crate::core::spectrum::Spectrum;
use crate::core::vector::Vector;
use crate::shading::interaction::SurfaceInteraction;
use crate::shading::texture::{FloatTexture, SpectralMode, TexturePoint, Textures};

pub use curve::CurveLight;
pub use disk::DiskLight;
use disk::{DiskLights, gather_disks};
pub(crate) use lanes::sample_area_lights;
pub use mesh::MeshLight;
use mesh::{Triangle as LightTriangle, sample_triangles};
pub(crate) use moving::LightMotion;
pub use patch::PatchLight;
pub use quadric::QuadricLight;
use quadric::{SphereLights, gather_spheres};

/// An area light.
#[derive(Clone, Debug)]
pub struct AreaLight {
    /// Emitted radiance.
    pub radiance: EmissionSpectrum,
    /// The operands of its scale.
    pub written: Scale,
    /// Alpha; `None` is opaque.
    pub alpha: Option<FloatTexture>,
    /// Whether both sides emit light.
    pub two_sided: bool,
    /// Weight of a clear coat over the emitter; `None` where there is none.
    pub coat: Option<FloatTexture>,
    /// The shape that emits light; of one that moves where it is when the shutter opens.
    pub shape: LightShape,
    /// The origin of render space in the world, in which textures have their places.
    pub(crate) origin: DVec3,
    /// Its motion, if it moves.
    pub(crate) motion: Option<LightMotion>,
}

/// The geometry of an area light.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub enum LightShape {
    /// A sphere or ellipsoid, a cylinder, a disk, or a part of one.
    Quadric(Box<QuadricLight>),
    /// A disk or ellipse.
    Disk(Box<DiskLight>),
    /// Triangles.
    Mesh(MeshLight),
    /// Bilinear patches.
    Patches(PatchLight),
    /// Curves, which are not sampled.
    Curves(CurveLight),
}

/// A point of a light, as seen from another point.
#[derive(Clone, Copy, Debug)]
pub struct LightPoint {
    /// Position, in render space.
    pub point: Point,
    /// Outward geometric normal, unit length: the side that emits light, where only one does.
    pub normal: DVec3,
    /// Texture coordinates.
    pub uv: Vec2,
    /// Index of the triangle, for a mesh; else 0.
    pub primitive: u32,
    /// The weights of the triangle's second and third corner.
    pub on_primitive: Vec2,
    /// Toward the light, unit length.
    pub wi: Vec3,
    /// Solid angle density, finite and positive.
    pub pdf: f32,
}

/// The operands of a density: `probability` is that of the part of the light that the point is on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum AreaDensity {
    /// Uniform over an area.
    Area { area: f64, probability: f64, corners: Option<[DVec3; 3]> },
    /// Uniform over a solid angle.
    SolidAngle { solid_angle: f64, probability: f64, corners: [DVec3; 3] },
    /// Uniform over the directions to a sphere, by its radius and the distance of its centre.
    Cone { radius: f64, distance: f64 },
    /// On a bilinear patch, by its area element at the four corners, at the place and there.
    Patch { probability: f64, place: [f64; 2], corners: [f64; 4], here: f64 },
}

/// Points of area lights as seen from other points, at any width: as [`LightPoint`].
#[derive(Clone, Copy)]
pub(crate) struct AreaSamples<R: Real> {
    pub(crate) points: Points<R>,
    pub(crate) normal: Vector<R::Double>,
    pub(crate) wi: Vector<R>,
    /// Finite and positive where there is a point.
    pub(crate) pdf: R,
    /// The lanes that have a point.
    pub(crate) is_valid: R::Mask,
}

impl<R: Real> AreaSamples<R> {
    /// Samples by the directions and distances to the points.
    #[inline(always)]
    fn new(
        points: Points<R>,
        normal: Vector<R::Double>,
        (wi, distance): (Vector<R>, R::Double),
        pdf: R,
    ) -> Self {
        let is_apart = pdf.narrow_mask(distance.gt(distance.like(0.0)));
        let is_valid = is_apart & Float::is_finite(pdf) & pdf.gt(pdf.like(0.0));
        Self { points, normal, wi, pdf, is_valid }
    }

    /// `yes` where the mask is set, `no` elsewhere.
    #[inline(always)]
    pub(crate) fn select(mask: R::Mask, wide_mask: <R::Double as Float>::Mask, yes: Self, no: Self) -> Self {
        Self {
            points: Points {
                position: Vector::select(wide_mask, yes.points.position, no.points.position),
                error: Vector::select(wide_mask, yes.points.error, no.points.error),
            },
            normal: Vector::select(wide_mask, yes.normal, no.normal),
            wi: Vector::select(mask, yes.wi, no.wi),
            pdf: R::select(mask, yes.pdf, no.pdf),
            is_valid: mask.choose(yes.is_valid, no.is_valid),
        }
    }
}

impl AreaSamples<f32> {
    /// The point with its texture coordinates, where there is one; for shapes of one primitive.
    fn light_point(self, uv: impl FnOnce() -> Vec2) -> Option<LightPoint> {
        let Self { points, normal, wi, pdf, is_valid } = self;
        is_valid.then(|| LightPoint {
            point: Point { position: points.position.into(), error: points.error.into() },
            normal: normal.into(),
            uv: uv(),
            primitive: 0,
            on_primitive: Vec2::ZERO,
            wi: wi.into(),
            pdf,
        })
    }
}

/// The unit directions from points to others, and the distances.
#[inline(always)]
fn toward_all<R: Real>(from: Vector<R::Double>, to: Vector<R::Double>) -> (Vector<R>, R::Double) {
    let way = to - from;
    let length = way.length();
    (Vector::narrow(Vector { x: way.x / length, y: way.y / length, z: way.z / length }), length)
}

/// Bounds of an area light and of its normals.
#[derive(Clone, Copy, Debug)]
pub struct EmitterBounds {
    /// Minimum of the bounding box, in render space.
    pub min: DVec3,
    /// Maximum of the bounding box, in render space.
    pub max: DVec3,
    /// Axis of the cone of normals, unit length.
    pub axis: Vec3,
    /// Cosine of the largest angle between a normal and the axis; −1 where they point in all directions.
    pub cos_normals: f32,
    /// Whether both sides emit light.
    pub two_sided: bool,
}

impl AreaLight {
    /// Whether it is sampled; otherwise only rays that hit it find its light: curves, and meshes on which no emission was found.
    pub fn is_sampled(&self) -> bool {
        let may_be = match &self.shape {
            LightShape::Mesh(light) => light.is_sampled(),
            LightShape::Curves(_) => false,
            _ => true,
        };
        may_be && self.motion.as_ref().is_none_or(LightMotion::is_rigid)
    }

    /// The mean of the emission texture over the light, where sampling takes the texture into account.
    pub fn mean_of_pattern(&self) -> Option<f32> {
        match &self.shape {
            LightShape::Mesh(light) => light.brightness(),
            _ => None,
        }
    }

    /// Emitted radiance at a point of the light on the side of its normal (`front`) or on the other, at an angle of
    /// cosine `cos` to its shading normal (on either side; evaluated only where there is a coat).
    pub fn emitted(
        &self,
        textures: &Textures,
        at: &TexturePoint,
        front: bool,
        cos: impl FnOnce() -> f32,
        mode: &SpectralMode,
    ) -> Spectrum {
        if !front && !self.two_sided {
            return Spectrum::BLACK;
        }
        let radiance = self.radiance.at(textures, at, mode);
        match self.coat {
            None => radiance,
            Some(amount) => {
                let amount = textures.float(amount, at).clamp(0.0, 1.0);
                radiance * (1.0 - amount * mirrored_by_coat(cos().abs()))
            }
        }
    }

    /// A sample of the light from a reference point.
    pub(super) fn sample(
        &self,
        textures: &Textures,
        from: DVec3,
        u: [f32; 2],
        mode: &SpectralMode,
    ) -> Option<LightSample> {
        let light_point = self.sample_point(from, u)?;
        let LightPoint { point, normal, wi, pdf, .. } = light_point;
        let front = normal.dot(wi.as_dvec3()) < 0.0;
        let at = TexturePoint { is_inside: !front, ..self.texture_point(&light_point) };
        let there = self.alpha.map_or(1.0, |alpha| textures.float(alpha, &at).clamp(0.0, 1.0));
        let cos = || self.shading_normal(&light_point).dot(wi.as_dvec3()) as f32;
        let li = self.emitted(textures, &at, front, cos, mode) * there;
        (!li.is_black()).then_some(LightSample { wi, li, pdf, target: Target::Surface(point, normal) })
    }

    /// Whether its emission is the same everywhere and in all directions.
    fn is_uniform(&self) -> bool {
        !self.radiance.color.varies() && self.alpha.or(self.coat).is_none()
    }

    /// The inputs of an emission texture.
    fn texture_point(&self, point: &LightPoint) -> TexturePoint<'_> {
        let world = self.origin + DVec3::from_array(point.point.position);
        let at = TexturePoint { uv: point.uv, world, n: point.normal.as_vec3(), ..TexturePoint::NOWHERE };
        let is_even = self.alpha.is_none()
            && !self.coat.is_some_and(FloatTexture::varies)
            && !self.radiance.color.varies();
        match &self.shape {
            LightShape::Mesh(light) if !is_even => {
                light.with_vertices(at, point.primitive, point.on_primitive)
            }
            _ => at,
        }
    }

    /// The shading normal of the coat.
    fn shading_normal(&self, point: &LightPoint) -> DVec3 {
        match &self.shape {
            LightShape::Mesh(light) => light.shading_normal(point.primitive, point.on_primitive),
            _ => point.normal,
        }
    }

    /// A sampled point of the light as seen from `from`, in render space, for `u ∈ [0, 1)²`, with the solid angle
    /// density [`Self::pdf`]. None where no point is visible, or the density is not usable. The point may be hidden
    /// behind other points of the light, or face away.
    pub fn sample_point(&self, from: DVec3, u: [f32; 2]) -> Option<LightPoint> {
        let point = match &self.shape {
            LightShape::Quadric(light) => light.sample(from, u),
            LightShape::Disk(light) => light.sample(from, u),
            LightShape::Mesh(light) => light.sample(from, u),
            LightShape::Patches(light) => light.sample(from, u),
            LightShape::Curves(_) => None,
        }?;
        (point.pdf.is_finite() && point.pdf > 0.0).then_some(point)
    }

    /// The solid angle density in [`Self::sample_point`] of `surface`, the point of this light that a ray from `from`
    /// in the unit direction `wi` hit. 0 where it is never sampled.
    pub fn pdf(&self, from: DVec3, surface: &SurfaceInteraction, wi: Vec3) -> f32 {
        let by_area = |density: f64| {
            let to = DVec3::from_array(surface.point.position) - from;
            (density * to.length_squared() / surface.ng.dot(wi.as_dvec3()).abs()) as f32
        };
        let place = (surface.primitive as usize, surface.on_primitive);
        let pdf = match &self.shape {
            LightShape::Quadric(light) => match light.pdf_by_direction(from, wi) {
                Some(pdf) => pdf,
                None => by_area(light.pdf_by_area(DVec3::from_array(surface.point.position))),
            },
            LightShape::Disk(light) => by_area(1.0 / light.area()),
            LightShape::Mesh(light) => match light.pdf_by_direction(from, place.0) {
                Some(pdf) => pdf,
                None => by_area(light.pdf_by_area(place.0)),
            },
            LightShape::Patches(light) => by_area(light.pdf_by_area(place)),
            LightShape::Curves(_) => 0.0,
        };
        if pdf.is_finite() && pdf > 0.0 { pdf } else { 0.0 }
    }

    /// The formula of a sampled point's density, as seen from `from`, with operands.
    pub(crate) fn density(&self, from: DVec3, point: DVec3) -> AreaDensity {
        match &self.shape {
            LightShape::Quadric(light) => match light.cone(from) {
                Some((radius, distance)) => AreaDensity::Cone { radius, distance },
                None => AreaDensity::Area {
                    area: 1.0 / light.pdf_by_area(point),
                    probability: 1.0,
                    corners: None,
                },
            },
            LightShape::Disk(light) => {
                AreaDensity::Area { area: light.area(), probability: 1.0, corners: None }
            }
            LightShape::Mesh(light) => light.density(from, point),
            LightShape::Patches(light) => light.density(from, point),
            LightShape::Curves(light) => {
                AreaDensity::Area { area: light.area(), probability: 0.0, corners: None }
            }
        }
    }

    /// Area of (one side of) the light, in render space.
    pub fn area(&self) -> f64 {
        self.shape.area()
    }

    /// Bounds of the light and of its normals.
    pub fn emitter_bounds(&self) -> EmitterBounds {
        let (bounds, NormalCone { axis, cos }) = match &self.shape {
            LightShape::Quadric(light) => (light.bounds(), light.normals()),
            LightShape::Disk(light) => (light.bounds(), light.normals()),
            LightShape::Mesh(light) => (light.bounds(), light.normals()),
            LightShape::Patches(light) => (light.bounds(), light.normals()),
            LightShape::Curves(light) => (light.bounds(), NormalCone::ALL),
        };
        let [min, max] = bounds;
        if let Some(motion) = &self.motion {
            let [min, max] = motion.bounds([min, max]);
            return EmitterBounds { min, max, axis: Vec3::Z, cos_normals: -1.0, two_sided: self.two_sided };
        }
        // Rounding must not make the cone too narrow.
        let cos_normals = (cos as f32 - 1e-6).max(-1.0);
        EmitterBounds { min, max, axis: axis.as_vec3(), cos_normals, two_sided: self.two_sided }
    }
}

impl LightShape {
    /// Area of (one side of) the shape, in render space.
    pub fn area(&self) -> f64 {
        match self {
            Self::Quadric(light) => light.area(),
            Self::Disk(light) => light.area(),
            Self::Mesh(light) => light.area(),
            Self::Patches(light) => light.area(),
            Self::Curves(light) => light.area(),
        }
    }
}

/// The part of emitted light that a clear coat reflects back, for a cosine to its normal, as in
/// `KHR_materials_clearcoat`: Schlick's approximation with F0 = 0.04, whatever the roughness of the coat. (Its normal
/// map is ignored: a light does not have it.)
fn mirrored_by_coat(cos: f32) -> f32 {
    0.04 + 0.96 * math::schlick(cos)
}

/// A cone of directions around an axis of unit length, up to an angle of this cosine.
#[derive(Clone, Copy, Debug)]
struct NormalCone {
    axis: DVec3,
    cos: f64,
}

impl NormalCone {
    const ALL: Self = Self { axis: DVec3::Z, cos: -1.0 };

    /// A cone that contains the given unit vectors.
    fn around(directions: impl Iterator<Item = DVec3> + Clone) -> Self {
        let sum: DVec3 = directions.clone().sum();
        let Some(axis) = sum.try_normalize() else { return Self::ALL };
        Self { axis, cos: directions.map(|n| n.dot(axis)).fold(1.0, f64::min) }
    }
}

/// A point of a light that was sampled with an area density, with its solid angle density as seen from `from`.
fn seen(from: DVec3, point: Point, normal: DVec3, uv: Vec2, density: f64) -> Option<LightPoint> {
    let (wi, distance) = toward(from, DVec3::from_array(point.position))?;
    let pdf = (density * distance * distance / normal.dot(wi.as_dvec3()).abs()) as f32;
    Some(LightPoint { point, normal, uv, primitive: 0, on_primitive: Vec2::ZERO, wi, pdf })
}

#[cfg(test)]
mod tests;
