//! Catmull–Rom splines through values at uneven nodes (Catmull & Rom 1974): evaluated, integrated and inverted.
//!
//! The derivative at a node is that of the chord between its neighbours; at the ends, that of the interval. Between two nodes a spline is
//! a cubic of the part t of the interval, from 0 to 1.

/// Bits of a number that are not in its key: a key is an exponent with two bits of the mantissa, a quarter of an octave.
const BELOW_KEY: u32 = 50;

/// Nodes of splines: at least two, that increase from 0.
#[derive(Debug)]
pub(super) struct Nodes {
    x: Vec<f64>,
    /// 1 / widths of the intervals.
    inverse_widths: Vec<f64>,
    /// The interval that contains the least number of each key, from that of the second node to the one after the last node's.
    first_intervals: Vec<usize>,
}

impl Nodes {
    pub(super) fn new(x: Vec<f64>) -> Self {
        let last_interval = x.len() - 2;
        let interval_at = |x0: f64| x.partition_point(|node| *node <= x0).clamp(1, last_interval + 1) - 1;
        let keys = key(x[1])..=key(x[last_interval + 1]) + 1;
        let first_intervals = keys.map(|key| interval_at(f64::from_bits(key << BELOW_KEY))).collect();
        let inverse_widths = x.windows(2).map(|pair| 1.0 / (pair[1] - pair[0])).collect();
        Self { x, inverse_widths, first_intervals }
    }

    /// The interval that contains `x`, by the index of the node before it, and the part t of it; `None` outside of the nodes.
    pub(super) fn place(&self, x: f64) -> Option<(usize, f64)> {
        if !(x >= 0.0 && x <= self.x[self.x.len() - 1]) {
            return None;
        }
        let interval = if x < self.x[1] {
            0
        } else {
            let above = (key(x) - key(self.x[1])) as usize;
            let (low, high) = (self.first_intervals[above], self.first_intervals[above + 1]);
            low + self.x[low + 1..=high].partition_point(|node| *node <= x)
        };
        Some((interval, (x - self.x[interval]) * self.inverse_widths[interval]))
    }

    /// The weights of the values at the nodes `interval` − 1 … `interval` + 2 in that of a spline, with their indices; those that do not
    /// exist have no weight and the index of another.
    pub(super) fn weights(&self, (interval, t): (usize, f64)) -> [(usize, f64); 4] {
        let last = self.x.len() - 1;
        let nodes = [interval.saturating_sub(1), interval, interval + 1, (interval + 2).min(last)];
        let x = nodes.map(|node| self.x[node]);
        let (t2, t3) = (t * t, t * t * t);
        let width = x[2] - x[1];
        let start = (t3 - 2.0 * t2 + t) * width / (x[2] - x[0]);
        let end = (t3 - t2) * width / (x[3] - x[1]);
        let weights = [-start, 2.0 * t3 - 3.0 * t2 + 1.0 - end, 3.0 * t2 - 2.0 * t3 + start, end];
        [0, 1, 2, 3].map(|k| (nodes[k], weights[k]))
    }

    /// The cubics of the spline through values at the nodes, by interval.
    pub(super) fn cubics(&self, values: &[f64]) -> Vec<Cubic> {
        let last = self.x.len() - 1;
        let chord = |from: usize, to: usize| (values[to] - values[from]) / (self.x[to] - self.x[from]);
        let cubic = |interval: usize| {
            let (i, j) = (interval, interval + 1);
            let width = self.x[j] - self.x[i];
            let (f0, f1) = (values[i], values[j]);
            let (d0, d1) = (width * chord(i.saturating_sub(1), j), width * chord(i, (j + 1).min(last)));
            Cubic([f0, d0, 3.0 * (f1 - f0) - 2.0 * d0 - d1, d0 + d1 + 2.0 * (f0 - f1)])
        };
        (0..last).map(cubic).collect()
    }

    /// The integrals of a spline from the first node to each.
    pub(super) fn integrals(&self, cubics: &[Cubic]) -> Vec<f64> {
        let mut integrals = vec![0.0];
        for (interval, cubic) in cubics.iter().enumerate() {
            integrals.push(integrals[interval] + self.width(interval) * cubic.integral(1.0));
        }
        integrals
    }

    /// The point where a spline that increases has the value `y`, or the end that is next to it.
    pub(super) fn inverse(&self, cubics: &[Cubic], y: f64) -> f64 {
        let Some(interval) = cubics.partition_point(|cubic| cubic.value(0.0) <= y).checked_sub(1) else {
            return self.x[0];
        };
        let cubic = &cubics[interval];
        if y >= cubic.value(1.0) {
            return self.x[interval + 1];
        }
        self.x(interval, root(|t| (cubic.value(t) - y, cubic.derivative(t)), y))
    }

    /// The point before which a part of a spline's integral lies, of values that are not negative: `wanted` of `integral` at the last node.
    pub(super) fn sample(
        &self,
        cubic: impl Fn(usize) -> Cubic,
        integral: impl Fn(usize) -> f64,
        wanted: f64,
    ) -> f64 {
        let (mut interval, mut end) = (0, self.inverse_widths.len());
        while interval + 1 < end {
            let middle = interval.midpoint(end);
            *(if integral(middle) <= wanted { &mut interval } else { &mut end }) = middle;
        }
        let cubic = cubic(interval);
        let rest = (wanted - integral(interval)) * self.inverse_widths[interval];
        self.x(interval, root(|t| (cubic.integral(t) - rest, cubic.value(t)), cubic.integral(1.0)))
    }

    fn width(&self, interval: usize) -> f64 {
        self.x[interval + 1] - self.x[interval]
    }

    fn x(&self, interval: usize, t: f64) -> f64 {
        self.x[interval] + t * self.width(interval)
    }
}

/// The exponent of a number that is not negative, with the first bits of its mantissa.
fn key(x: f64) -> u64 {
    x.to_bits() >> BELOW_KEY
}

/// The coefficients of 1, t, t², t³.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cubic(pub(super) [f64; 4]);

impl Cubic {
    pub(super) fn value(&self, t: f64) -> f64 {
        let [a, b, c, d] = self.0;
        a + t * (b + t * (c + t * d))
    }

    fn derivative(&self, t: f64) -> f64 {
        let [_, b, c, d] = self.0;
        b + t * (2.0 * c + t * 3.0 * d)
    }

    /// The integral from 0 to t, by t.
    fn integral(&self, t: f64) -> f64 {
        let [a, b, c, d] = self.0;
        t * (a + t * (0.5 * b + t * ((1.0 / 3.0) * c + t * (0.25 * d))))
    }
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
