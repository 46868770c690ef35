//! Filters after decoding: vectors, quaternions, floats and colours stored in fewer bits.

use super::Filter;

/// Replaces encoded elements of `stride` bytes by their values. Results that the extension leaves unspecified are
/// arbitrary, but never cause a panic.
pub(super) fn apply(filter: Filter, stride: usize, bytes: &mut [u8]) {
    match filter {
        Filter::None => {}
        Filter::Octahedral => integers(stride, bytes, octahedral),
        Filter::Quaternion => integers(stride, bytes, |element, _| quaternion(element)),
        Filter::Exponential => bytes.as_chunks_mut().0.iter_mut().for_each(exponential),
        Filter::Color => integers(stride, bytes, color),
    }
}

/// Applies `f` to every four integers of 8 or 16 bits, sign-extended, with the maximum of their type.
fn integers(stride: usize, bytes: &mut [u8], f: impl Fn([i32; 4], i32) -> [i32; 4]) {
    if stride == 4 {
        for element in bytes.as_chunks_mut::<4>().0 {
            let signed = element.map(|byte| i32::from(byte.cast_signed()));
            *element = f(signed, 127).map(|value| value as u8);
        }
    } else {
        for element in bytes.as_chunks_mut::<8>().0 {
            let signed = [0, 2, 4, 6].map(|i| i32::from(i16::from_le_bytes([element[i], element[i + 1]])));
            let words = f(signed, 32767).map(|value| (value as u16).to_le_bytes());
            element.copy_from_slice(words.as_flattened());
        }
    }
}

/// A unit vector from octahedral encoding (Meyer et al. 2010); the third number stands for 1.
fn octahedral([x, y, one, rest]: [i32; 4], most: i32) -> [i32; 4] {
    let (x, y) = (x as f32 / one as f32, y as f32 / one as f32);
    let z = 1.0 - x.abs() - y.abs();
    // The lower hemisphere is folded over the edges of the upper.
    let fold = z.min(0.0);
    let (x, y) = (x - fold.copysign(x), y - fold.copysign(y));
    let length = (x * x + y * y + z * z).sqrt();
    let [x, y, z] = [x, y, z].map(|c| (c / length * most as f32).round() as i32);
    [x, y, z, rest]
}

/// A unit quaternion from three of its components and the index of the largest.
fn quaternion([x, y, z, code]: [i32; 4]) -> [i32; 4] {
    let scale = 1.0 / ((code | 3) as f32 * std::f32::consts::SQRT_2);
    let [x, y, z] = [x, y, z].map(|c| c as f32 * scale);
    let w = (1.0 - x * x - y * y - z * z).max(0.0).sqrt();
    let mut components = [w, x, y, z].map(|c| (c * 32767.0).round() as i32);
    components.rotate_right((code & 3) as usize);
    components
}

/// A float from a mantissa of 24 and an exponent of 8 bits.
fn exponential(bytes: &mut [u8; 4]) {
    let bits = i32::from_le_bytes(*bytes);
    *bytes = libm::ldexpf(((bits << 8) >> 8) as f32, bits >> 24).to_le_bytes();
}

/// Red, green, blue and alpha from YCoCg luma and chroma, and an alpha whose highest bit gives the bit width of all.
fn color([y, orange, green, alpha]: [i32; 4], most: i32) -> [i32; 4] {
    let unsigned = 2 * most + 1;
    let (y, alpha) = (y & unsigned, alpha & unsigned);
    let width = alpha.checked_ilog2().unwrap_or(0);
    let greatest = (2 << width) - 1;
    let alpha = alpha & (greatest >> 1);
    let rgba = [y + orange - green, y + green, y - orange - green, (alpha << 1) | (alpha & 1)];
    let scale = unsigned as f32 / greatest as f32;
    rgba.map(|c| (c as f32 * scale).round() as i32)
}
