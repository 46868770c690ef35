//! Triangulation of polygons.
//!
//! A fan if its triangles do not overlap, otherwise ear clipping (Meisters 1975). Polygons in space are projected along
//! their mean normal (Newell's, in Sutherland, Sproull, Schumacker 1974). No vertex is left out, so neighbours with the
//! same edges fit without gaps.

use glam::{DVec2, DVec3, Vec3};

/// A polygon triangulator, which reuses its memory.
pub(crate) struct Triangulator {
    flat: Vec<DVec2>,
    /// The remaining corners.
    left: Vec<u32>,
    /// The budget of corner tests: ear clipping takes time quadratic in the number of corners, and a file must not be able
    /// to take hours.
    tests_left: u64,
}

impl Triangulator {
    /// The default budget: a few seconds.
    pub(crate) fn new() -> Self {
        Self { flat: Vec::new(), left: Vec::new(), tests_left: 1 << 30 }
    }

    /// Whether a polygon exceeded the budget and became a fan.
    pub(crate) fn gave_up(&self) -> bool {
        self.tests_left == 0
    }

    /// Appends triangles as indices into `points`, with the orientation of the polygon. Points must be finite; n ≥ 3 points
    /// give n − 2 triangles, some possibly without area.
    pub(crate) fn cut(&mut self, points: &[Vec3], triangles: &mut Vec<[u32; 3]>) {
        let count = points.len() as u32;
        if count <= 3 {
            if count == 3 {
                triangles.push([0, 1, 2]);
            }
            return;
        }
        self.flatten(points);
        let fan = (1..count - 1).all(|i| self.area([0, i, i + 1]) > 0.0);
        if fan || self.tests_left == 0 {
            triangles.extend((1..count - 1).map(|i| [0, i, i + 1]));
        } else {
            self.cut_ears(count, triangles);
        }
    }

    /// Projects along the mean normal, so that the polygon is counter-clockwise.
    fn flatten(&mut self, points: &[Vec3]) {
        let origin = points[0].as_dvec3();
        let at = |i: usize| points[i % points.len()].as_dvec3() - origin;
        let normal = (0..points.len()).fold(DVec3::ZERO, |sum, i| sum + at(i).cross(at(i + 1)));
        let size = normal.abs();
        self.flat.clear();
        self.flat.extend((0..points.len()).map(|i| {
            let p = at(i);
            // Drop the axis along which the normal is longest; swap the others if the normal points backwards.
            let (flat, forward) = if size.x > size.y && size.x > size.z {
                (DVec2::new(p.y, p.z), normal.x)
            } else if size.y > size.z {
                (DVec2::new(p.z, p.x), normal.y)
            } else {
                (DVec2::new(p.x, p.y), normal.z)
            };
            if forward < 0.0 { DVec2::new(flat.y, flat.x) } else { flat }
        }));
    }

    /// Twice the signed area of three corners.
    fn area(&self, [a, b, c]: [u32; 3]) -> f64 {
        let [a, b, c] = [a, b, c].map(|i| self.flat[i as usize]);
        (b - a).perp_dot(c - a)
    }

    fn cut_ears(&mut self, count: u32, triangles: &mut Vec<[u32; 3]>) {
        self.left.clear();
        self.left.extend(0..count);
        let mut tip = 0;
        let mut failures = 0;
        while self.left.len() > 3 && self.tests_left > 0 {
            let n = self.left.len();
            tip %= n;
            let ear = [self.left[(tip + n - 1) % n], self.left[tip], self.left[(tip + 1) % n]];
            // If no corner is an ear, the polygon intersects itself: clip anyway, so that the loop terminates.
            if self.is_ear(ear) || failures >= n {
                triangles.push(ear);
                self.left.remove(tip);
                self.tests_left = self.tests_left.saturating_sub(n as u64);
                failures = 0;
            } else {
                self.tests_left -= 1;
                failures += 1;
            }
            // Skipping the next corner avoids thin triangles.
            tip += 1;
        }
        // The last triangle; if the budget is exhausted, a fan.
        triangles.extend(self.left.windows(2).skip(1).map(|pair| [self.left[0], pair[0], pair[1]]));
    }

