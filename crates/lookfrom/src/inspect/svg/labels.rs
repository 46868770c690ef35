//! Labels of a drawing, placed one after another where they hide least (after Christensen, Marks & Shieber 1995).

use glam::DVec2;

/// Height of a line of text.
pub(super) const FONT: f64 = 13.0;

/// Distances of a label from its anchor.
const DISTANCES: [f64; 6] = [8.0, 20.0, 36.0, 56.0, 80.0, 110.0];

/// The cost of a label on another.
const OVERLAPS: f64 = 1e6;

/// A text that wants to be near a point.
pub(super) struct Label {
    pub(super) anchor: DVec2,
    pub(super) text: String,
    pub(super) color: &'static str,
    pub(super) is_bold: bool,
}

/// The place of a label.
pub(super) struct Placed {
    pub(super) label: Label,
    pub(super) low: DVec2,
    pub(super) high: DVec2,
}

impl Label {
    /// An upper estimate of its size in any sans-serif font.
    fn size(&self) -> DVec2 {
        let wide = if self.is_bold { 0.66 } else { 0.6 };
        DVec2::new(wide * FONT * self.text.chars().count() as f64 + 4.0, FONT + 4.0)
    }
}

impl Placed {
    fn overlaps(&self, low: DVec2, high: DVec2) -> bool {
        low.cmplt(self.high).all() && self.low.cmplt(high).all()
    }

    /// The point of the box that is nearest to the anchor.
    pub(super) fn nearest(&self) -> DVec2 {
        self.label.anchor.clamp(self.low, self.high)
    }
}

/// Places labels inside a frame. Overlaps of labels cost most, then those of `rays`, then those of the `scene`, then
/// distance from the anchor.
pub(super) fn place(
    labels: Vec<Label>,
    frame: [DVec2; 2],
    rays: &[[DVec2; 2]],
    scene: &[[DVec2; 2]],
) -> Vec<Placed> {
    let mut placed: Vec<Placed> = Vec::new();
    for label in labels {
        let size = label.size();
        // Most lines are far away.
        let reach = size + DISTANCES[DISTANCES.len() - 1];
        let around = [label.anchor - reach, label.anchor + reach];
        let [rays, scene] = [rays, scene].map(|lines| near(lines, around));
        let mut best = (f64::INFINITY, DVec2::ZERO);
        for distance in DISTANCES {
            for step in 0..16 {
                let (sin, cos) = libm::sincos(std::f64::consts::TAU * f64::from(step) / 16.0);
                let middle = label.anchor + DVec2::new(cos, -sin) * (0.5 * size + distance);
                let (low, high) = (middle - 0.5 * size, middle + 0.5 * size);
                if low.cmplt(frame[0]).any() || high.cmpgt(frame[1]).any() {
                    continue;
                }
                let count = |lines: &[[DVec2; 2]]| {
                    lines.iter().filter(|line| crosses(line, low, high)).count() as f64
                };
                let hidden = placed.iter().filter(|other| other.overlaps(low, high)).count() as f64;
                let anchors =
                    placed.iter().filter(|other| contains(low, high, other.label.anchor)).count() as f64;
                let cost = OVERLAPS * hidden
                    + 100.0 * (count(&rays) + anchors)
                    + 4.0 * count(&scene).min(20.0)
                    + distance;
                if cost < best.0 {
                    best = (cost, low);
                }
            }
        }
        // A label that has no place, or only one on another, is left out: hovering over its ray still tells.
        if best.0 < OVERLAPS {
            placed.push(Placed { label, low: best.1, high: best.1 + size });
        }
    }
    placed
}

/// The lines that cross a box.
fn near(lines: &[[DVec2; 2]], [low, high]: [DVec2; 2]) -> Vec<[DVec2; 2]> {
    lines.iter().filter(|line| crosses(line, low, high)).copied().collect()
}

fn contains(low: DVec2, high: DVec2, point: DVec2) -> bool {
    low.cmple(point).all() && point.cmple(high).all()
}

/// Whether a line segment crosses a box (Liang & Barsky 1984).
fn crosses(&[from, to]: &[DVec2; 2], low: DVec2, high: DVec2) -> bool {
    let way = to - from;
    let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
    for axis in 0..2 {
        if way[axis] == 0.0 {
            if from[axis] < low[axis] || from[axis] > high[axis] {
                return false;
            }
            continue;
        }
        let [a, b] = [low, high].map(|side| (side[axis] - from[axis]) / way[axis]);
        (enter, leave) = (enter.max(a.min(b)), leave.min(a.max(b)));
    }
    enter <= leave
}

#[cfg(test)]
mod tests {
    use super::*;

    fn label(x: f64, y: f64) -> Label {
        Label { anchor: DVec2::new(x, y), text: "12".into(), color: "#000", is_bold: false }
    }

    #[test]
    fn labels_avoid_each_other_and_lines() {
        let frame = [DVec2::ZERO, DVec2::splat(200.0)];
        let line = [DVec2::new(0.0, 100.0), DVec2::new(200.0, 100.0)];
        let placed = place((0..6).map(|_| label(100.0, 100.0)).collect(), frame, &[line], &[]);
        assert_eq!(placed.len(), 6);
        for (index, one) in placed.iter().enumerate() {
            assert!(!crosses(&line, one.low, one.high));
            assert!(one.low.cmpge(frame[0]).all() && one.high.cmple(frame[1]).all());
            assert!(placed[..index].iter().all(|other| !other.overlaps(one.low, one.high)));
        }
    }

    #[test]
    fn labels_without_a_place_are_left_out() {
        let frame = [DVec2::ZERO, DVec2::new(60.0, 40.0)];
        let placed = place((0..50).map(|_| label(30.0, 20.0)).collect(), frame, &[], &[]);
        assert!(!placed.is_empty() && placed.len() < 50);
    }
}
