//! Motion while the shutter is open.

use glam::{DMat3, DMat4, DQuat, DVec3};

/// Turn between two maps of a motion, in radians: entries are linear in between, which differs from the rotation by an eighth
/// of the square of this, 1.2 · 10⁻⁴ of the distance from the axis.
const LARGEST_TURN: f64 = 1.0 / 32.0;

/// The most parts of a motion.
const MOST_PARTS: usize = 256;

/// The motion of a space while the shutter is open: its affine maps to the world at equally spaced times from the opening to the
/// closing, of which every entry is linear in between.
///
/// The number of parts between two times is a power of two, so that a motion is the same in a larger number of parts.
#[derive(Clone, Debug, PartialEq)]
pub struct Motion {
    maps: Vec<DMat4>,
}

impl Motion {
    /// The motion from one map to another, as pbrt interpolates them: translation and stretch linearly, rotation about one axis
    /// with constant speed (Shoemake, Duff 1992, "Matrix Animation and Polar Decomposition"). `fractions` are the parts of that
    /// way at the opening and at the closing of the shutter; before 0 and after 1 it stands still.
    ///
    /// `None` where nothing moves, or a map has no inverse.
    pub fn between(start: &DMat4, end: &DMat4, fractions: [f64; 2]) -> Option<Self> {
        let [open, close] = fractions;
        if start == end
            || !(open.is_finite() && close.is_finite())
            || open.max(close) <= 0.0
            || open.min(close) >= 1.0
        {
            return None;
        }
        let [from, to] = [start, end].map(Parts::of);
        let (from, to) = (from?, to?);
        let cosine = from.rotation.dot(to.rotation);
        let to = Parts { rotation: if cosine < 0.0 { -to.rotation } else { to.rotation }, ..to };
        let turn = 2.0 * libm::acos(cosine.abs().min(1.0)) * (close - open).abs();
        let has_bend = open.min(close) < 0.0 || open.max(close) > 1.0;
        let parts = ((turn / LARGEST_TURN) as usize + 1).max(if has_bend { 64 } else { 1 });
        let parts = parts.next_power_of_two().min(MOST_PARTS);
        let at = |part: usize| {
            let fraction = open + (close - open) * (part as f64 / parts as f64);
            from.toward(&to, fraction.clamp(0.0, 1.0))
        };
        Some(Self { maps: (0..=parts).map(at).collect() })
    }

    /// The motion through maps at equally spaced times, 2ᵏ + 1 for a k ≥ 0, between two of which it is as [`Self::between`] has it.
    /// `None` for other numbers of maps, where nothing moves, or a map has no inverse.
    pub fn through(maps: &[DMat4]) -> Option<Self> {
        if maps.iter().all(|map| *map == maps[0]) {
            return None;
        }
        let ways = maps.windows(2).map(|pair| match pair[0] == pair[1] {
            true => Some(Self { maps: pair.to_vec() }),
            false => Self::between(&pair[0], &pair[1], [0.0, 1.0]),
        });
        let ways: Vec<Self> = ways.collect::<Option<_>>()?;
        let parts = ways.iter().map(Self::parts).max()?;
        let mut all = vec![maps[0]];
        ways.iter().for_each(|way| all.extend(way.in_parts(parts).into_iter().skip(1)));
        Self::of_maps(all)
    }

    /// No motion, but a place.
    pub(crate) fn standing(map: DMat4) -> Self {
        Self { maps: vec![map; 2] }
    }

    /// The motion of what moves by another in a space that moves by this one.
    pub(crate) fn of(&self, inner: &Self) -> Self {
        // A product of two motions is not linear.
        let parts = self.parts().max(inner.parts()).max(16);
        let [outer, inner] = [self, inner].map(|motion| motion.in_parts(parts));
        Self { maps: outer.iter().zip(inner).map(|(outer, inner)| *outer * inner).collect() }
    }

    /// The motion with these maps: 2ᵏ + 1 for a k ≥ 0. `None` for other numbers, and where nothing moves.
    pub fn of_maps(maps: Vec<DMat4>) -> Option<Self> {
        let is_count = maps.len() > 1 && (maps.len() - 1).is_power_of_two();
        (is_count && maps.iter().any(|map| *map != maps[0])).then_some(Self { maps })
    }

    /// The maps at equally spaced times.
    pub fn maps(&self) -> &[DMat4] {
        &self.maps
    }

    /// The number of parts between two maps.
    pub fn parts(&self) -> usize {
        self.maps.len() - 1
    }

    /// Bytes of its maps.
    pub fn bytes(&self) -> u64 {
        size_of_val(&*self.maps) as u64
    }

    /// The map when the shutter opens.
    pub fn at_opening(&self) -> DMat4 {
        self.maps[0]
    }

    /// The map at a time, from 0 at the opening to 1 at the closing.
    pub fn at(&self, time: f64) -> DMat4 {
        let place = time.clamp(0.0, 1.0) * self.parts() as f64;
        let earlier = (place as usize).min(self.parts() - 1);
        let fraction = place - earlier as f64;
        self.maps[earlier] * (1.0 - fraction) + self.maps[earlier + 1] * fraction
    }

    /// The maps of this motion in a number of parts that is a multiple of its own.
    fn in_parts(&self, parts: usize) -> Vec<DMat4> {
        (0..=parts).map(|part| self.at(part as f64 / parts as f64)).collect()
    }

