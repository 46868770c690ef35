//! Animation samplers: interpolation between keyframes (specification, §3.11 and appendix C).

use glam::{DQuat, DVec4};

/// The interpolation between two keyframes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Interpolation {
    /// Linear, and along a great arc for rotations.
    Linear,
    /// The value of the earlier keyframe.
    Step,
    /// Cubic Hermite: each keyframe has a tangent before and one after its value.
    CubicSpline,
}

impl Interpolation {
    /// The interpolation of a file's keyword.
    pub(super) fn of(word: &str) -> Option<Self> {
        Some(match word {
            "LINEAR" => Self::Linear,
            "STEP" => Self::Step,
            "CUBICSPLINE" => Self::CubicSpline,
            _ => return None,
        })
    }

    /// Number of elements per keyframe.
    pub(super) fn elements(self) -> usize {
        if self == Self::CubicSpline { 3 } else { 1 }
    }
}

/// Keyframes of a value over time.
pub(super) struct Track<'a> {
    /// In seconds, increasing: at least one.
    pub(super) times: &'a [f32],
    /// `width` numbers for each element of each keyframe.
    pub(super) values: &'a [f32],
    /// Numbers per element.
    pub(super) width: usize,
    /// The interpolation.
    pub(super) interpolation: Interpolation,
}

impl Track<'_> {
    /// The value at a time, which is clamped to the first and last keyframe; NaN gives the first.
    pub(super) fn vector(&self, time: f64) -> Vec<f64> {
        let (key, part, span) = self.place(time);
        let blend = |f: &dyn Fn(f64, f64) -> f64| {
            let (from, to) = (self.value(key), self.value(key + 1));
            from.iter().zip(to).map(|(&a, &b)| f(f64::from(a), f64::from(b))).collect()
        };
        if part == 0.0 {
            return self.value(key).iter().map(|&value| f64::from(value)).collect();
        }
        match self.interpolation {
            Interpolation::Step => self.value(key).iter().map(|&value| f64::from(value)).collect(),
            Interpolation::Linear => blend(&|a, b| a + part * (b - a)),
            Interpolation::CubicSpline => {
                let (u, u2, u3) = (part, part * part, part * part * part);
                let [leave, reach] = [u3 - 2.0 * u2 + u, u3 - u2].map(|weight| span * weight);
                let [from, to] = [2.0 * u3 - 3.0 * u2 + 1.0, -2.0 * u3 + 3.0 * u2];
                let element = |index: usize, i: usize| f64::from(self.values[index * self.width + i]);
                (0..self.width)
                    .map(|i| {
                        from * element(3 * key + 1, i)
                            + leave * element(3 * key + 2, i)
                            + to * element(3 * key + 4, i)
                            + reach * element(3 * key + 3, i)
                    })
                    .collect()
            }
        }
    }

    /// The value at a time for quaternions (x, y, z, w): of unit length if the keyframes are, along the shorter arc.
    pub(super) fn rotation(&self, time: f64) -> DVec4 {
        let unit = |numbers: &[f64]| match numbers {
            &[x, y, z, w] => DVec4::new(x, y, z, w).normalize_or_zero(),
            _ => DVec4::ZERO,
        };
        let (key, part, _) = self.place(time);
        if part == 0.0 || self.interpolation != Interpolation::Linear {
            return unit(&self.vector(time));
        }
        let [from, to] = [key, key + 1]
            .map(|key| unit(&self.value(key).iter().map(|&value| f64::from(value)).collect::<Vec<_>>()));
        slerp(DQuat::from_vec4(from), DQuat::from_vec4(to), part).into()
    }

    /// The keyframe before a time, the fraction of the way to the next one, and the time between both.
    fn place(&self, time: f64) -> (usize, f64, f64) {
        // In the precision of the file, so that the frame of a keyframe is not before it by the rounding of the keyframe's time.
        let next = self.times.partition_point(|&key| key <= time as f32);
        if next == 0 || next == self.times.len() {
            return (next.saturating_sub(1), 0.0, 0.0);
        }
        let (from, to) = (f64::from(self.times[next - 1]), f64::from(self.times[next]));
        let span = to - from;
        // Decreasing or equal times have nothing between them.
        let part = (time - from) / span;
        if part > 0.0 && part < 1.0 { (next - 1, part, span) } else { (next - 1, 0.0, 0.0) }
    }

    fn value(&self, key: usize) -> &[f32] {
        let element = match self.interpolation {
            Interpolation::CubicSpline => 3 * key + 1,
            _ => key,
        };
        &self.values[element * self.width..][..self.width]
    }
}

