//! False colours of numbers, and bytes of colours.

/// A false colour of 0 … 1, brighter for more; NaN is black.
pub(crate) fn heat(value: f32) -> [f32; 3] {
    const STOPS: [[f32; 3]; 6] = [
        [0.0, 0.0, 0.0],
        [0.16, 0.07, 0.42],
        [0.55, 0.13, 0.45],
        [0.89, 0.33, 0.24],
        [0.98, 0.68, 0.15],
        [1.0, 1.0, 0.85],
    ];
    let place = value.clamp(0.0, 1.0) * (STOPS.len() - 1) as f32;
    let index = (place as usize).min(STOPS.len() - 2);
    let share = if place.is_nan() { 0.0 } else { place - index as f32 };
    std::array::from_fn(|c| STOPS[index][c] + share * (STOPS[index + 1][c] - STOPS[index][c]))
}

/// The byte of a value in 0 … 1.
pub(crate) fn byte(value: f32) -> u8 {
    (255.0 * value.clamp(0.0, 1.0) + 0.5) as u8
}
