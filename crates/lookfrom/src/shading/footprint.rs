//! The footprint of pixels on surfaces: how far positions and texture coordinates change from one pixel to the next.
//!
//! An approximation without ray differentials: wherever a path meets a surface, and after any number of bounces, the footprint is
//! the one that the camera's narrowest pixel would have there, if the camera looked at the point. pbrt-v4's
//! `Camera::Approximate_dp_dxy` (Pharr, Jakob & Humphreys 2023, § 10.1.3). Bump maps take it for pixels of many samples, at pbrt's limit of 64, so
//! that a picture does not depend on how many are taken; textures scale it by a width of their own.

use glam::{DMat3, DVec3, Vec2, Vec3};
use lookfrom_simd::{Float, Real};

use crate::core::vector::Vector;

/// The distance of samples within a pixel, for bump maps.
const SPACING: f64 = 0.125;

/// Changes of u and v are clamped to this, as in pbrt-v4.
const MOST_CHANGE: f64 = 1e8;

/// The pixels of a camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PixelFootprint {
    /// The camera's position in the world.
    pub eye: DVec3,
    /// From the camera's space to the world.
    pub world_from_camera: DMat3,
    /// Its inverse.
    pub camera_from_world: DMat3,
    /// Changes of the origins of rays, from one pixel to the next in x and in y, in a space whose z axis is along the
    /// ray.
    pub origins: [DVec3; 2],
    /// Changes of their directions of unit length.
    pub directions: [DVec3; 2],
}

/// The part of a surface that a pixel shows: changes from one pixel to the next, in x and in y.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceFootprint {
    /// Differentials of the first set of texture coordinates.
    pub uv: [Vec2; 2],
    /// Differentials of the position in the world.
    pub p: [Vec3; 2],
}

/// [`SurfaceFootprint`] at any width; 0 where it is not defined.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Changes<R> {
    pub(crate) uv: [[R; 2]; 2],
    pub(crate) p: [Vector<R>; 2],
}

impl PixelFootprint {
    /// Half of what u and v change by from sample to sample at a point of a surface, by its geometric normal, ∂p/∂u and ∂p/∂v, at any width:
    /// at least 0; both 0 where that is not defined.
    #[inline(always)]
    pub(crate) fn half<R: Real>(
        &self,
        world: Vector<R::Double>,
        ng: Vector<R>,
        [dpdu, dpdv]: [Vector<R>; 2],
    ) -> [R; 2] {
        let ([x, y], is_defined) = self.on_surface(world, ng.widen());
        let derivatives = [dpdu.widen(), dpdv.widen()];
        let spacing = x.x.like(SPACING);
        let (by_x, by_y) = (solved(derivatives, x * spacing), solved(derivatives, y * spacing));
        let half = |x: R::Double, y: R::Double| R::narrow((Float::abs(x) + Float::abs(y)) * 0.5);
        let [u, v] = [half(by_x[0], by_y[0]), half(by_x[1], by_y[1])];
        let is_defined = u.narrow_mask(is_defined) & Float::is_finite(u) & Float::is_finite(v);
        let zero = u.like(0.0);
        [R::select(is_defined, u, zero), R::select(is_defined, v, zero)]
    }

    /// The footprint at a point of a surface, by its geometric normal, ∂p/∂u and ∂p/∂v.
    pub fn at(&self, world: DVec3, ng: DVec3, [dpdu, dpdv]: [Vec3; 2]) -> SurfaceFootprint {
        let Changes { uv, p } = self.changes(world.into(), ng.into(), [dpdu.into(), dpdv.into()]);
        SurfaceFootprint { uv: uv.map(Vec2::from), p: p.map(Vec3::from) }
    }

    /// [`PixelFootprint::at`], at any width.
    #[inline(always)]
    pub(crate) fn changes<R: Real>(
        &self,
        world: Vector<R::Double>,
        ng: Vector<R::Double>,
        [dpdu, dpdv]: [Vector<R>; 2],
    ) -> Changes<R> {
        let ([x, y], is_defined) = self.on_surface(world, ng);
        let derivatives = [dpdu.widen(), dpdv.widen()];
        let ([ux, vx], [uy, vy]) = (solved(derivatives, x), solved(derivatives, y));
        Changes {
            uv: [
                [change::<R>(ux, is_defined), change::<R>(vx, is_defined)],
                [change::<R>(uy, is_defined), change::<R>(vy, is_defined)],
            ],
            p: [step(x, is_defined), step(y, is_defined)],
        }
    }

