//! The inspection of a pixel as text: colour, largest contributions, then every sample, the brightest first.

use std::fmt::{self, Display, Formatter, Write};

use lookfrom_scene::plural::are;

use super::{digits, short, write_wrapped};
use crate::inspect::{Contribution, Inspection, PixelInspection};

impl Display for PixelInspection {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let mut text = String::new();
        self.write(&mut text)?;
        text.lines().try_for_each(|line| write_wrapped(f, line))
    }
}

impl PixelInspection {
    fn write(&self, f: &mut String) -> fmt::Result {
        let [x, y] = self.pixel;
        let last = u64::from(self.first_sample) + u64::from(self.samples) - 1;
        writeln!(f, "pixel {x} {y} (column, row from the top), samples {} to {last}", self.first_sample)?;
        writeln!(f)?;
        let [red, green, blue] = self.color8;
        writeln!(f, "In short")?;
        writeln!(f, "  mean {}   as 8 bits {red} {green} {blue}", digits(&self.mean))?;
        if let (Some(variance), Some(error)) = (&self.variance, &self.standard_error) {
            let brackets = |v: &[f64; 3]| v.map(short).join(" ");
            writeln!(
                f,
                "  variance of a sample [{}]   standard error of the mean [{}]",
                brackets(variance),
                brackets(error)
            )?;
        }
        if self.dropped > 0 {
            let them = if self.dropped == 1 { "it" } else { "them" };
            let dropped = are(self.dropped.into(), "sample");
            writeln!(f, "  {dropped} not finite: the film leaves {them} out")?;
        }
        let of_all = f64::from(self.samples - self.dropped);
        let sum = self.mean.iter().map(|c| f64::from(*c)).sum::<f64>() * of_all;
        write_contributions(f, &self.contributions, sum, true)?;
        writeln!(f)?;
        writeln!(f, "All samples, the brightest first")?;
        writeln!(f, "  {:>6} {:>12} {:>5}   the largest contribution", "sample", "luminance", "depth")?;
        for sample in &self.all {
            writeln!(
                f,
                "  {:>6} {:>12} {:>5}   {}",
                sample.sample,
                short(f64::from(sample.luminance)),
                sample.depth,
                sample.expression
            )?;
        }
        Ok(())
    }
}

impl Inspection {
    /// Writes the colour and the largest contributions.
    pub(super) fn write_summary(&self, f: &mut String) -> fmt::Result {
        let [red, green, blue] = self.color8;
        writeln!(f, "In short")?;
        writeln!(f, "  the film received {}   as 8 bits, alone {red} {green} {blue}", digits(&self.film))?;
        let sum = self.film.iter().map(|c| f64::from(*c)).sum();
        write_contributions(f, &self.contributions, sum, false)
    }
}

fn write_contributions(
    f: &mut String,
    contributions: &[Contribution],
    sum: f64,
    of_many: bool,
) -> fmt::Result {
    if contributions.is_empty() {
        return writeln!(f, "  no light");
    }
    for Contribution { sample, value, expression, why, .. } in contributions {
        let part = 100.0 * value.iter().map(|c| f64::from(*c)).sum::<f64>() / sum;
        let percent = if part.is_finite() { format!("{part:>3.0} %   ") } else { String::new() };
        let of_sample = if of_many { format!("sample {sample}: ") } else { String::new() };
        writeln!(f, "  {percent}{of_sample}{expression}")?;
        writeln!(f, "          {} = {why}", digits(value))?;
    }
    Ok(())
}
