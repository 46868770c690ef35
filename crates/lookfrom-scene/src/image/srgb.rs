//! The sRGB transfer function (IEC 61966-2-1, 1999).

/// Linear light from an sRGB-encoded value; both nominally in [0, 1].
pub fn linear_from_srgb(encoded: f32) -> f32 {
    if encoded <= 0.04045 { encoded / 12.92 } else { libm::powf((encoded + 0.055) / 1.055, 2.4) }
}

/// The sRGB-encoded value of linear light; both nominally in [0, 1].
pub fn srgb_from_linear(linear: f32) -> f32 {
    if linear <= 0.003_130_8 { linear * 12.92 } else { 1.055 * libm::powf(linear, 1.0 / 2.4) - 0.055 }
}

#[cfg(test)]
mod tests {
    use super::{linear_from_srgb, srgb_from_linear};

    #[test]
    fn every_byte_comes_back() {
        for byte in 0..=255_u8 {
            let encoded = f32::from(byte) / 255.0;
            assert_eq!((srgb_from_linear(linear_from_srgb(encoded)) * 255.0 + 0.5) as u8, byte);
        }
    }

    #[test]
    fn middle_gray_is_dark_in_light() {
        assert!((linear_from_srgb(0.5) - 0.214_041).abs() < 1e-6);
        assert_eq!((linear_from_srgb(0.0), linear_from_srgb(1.0)), (0.0, 1.0));
    }
}
