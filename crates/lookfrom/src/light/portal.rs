//! Portals: environments sampled through a rectangle (Bitterli, Novák & Jarosz 2015).
//!
//! With two angles about the sides of the rectangle as coordinates (*rectified*), the part of the environment that is
//! visible through it from any point is a rectangle too, a window of the square. Environment maps are resampled into
//! that square once; from each point, directions are sampled within its window. As in pbrt-v4 light enters from one
//! side, and the environment is invisible elsewhere than through the portal. `derivation` is for the inspector.

mod derivation;

use std::f64::consts::PI;

use glam::{DVec3, Vec3};
use lookfrom_scene::image::Image;

use crate::core::distribution::{Window, Windowed2D};
use crate::core::parallel;

/// Resolution of the square, per side, for an environment without a map.
const SIDE: usize = 64;

/// A rectangle through which an environment is seen.
#[derive(Clone, Debug)]
pub struct Portal {
    opening: Opening,
    choice: Windowed2D,
    /// The environment map, resampled into the square.
    picture: Option<Image>,
}

/// The rectangle, and the square of the angles about its sides: 0 … 1 stands for −π/2 … π/2 of the outer hemisphere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Opening {
    /// In render space: the corner that comes first in both angles …
    corner: DVec3,
    /// … and the one across.
    opposite: DVec3,
    /// Directions of unit length: along both sides, and outward.
    axes: [DVec3; 3],
    area: f64,
}

impl Portal {
    /// A portal to a constant environment, or one that varies little.
    pub fn plain(opening: Opening) -> Self {
        let weights = solid_angles(SIDE, SIDE).map(|angle| angle as f32).collect();
        Self { opening, choice: Windowed2D::new(weights, SIDE, SIDE), picture: None }
    }

    /// A portal to an environment map of that size, whose colours are given by unit direction in render space.
    ///
    /// # Panics
    /// If the picture has no texels.
    pub fn of_picture(opening: Opening, size: [u32; 2], color: impl Fn(Vec3) -> [f32; 3] + Sync) -> Self {
        let [width, height] = size.map(|size| size as usize);
        let mut texels = vec![[0.0; 3]; width * height];
        parallel::for_chunks_mut(&mut texels, width, |y, row| {
            let v = (y as f64 + 0.5) / height as f64;
            for (x, texel) in row.iter_mut().enumerate() {
                *texel = color(opening.direction([(x as f64 + 0.5) / width as f64, v]));
            }
        });
        let brightness = |rgb: &[f32; 3]| rgb.iter().fold(0.0, |most: f32, c| most.max(*c));
        let weights = texels
            .iter()
            .zip(solid_angles(width, height))
            .map(|(rgb, angle)| (f64::from(brightness(rgb)) * angle) as f32)
            .collect();
        let choice = Windowed2D::new(weights, width, height);
        let [width, height] = size;
        let picture = Image::from_linear("what is seen through a portal", width, height, texels);
        Self { opening, choice, picture: Some(picture) }
    }

    /// The rectangle.
    pub(crate) fn opening(&self) -> Opening {
        self.opening
    }

    /// Whether a ray leaves through the portal.
    pub fn is_seen(&self, from: DVec3, direction: Vec3) -> bool {
        self.place(from, direction).is_some()
    }

    /// The point in the square of a direction through the portal from a point.
    fn place(&self, from: DVec3, direction: Vec3) -> Option<[f64; 2]> {
        let place = self.opening.place(direction.as_dvec3())?;
        self.opening.window(from)?.contains(place).then_some(place)
    }

    /// The texel of the resampled map, if there is one, in a direction through the portal.
    pub(super) fn texel(&self, direction: Vec3) -> Option<[f32; 3]> {
        let picture = self.picture.as_ref()?;
        let place = self.opening.place(direction.as_dvec3())?;
        let [x, y] = [(place[0], picture.width), (place[1], picture.height)]
            .map(|(place, size)| ((place * f64::from(size)) as usize).min(size as usize - 1));
        Some(picture.texel(y * picture.width as usize + x))
    }

    /// A sampled direction through the portal and its solid angle density, or `None` where nothing is visible.
    pub(super) fn sample(&self, from: DVec3, u: [f32; 2]) -> Option<(Vec3, f32)> {
        let (place, pdf) = self.choice.sample(&self.opening.window(from)?, u)?;
        Some((self.opening.direction(place), pdf / self.opening.solid_angle(place)))
    }

    /// The density of [`Portal::sample`].
    pub(super) fn pdf(&self, from: DVec3, direction: Vec3) -> f32 {
        let (Some(window), Some(place)) =
            (self.opening.window(from), self.opening.place(direction.as_dvec3()))
        else {
            return 0.0;
        };
        self.choice.pdf(&window, place) / self.opening.solid_angle(place)
    }

    /// Area of the rectangle.
    pub(super) fn area(&self) -> f64 {
        self.opening.area
    }
}

impl Opening {
    /// The rectangle of four corners in render space, in order: counter-clockwise when looking out. If they do not form
    /// a rectangle, nothing is visible through it.
    pub fn new([a, b, c, d]: [DVec3; 4]) -> Self {
        let x = (d - a).normalize_or_zero();
        let z = x.cross(b - a).normalize_or_zero();
        Self { corner: a, opposite: c, axes: [x, z.cross(x), z], area: (d - a).cross(b - a).length() }
    }

