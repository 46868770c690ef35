//! The exposure that shows what is lit in a picture, in eighths of a stop.

use crate::core::math::luminance;
use crate::film::Picture;

/// The luminance that all but a few hundredths of what is lit are below.
const BRIGHT: f64 = 0.9;
const BRIGHT_QUANTILE: f64 = 0.97;
/// The least geometric mean of what is lit, even if lamps and windows become white by it.
const DARK: f64 = 0.03;
/// The fraction of a stop that exposures are rounded to, so that a person can repeat one.
const STEPS: f64 = 8.0;
/// The most stops, as in options.
const MOST: f64 = 64.0;

/// The exposure in stops; 0 where nothing is lit. Lamps and windows become white where the rest would be dark without.
pub(crate) fn stops(picture: &Picture) -> f32 {
    let mut lit: Vec<f64> = picture.pixels.iter().map(|&rgb| f64::from(luminance(rgb))).collect();
    lit.retain(|luminance| *luminance > 0.0 && luminance.is_finite());
    if lit.is_empty() {
        return 0.0;
    }
    lit.sort_by(f64::total_cmp);
    let bright = lit[((lit.len() - 1) as f64 * BRIGHT_QUANTILE).round() as usize];
    let mean = lit.iter().map(|luminance| libm::log2(*luminance)).sum::<f64>() / lit.len() as f64;
    let stops = (libm::log2(BRIGHT) - libm::log2(bright)).max(libm::log2(DARK) - mean);
    ((stops * STEPS).round() / STEPS).clamp(-MOST, MOST) as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(luminances: &[f32]) -> f32 {
        let pixels: Vec<_> = luminances.iter().map(|&value| [value; 3]).collect();
        stops(&Picture { width: luminances.len() as u32, height: 1, pixels, alpha: Vec::new() })
    }

    #[test]
    fn what_is_lit_becomes_bright() {
        assert_eq!(of(&[0.0, f32::NAN, f32::INFINITY]), 0.0);
        assert_eq!(of(&[0.9; 20]), 0.0);
        // Black surroundings do not count.
        let mut alone = vec![0.0; 1000];
        alone.extend([0.9 / 256.0; 10]);
        assert_eq!(of(&alone), 8.0);
        assert_eq!(of(&[0.9 * 1024.0; 5]), -10.0);
        assert_eq!(of(&[1e-38, 1e-40]), 64.0);
        // A room keeps its light where its lamp is white, but is not lost for a wide lamp.
        let mut room = vec![0.9; 98];
        room.extend([500.0; 2]);
        assert_eq!(of(&room), 0.0);
        let mut wide = vec![0.01; 70];
        wide.extend([1000.0; 30]);
        let dark = f64::from(of(&wide));
        assert!(dark > -10.0 && dark < -2.0, "{dark}");
        assert_eq!(of(&[1.0]) * 8.0, (of(&[1.0]) * 8.0).round());
    }
}
