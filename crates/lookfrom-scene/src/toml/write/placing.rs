//! Transforms and motions: as steps where these give the same bits, else as matrices.

use glam::{DMat4, DVec3};

use super::text::{Fields, Item};
use crate::motion::Motion;
use crate::toml::quadric::along;

/// Whether two matrices are the same, the signs of zeros included.
pub(super) fn same_bits(a: &DMat4, b: &DMat4) -> bool {
    let bits = |matrix: &DMat4| matrix.to_cols_array().map(f64::to_bits);
    bits(a) == bits(b)
}

/// The center and the axis by which keys give the matrix of a shape around the z axis (`around` of the reader), if it is
/// one of these, and not the identity.
pub(super) fn center_and_axis(matrix: &DMat4) -> Option<(DVec3, DVec3)> {
    let (center, axis) = (matrix.w_axis.truncate(), matrix.z_axis.truncate());
    let own = along(center, axis.normalize());
    let is_placed = same_bits(matrix, &(DMat4::IDENTITY * own)) && *matrix != DMat4::IDENTITY;
    is_placed.then_some((center, axis))
}

/// 16 numbers, row by row.
pub(super) fn put_matrix(fields: &mut Fields, key: &str, matrix: &DMat4) {
    fields.put(key, Item::from(matrix));
}

/// The transform of a table, to its parent's space.
pub(super) fn put_transform(fields: &mut Fields, matrix: &DMat4) {
    let translate = matrix.w_axis.truncate();
    let scale = DVec3::new(matrix.x_axis.x, matrix.y_axis.y, matrix.z_axis.z);
    // As the reader computes them, one step after the other, and then after the shape's own space.
    let [of_scale, of_translate] = [DMat4::from_scale(scale), DMat4::from_translation(translate)];
    let placed =
        |steps: &[DMat4]| steps.iter().fold(DMat4::IDENTITY, |before, step| *step * before) * DMat4::IDENTITY;
    if same_bits(matrix, &DMat4::IDENTITY) {
        return;
    }
    if same_bits(matrix, &placed(&[of_translate])) {
        fields.put("translate", translate);
    } else if same_bits(matrix, &placed(&[of_scale])) {
        put_scale(fields, scale);
    } else if same_bits(matrix, &placed(&[of_scale, of_translate])) {
        put_scale(fields, scale);
        fields.put("translate", translate);
    } else {
        fields.put("transform", Item::List(vec![Fields::one("matrix", Item::from(matrix)).into()]));
    }
}

fn put_scale(fields: &mut Fields, scale: DVec3) {
    match scale == DVec3::splat(scale.x) {
        true => fields.put("scale", scale.x),
        false => fields.put("scale", scale),
    }
}

/// The maps of what moves while the shutter is open.
pub(super) fn put_motion(fields: &mut Fields, motion: Option<&Motion>) {
    if let Some(motion) = motion {
        fields.put("motion", Item::list(motion.maps()));
    }
}