/// Spherical interpolation between two unit quaternions (Shoemake 1985), along the shorter arc.
fn slerp(from: DQuat, to: DQuat, part: f64) -> DQuat {
    let cos = from.dot(to);
    // A quaternion and its opposite are the same rotation.
    let (to, cos) = if cos < 0.0 { (-to, -cos) } else { (to, cos) };
    if cos > 1.0 - 1e-9 {
        return (from * (1.0 - part) + to * part).normalize();
    }
    let angle = libm::acos(cos);
    let [a, b] = [(1.0 - part) * angle, part * angle].map(libm::sin);
    (from * a + to * b).normalize()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn track(times: &'static [f32], values: &'static [f32], interpolation: Interpolation) -> Track<'static> {
        let width = values.len() / times.len() / interpolation.elements();
        Track { times, values, width, interpolation }
    }

    #[test]
    fn values_are_clamped_at_both_ends() {
        for interpolation in [Interpolation::Linear, Interpolation::Step] {
            let track = track(&[1.0, 2.0], &[10.0, 20.0, 30.0, 40.0], interpolation);
            for early in [f64::NAN, f64::NEG_INFINITY, 0.0, 1.0] {
                assert_eq!(track.vector(early), [10.0, 20.0]);
            }
            for late in [2.0, 3.0, f64::INFINITY] {
                assert_eq!(track.vector(late), [30.0, 40.0]);
            }
        }
        assert_eq!(track(&[1.0, 2.0], &[0.0, 4.0], Interpolation::Linear).vector(1.25), [1.0]);
        assert_eq!(track(&[1.0, 2.0], &[0.0, 4.0], Interpolation::Step).vector(1.99), [0.0]);
        assert_eq!(track(&[5.0], &[7.0], Interpolation::Linear).vector(9.0), [7.0]);
    }

    /// Exporters round frame / fps to single precision, to above it for half of the frames.
    #[test]
    fn a_frame_has_the_value_of_its_keyframe() {
        let frames = 0..240_u16;
        let times: Vec<f32> = frames.clone().map(|frame| (f64::from(frame) / 24.0) as f32).collect();
        let values: Vec<f32> = frames.clone().map(f32::from).collect();
        for interpolation in [Interpolation::Linear, Interpolation::Step] {
            let track = Track { times: &times, values: &values, width: 1, interpolation };
            for frame in frames.clone() {
                let error = track.vector(f64::from(frame) / 24.0)[0] - f64::from(frame);
                assert!(error.abs() < 1e-4, "{interpolation:?}, frame {frame}: {error}");
            }
        }
    }

    #[test]
    fn a_cubic_is_hermites() {
        // Keyframes: tangent before, value, tangent after; between the times 1 and 3.
        let track = track(&[1.0, 3.0], &[9.0, 2.0, 1.0, -2.0, 4.0, 9.0], Interpolation::CubicSpline);
        // By hand at u = ½: ½·2 + ½·4 + 2·(⅛·1 − ⅛·(−2)) = 3.75.
        assert_eq!(track.vector(2.0), [3.75]);
        assert_eq!(
            (track.vector(0.0), track.vector(1.0), track.vector(3.0)),
            (vec![2.0], vec![2.0], vec![4.0])
        );
        // It starts with the tangent after the first value and ends with the tangent before the second.
        let slope = |from: f64, to: f64| (track.vector(to)[0] - track.vector(from)[0]) / (to - from);
        assert!((slope(1.0, 1.0 + 1e-6) - 1.0).abs() < 1e-4);
        assert!((slope(3.0 - 1e-6, 3.0) + 2.0).abs() < 1e-4);
    }

    #[test]
    fn rotations_take_the_shorter_way_at_even_speed() {
        // From no rotation to a rotation by `angle` about z.
        for exponent in -30..=7 {
            let angle = 2f64.powi(exponent) * 0.0245;
            for sign in [1.0, -1.0] {
                let half = angle / 2.0;
                let to = [0.0, 0.0, half.sin(), half.cos()].map(|c| (sign * c) as f32);
                let values = [[0.0, 0.0, 0.0, 1.0], to].concat();
                let times = [0.0, 1.0];
                let track =
                    Track { times: &times, values: &values, width: 4, interpolation: Interpolation::Linear };
                // The exact angle of the rounded quaternion.
                let reached = 2.0 * f64::atan2(f64::from(to[2]) * sign, f64::from(to[3]) * sign);
                for part in [0.125, 0.5, 0.75] {
                    let at = track.rotation(part);
                    let turned = 2.0 * f64::atan2(at.z, at.w);
                    assert!((turned - part * reached).abs() < 1e-9, "{angle} {sign} {part}: {turned}");
                    assert!((at.length() - 1.0).abs() < 1e-12);
                }
            }
        }
    }

    #[test]
    fn antipodes_and_damaged_quaternions_are_survived() {
        let same = track(&[0.0, 1.0], &[0.0, 0.6, 0.0, 0.8, 0.0, -0.6, 0.0, -0.8], Interpolation::Linear);
        let at = same.rotation(0.5);
        assert!((at - DVec4::new(0.0, 0.6, 0.0, 0.8)).length() < 1e-6, "{at}");
        let bad = track(&[0.0, 1.0], &[0.0, 0.0, 0.0, 0.0, f32::NAN, 0.0, 0.0, 1.0], Interpolation::Linear);
        for time in [0.0, 0.5, 1.0] {
            bad.rotation(time);
        }
        let still = track(&[0.0, 0.0, f32::NAN, 1.0], &[1.0, 2.0, 3.0, 4.0], Interpolation::Linear);
        for time in [-1.0, 0.0, 0.5, 1.0, f64::NAN] {
            assert!((1.0..=4.0).contains(&still.vector(time)[0]));
        }
    }
}