    /// ∂p/∂x and ∂p/∂y of a point of a surface, in the world; not defined at the camera itself.
    #[inline(always)]
    fn on_surface<F>(&self, world: Vector<F>, ng: Vector<F>) -> ([Vector<F>; 2], F::Mask)
    where
        F: Float<Scalar = f64>,
    {
        let point = times(&self.camera_from_world, world - Vector::splat(world.x, self.eye.to_array()));
        let distance = point.length();
        // The camera's space turned so that its z axis goes through the point.
        let (toward, is_defined) = point.try_normalize();
        let axes = axes_toward(toward);
        let n = times(&self.world_from_camera.transpose(), ng);
        let n = Vector { x: n.dot(axes[0]), y: n.dot(axes[1]), z: n.dot(axes[2]) };
        ([self.moved(0, &axes, n, distance), self.moved(1, &axes, n, distance)], is_defined)
    }

    /// The step along a surface to the ray of the next pixel in x (0) or y (1), by its normal and distance in the space of these axes.
    #[inline(always)]
    fn moved<F>(&self, axis: usize, axes: &[Vector<F>; 3], n: Vector<F>, distance: F) -> Vector<F>
    where
        F: Float<Scalar = f64>,
    {
        let direction = Vector::splat(distance, (DVec3::Z + self.directions[axis]).to_array());
        let origin = Vector::splat(distance, self.origins[axis].to_array());
        let t = (n.z * distance - n.dot(origin)) / n.dot(direction);
        let here = Vector { x: distance.like(0.0), y: distance.like(0.0), z: distance };
        let step = origin + direction * t - here;
        times(&self.world_from_camera, axes[0] * step.x + axes[1] * step.y + axes[2] * step.z)
    }
}

/// A change of u or v within bounds; 0 where it is not defined.
#[inline(always)]
fn change<R: Real>(by: R::Double, is_defined: <R::Double as Float>::Mask) -> R {
    let is_defined = is_defined & Float::eq(by, by);
    R::narrow(R::Double::select(is_defined, Float::clamp(by, -MOST_CHANGE, MOST_CHANGE), by.like(0.0)))
}

/// A step in space; 0 where it is not defined.
#[inline(always)]
fn step<R: Real>(by: Vector<R::Double>, is_defined: <R::Double as Float>::Mask) -> Vector<R> {
    let is_step = is_defined & Float::is_finite(by.x) & Float::is_finite(by.y) & Float::is_finite(by.z);
    Vector::narrow(Vector::select(is_step, by, Vector::splat(by.x, [0.0; 3])))
}

/// A vector, transformed.
#[inline(always)]
fn times<F: Float<Scalar = f64>>(matrix: &DMat3, v: Vector<F>) -> Vector<F> {
    let x = Vector::splat(v.x, matrix.x_axis.to_array());
    let y = Vector::splat(v.x, matrix.y_axis.to_array());
    let z = Vector::splat(v.x, matrix.z_axis.to_array());
    x * v.x + y * v.y + z * v.z
}

/// The axes of a space turned by the shortest way so that its z axis is a direction.
#[inline(always)]
fn axes_toward<F: Float<Scalar = f64>>(z: Vector<F>) -> [Vector<F>; 3] {
    // Rodrigues' formula about z₀ × z; half a turn about x, where they are opposite.
    let (zero, one) = (z.z.like(0.0), z.z.like(1.0));
    let opposite = one + z.z;
    let (xx, xy, yy) = (z.x * z.x / opposite, z.x * z.y / opposite, z.y * z.y / opposite);
    let is_opposite = opposite.lt(z.z.like(1e-12));
    let x = Vector { x: one - xx, y: -xy, z: -z.x };
    let y = Vector { x: -xy, y: one - yy, z: -z.y };
    [
        Vector::select(is_opposite, Vector { x: one, y: zero, z: zero }, x),
        Vector::select(is_opposite, Vector { x: zero, y: -one, z: zero }, y),
        Vector::select(is_opposite, Vector { x: zero, y: zero, z: -one }, z),
    ]
}

