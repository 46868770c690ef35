//! Whole spheres, which the kernel intersects itself.

use std::f64::consts::PI;

use glam::{DVec3, Mat3, Vec2, Vec3};
use lookfrom_bvh::Sphere;
use lookfrom_simd::{Float, Real, Simd, f32x8, f64x8, prelude::*};

use super::quadric::sphere_derivatives;
use super::{MaterialBinding, SurfacePoint, SurfacePoints};
use crate::core::lanes::{LANES, by_lane, gather};
use crate::core::points::Points;
use crate::core::vector::Vector;
use crate::shading::texture;

/// Spheres of many shapes.
#[derive(Clone, Debug, Default)]
pub struct Spheres {
    /// In the kernel's form.
    pub spheres: Vec<Sphere>,
    /// For each sphere, an index into `bindings`.
    pub binding_of: Vec<u32>,
    /// The attributes of spheres, and their orientations.
    pub bindings: Vec<SphereBinding>,
}

/// Attributes shared by the spheres of one shape.
#[derive(Clone, Copy, Debug)]
pub struct SphereBinding {
    /// Its attributes.
    pub binding: MaterialBinding,
    /// The rotation (or reflection) to the shape's own axes, where its poles are on y.
    pub object_from_sphere: Mat3,
    /// Whether the outside is the side of the centre.
    pub flip: bool,
}

impl SphereBinding {
    /// The texture coordinates where a sphere has a normal to the outside.
    #[inline]
    pub(crate) fn uv(&self, ng: Vec3) -> Vec2 {
        let from_center = if self.flip { -ng } else { ng };
        texture::sphere_uv(OwnAxes::new(self).own(from_center.into())).into()
    }
}

impl Spheres {
    /// A sphere and its attributes.
    #[inline]
    pub(crate) fn get(&self, index: usize) -> (&Sphere, &SphereBinding) {
        (&self.spheres[index], &self.bindings[self.binding_of[index] as usize])
    }

    /// The point of a sphere nearest to one that is on it up to errors.
    pub(crate) fn point(&self, index: usize, near: DVec3) -> SurfacePoint {
        let (sphere, binding) = self.get(index);
        let (lanes, axes) = (SphereLanes::new(sphere, binding), OwnAxes::new(binding));
        let (mut at, outward) = lanes.points(near.into());
        let own = axes.own(outward);
        axes.set_derivatives(&mut at, own, lanes.radius);
        let uv = texture::sphere_uv(own).into();
        let derivatives = [at.dpdu.into(), at.dpdv.into()];
        SurfacePoint::plain(at.points.into(), at.ng.into(), uv, derivatives, binding.binding)
    }
}

/// A sphere in each lane.
struct SphereLanes<R: Real> {
    center: Vector<R::Double>,
    radius: R::Double,
    /// −1 where the outside is the side of the centre, otherwise 1.
    orientation: R::Double,
}

impl SphereLanes<f32> {
    #[inline]
    fn new(sphere: &Sphere, binding: &SphereBinding) -> Self {
        Self {
            center: Vector::from(sphere.center).widen(),
            radius: sphere.radius.into(),
            orientation: if binding.flip { -1.0 } else { 1.0 },
        }
    }
}

impl<R: Real> SphereLanes<R> {
    /// The points nearest to some that are on the spheres up to errors, with texture coordinates and derivatives of 0; and the unit
    /// vectors from the centres.
    #[inline(always)]
    fn points(&self, near: Vector<R::Double>) -> (SurfacePoints<R>, Vector<R>) {
        let points = Points::<R>::on_spheres(self.center, self.radius, near);
        let outward = (points.position - self.center).normalize();
        let ng = outward * self.orientation;
        let zero = self.radius.like(0.0);
        let none = Vector { x: zero, y: zero, z: zero };
        let outward = Vector::<R>::narrow(outward);
        let at = SurfacePoints {
            points,
            ng,
            ns: ng,
            uv: [outward.x.like(0.0); 2],
            dpdu: none,
            dpdv: none,
            shading_dpdu: none,
            shading_dpdv: none,
            lift: none,
        };
        (at, outward)
    }
}

