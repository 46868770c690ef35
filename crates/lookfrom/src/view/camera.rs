//! The camera, from a pixel back to the world: `P_world = T4 · R3 · S2 · T1 · P_k`, as in the lecture notes.
//!
//! `P_k = (x_k, y_k, 0, 1)` with `x_k` to the right and `y_k` *up*: the centre of the pixel in column i, row j (from
//! the top) is `(i + ½, ny − j − ½)`. The four matrices are kept apart, so that each can be shown:
//!
//! | matrix | does |
//! | --- | --- |
//! | `t1` | moves the image's centre to the axis and the image plane to the distance `d` |
//! | `s2` | scales pixels to lengths; x is flipped, since `u` points to the viewer's left |
//! | `r3` | `[u v w]`: rotates view to world, about the camera |
//! | `t4` | moves the camera to its position |
//!
//! There is no perspective matrix: every ray starts at the camera and passes through its pixel, so the division by
//! depth is in the geometry of the rays.
//!
//! Everything here is f64; the resulting ray is rounded to f32 in *render space*, the world translated to the camera
//! (see `world`). The first step in the computation of a pixel.

use std::sync::Arc;

use glam::{DMat3, DMat4, DVec3, DVec4};
use lookfrom_scene::camera::{Camera as Written, Lens, Projection, View, Window, up_across};
use lookfrom_scene::motion::Motion;
use lookfrom_scene::{Error, Location, Result};
use lookfrom_simd::{Float, Real};

use crate::core::vector::Vector;
use crate::core::warp;
use crate::view::lens_system::{LeavingRay, LensSystem};

/// The camera as matrices.
#[derive(Clone, Debug, PartialEq)]
pub struct Camera {
    /// Translates by `(−nx/2, −ny/2, d)`; for an off-centre screen window by the pixel that is on the axis.
    pub t1: DMat4,
    /// Scales by `(−w/nx, h/ny, 1)`.
    pub s2: DMat4,
    /// `[u v w]` by columns. From another format it may scale, shear and reflect as well.
    pub r3: DMat4,
    /// Translates by `lookfrom`.
    pub t4: DMat4,
    /// The projection.
    pub projection: Projection,
    /// The thin lens, on which rays start, if there is one.
    pub lens: Option<Lens>,
    /// The lens system of a [`Projection::LensSystem`], focused.
    pub lens_system: Option<Arc<LensSystem>>,
    /// `d`.
    pub distance: f64,
    /// Distances of the near and the far clipping plane along the view axis; `None` without them.
    pub clip: Option<[f64; 2]>,
    /// `nx`, `ny`.
    pub size: [u32; 2],
    /// Its motion, if it moves: in the world, from where the matrices put it, which is where it is when the shutter opens.
    pub motion: Option<Arc<Motion>>,
}

/// A ray through a point of the image, with the steps of its computation.
#[derive(Clone, Copy, Debug)]
pub struct CameraRay {
    /// `P_k`.
    pub p_k: DVec4,
    /// `T1 · P_k`.
    pub after_t1: DVec4,
    /// `S2 · T1 · P_k`: the point on the image plane in view space.
    pub after_s2: DVec4,
    /// `R3 · S2 · T1 · P_k`.
    pub after_r3: DVec4,
    /// `P_world`.
    pub p_world: DVec3,
    /// `a`, the origin of the ray, relative to `lookfrom`: zero for a pinhole.
    pub a_from_eye: DVec3,
    /// `b − a`; not of unit length: `t = 1` is the image plane.
    pub direction: DVec3,
    /// The factor of its light: 1, but for that of a lens system, which is 0 for a ray that the system blocks. That is the ray of a
    /// pinhole then.
    pub weight: f32,
}

/// Rays of a camera as they are computed, in view space or in the world: origins relative to `lookfrom`, directions, and factors
/// of their light.
#[derive(Clone, Copy, Debug)]
pub(crate) struct StartingRay<R: Real> {
    pub(crate) a: Vector<R::Double>,
    pub(crate) direction: Vector<R::Double>,
    pub(crate) weight: R,
}