/// Least squares: the changes of u and v that move a point so far along a surface, by ∂p/∂u and ∂p/∂v.
#[inline(always)]
fn solved<F: Float<Scalar = f64>>([dpdu, dpdv]: [Vector<F>; 2], step: Vector<F>) -> [F; 2] {
    let (uu, uv, vv) = (dpdu.dot(dpdu), dpdu.dot(dpdv), dpdv.dot(dpdv));
    let determinant = uu * vv - uv * uv;
    let (along_u, along_v) = (dpdu.dot(step), dpdv.dot(step));
    [(vv * along_u - uv * along_v) / determinant, (uu * along_v - uv * along_u) / determinant]
}

#[cfg(test)]
mod tests {
    use lookfrom_simd::{Kernel, Level, Simd, dispatch, f32x8};

    use super::*;
    use crate::core::hash;
    use crate::core::lanes::{LANES, gather, gather_f64};

    /// A camera at the origin whose pixels are this wide at distance 1.
    fn camera(pixel: f64) -> PixelFootprint {
        PixelFootprint {
            eye: DVec3::ZERO,
            world_from_camera: DMat3::IDENTITY,
            camera_from_world: DMat3::IDENTITY,
            origins: [DVec3::ZERO; 2],
            directions: [DVec3::X * pixel, DVec3::Y * pixel],
        }
    }

    /// ∂p/∂u and ∂p/∂v of a wall by its normal: 2 and 4 long.
    fn wall(ng: Vec3) -> [Vec3; 2] {
        let along = Vec3::Y.cross(ng).normalize();
        [2.0 * along, 4.0 * ng.cross(along)]
    }

    #[test]
    fn axes_are_a_rotation() {
        for z in [DVec3::Z, DVec3::X, DVec3::new(0.3, -0.5, -0.7).normalize(), -DVec3::Z] {
            let [x, y, to] = axes_toward(Vector::from(z)).map(DVec3::from);
            assert!((x.cross(y) - to).length() < 1e-14 && (to - z).length() < 1e-14, "{z}");
            assert!((x.length() - 1.0).abs() < 1e-14 && x.dot(z).abs() < 1e-14, "{z}");
        }
    }

    struct Eight<'a> {
        pixels: &'a PixelFootprint,
        world: &'a [[f64; 3]; LANES],
        ng: &'a [[f64; 3]; LANES],
        derivatives: [&'a [[f32; 3]; LANES]; 2],
    }

    impl Kernel for Eight<'_> {
        type Output = [[f32; 12]; LANES];

