//! Chi-square statistics for tests.
//!
//! The conversion of chi-square to a normal deviate follows Wilson & Hilferty 1931.

/// Deviation of Pearson's chi-square of the counts from its expectation, in standard deviations. Cells with an
/// expected count below five are pooled. A deviation above 4.5 is significant (three in a million).
///
/// Infinite if anything was counted in cells whose expected count is 0.
pub(crate) fn chi_square_deviate(observed: &[u64], expected: &[f64]) -> f64 {
    assert_eq!(observed.len(), expected.len());
    let (mut statistic, mut cells) = (0.0, 0_u32);
    let (mut pooled_observed, mut pooled_expected) = (0.0, 0.0);
    for (&o, &e) in observed.iter().zip(expected) {
        if e < 5.0 {
            pooled_observed += o as f64;
            pooled_expected += e;
        } else {
            statistic += (o as f64 - e).powi(2) / e;
            cells += 1;
        }
    }
    if pooled_observed > 0.0 || pooled_expected > 0.0 {
        statistic += (pooled_observed - pooled_expected).powi(2) / pooled_expected;
        cells += 1;
    }
    let freedom = f64::from(cells.saturating_sub(1).max(1));
    let spread = 2.0 / (9.0 * freedom);
    ((statistic / freedom).cbrt() - (1.0 - spread)) / spread.sqrt()
}

/// The deviate that the largest of `tests` independent normal ones exceeds with a probability of about 0.01.
pub(crate) fn corrected_bound(tests: usize) -> f64 {
    let tail = 0.01 / tests as f64;
    let (mut low, mut high) = (0.0, 40.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if 0.5 * libm::erfc(middle / 2_f64.sqrt()) > tail { low = middle } else { high = middle }
    }
    high
}

#[test]
fn bounds_of_known_tails() {
    assert!((corrected_bound(1) - 2.3263).abs() < 1e-3);
    assert!((corrected_bound(10) - 3.0902).abs() < 1e-3);
}

#[test]
fn fair_dice_pass_and_loaded_dice_do_not() {
    let expected = [1000.0; 6];
    assert!(chi_square_deviate(&[1012, 987, 1020, 969, 1003, 1009], &expected).abs() < 3.0);
    assert!(chi_square_deviate(&[1200, 960, 960, 960, 960, 960], &expected) > 4.5);
    assert_eq!(chi_square_deviate(&[1000, 1], &[1000.0, 0.0]), f64::INFINITY);
}