impl Camera {
    /// The matrices for a picture of `width` × `height` pixels.
    ///
    /// # Errors
    /// `Invalid` for each degenerate camera: `lookfrom = lookat`, `up` zero or parallel to the view, `θ ∉ (0°, 180°)`,
    /// `d ≤ 0`, no pixels, an impossible lens or matrix, any value that is not finite; as [`LensSystem::new`].
    pub fn new(written: &Written, width: u32, height: u32) -> Result<Self> {
        let at = &written.at;
        if width == 0 || height == 0 {
            return Err(Error::invalid(
                at,
                format!("the picture has {width} × {height} pixels; both must be at least 1"),
            ));
        }
        let d = positive(at, "distance", written.distance)?;
        let (nx, ny) = (f64::from(width), f64::from(height));
        let lens_system = match &written.projection {
            Projection::LensSystem(system) => Some(Arc::new(LensSystem::new(system, at)?)),
            _ => None,
        };
        // h, the height of the image on the image plane
        let h = match written.projection {
            Projection::Perspective { fov } if fov > 0.0 && fov < 180.0 => {
                2.0 * d * libm::tan(0.5 * fov.to_radians())
            }
            Projection::Perspective { fov } => {
                return Err(Error::invalid(
                    at,
                    format!("fov is {fov}°; expected an angle between 0° and 180°"),
                ));
            }
            Projection::Orthographic { height } => positive(at, "height", height)?,
            // There is no image plane as in the notes here; it is taken to be 2 × 2.
            Projection::Equirectangular
            | Projection::EquirectangularPbrt
            | Projection::Octahedral
            | Projection::Irradiance { .. } => 2.0,
            // That of a pinhole which sees the plane of focus as large.
            Projection::LensSystem(_) => lens_system.as_ref().map_or(2.0, |system| {
                let film = 2.0 * system.film_radius() * ny / (nx * nx + ny * ny).sqrt();
                film * d / system.pinhole_distance()
            }),
        };
        if let Some(Lens { radius, focus_distance }) = written.lens {
            positive(at, "focus_distance", focus_distance)?;
            if !(radius >= 0.0 && radius.is_finite()) {
                return Err(Error::invalid(
                    at,
                    format!("the lens radius is {radius}; expected a number ≥ 0"),
                ));
            }
        }
        if let Some([near, far]) = written.clip
            && !(near >= 0.0 && far > near)
        {
            let message =
                format!("the camera sees from {near} to {far}; expected distances that rise from 0");
            return Err(Error::invalid(at, message));
        }
        let (r3, lookfrom) = match written.view {
            View::Look { lookfrom, lookat, up } => (view_axes(at, lookfrom, lookat, up)?, lookfrom),
            View::Matrix(matrix) => {
                let linear = DMat3::from_mat4(matrix);
                let determinant = linear.determinant();
                if !matrix.is_finite() || !determinant.is_normal() {
                    return Err(Error::invalid(at, "the camera's matrix is not invertible")
                        .hint("give it three independent axes and finite numbers"));
                }
                (linear, matrix.w_axis.truncate())
            }
        };
        let window = written.window.unwrap_or(Window { x: [-nx / ny, nx / ny], y: [-1.0, 1.0] });
        // the size of a pixel and the pixel on the axis
        let across = |[low, high]: [f64; 2], pixels: f64| {
            let size = 0.5 * h * (high - low) / pixels;
            (size, -0.5 * h * low / size)
        };
        let ((pixel_x, axis_x), (pixel_y, axis_y)) = (across(window.x, nx), across(window.y, ny));
        for (size, axis) in [(pixel_x, axis_x), (pixel_y, axis_y)] {
            if !(size != 0.0 && size.is_finite() && axis.is_finite()) {
                return Err(Error::invalid(
                    at,
                    format!("the window {window:?} of the image plane has no area"),
                )
                .hint("give it a left and a right, a bottom and a top that differ"));
            }
        }
        Ok(Self {
            t1: DMat4::from_translation(DVec3::new(-axis_x, -axis_y, d)),
            s2: DMat4::from_scale(DVec3::new(-pixel_x, pixel_y, 1.0)),
            r3: DMat4::from_mat3(r3),
            t4: DMat4::from_translation(lookfrom),
            projection: written.projection.clone(),
            lens: written.lens.filter(|lens| lens.radius > 0.0),
            lens_system,
            distance: d,
            clip: written.clip,
            size: [width, height],
            // The surface that is measured does not move with it.
            motion: written.motion.clone().filter(|_| !written.projection.is_measurement()),
        })
    }