/// The columns of the maps to the shapes' own axes, in which unit vectors from the centres have texture coordinates.
struct OwnAxes<R: Real>([Vector<R>; 3]);

impl OwnAxes<f32> {
    #[inline]
    fn new(binding: &SphereBinding) -> Self {
        let Mat3 { x_axis, y_axis, z_axis } = binding.object_from_sphere;
        Self([x_axis.into(), y_axis.into(), z_axis.into()])
    }
}

impl<R: Real> OwnAxes<R> {
    /// A vector in these axes.
    #[inline(always)]
    fn own(&self, outward: Vector<R>) -> Vector<R> {
        let [x, y, z] = self.0;
        x * outward.x + y * outward.y + z * outward.z
    }

    /// The derivatives by the texture coordinates on spheres of some radii, at unit vectors from the centres in these axes.
    #[inline(always)]
    fn set_derivatives(&self, at: &mut SurfacePoints<R>, own: Vector<R>, radius: R::Double) {
        // Their poles are on z.
        let own = own.widen();
        let on_z = Vector { x: own.x, y: -own.z, z: own.y } * radius;
        let [dpdu, dpdv] = sphere_derivatives(on_z, radius, [-PI, 2.0 * PI]);
        (at.dpdu, at.dpdv) = (self.turned_back(dpdu), self.turned_back(dpdv));
        (at.shading_dpdu, at.shading_dpdv) = (at.dpdu, at.dpdv);
    }

    /// From axes with the poles on z to those of the space that the spheres are in.
    #[inline(always)]
    fn turned_back(&self, v: Vector<R::Double>) -> Vector<R::Double> {
        let own = Vector { x: v.x, y: v.z, z: -v.y };
        let [x, y, z] = self.0;
        Vector { x: x.widen().dot(own), y: y.widen().dot(own), z: z.widen().dot(own) }
    }
}

/// The points of eight hits on spheres, nearest to some that are on them up to errors: most often on one sphere. Texture coordinates
/// and derivatives are 0 where they are not wanted.
#[inline(always)]
pub(crate) fn points_on_spheres<S: Simd>(
    simd: S,
    spheres: &[(&Sphere, &SphereBinding); LANES],
    near: Vector<f64x8<S>>,
    [wants_uvs, wants_derivatives]: [bool; 2],
) -> SurfacePoints<f32x8<S>> {
    let (first, binding) = spheres[0];
    let is_one = by_lane!(lane => std::ptr::eq(spheres[lane].0, first)) == [true; LANES];
    let lanes: SphereLanes<f32x8<S>> = if is_one {
        let SphereLanes { center, radius, orientation } = SphereLanes::new(first, binding);
        let radius = f64x8::splat(simd, radius);
        let center = Vector::splat(radius, center.into());
        SphereLanes { center, radius, orientation: f64x8::splat(simd, orientation) }
    } else {
        SphereLanes {
            center: gather(simd, &by_lane!(lane => spheres[lane].0.center)).widen(),
            radius: Real::widen(f32x8::load_array(simd, by_lane!(lane => spheres[lane].0.radius))),
            orientation: f64x8::load_array(
                simd,
                by_lane!(lane => if spheres[lane].1.flip { -1.0 } else { 1.0 }),
            ),
        }
    };
    let (mut at, outward) = lanes.points(near);
    if !(wants_uvs || wants_derivatives) {
        return at;
    }

    let axes = if is_one {
        let (OwnAxes([x, y, z]), like) = (OwnAxes::<f32>::new(binding), f32x8::splat(simd, 0.0));
        OwnAxes([Vector::splat(like, x.into()), Vector::splat(like, y.into()), Vector::splat(like, z.into())])
    } else {
        OwnAxes([
            gather(simd, &by_lane!(lane => spheres[lane].1.object_from_sphere.x_axis.to_array())),
            gather(simd, &by_lane!(lane => spheres[lane].1.object_from_sphere.y_axis.to_array())),
            gather(simd, &by_lane!(lane => spheres[lane].1.object_from_sphere.z_axis.to_array())),
        ])
    };
    let own = axes.own(outward);
    if wants_uvs {
        at.uv = texture::sphere_uv(own);
    }
    if wants_derivatives {
        axes.set_derivatives(&mut at, own, lanes.radius);
    }
    at
}

