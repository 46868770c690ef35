//! The up axis of a model, by its footprint on the ground.

use glam::Vec3;

/// The height above the lowest point, relative to that of the model, up to which points touch the ground.
const GROUND: f32 = 0.01;
/// The part of a model's ground plan on which it stands firmly, and the one on which it would fall over.
const FIRM: f32 = 0.25;
const TIPSY: f32 = 0.02;

/// The height of a model of which nobody says that it lies, in its least other side.
const HIGH: f32 = 0.5;

/// Whether a model would fall over if z were up, and stands firmly with y up: its file is not of its format's custom. What is flat with
/// z up lies on the bed of a printer, even if only clips or screws touch the bed.
pub(crate) fn stands_on_y<'a>(points: impl Iterator<Item = &'a Vec3> + Clone) -> bool {
    let bounds = |points: &mut dyn Iterator<Item = &'a Vec3>| {
        points.fold([Vec3::INFINITY, Vec3::NEG_INFINITY], |[min, max], p| [min.min(*p), max.max(*p)])
    };
    let [min, max] = bounds(&mut points.clone());
    let size = max - min;
    size.z > HIGH * size.x.min(size.y) && footprint(points.clone(), 1) > FIRM && footprint(points, 2) < TIPSY
}

/// The box around the points on the ground below an axis, as a part of the ground plan of all; 0 for flat models.
fn footprint<'a>(points: impl Iterator<Item = &'a Vec3> + Clone, axis: usize) -> f32 {
    let bounds = |points: &mut dyn Iterator<Item = &'a Vec3>| {
        points.fold([Vec3::INFINITY, Vec3::NEG_INFINITY], |[min, max], p| [min.min(*p), max.max(*p)])
    };
    let [min, max] = bounds(&mut points.clone());
    let lowest = min[axis] + GROUND * (max[axis] - min[axis]);
    let [from, to] = bounds(&mut points.filter(|point| point[axis] <= lowest));
    let area = |size: Vec3| size[(axis + 1) % 3] * size[(axis + 2) % 3];
    let part = area(to - from) / area(max - min);
    if part.is_finite() { part } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stool_stands_on_its_legs() {
        let legs = [[-1.0, 0.0, -1.0], [1.0, 0.0, -1.0], [1.0, 0.0, 1.2], [-1.0, 0.0, 1.2]];
        // Its seat looks out at one point below each other axis.
        let seat = [[0.0, 3.0, -2.0], [0.3, 2.9, 2.0]];
        let stool: Vec<Vec3> = legs.iter().chain(&seat).map(|&p| Vec3::from_array(p)).collect();
        assert!(stands_on_y(stool.iter()));
        let lying: Vec<Vec3> = stool.iter().map(|p| Vec3::new(p.x, -p.z, p.y)).collect();
        assert!(!stands_on_y(lying.iter()));
        // A plate on four clips, which are near its middle: at one of its edges it would stand, too.
        let plate = [[0.0, 0.0], [100.0, 0.0], [100.0, 80.0], [0.0, 80.0]];
        let plate = plate.iter().flat_map(|&[x, y]| [2.0, 6.0].map(|z| Vec3::new(x, y, z)));
        let clips =
            [[48.0, 40.0], [52.0, 40.0], [50.0, 42.0], [50.0, 38.0]].map(|[x, y]| Vec3::new(x, y, 0.0));
        let plate: Vec<Vec3> = plate.chain(clips).collect();
        assert!(footprint(plate.iter(), 1) > FIRM && footprint(plate.iter(), 2) < TIPSY);
        assert!(!stands_on_y(plate.iter()));
        // A box stands on anything, a flat shape on nothing.
        let corners: Vec<Vec3> =
            (0..8).map(|k| Vec3::new((k & 1) as f32, (k >> 1 & 1) as f32, (k >> 2) as f32)).collect();
        assert!(!stands_on_y(corners.iter()));
        assert!(!stands_on_y(corners[..4].iter()) && !stands_on_y([].iter()));
    }
}