    /// The camera's position in the world.
    pub fn lookfrom(&self) -> DVec3 {
        self.t4.w_axis.truncate()
    }

    /// `w`: the view direction, of unit length where the camera was given by `lookat`.
    pub fn w(&self) -> DVec3 {
        self.r3.z_axis.truncate()
    }

    /// `M_vw`, from view space to the world: `T4 · R3`.
    pub fn world_from_view(&self) -> DMat4 {
        self.t4 * self.r3
    }

    /// Whether its rays are parallel: orthographic, without a lens.
    pub(crate) fn is_parallel(&self) -> bool {
        self.lens.is_none() && matches!(self.projection, Projection::Orthographic { .. })
    }

    /// Whether it has an image plane, so that its rays are those of [`Camera::flat_ray`].
    pub(crate) fn is_flat(&self) -> bool {
        match self.projection {
            Projection::Perspective { .. } | Projection::Orthographic { .. } | Projection::LensSystem(_) => {
                true
            }
            Projection::Equirectangular
            | Projection::EquirectangularPbrt
            | Projection::Octahedral
            | Projection::Irradiance { .. } => false,
        }
    }

    /// Whether its rays start at places of a lens, which random numbers choose.
    pub(crate) fn has_lens(&self) -> bool {
        self.lens.is_some() || self.lens_system.is_some()
    }

    /// The rays of a camera with an image plane, as [`Camera::ray`] gives them, at any width.
    #[inline(always)]
    pub(crate) fn flat_ray<R: Real>(&self, [x_k, y_k]: [R::Double; 2], lens: [R; 2]) -> StartingRay<R> {
        let zero = x_k.like(0.0);
        // S2 · T1 · P_k; its other terms are zero
        let image_point = Vector {
            x: (x_k + x_k.like(self.t1.w_axis.x)) * x_k.like(self.s2.x_axis.x) + zero,
            y: (y_k + y_k.like(self.t1.w_axis.y)) * y_k.like(self.s2.y_axis.y) + zero,
            z: x_k.like(self.distance),
        };
        let StartingRay { a, direction, weight } = self.flat_ray_in_view(image_point, lens);
        StartingRay { a: self.rotated(a), direction: self.rotated(direction), weight }
    }

    /// The rays through points of the image plane, in view space.
    #[inline(always)]
    fn flat_ray_in_view<R: Real>(&self, image_point: Vector<R::Double>, lens: [R; 2]) -> StartingRay<R> {
        let zero = image_point.x.like(0.0);
        let one = lens[0].like(1.0);
        // Parallel rays if the camera is orthographic, else from a pinhole.
        let (start, straight) = match self.projection {
            Projection::Orthographic { .. } => {
                (Vector { z: zero, ..image_point }, Vector { x: zero, y: zero, z: image_point.z })
            }
            _ => (Vector { x: zero, y: zero, z: zero }, image_point),
        };
        if let Some(system) = &self.lens_system {
            return through_lens_system(system, image_point, lens);
        }
        let Some(Lens { radius, focus_distance }) = self.lens else {
            return StartingRay { a: start, direction: straight, weight: one };
        };
        // every ray from the lens intersects the pinhole's ray in the plane of focus
        let pinhole = image_point - start;
        let focus = start + pinhole * (zero.like(focus_distance) / pinhole.z);
        let [x, y] = warp::concentric_disk(lens);
        let radius = zero.like(radius);
        let (x, y) = (x.widen() * radius, y.widen() * radius);
        let a = start + Vector { x, y, z: zero };
        let direction = (focus - a) * zero.like(self.distance / focus_distance);
        StartingRay { a, direction, weight: one }
    }