        #[inline(always)]
        fn run<S: Simd>(self, simd: S) -> Self::Output {
            let [dpdu, dpdv] = self.derivatives;
            let (world, ng) = (gather_f64(simd, self.world), gather_f64(simd, self.ng));
            let derivatives: [Vector<f32x8<S>>; 2] = [gather(simd, dpdu), gather(simd, dpdv)];
            let Changes { uv: [ux, uy], p: [x, y] } = self.pixels.changes(world, ng, derivatives);
            let [u, v] = self.pixels.half(world, Vector::narrow(ng), derivatives);
            let columns = [ux[0], ux[1], uy[0], uy[1], x.x, x.y, x.z, y.x, y.y, y.z, u, v];
            let columns = columns.map(<[f32; LANES]>::from);
            std::array::from_fn(|lane| columns.map(|column| column[lane]))
        }
    }

    #[test]
    fn eight_at_once_are_eight_one_by_one() {
        let mut count = 0_u64;
        // A number of any exponent, now and then 0.
        let mut number = || {
            count += 1;
            let bits = hash::pair(count, 3);
            let mantissa = (bits >> 40) as f64 / 8_388_608.0 - 1.0;
            if bits.is_multiple_of(37) { 0.0 } else { mantissa * libm::exp2((bits % 37) as f64 - 18.0) }
        };
        let mut levels = vec![Level::baseline(), Level::new()];
        #[cfg(target_arch = "x86_64")]
        levels.extend(Level::new().as_avx2().map(Level::Avx2));
        for round in 0..3000 {
            let mut vector = || [number(), number(), number()];
            let turn = DMat3::from_quat(glam::DQuat::from_xyzw(1.0, 2.0, -3.0, f64::from(round)).normalize());
            let pixels = PixelFootprint {
                eye: vector().into(),
                world_from_camera: turn,
                camera_from_world: turn.inverse(),
                origins: [vector().into(), DVec3::ZERO],
                directions: [1e-3 * DVec3::from(vector()), DVec3::Y * 1e-3],
            };
            let ng: [[f64; 3]; LANES] =
                std::array::from_fn(|_| DVec3::from(vector()).normalize_or(DVec3::Z).into());
            let world = std::array::from_fn(|lane| if lane == 5 { pixels.eye.into() } else { vector() });
            let [dpdu, dpdv] = [0, 1].map(|_| std::array::from_fn(|_| vector().map(|x| x as f32)));
            for &level in &levels {
                let eight = Eight { pixels: &pixels, world: &world, ng: &ng, derivatives: [&dpdu, &dpdv] };
                let eight = dispatch(level, eight);
                for lane in 0..LANES {
                    let derivatives = [dpdu[lane].into(), dpdv[lane].into()];
                    let SurfaceFootprint { uv, p } =
                        pixels.at(world[lane].into(), ng[lane].into(), derivatives);
                    let [x, y] = p;
                    let ng = DVec3::from(ng[lane]).as_vec3().into();
                    let [u, v] = pixels.half(world[lane].into(), ng, derivatives.map(Vec3::into));
                    let [[ux, vx], [uy, vy]] = uv.map(<[f32; 2]>::from);
                    let alone = [ux, vx, uy, vy, x.x, x.y, x.z, y.x, y.y, y.z, u, v];
                    assert_eq!(eight[lane].map(f32::to_bits), alone.map(f32::to_bits), "{alone:?} {round}");
                    assert!(alone.iter().all(|x| x.is_finite()), "{alone:?}");
                }
            }
        }
    }

    #[test]
    fn it_grows_with_the_distance_and_the_slant() {
        let half_on = |pixel: f64, world: DVec3, ng: Vec3, derivatives: [Vec3; 2]| {
            let half = camera(pixel).half(world.into(), ng.into(), derivatives.map(Vector::from));
            Vec2::from_array(half)
        };
        let half = |pixel: f64, world: DVec3, ng: Vec3| half_on(pixel, world, ng, wall(ng));
        // Facing the camera: half an eighth of a pixel, over the length of u and v.
        for distance in [1.0, 100.0] {
            let half = half(1e-3, DVec3::Z * distance, Vec3::NEG_Z);
            let expected = 0.5 * 0.125 * 1e-3 * distance as f32;
            assert!((half - expected / Vec2::new(2.0, 4.0)).length() < 1e-3 * expected, "{half}");
        }
        // Slanted about the y axis by 60°: twice as long along u.
        let slanted = Vec3::new(0.75_f32.sqrt(), 0.0, -0.5);
        let seen = half(1e-4, DVec3::Z, slanted);
        let expected = 0.5 * 0.125 * 1e-4;
        assert!((seen.x / (2.0 * expected / 2.0) - 1.0).abs() < 1e-3, "{seen}");
        assert!((seen.y / (expected / 4.0) - 1.0).abs() < 1e-3, "{seen}");
        // In any direction alike.
        let toward = DVec3::new(-2.0, 1.0, -2.0);
        let seen = half(1e-3, toward, -toward.normalize().as_vec3());
        assert!((seen.x * 2.0 - seen.y * 4.0).abs() < 0.3 * seen.x, "{seen}");
        // None in the camera itself, or where u and v are not independent.
        assert_eq!(half(1e-3, DVec3::ZERO, slanted), Vec2::ZERO);
        assert_eq!(half_on(1e-3, DVec3::Z, slanted, [wall(slanted)[0]; 2]), Vec2::ZERO);
    }
}