    /// Whether the triangle has area and no other corner lies in it.
    fn is_ear(&mut self, ear: [u32; 3]) -> bool {
        if self.area(ear) <= 0.0 {
            return false;
        }
        // At least one test is left, to be spent by the caller.
        self.tests_left = self.tests_left.saturating_sub(self.left.len() as u64).max(1);
        let tips = ear.map(|i| self.flat[i as usize]);
        self.left.iter().all(|&other| {
            ear.contains(&other)
                || tips.contains(&self.flat[other as usize])
                || self.area([ear[0], ear[1], other]) < 0.0
                || self.area([ear[1], ear[2], other]) < 0.0
                || self.area([ear[2], ear[0], other]) < 0.0
        })
    }
}

/// Whether the triangle of three finite points has an area.
pub(crate) fn has_area([a, b, c]: [Vec3; 3]) -> bool {
    let [a, b, c] = [a, b, c].map(Vec3::as_dvec3);
    (b - a).cross(c - a) != DVec3::ZERO
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn cut(points: &[Vec3]) -> Vec<[u32; 3]> {
        let mut triangles = Vec::new();
        Triangulator::new().cut(points, &mut triangles);
        triangles
    }

    fn area(points: &[Vec3], triangle: [u32; 3]) -> DVec3 {
        let [a, b, c] = triangle.map(|i| points[i as usize].as_dvec3());
        0.5 * (b - a).cross(c - a)
    }

    #[test]
    fn a_corner_on_an_edge_is_kept() {
        let points = [Vec3::ZERO, Vec3::X, 2.0 * Vec3::X, Vec3::new(1.0, 1.0, 0.0)];
        let triangles = cut(&points);
        assert_eq!(triangles.len(), 2);
        assert!(triangles.iter().all(|&t| area(&points, t).z > 0.0), "{triangles:?}");
    }

    #[test]
    fn crossing_and_degenerate_polygons_end() {
        let bow = [Vec3::ZERO, Vec3::X + Vec3::Y, Vec3::X, Vec3::Y];
        assert_eq!(cut(&bow).len(), 2);
        assert_eq!(cut(&[Vec3::ONE; 9]).len(), 7);
        assert_eq!(cut(&[Vec3::ONE; 2]).len(), 0);
    }

    #[test]
    fn a_comb_of_many_teeth_gives_up_in_time_or_is_right() {
        let comb: Vec<Vec3> = (0..40_000)
            .map(|i| Vec3::new(i as f32, if i % 2 == 0 { 0.0 } else { 1.0 }, 0.0))
            .chain([Vec3::new(40_000.0, 9.0, 0.0), Vec3::new(-1.0, 9.0, 0.0)])
            .collect();
        assert_eq!(cut(&comb).len(), comb.len() - 2);
    }

    proptest! {
        #[test]
        fn star_shapes_are_covered_once(
            radii in prop::collection::vec(100_u16..1000, 4..40),
            scale in -20_i32..20,
            axis in 0_usize..6,
        ) {
            // A star-shaped polygon around the origin of any concavity, in one of six orientations of a cube.
            let scale = 2_f32.powi(scale);
            let step = std::f32::consts::TAU / radii.len() as f32;
            let radii = radii.iter().map(|&thousandths| f32::from(thousandths) / 1000.0);
            let points: Vec<Vec3> = radii.enumerate().map(|(i, r)| {
                let (x, y) = (scale * r * (step * i as f32).cos(), scale * r * (step * i as f32).sin());
                match axis {
                    0 => Vec3::new(x, y, 0.3 * y), 1 => Vec3::new(y, x, 0.0),
                    2 => Vec3::new(x, 0.1 * x, y), 3 => Vec3::new(y, 0.0, x),
                    4 => Vec3::new(0.0, x, y), _ => Vec3::new(0.2 * y, y, x),
                }
            }).collect();
            let n = points.len();
            let whole = (0..n).fold(DVec3::ZERO, |sum, i| {
                sum + 0.5 * points[i].as_dvec3().cross(points[(i + 1) % n].as_dvec3())
            });
            let triangles = cut(&points);
            prop_assert_eq!(triangles.len(), n - 2);
            // All have the orientation of the polygon, and their areas sum to its area: no overlap, no gap.
            let direction = whole.normalize();
            let mut sum = 0.0;
            for &triangle in &triangles {
                let along = area(&points, triangle).dot(direction);
                prop_assert!(along > 0.0);
                sum += along;
            }
            prop_assert!((sum - whole.length()).abs() <= 1e-6 * whole.length());
        }
    }
}
