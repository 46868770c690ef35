//! The frame in which a tree is built: the middle of its box is the origin, and half of its largest extent 1 to 2 units.

/// From the world to a tree: `scale · (p − origin)`. The scale is a power of two, so scaling does not round.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Frame {
    pub(super) origin: [f64; 3],
    pub(super) scale: f64,
}

/// A box; empty where a minimum is greater than the maximum.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bounds {
    pub(super) min: [f64; 3],
    pub(super) max: [f64; 3],
}

impl Bounds {
    pub(super) const EMPTY: Self = Self { min: [f64::INFINITY; 3], max: [f64::NEG_INFINITY; 3] };

    /// Grows to contain a ball around a point.
    pub(super) fn add(&mut self, p: [f64; 3], radius: f64) {
        for axis in 0..3 {
            self.min[axis] = self.min[axis].min(p[axis] - radius);
            self.max[axis] = self.max[axis].max(p[axis] + radius);
        }
    }

    pub(super) fn contain(&self, p: [f64; 3]) -> bool {
        (0..3).all(|axis| self.min[axis] <= p[axis] && p[axis] <= self.max[axis])
    }

    pub(super) fn is_empty(&self) -> bool {
        (0..3).any(|axis| self.min[axis] > self.max[axis])
    }
}

impl Frame {
    /// The frame of everything in a box.
    pub(super) fn around(bounds: &Bounds) -> Self {
        if bounds.is_empty() {
            return Self { origin: [0.0; 3], scale: 1.0 };
        }
        // Halved first: the sum may be beyond f64.
        let origin = [0, 1, 2].map(|axis| 0.5 * bounds.min[axis] + 0.5 * bounds.max[axis]);
        let half = (0..3).fold(0.0_f64, |most, axis| most.max(bounds.max[axis] - origin[axis]));
        Self { origin, scale: to_unit(half) }
    }

    /// True if a box can do with this frame: it is within twice the frame's size, and not much smaller.
    pub(super) fn still_fits(&self, bounds: &Bounds) -> bool {
        let size = (0..3).fold(0.0_f64, |most, axis| most.max(bounds.max[axis] - bounds.min[axis]));
        let [min, max] = [bounds.min, bounds.max].map(|p| largest(self.point(p)));
        !bounds.is_empty() && min <= 4.0 && max <= 4.0 && size * self.scale >= 0.5
    }

    /// A point in the frame.
    pub(super) fn point(&self, p: [f64; 3]) -> [f64; 3] {
        [0, 1, 2].map(|axis| (p[axis] - self.origin[axis]) * self.scale)
    }

    /// A point in the frame, rounded.
    pub(super) fn rounded(&self, p: [f64; 3]) -> [f32; 3] {
        self.point(p).map(|x| x as f32)
    }
}

/// The power of two that brings a size to 1 … 2. For sizes at the ends of f64's range one that brings it near; 1 for 0.
pub(super) fn to_unit(size: f64) -> f64 {
    if size == 0.0 {
        return 1.0;
    }
    let exponent = size.to_bits() >> 52 & 0x7ff;
    f64::from_bits((2046_u64.saturating_sub(exponent)).clamp(1, 2045) << 52)
}

/// The largest magnitude of a component; a NaN if one is a NaN.
pub(super) fn largest([x, y, z]: [f64; 3]) -> f64 {
    x.abs().max(y.abs()).max(z.abs()) + 0.0 * x + 0.0 * y + 0.0 * z
}

pub(super) fn subtract(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|axis| a[axis] - b[axis])
}

pub(super) fn times(a: [f64; 3], s: f64) -> [f64; 3] {
    a.map(|x| x * s)
}

pub(super) fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(super) fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}
