//! The estimated gain of a guide: the ratio of the second moments of light samples without it and with it.

/// The part of the light that surfaces reflect, as far as the gain of a guide is concerned.
const REFLECTED: f32 = 0.5;

/// The first two moments of numbers.
#[derive(Clone, Copy)]
pub(super) struct Moments {
    /// The mean.
    pub(super) mean: f32,
    /// The mean square.
    pub(super) square: f32,
}

impl Moments {
    /// The moments of this number of terms, of which others than those given are zero.
    pub(super) fn of(terms: impl Iterator<Item = f32>, count: u32) -> Self {
        let (sum, squares) =
            terms.fold((0.0, 0.0), |(sum, squares), term| (sum + term, squares + term * term));
        Self { mean: sum / count as f32, square: squares / count as f32 }
    }
}

/// The irradiance at the points of a leaf, as samples of the environment estimate it.
pub(super) struct Lit {
    /// Number of points.
    count: f32,
    /// The mean.
    mean: f32,
    /// The mean square of one sample without a guide, and with one.
    squares: [f32; 2],
}

impl Lit {
    /// At so many points without a histogram.
    pub(super) fn without(count: usize, samples: Moments) -> Self {
        Self { count: count as f32, mean: samples.mean, squares: [samples.square; 2] }
    }

    /// At so many points with a histogram that chooses a share of the samples: the irradiance by what it knows, of which a sample
    /// without it finds `found` or nothing, and that by what it leaves to the environment.
    pub(super) fn with(count: usize, share: f32, known: f32, found: f32, left: Moments) -> Self {
        let by_others = if share < 1.0 { left.square / (1.0 - share) } else { 0.0 };
        Self {
            count: count as f32,
            mean: known + left.mean,
            squares: [found * known + left.square, known * known / share + by_others],
        }
    }
}

/// The ratio of the second moments of light samples without a guide and with one, each relative to the squared light at its point. Of
/// indirect light the same part reaches all points, with the second moment of all light samples.
pub(super) fn gain(lit: &[Lit], points: usize) -> f32 {
    let over_points =
        |of: &dyn Fn(&Lit) -> f32| lit.iter().map(|lit| lit.count * of(lit)).sum::<f32>() / points as f32;
    let indirect = over_points(&|lit| lit.mean) * REFLECTED / (1.0 - REFLECTED);
    let [without, with] = [0, 1].map(|guided| {
        let of_others = over_points(&|lit| lit.squares[guided]) * REFLECTED * REFLECTED;
        over_points(&|lit| {
            let light = lit.mean + indirect;
            (lit.squares[guided] + of_others) / (light * light)
        })
    });
    without / with
}
