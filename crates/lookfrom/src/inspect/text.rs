//! The inspection as text: what matters first, from the pixel to the world, then the tree of rays, indented, or the path,
//! ray by ray, and the sum. An [`Excerpt`] is a part of it.

mod camera;
mod candidates;
mod hit;
mod lens_system;
mod medium;
mod microfacets;
mod path;
mod pixel;
mod probe;
mod sum;
mod tree;

use std::fmt::{self, Display, Formatter, Write};

use super::{Amount, Inspection, RayReport};

/// Maximum number of columns of a line.
const COLUMNS: usize = 120;

/// A part of the text of an inspection.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TextPart {
    /// From the pixel to the world.
    Camera,
    /// The rays and the primitives that they were tested against.
    Tests,
    /// The light at each hit.
    Lights,
    /// What matters, and the sum.
    Sums,
}

/// The parts and rays to show.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Selection {
    /// Only the ray with this address.
    pub ray: Option<u64>,
    /// Only rays after this number of reflections, refractions and bounces.
    pub bounce: Option<u32>,
    /// Only this part.
    pub part: Option<TextPart>,
}

/// The text of a part of an inspection.
#[derive(Clone, Copy, Debug)]
pub struct Excerpt<'a> {
    pub(super) inspection: &'a Inspection,
    selection: Selection,
}

impl Inspection {
    /// A part of its text; all of it by default.
    pub fn excerpt(&self, selection: Selection) -> Excerpt<'_> {
        Excerpt { inspection: self, selection }
    }
}

impl Display for Inspection {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        self.excerpt(Selection::default()).fmt(f)
    }
}

impl Display for Excerpt<'_> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let mut text = String::new();
        self.write(&mut text)?;
        text.lines().try_for_each(|line| write_wrapped(f, line))
    }
}

impl Excerpt<'_> {
    fn write(&self, f: &mut String) -> fmt::Result {
        let inspection = self.inspection;
        let [x, y] = inspection.pixel;
        writeln!(f, "pixel {x} {y} (column, row from the top), sample {}", inspection.sample)?;
        if self.has(TextPart::Sums) && !self.is_of_rays() {
            writeln!(f)?;
            inspection.write_summary(f)?;
        }
        if self.has(TextPart::Camera) && !self.is_of_rays() {
            writeln!(f)?;
            inspection.write_camera(f)?;
            inspection.write_wavelengths(f)?;
        }
        if self.has(TextPart::Tests) || self.has(TextPart::Lights) {
            writeln!(f)?;
            if inspection.is_path() {
                self.write_path(f)?;
            } else {
                writeln!(f, "The tree of rays")?;
                if let Some(root) = inspection.rays.first() {
                    self.write_ray(f, root, 0)?;
                }
            }
        }
        if self.has(TextPart::Sums) && !self.is_of_rays() {
            writeln!(f)?;
            inspection.write_sum(f)?;
            inspection.write_development(f)?;
        }
        Ok(())
    }

    /// Whether a part is shown.
    fn has(&self, part: TextPart) -> bool {
        self.selection.part.is_none_or(|chosen| chosen == part)
    }

    /// Whether only some rays are shown.
    fn is_of_rays(&self) -> bool {
        self.selection.ray.is_some() || self.selection.bounce.is_some()
    }

    /// Whether a ray is shown.
    fn shows(&self, ray: &RayReport) -> bool {
        let Selection { ray: address, bounce, .. } = self.selection;
        address.is_none_or(|address| address == ray.address)
            && bounce.is_none_or(|bounce| bounce == ray.depth)
    }
}

/// Writes a line; what is beyond the last column goes on in the next line, four columns further in.
fn write_wrapped(f: &mut Formatter<'_>, line: &str) -> fmt::Result {
    let indent = line.chars().take_while(|c| *c == ' ').count();
    write!(f, "{}", &line[..indent])?;
    let (mut column, mut spaces) = (indent, 0);
    for (index, word) in line[indent..].split(' ').enumerate() {
        spaces += usize::from(index > 0);
        if word.is_empty() {
            continue;
        }
        let width = word.chars().count();
        if column > indent && column + spaces + width > COLUMNS {
            write!(f, "\n{:1$}", "", indent + 4)?;
            column = indent + 4;
        } else {
            write!(f, "{:spaces$}", "")?;
            column += spaces;
        }
        f.write_str(word)?;
        column += width;
        spaces = 0;
    }
    writeln!(f)
}

fn vector(v: &[f64]) -> String {
    format!("({})", v.iter().map(|x| short(*x)).collect::<Vec<_>>().join(", "))
}

fn vector32(v: &[f32]) -> String {
    format!("({})", v.iter().map(|x| short(f64::from(*x))).collect::<Vec<_>>().join(", "))
}

/// Light with all digits, so that these numbers can be added up; in spectral mode followed by its colour.
fn amount(amount: &Amount) -> String {
    match amount.lanes == amount.rgb || amount.lanes.iter().all(|lane| *lane == 0.0) {
        true => lanes(&amount.lanes),
        false => {
            let rgb = amount.rgb.map(|x| short(f64::from(x))).join(" ");
            format!("{} (rgb {rgb})", lanes(&amount.lanes))
        }
    }
}

/// A colour with few digits.
fn digits(rgb: &[f32]) -> String {
    format!("[{}]", rgb.iter().map(|x| short(f64::from(*x))).collect::<Vec<_>>().join(" "))
}

/// A factor or a colour with all digits.
fn lanes(lanes: &[f32]) -> String {
    format!("[{}]", lanes.iter().map(|x| full(*x)).collect::<Vec<_>>().join(" "))
}

/// A vector, or a number, with all its digits.
fn exact(value: &[f64]) -> String {
    match value {
        [number] => full64(*number),
        vector => format!("({})", vector.iter().map(|x| full64(*x)).collect::<Vec<_>>().join(", ")),
    }
}

/// Enough digits to read the same number back.
fn full64(x: f64) -> String {
    if x != 0.0 && !(1e-5..1e15).contains(&x.abs()) { format!("{x:e}") } else { format!("{x}") }
}

/// Enough digits to read the same number back.
fn full(x: f32) -> String {
    if x != 0.0 && x.abs() < 1e-5 { format!("{x:e}") } else { format!("{x}") }
}

/// Seven digits, without trailing zeros.
fn short(x: f64) -> String {
    // print −0 as 0
    let x = if x == 0.0 { 0.0 } else { x };
    if x != 0.0 && !(1e-4..1e7).contains(&x.abs()) {
        return format!("{x:.4e}");
    }
    let digits = 6usize.saturating_sub(x.abs().log10().max(0.0) as usize);
    let fixed = format!("{x:.digits$}");
    if fixed.contains('.') { fixed.trim_end_matches('0').trim_end_matches('.').to_owned() } else { fixed }
}
