//! Conversions of affine maps from and to those of the crate `glam`, which has columns where [`Affine`] has rows.

use glam::{DAffine3, DMat3, DVec3};

use super::Affine;

impl From<DAffine3> for Affine {
    fn from(map: DAffine3) -> Self {
        let rows = map.matrix3.transpose();
        Self {
            matrix: [rows.x_axis, rows.y_axis, rows.z_axis].map(|row| row.to_array()),
            translation: map.translation.to_array(),
        }
    }
}

impl From<Affine> for DAffine3 {
    fn from(map: Affine) -> Self {
        let matrix3 = DMat3::from_cols_array_2d(&map.matrix).transpose();
        Self { matrix3, translation: DVec3::from_array(map.translation) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rotation_is_not_transposed() {
        let turned = DAffine3::from_rotation_z(0.5) * DAffine3::from_translation(DVec3::new(1.0, 2.0, 3.0));
        let map = Affine::from(turned);
        for p in [[0.0; 3], [1.0, 0.0, 0.0], [0.5, -2.0, 4.0]] {
            assert_eq!(map.vector(p), turned.transform_vector3(p.into()).to_array());
            let difference = DVec3::from(map.point(p)) - turned.transform_point3(p.into());
            assert!(difference.length() < 1e-15, "{difference}");
        }
        assert_eq!(DAffine3::from(map), turned);
    }
}