    /// This motion with each of its maps changed.
    #[must_use]
    pub fn with(&self, change: impl FnMut(&DMat4) -> DMat4) -> Self {
        Self { maps: self.maps.iter().map(change).collect() }
    }
}

/// The parts of an affine map: first a stretch, then a rotation, then a translation.
struct Parts {
    translation: DVec3,
    rotation: DQuat,
    /// Reflections are part of it.
    stretch: DMat3,
}

impl Parts {
    /// The polar decomposition, by Newton's iteration of Higham (1986), "Computing the Polar Decomposition—with Applications".
    fn of(map: &DMat4) -> Option<Self> {
        let linear = DMat3::from_mat4(*map);
        let mut rotation = linear;
        for _ in 0..100 {
            let next = (rotation + rotation.inverse().transpose()) * 0.5;
            if !next.is_finite() {
                return None;
            }
            let change = next - rotation;
            rotation = next;
            let columns = [change.x_axis, change.y_axis, change.z_axis];
            if columns.iter().all(|column| column.abs().max_element() < 1e-14) {
                break;
            }
        }
        if rotation.determinant() < 0.0 {
            rotation *= -1.0;
        }
        let stretch = rotation.transpose() * linear;
        Some(Self {
            translation: map.w_axis.truncate(),
            rotation: DQuat::from_mat3(&rotation).normalize(),
            stretch,
        })
    }

    /// The map on the way to another, whose quaternion is on the same half of the sphere.
    fn toward(&self, other: &Self, fraction: f64) -> DMat4 {
        let rest = 1.0 - fraction;
        let translation = self.translation * rest + other.translation * fraction;
        let stretch = self.stretch * rest + other.stretch * fraction;
        let linear = DMat3::from_quat(slerp(self.rotation, other.rotation, fraction)) * stretch;
        DMat4::from_mat3_translation(linear, translation)
    }
}

/// Spherical linear interpolation (Shoemake 1985, "Animating Rotation with Quaternion Curves") of quaternions that form an acute
/// angle. By `libm`: the same bits on every machine.
fn slerp(from: DQuat, to: DQuat, fraction: f64) -> DQuat {
    let angle = libm::acos(from.dot(to).min(1.0));
    let sine = libm::sin(angle);
    if sine < 1e-9 {
        return (from * (1.0 - fraction) + to * fraction).normalize();
    }
    let weight = |part: f64| libm::sin(part * angle) / sine;
    (from * weight(1.0 - fraction) + to * weight(fraction)).normalize()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wheel_turns_with_constant_speed() {
        let [start, end] = [0.0_f64, 90.0].map(|degrees| {
            DMat4::from_translation(DVec3::X)
                * DMat4::from_rotation_z(degrees.to_radians())
                * DMat4::from_scale(DVec3::splat(2.0))
        });
        let motion = Motion::between(&start, &end, [0.0, 1.0]).unwrap();
        assert_eq!(motion.parts(), 64);
        for time in [0.0, 0.1, 1.0 / 3.0, 0.5, 0.77, 1.0] {
            let rim = motion.at(time).transform_point3(DVec3::X);
            let angle = (90.0_f64 * time).to_radians();
            let expected = DVec3::new(1.0 + 2.0 * angle.cos(), 2.0 * angle.sin(), 0.0);
            assert!((rim - expected).length() < 2.5e-4, "{rim} instead of {expected}");
        }
        assert_eq!(motion.in_parts(128)[2], motion.maps()[1]);
        // Half of the way, and none of it.
        let half = Motion::between(&start, &end, [0.25, 0.75]).unwrap();
        assert!((half.at(0.5) - motion.at(0.5)).abs_diff_eq(DMat4::ZERO, 1e-12));
        assert_eq!(Motion::between(&start, &end, [1.5, 2.0]), None);
        assert_eq!(Motion::between(&start, &start, [0.0, 1.0]), None);
    }

    #[test]
    fn ends_are_kept_whatever_the_map() {
        let shear = DMat4::from_cols_array(&[
            -2.0, 0.3, 0.0, 0.0, 0.5, 1.0, 0.1, 0.0, 0.0, 0.2, 1e-3, 0.0, 5.0, -4.0, 3e3, 1.0,
        ]);
        let mirror = DMat4::from_scale(DVec3::new(-1.0, 1.0, 1.0));
        for (start, end) in
            [(shear, mirror), (DMat4::IDENTITY, shear), (shear, shear * DMat4::from_rotation_x(3.1))]
        {
            let motion = Motion::between(&start, &end, [0.0, 1.0]).unwrap();
            for (time, expected) in [(0.0, start), (1.0, end)] {
                let error = motion.at(time) - expected;
                let largest = error.to_cols_array().iter().fold(0.0_f64, |largest, x| largest.max(x.abs()));
                assert!(largest < 1e-11 * 3e3, "{largest}");
            }
        }
    }

    #[test]
    fn maps_are_a_power_of_two_and_one() {
        let maps = |count: usize| (0..count).map(|k| DMat4::from_translation(DVec3::X * k as f64)).collect();
        assert!([2, 3, 5, 9].iter().all(|&count| Motion::of_maps(maps(count)).is_some()));
        assert!([0, 1, 4, 6].iter().all(|&count| Motion::of_maps(maps(count)).is_none()));
        assert!(Motion::of_maps(vec![DMat4::IDENTITY; 3]).is_none());
    }
}