    /// `R3` times vectors of view space.
    #[inline(always)]
    fn rotated<F: Float<Scalar = f64>>(&self, v: Vector<F>) -> Vector<F> {
        let [x, y, z] = [self.r3.x_axis, self.r3.y_axis, self.r3.z_axis];
        Vector {
            x: v.x * v.x.like(x.x) + v.y * v.x.like(y.x) + v.z * v.x.like(z.x),
            y: v.x * v.x.like(x.y) + v.y * v.x.like(y.y) + v.z * v.x.like(z.y),
            z: v.x * v.x.like(x.z) + v.y * v.x.like(y.z) + v.z * v.x.like(z.z),
        }
    }

    /// The ray through the point `(x_k, y_k)` of the image, `y_k` up; `lens` in `[0, 1)²` chooses a point of the lens. Of a
    /// [`Projection::Irradiance`], whose rays start on a surface of the world, the view axis.
    #[inline]
    pub fn ray(&self, [x_k, y_k]: [f64; 2], lens: [f32; 2]) -> CameraRay {
        let p_k = DVec4::new(x_k, y_k, 0.0, 1.0);
        let after_t1 = self.t1 * p_k;
        let after_s2 = self.s2 * after_t1;
        let after_r3 = self.r3 * after_s2;
        let p_world = (self.t4 * after_r3).truncate();
        // in view space: the origin of the ray and its direction
        let (a, direction, weight) = match self.projection {
            Projection::Perspective { .. } | Projection::Orthographic { .. } | Projection::LensSystem(_) => {
                let StartingRay { a, direction, weight } =
                    self.flat_ray_in_view::<f32>(after_s2.truncate().into(), lens);
                (a.into(), direction.into(), weight)
            }
            Projection::Equirectangular | Projection::EquirectangularPbrt => {
                let [u, v] = [x_k / f64::from(self.size[0]), y_k / f64::from(self.size[1])];
                let is_pbrts = self.projection == Projection::EquirectangularPbrt;
                (DVec3::ZERO, if is_pbrts { equirectangular_pbrt(u, v) } else { equirectangular(u, v) }, 1.0)
            }
            Projection::Octahedral => {
                let square = [x_k / f64::from(self.size[0]), 1.0 - y_k / f64::from(self.size[1])];
                let direction = warp::octahedral_direction(square.map(|u| u as f32)).as_dvec3();
                (DVec3::ZERO, DVec3::new(-direction.x, direction.z, direction.y), 1.0)
            }
            Projection::Irradiance { .. } => (DVec3::ZERO, DVec3::Z, 1.0),
        };
        CameraRay {
            p_k,
            after_t1,
            after_s2,
            after_r3,
            p_world,
            a_from_eye: self.rotated(a.into()).into(),
            direction: self.rotated(direction.into()).into(),
            weight,
        }
    }

    /// The point of the image, in pixels, `y` up, at which a point of view space is seen: by a camera with an image plane, through the
    /// middle of its lens. `None` for other cameras, and behind the camera.
    pub(crate) fn image_of(&self, point: DVec3) -> Option<[f64; 2]> {
        let on_plane = match self.projection {
            Projection::Orthographic { .. } => point,
            _ => point * (self.distance / point.z),
        };
        let is_seen = self.is_flat() && (point.z > 0.0 || self.is_parallel());
        let at = |plane: f64, pixel: f64, axis: f64| plane / pixel - axis;
        is_seen.then(|| {
            [
                at(on_plane.x, self.s2.x_axis.x, self.t1.w_axis.x),
                at(on_plane.y, self.s2.y_axis.y, self.t1.w_axis.y),
            ]
        })
    }