#[cfg(test)]
mod tests {
    use lookfrom_simd::{Kernel, Level, dispatch};

    use super::*;
    use crate::core::hash;
    use crate::core::lanes::{gather_f64, scatter, scatter_f64};

    /// A number of any exponent from 2⁻²⁰ to 2²⁰.
    fn number(count: u64) -> f32 {
        let bits = hash::pair(count, 17);
        let mantissa = (bits >> 40) as f64 / 16_777_216.0 - 0.5;
        (mantissa * libm::exp2((bits % 41) as f64 - 20.0)) as f32
    }

    fn vector(count: u64) -> Vec3 {
        Vec3::new(number(3 * count), number(3 * count + 1), number(3 * count + 2))
    }

    struct Eight<'a>(&'a [(Sphere, SphereBinding); LANES], &'a [[f64; 3]; LANES]);

    impl Kernel for Eight<'_> {
        /// The position, the normal and the derivatives of each lane; the texture coordinates.
        type Output = ([[[f64; 3]; LANES]; 4], [[f32; 3]; LANES]);

        #[inline(always)]
        fn run<S: Simd>(self, simd: S) -> Self::Output {
            let spheres = by_lane!(lane => (&self.0[lane].0, &self.0[lane].1));
            let at = points_on_spheres(simd, &spheres, gather_f64(simd, self.1), [true; 2]);
            let [u, v] = at.uv;
            let wide = [at.points.position, at.ng, at.dpdu, at.dpdv];
            (wide.map(scatter_f64), scatter(Vector { x: u, y: v, z: v }))
        }
    }

    #[test]
    fn eight_points_are_those_of_one_at_a_time() {
        for round in 0..2000 {
            let binding = |lane: u64| {
                let axis = vector(64 * round + lane).normalize_or(Vec3::Y);
                SphereBinding {
                    binding: MaterialBinding::NONE,
                    object_from_sphere: Mat3::from_axis_angle(axis, number(64 * round + 8 + lane)),
                    flip: hash::pair(round, lane) & 1 == 1,
                }
            };
            let sphere = |lane: u64| Sphere {
                center: vector(64 * round + 16 + lane).to_array(),
                radius: number(64 * round + 24 + lane).abs(),
            };
            // Now and then all lanes are on one sphere, and now and then at its pole.
            let one = round % 3 == 0;
            let items: [(Sphere, SphereBinding); LANES] = std::array::from_fn(|lane| {
                let lane = if one { 0 } else { lane as u64 };
                (sphere(lane), binding(lane))
            });
            let near = std::array::from_fn(|lane| {
                let (Sphere { center, radius }, SphereBinding { object_from_sphere, .. }) = items[lane];
                let away = match (round + lane as u64) % 5 {
                    0 => object_from_sphere.transpose() * Vec3::Y,
                    _ => vector(64 * round + 32 + lane as u64).normalize_or(Vec3::Z),
                };
                (Vec3::from(center).as_dvec3() + f64::from(radius) * away.as_dvec3()).to_array()
            });
            let spheres = Spheres {
                spheres: items.iter().map(|(sphere, _)| *sphere).collect(),
                binding_of: (0..LANES as u32).collect(),
                bindings: items.iter().map(|(_, binding)| *binding).collect(),
            };
            let (wide, uv) = dispatch(Level::new(), Eight(&items, &near));
            for lane in 0..LANES {
                let one = spheres.point(lane, near[lane].into());
                let expected = [one.point.position, one.ng.into(), one.dpdu.into(), one.dpdv.into()];
                let bits = |vectors: [[f64; 3]; 4]| vectors.map(|v| v.map(f64::to_bits));
                assert_eq!(bits([0, 1, 2, 3].map(|k| wide[k][lane])), bits(expected), "{:?}", items[lane]);
                assert_eq!([uv[lane][0], uv[lane][1]].map(f32::to_bits), one.uv.to_array().map(f32::to_bits));
            }
        }
    }
}
