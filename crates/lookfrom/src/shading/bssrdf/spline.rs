//! Catmull–Rom splines through values at uneven nodes (Catmull & Rom 1974): evaluated, integrated and inverted.
//!
//! The derivative at a node is that of the chord between its neighbours; at the ends, that of the interval.

/// The weights of the values at a point of a spline.
#[derive(Clone, Copy, Debug)]
pub(super) struct Weights {
    /// The interval that contains the point: between the nodes of this index and the next.
    interval: usize,
    /// The weights of the nodes `interval` − 1 … `interval` + 2; 0 for those that do not exist.
    weights: [f64; 4],
}

impl Weights {
    /// At `x`; `None` outside of the nodes, which increase.
    pub(super) fn at(nodes: &[f64], x: f64) -> Option<Self> {
        let (first, last) = (*nodes.first()?, *nodes.last()?);
        if !(x >= first && x <= last) {
            return None;
        }
        let interval = nodes.partition_point(|node| *node <= x).clamp(1, nodes.len() - 1) - 1;
        let width = nodes[interval + 1] - nodes[interval];
        let t = (x - nodes[interval]) / width;
        let (t2, t3) = (t * t, t * t * t);
        let (of_start, of_end) = (t3 - 2.0 * t2 + t, t3 - t2);
        let mut weights = [0.0, 2.0 * t3 - 3.0 * t2 + 1.0, 3.0 * t2 - 2.0 * t3, 0.0];
        let before = if interval > 0 { interval - 1 } else { interval };
        let after = if interval + 2 < nodes.len() { interval + 2 } else { interval + 1 };
        let start = of_start * width / (nodes[interval + 1] - nodes[before]);
        let end = of_end * width / (nodes[after] - nodes[interval]);
        weights[2] += start;
        weights[before + 1 - interval] -= start;
        weights[after + 1 - interval] += end;
        weights[1] -= end;
        Some(Self { interval, weights })
    }

    /// The weighted sum of values at nodes.
    pub(super) fn sum(&self, value: impl Fn(usize) -> f64) -> f64 {
        let used = self.weights.iter().enumerate().filter(|(_, weight)| **weight != 0.0);
        used.map(|(k, weight)| weight * value(self.interval + k - 1)).sum()
    }
}

/// An interval of a spline, as a cubic of t from 0 to 1.
#[derive(Clone, Copy, Debug)]
struct Segment {
    start: f64,
    width: f64,
    /// Values at both ends …
    f: [f64; 2],
    /// … and derivatives by t.
    d: [f64; 2],
}

impl Segment {
    fn new(nodes: &[f64], value: &impl Fn(usize) -> f64, interval: usize) -> Self {
        let (i, j) = (interval, interval + 1);
        let width = nodes[j] - nodes[i];
        let slope = |from: usize, to: usize| width * (value(to) - value(from)) / (nodes[to] - nodes[from]);
        let after = if j + 1 < nodes.len() { j + 1 } else { j };
        Self {
            start: nodes[i],
            width,
            f: [value(i), value(j)],
            d: [slope(i.saturating_sub(1), j), slope(i, after)],
        }
    }

    /// The coefficients of 1, t, t², t³.
    fn cubic(&self) -> [f64; 4] {
        let ([f0, f1], [d0, d1]) = (self.f, self.d);
        [f0, d0, 3.0 * (f1 - f0) - 2.0 * d0 - d1, d0 + d1 + 2.0 * (f0 - f1)]
    }

    fn value(&self, t: f64) -> f64 {
        let [a, b, c, d] = self.cubic();
        a + t * (b + t * (c + t * d))
    }

    fn derivative(&self, t: f64) -> f64 {
        let [_, b, c, d] = self.cubic();
        b + t * (2.0 * c + t * 3.0 * d)
    }

    /// The integral from 0 to t, by t.
    fn integral(&self, t: f64) -> f64 {
        let [a, b, c, d] = self.cubic();
        t * (a + t * (b / 2.0 + t * (c / 3.0 + t * d / 4.0)))
    }

    fn x(&self, t: f64) -> f64 {
        self.start + t * self.width
    }
}

/// The integrals of a spline from the first node to each.
pub(super) fn integrals(nodes: &[f64], value: impl Fn(usize) -> f64) -> Vec<f64> {
    let mut sum = 0.0;
    let mut integrals = vec![0.0];
    for interval in 0..nodes.len() - 1 {
        let segment = Segment::new(nodes, &value, interval);
        sum += segment.width * segment.integral(1.0);
        integrals.push(sum);
    }
    integrals
}

/// The point where a spline of values that increase has the value `y`, or the end that is next to it.
pub(super) fn inverse(nodes: &[f64], value: impl Fn(usize) -> f64, y: f64) -> f64 {
    let Some(interval) = interval_of(nodes.len(), &value, y) else { return nodes[0] };
    if interval + 1 == nodes.len() {
        return nodes[interval];
    }
    let segment = Segment::new(nodes, &value, interval);
    segment.x(root(|t| (segment.value(t) - y, segment.derivative(t)), y))
}

/// The point before which the part `u` of a spline's integral lies, of values that are not negative.
pub(super) fn sample(
    nodes: &[f64],
    value: impl Fn(usize) -> f64,
    integral: impl Fn(usize) -> f64,
    u: f64,
) -> f64 {
    let wanted = u * integral(nodes.len() - 1);
    let interval = interval_of(nodes.len(), &integral, wanted).unwrap_or_default().min(nodes.len() - 2);
    let segment = Segment::new(nodes, &value, interval);
    let rest = (wanted - integral(interval)) / segment.width;
    segment.x(root(|t| (segment.integral(t) - rest, segment.value(t)), segment.integral(1.0)))
}

/// The last of `count` nodes whose value is at most `y`, where values increase.
fn interval_of(count: usize, value: &impl Fn(usize) -> f64, y: f64) -> Option<usize> {
    let (mut low, mut high) = (0, count);
    while low < high {
        let middle = low.midpoint(high);
        if value(middle) <= y {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    low.checked_sub(1)
}

/// The t in 0 … 1 where a function, given with its derivative, passes from below 0 to above, to a part of `size`: Newton's
/// method, by bisection where that leaves the bracket.
fn root(function: impl Fn(f64) -> (f64, f64), size: f64) -> f64 {
    const PRECISION: f64 = 1e-7;
    let (mut low, mut high, mut t) = (0.0, 1.0, 0.5);
    while high - low > PRECISION {
        let (value, derivative) = function(t);
        if value.abs() <= PRECISION * size.abs() {
            break;
        }
        *(if value < 0.0 { &mut low } else { &mut high }) = t;
        t -= value / derivative;
        if !(t > low && t < high) {
            t = 0.5 * (low + high);
        }
    }
    t
}