    /// The part of the square that is visible through the portal from a point; `None` from outside and from its plane.
    fn window(&self, from: DVec3) -> Option<Window> {
        let min = self.place(self.corner - from)?;
        let max = self.place(self.opposite - from)?;
        Some(Window { min, max })
    }

    /// The point in the square of a direction of any length; `None` for those that do not lead outside.
    fn place(&self, direction: DVec3) -> Option<[f64; 2]> {
        let [x, y, z] = self.axes.map(|axis| axis.dot(direction));
        (z > 0.0).then(|| [x, y].map(|side| (0.5 + libm::atan2(side, z) / PI).clamp(0.0, 1.0)))
    }

    /// The unit direction of a point in the square.
    fn direction(&self, place: [f64; 2]) -> Vec3 {
        let [x, y] = place.map(slope);
        (self.axes[0] * x + self.axes[1] * y + self.axes[2]).normalize().as_vec3()
    }

    /// Solid angle per area of the square, at a point of it.
    fn solid_angle(&self, place: [f64; 2]) -> f32 {
        let [x2, y2] = place.map(|place| slope(place) * slope(place));
        let length2 = 1.0 + x2 + y2;
        (PI * PI * (1.0 + x2) * (1.0 + y2) / (length2 * length2.sqrt())) as f32
    }
}

/// The tangent of the angle from the normal; very large at a right angle.
fn slope(place: f64) -> f64 {
    libm::tan(PI * (place - 0.5).clamp(-0.4999999999, 0.4999999999))
}

/// The solid angle of each cell of the square, row by row.
fn solid_angles(width: usize, height: usize) -> impl Iterator<Item = f64> {
    let edges = move |cells: usize| (0..=cells).map(move |cell| slope(cell as f64 / cells as f64));
    let columns: Vec<f64> = edges(width).collect();
    let rows: Vec<f64> = edges(height).collect();
    (0..width * height).map(move |index| {
        cell_solid_angle([0, 1].map(|i| columns[index % width + i]), [0, 1].map(|i| rows[index / width + i]))
    })
}

/// The solid angle of a cell between the tangents of its sides.
fn cell_solid_angle([left, right]: [f64; 2], [top, bottom]: [f64; 2]) -> f64 {
    // Solid angle from a distance of 1 of a rectangle with one corner on the axis and the opposite one at (x, y).
    let until = |x: f64, y: f64| libm::atan2(x * y, (1.0 + x * x + y * y).sqrt());
    let angle = until(right, bottom) - until(left, bottom) - until(right, top) + until(left, top);
    // rounding must not leave a cell without solid angle
    angle.max(f64::MIN_POSITIVE)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn unit() -> Opening {
        // counter-clockwise when looking along −z, from the lower left
        Opening::new(
            [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(|[x, y]| DVec3::new(x, y, -1.0)),
        )
    }

    #[test]
    fn one_side_looks_out() {
        let portal = Portal::plain(unit());
        assert!(portal.is_seen(DVec3::ZERO, -Vec3::Z));
        assert!(!portal.is_seen(DVec3::ZERO, Vec3::Z));
        assert!(!portal.is_seen(DVec3::new(0.0, 0.0, -2.0), Vec3::Z));
        assert!(portal.is_seen(DVec3::ZERO, Vec3::new(0.99, -0.99, -1.0).normalize()));
        assert!(!portal.is_seen(DVec3::ZERO, Vec3::new(1.01, 0.0, -1.0).normalize()));
        assert!(!portal.is_seen(DVec3::new(0.0, 0.0, -1.0), -Vec3::Z), "within the opening");
    }

    #[test]
    fn cells_make_a_hemisphere() {
        for (width, height) in [(1, 1), (64, 64), (7, 300)] {
            let sum: f64 = solid_angles(width, height).sum();
            assert!((sum / (2.0 * PI) - 1.0).abs() < 1e-8, "{sum}");
        }
    }

    #[test]
    fn places_and_directions_are_inverse() {
        let opening = unit();
        for k in 0..1000 {
            let place = [f64::from(k % 33) / 33.0 + 0.01, f64::from(k % 29) / 29.0 + 0.01];
            let back = opening.place(opening.direction(place).as_dvec3()).expect("outside");
            assert!((0..2).all(|i| (back[i] - place[i]).abs() < 1e-6), "{place:?} {back:?}");
        }
    }

    #[test]
    fn solid_angles_of_places_are_those_of_their_cells() {
        let (opening, size) = (unit(), 50);
        for (index, angle) in solid_angles(size, size).enumerate() {
            let place = [index % size, index / size].map(|i| (i as f64 + 0.5) / size as f64);
            let near_corner = place.iter().all(|x| (x - 0.5).abs() > 0.4);
            let ratio = f64::from(opening.solid_angle(place)) / (angle * (size * size) as f64);
            assert!(near_corner || (ratio - 1.0).abs() < 0.03, "{place:?} {ratio}");
        }
    }

    #[test]
    fn no_rectangle_lets_nothing_through() {
        for corners in [[DVec3::ZERO; 4], [DVec3::NAN; 4], [DVec3::INFINITY; 4]] {
            let portal = Portal::plain(Opening::new(corners));
            assert!(portal.sample(DVec3::ONE, [0.5; 2]).is_none());
            assert_eq!(portal.pdf(DVec3::ONE, Vec3::Z), 0.0);
        }
    }
}