    /// The point of the film of a lens system, in lens space, where the point `(x_k, y_k)` of the image is: upside down, left and right
    /// interchanged.
    pub(crate) fn film_point(&self, point: [f64; 2]) -> Option<[f64; 2]> {
        let system = self.lens_system.as_ref()?;
        let image_point = (self.s2 * self.t1 * DVec4::new(point[0], point[1], 0.0, 1.0)).truncate();
        Some(film_point(system, image_point.into()))
    }
}

/// The points of the film for points of the image plane in view space, whose x is to the left.
#[inline(always)]
fn film_point<F: Float<Scalar = f64>>(system: &LensSystem, image_point: Vector<F>) -> [F; 2] {
    let size = image_point.x.like(system.pinhole_distance()) / image_point.z;
    [image_point.x * size, -(image_point.y * size)]
}

/// The rays that leave a lens system, in view space; of unit length.
#[inline(always)]
fn through_lens_system<R: Real>(
    system: &LensSystem,
    image_point: Vector<R::Double>,
    lens: [R; 2],
) -> StartingRay<R> {
    let zero = image_point.x.like(0.0);
    let LeavingRay { origin, direction, weight } = system.leaving(film_point(system, image_point), lens);
    let is_blocked = weight.widen().eq(zero);
    let nowhere = Vector { x: zero, y: zero, z: zero };
    StartingRay {
        a: Vector::select(is_blocked, nowhere, Vector { x: -origin.x, ..origin }),
        direction: Vector::select(
            is_blocked,
            image_point.normalize(),
            Vector { x: -direction.x, ..direction },
        ),
        weight,
    }
}

/// The direction at `(u, v)` of an equirectangular picture, `v` up, in view space: θ = π (1 − v) from the up axis,
/// φ = 2π (u − ½) from the front toward the viewer's right.
fn equirectangular(u: f64, v: f64) -> DVec3 {
    let (theta, phi) = (std::f64::consts::PI * (1.0 - v), std::f64::consts::TAU * (u - 0.5));
    let sin_theta = libm::sin(theta);
    DVec3::new(-sin_theta * libm::sin(phi), libm::cos(theta), sin_theta * libm::cos(phi))
}

/// The direction of a point of pbrt's spherical camera: φ = 2π u from the viewer's right toward the front.
fn equirectangular_pbrt(u: f64, v: f64) -> DVec3 {
    let (theta, phi) = (std::f64::consts::PI * (1.0 - v), std::f64::consts::TAU * u);
    let sin_theta = libm::sin(theta);
    DVec3::new(-sin_theta * libm::cos(phi), libm::cos(theta), sin_theta * libm::sin(phi))
}

fn positive(at: &Location, name: &str, value: f64) -> Result<f64> {
    if value > 0.0 && value.is_finite() {
        Ok(value)
    } else {
        Err(Error::invalid(at, format!("{name} is {value}; expected a positive number")))
    }
}

/// `[u v w]` with `w` forward, `u = up × w` to the viewer's left, `v = w × u` up.
fn view_axes(at: &Location, lookfrom: DVec3, lookat: DVec3, up: DVec3) -> Result<DMat3> {
    for (name, point) in [("lookfrom", lookfrom), ("lookat", lookat), ("up", up)] {
        if !point.is_finite() {
            return Err(Error::invalid(at, format!("{name} is {point}; expected finite numbers")));
        }
    }
    let w = (lookat - lookfrom).try_normalize().ok_or_else(|| {
        Error::invalid(at, format!("lookfrom and lookat are the same point {lookfrom}"))
            .hint("move one of them: the camera needs a direction")
    })?;
    let other = || format!("try up = {}", up_across(w));
    let up = up.try_normalize().ok_or_else(|| Error::invalid(at, "up is zero").hint(other()))?;
    let u = up.cross(w);
    // Below this the direction of up × w is rounding noise.
    if u.length() < 1e-10 {
        return Err(Error::invalid(at, "up is parallel to the direction of view").hint(other()));
    }
    let u = u.normalize();
    Ok(DMat3::from_cols(u, w.cross(u), w))
}

#[cfg(test)]
mod tests;
