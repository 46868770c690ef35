//! Reader for photometric files of luminaires, `.ies` (ANSI/IES LM-63, all editions): the intensity by direction.
//!
//! Nearly all files are of type C: vertical angles from straight down, horizontal ones around the upright axis, counter-clockwise
//! as seen from above. Types B (floodlights) and A (headlights) have their angles around the axis that the lamp shines along; both
//! hang so that it is straight down (IES LM-75). Intensities are relative, since luminaires are dimmed and have other lamps; how bright the
//! brightest one is, is told besides.

use std::f64::consts::{FRAC_PI_4, PI};
use std::path::Path;

use crate::error::{Error, ErrorKind, Location, Result};
use crate::files::LoadContext;
use crate::image::Image;
use crate::model::number::parse_f32;
use crate::model::text;

/// The longest file, and the most angles of a kind: real ones have a few hundred.
const LONGEST: u64 = 1 << 24;
const MOST_ANGLES: usize = 1 << 12;
/// Texels along each side of the picture of a distribution.
const SIDE: u32 = 512;

/// Intensities of a luminaire by direction.
#[derive(Clone, Debug, PartialEq)]
pub struct Photometry {
    kind: Kind,
    /// Vertical angles in degrees, increasing. Of type C 0 is straight down, 180 straight up.
    vertical: Vec<f64>,
    /// Horizontal angles in degrees, increasing; the rest is symmetric.
    horizontal: Vec<f64>,
    /// By horizontal, then by vertical angle; the greatest is 1.
    intensities: Vec<f64>,
    /// The greatest intensity in candela, with the factors of the file.
    candela: f64,
}

/// The type of a photometry: the meaning of its angles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    /// Longitudes around the axis to the lamp's top, and latitudes.
    A,
    /// Longitudes around the axis to the lamp's right, which are its vertical angles, and latitudes.
    B,
    /// Longitudes around the upright axis, and angles from straight down.
    C,
}

/// Whether a file has the name of a photometric file.
pub fn is_ies(name: &str) -> bool {
    Path::new(name).extension().is_some_and(|extension| extension.eq_ignore_ascii_case("ies"))
}

/// Reads a photometric file.
///
/// # Errors
/// `Syntax` or `Invalid` for what is no such file, `Limit` for too many angles.
pub fn read(path: &Path, context: &LoadContext<'_>) -> Result<Photometry> {
    let bytes = context.read(path)?;
    if bytes.len() as u64 > LONGEST {
        let message = format!("{} bytes are more than a photometric file has", bytes.len());
        return Err(Error::new(ErrorKind::Limit, &Location::file(path), message));
    }
    parse(&String::from_utf8_lossy(&text::utf8(&bytes)), &Location::file(path))
}

/// The numbers of a file, one after the other.
struct Numbers<'a> {
    words: Box<dyn Iterator<Item = (u32, &'a str)> + 'a>,
    file: &'a Location,
    last_line: u32,
}

impl Numbers<'_> {
    fn next(&mut self, what: &str) -> Result<f64> {
        let Some((line, word)) = self.words.next() else {
            let message = format!("the file ends before {what}");
            return Err(Error::syntax(&self.file.at(self.last_line, 1), message));
        };
        self.last_line = line;
        let number = parse_f32(word.as_bytes()).filter(|number| number.is_finite());
        number.map(f64::from).ok_or_else(|| {
            Error::syntax(&self.file.at(line, 1), format!("`{word}` is no number; expected {what}"))
        })
    }

    fn count(&mut self, what: &str) -> Result<usize> {
        let number = self.next(what)?;
        if number < 1.0 || number.fract() != 0.0 {
            return Err(self.wrong(format!("{what} is {number}; expected a whole number above 0")));
        }
        if number > MOST_ANGLES as f64 {
            let at = self.file.at(self.last_line, 1);
            let message = format!("{what} is {number}, more than the limit of {MOST_ANGLES}");
            return Err(Error::new(ErrorKind::Limit, &at, message));
        }
        Ok(number as usize)
    }

    fn angles(&mut self, count: usize, what: &str) -> Result<Vec<f64>> {
        let angles = (0..count).map(|_| self.next(what)).collect::<Result<Vec<_>>>()?;
        if angles.windows(2).any(|pair| pair[0] >= pair[1]) {
            return Err(self.wrong(format!("the {what}s do not increase")));
        }
        Ok(angles)
    }

    fn wrong(&self, message: String) -> Error {
        Error::invalid(&self.file.at(self.last_line, 1), message)
    }
}

fn parse(text: &str, file: &Location) -> Result<Photometry> {
    let mut lines = (1..).zip(text.lines());
    let is_tilt = |line: &str| line.split_whitespace().collect::<String>().starts_with("TILT=");
    let tilt = lines.by_ref().find(|(_, line)| is_tilt(line));
    let Some((_, tilt)) = tilt else {
        return Err(Error::syntax(file, "there is no line `TILT=`: it is no photometric file"));
    };
    let has_tilt = tilt.contains("INCLUDE");
    let words = lines.flat_map(|(line, text): (u32, &str)| {
        text.split(|c: char| c.is_whitespace() || c == ',')
            .filter(|word| !word.is_empty())
            .map(move |word| (line, word))
    });
    let mut numbers = Numbers { words: Box::new(words), file, last_line: 1 };
    if has_tilt {
        // By how much the lamp is dimmer where the luminaire is tilted: ours hangs as it was measured.
        numbers.next("the lamp's position")?;
        let count = numbers.count("the number of tilt angles")?;
        (0..2 * count).try_for_each(|_| numbers.next("a tilt angle or factor").map(drop))?;
    }
    for what in ["the number of lamps", "the lumens of a lamp"] {
        numbers.next(what)?;
    }
    let multiplier = numbers.next("the factor of the intensities")?;
    let vertical_count = numbers.count("the number of vertical angles")?;
    let horizontal_count = numbers.count("the number of horizontal angles")?;
    let kind = numbers.next("the type of photometry")?;
    let kind = match kind {
        1.0 => Kind::C,
        2.0 => Kind::B,
        3.0 => Kind::A,
        _ => {
            let message = format!("the type of photometry is {kind}; expected 1 (C), 2 (B) or 3 (A)");
            return Err(numbers.wrong(message));
        }
    };
    for what in ["the unit of lengths", "the width", "the length", "the height"] {
        numbers.next(what)?;
    }
    let ballast = numbers.next("the ballast factor")?;
    // In old files another factor of the ballast, 1 in others.
    let with_this_lamp = numbers.next("a number for the future")?;
    numbers.next("the watts")?;
    let vertical = numbers.angles(vertical_count, "vertical angle")?;
    let mut horizontal = numbers.angles(horizontal_count, "horizontal angle")?;
    let count = vertical_count * horizontal_count;
    let mut intensities = (0..count).map(|_| numbers.next("an intensity")).collect::<Result<Vec<f64>>>()?;
    // Some programs leave out the last plane, which is the first.
    let last = horizontal[horizontal_count - 1];
    if kind == Kind::C && horizontal[0] == 0.0 && last > 180.0 && last < 360.0 {
        horizontal.push(360.0);
        intensities.extend_from_within(..vertical_count);
    }
    if intensities.iter().any(|intensity| *intensity < 0.0) {
        return Err(Error::invalid(file, "an intensity is below 0"));
    }
    let greatest = intensities.iter().fold(0.0, |most: f64, intensity| most.max(*intensity));
    if greatest > 0.0 {
        intensities.iter_mut().for_each(|intensity| *intensity /= greatest);
        let candela = greatest * multiplier * ballast * with_this_lamp;
        return Ok(Photometry { kind, vertical, horizontal, intensities, candela });
    }
    Err(Error::invalid(file, "the luminaire emits no light: all intensities are 0"))
}

impl Photometry {
    /// The greatest intensity in candela; 0 or less where the file's factors are no real ones.
    pub fn candela(&self) -> f64 {
        self.candela
    }

    /// The relative intensity into a direction: degrees from straight down, and around. 0 beyond the file's angles.
    pub fn intensity(&self, vertical: f64, horizontal: f64) -> f64 {
        if self.kind == Kind::C {
            let column = place(&self.horizontal, self.folded(horizontal)).unwrap_or((0, 0.0));
            return self.at(place(&self.vertical, vertical), Some(column));
        }
        // A lamp that is tilted from straight down until it shines forward has its top up and its right to the right.
        let (sin, ahead) = libm::sincos(vertical.to_radians());
        let (minus_right, top) = libm::sincos(horizontal.to_radians());
        let (right, top) = (-sin * minus_right, sin * top);
        let longitude = |side: f64| libm::atan2(side, ahead).to_degrees();
        let latitude = |side: f64| libm::asin(side.clamp(-1.0, 1.0)).to_degrees();
        let (vertical, horizontal) = match self.kind {
            Kind::A => (latitude(top), longitude(right)),
            Kind::B | Kind::C => (longitude(top), latitude(right)),
        };
        // Angles from 0 on stand for both sides.
        let on =
            |angles: &[f64], angle: f64| place(angles, if angles[0] == 0.0 { angle.abs() } else { angle });
        self.at(on(&self.vertical, vertical), on(&self.horizontal, horizontal))
    }

    /// The intensity in an interval of vertical and in one of horizontal angles; 0 outside of them.
    fn at(&self, row: Option<(usize, f64)>, column: Option<(usize, f64)>) -> f64 {
        let (Some((row, t)), Some((column, s))) = (row, column) else { return 0.0 };
        let at = |column: usize, row: usize| {
            let column = column.min(self.horizontal.len() - 1);
            self.intensities[column * self.vertical.len() + row.min(self.vertical.len() - 1)]
        };
        let along = |column: usize| at(column, row) + t * (at(column, row + 1) - at(column, row));
        let here = along(column);
        here + s * (along(column + 1) - here)
    }

    /// A horizontal angle brought to those of the file by its symmetry.
    fn folded(&self, angle: f64) -> f64 {
        let (first, last) = (self.horizontal[0], self.horizontal[self.horizontal.len() - 1]);
        let angle = angle.rem_euclid(360.0);
        let mirrored = if angle > 180.0 { 360.0 - angle } else { angle };
        match (first, last) {
            // The same all around; both planes of symmetry; the plane through 0, or the one through 90.
            _ if first == last => first,
            (_, last) if last <= 90.0 => mirrored.min(180.0 - mirrored),
            (_, last) if last <= 180.0 => mirrored,
            (first, last) if first >= 90.0 && last <= 270.0 => match angle {
                angle if angle < 90.0 => 180.0 - angle,
                angle if angle > 270.0 => 540.0 - angle,
                angle => angle,
            },
            _ => angle,
        }
    }

    /// The intensities as an equal-area octahedral map (Clarberg 2008) with straight up in the middle.
    pub fn octahedral(&self, name: &str) -> Image {
        let place = |texel: u32| 2.0 * (f64::from(texel) + 0.5) / f64::from(SIDE) - 1.0;
        let texels = (0..SIDE * SIDE).map(|index| {
            let [u, v] = [place(index % SIDE), place(index / SIDE)];
            let signed = 1.0 - u.abs() - v.abs();
            let r = 1.0 - signed.abs();
            let phi = if r == 0.0 { 0.0 } else { ((v.abs() - u.abs()) / r + 1.0) * FRAC_PI_4 };
            let (sin, cos) = libm::sincos(phi);
            let up = (1.0 - r * r).copysign(signed);
            let around = libm::atan2(sin.copysign(v), cos.copysign(u));
            let degrees = 180.0 / PI;
            [self.intensity(libm::acos(-up) * degrees, around * degrees) as f32; 3]
        });
        Image::from_linear(name, SIDE, SIDE, texels.collect())
    }
}

/// The interval of increasing numbers that a number is in, and where; `None` outside of them.
fn place(sorted: &[f64], number: f64) -> Option<(usize, f64)> {
    let (first, last) = (sorted[0], sorted[sorted.len() - 1]);
    // Rounding does not make straight down and up dark.
    let slack = 1e-6;
    if number < first - slack || number > last + slack {
        return None;
    }
    let above = sorted.partition_point(|known| *known <= number).clamp(1, sorted.len());
    let below = above - 1;
    match sorted.get(above) {
        Some(next) => Some((below, ((number - sorted[below]) / (next - sorted[below])).clamp(0.0, 1.0))),
        None => Some((below, 0.0)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::files::Memory;

    fn of(body: &str) -> Result<Photometry> {
        let files = Memory([("a.ies".into(), body.as_bytes().to_vec())].into());
        read(Path::new("a.ies"), &LoadContext::new(&files))
    }

    fn near(a: f64, b: f64) -> bool {
        (a - b).abs() < 1e-9
    }

    #[test]
    fn the_last_plane_may_be_left_out() {
        let rows = "4 1 8 1 2 1 6 1";
        let planes =
            of(&format!("IES\nTILT = NONE\n1 1000 1 2 4 1 1 0 0 0 1 1 40\n0 180\n0 90 180 300\n{rows}\n"))
                .unwrap();
        assert!(
            near(planes.intensity(0.0, 330.0), 0.625) && near(planes.intensity(0.0, 359.999_999_999), 0.5)
        );
    }

    #[test]
    fn the_last_plane_may_be_any_beyond_half_a_turn() {
        for (planes, last) in [("0 90 180 270", 270.0), ("0 120 190 240", 240.0)] {
            let rows = "4 1 8 1 2 1 6 1";
            let photometry =
                of(&format!("TILT=NONE\n1 1 1 2 4 1 1 0 0 0 1 1 40\n0 180\n{planes}\n{rows}\n")).unwrap();
            assert!(near(photometry.intensity(0.0, last), 0.75));
            assert!(near(photometry.intensity(0.0, 0.5 * (last + 360.0)), 0.625), "{planes}");
        }
    }

    #[test]
    fn the_candela_have_all_factors() {
        let candela =
            |head: &str| of(&format!("TILT=NONE\n{head} 40\n0 90\n0\n200 100\n")).unwrap().candela();
        assert!(near(candela("1 1000 1 2 1 1 1 0 0 0 1 1"), 200.0));
        assert!(near(candela("2 -1 1.5 2 1 1 1 0 0 0 0.75 0.5"), 200.0 * 1.5 * 0.75 * 0.5));
    }

    #[test]
    fn symmetric_luminaires() {
        let head = "IESNA:LM-63-2002\n[TEST] X\nTILT=NONE\n1 1000 1";
        let round = of(&format!("{head} 3 1 1 1 0 0 0 1 1 40\n0 45 90\n0\n200 100 0\n")).unwrap();
        for around in [0.0, 77.0, 359.0] {
            assert!(near(round.intensity(0.0, around), 1.0) && near(round.intensity(22.5, around), 0.75));
            assert!(near(round.intensity(67.5, around), 0.25) && round.intensity(91.0, around) == 0.0);
        }
        let quarter = of(&format!("{head} 2 2 1 1 0 0 0 1 1 40\r\n0, 90\r\n0 90\r\n8 8 2 2\r\n")).unwrap();
        for around in [90.0, 270.0] {
            assert!(near(quarter.intensity(50.0, around), 0.25), "{around}");
        }
        for around in [45.0, 135.0, 225.0, 315.0, -45.0] {
            assert!(near(quarter.intensity(50.0, around), 0.625), "{around}");
        }
        let half = of(&format!("{head} 2 3 1 1 0 0 0 1 1 40\n0 180\n0 90 180\n4 4 2 2 1 1\n")).unwrap();
        assert!(near(half.intensity(120.0, 180.0), 0.25) && near(half.intensity(1.0, 315.0), 0.75));
        let other = of(&format!("{head} 2 3 1 1 0 0 0 1 1 40\n0 180\n90 180 270\n4 4 2 2 1 1\n")).unwrap();
        assert!(near(other.intensity(9.0, 0.0), 0.5) && near(other.intensity(9.0, 300.0), 0.25 + 0.25 / 3.0));
    }

    #[test]
    fn floodlights_and_headlights_have_their_axis_straight_down() {
        // By hand: 30° toward the top of the lamp (C 0), then from there to its right (C 270), by the formulas of LM-75:
        // type B turns around the axis to the right, type A around the one to the top.
        let body = "0 0 0 1 1 40\n-60 0 60\n-60 0 60\n1 2 3\n4 8 6\n2 5 7\n";
        let [b, a] = [2, 3].map(|kind| of(&format!("TILT=NONE\n1 1 1 3 3 {kind} 1 {body}")).unwrap());
        assert!(near(b.intensity(0.0, 123.0), 1.0) && near(a.intensity(0.0, 0.0), 1.0));
        for photometry in [&a, &b] {
            // On both axes the types agree: up by 60° it is 6, right by 60° it is 5, down 4, left 2, of 8.
            let seen = [0.0, 270.0, 180.0, 90.0].map(|around| photometry.intensity(60.0, around) * 8.0);
            assert!(seen.into_iter().zip([6.0, 5.0, 4.0, 2.0]).all(|(a, b)| near(a, b)), "{seen:?}");
            assert_eq!(photometry.intensity(61.0, 0.0), 0.0);
            assert_eq!(photometry.intensity(180.0, 0.0), 0.0);
        }
        // 45° toward top and right: the direction (top, right, ahead) = (½, ½, √½).
        let [longitude, latitude] = [libm::atan(libm::sqrt(0.5)), libm::asin(0.5)].map(f64::to_degrees);
        let value = |up: f64, right: f64| {
            let (t, s) = (up / 60.0, right / 60.0);
            (8.0 + t * (6.0 - 8.0)) * (1.0 - s) + (5.0 + t * (7.0 - 5.0)) * s
        };
        assert!(near(b.intensity(45.0, 315.0) * 8.0, value(longitude, latitude)));
        assert!(near(a.intensity(45.0, 315.0) * 8.0, value(latitude, longitude)));
        assert!(!near(a.intensity(45.0, 315.0), b.intensity(45.0, 315.0)));
        // Half of the angles stand for both sides.
        let half = of("TILT=NONE\n1 1 1 2 2 2 1 0 0 0 1 1 40\n0 90\n0 90\n4 2 1 0\n").unwrap();
        for around in [0.0, 180.0] {
            assert!(near(half.intensity(45.0, around), 0.75), "{around}");
        }
        assert!(near(half.intensity(45.0, 90.0), 0.625) && near(half.intensity(45.0, 270.0), 0.625));
    }

    #[test]
    fn the_map_has_straight_up_in_the_middle() {
        let tilt = "TILT=INCLUDE\n1 2 0 90 1 1\n1 -1 1 3 1 1 1 0 0 0 1 1 40 0 90 180 0 1 2 4";
        let up = of(tilt).unwrap().octahedral("up");
        let at = |x: u32, y: u32| up.texel((y * SIDE + x) as usize)[0];
        assert!(at(SIDE / 2, SIDE / 2) > 0.99 && at(0, 0) < 0.26 && at(SIDE - 1, 0) < 0.26);
        // The horizon is a square that stands on its corner.
        assert!((at(SIDE / 4, SIDE / 4) - 0.5).abs() < 0.01);
    }

    #[test]
    fn what_is_wrong_is_told_with_its_line() {
        for (text, expected) in [
            ("a picture", "no line `TILT=`"),
            ("TILT=NONE\n1 1 1 2 1 1", "a.ies:2:1: the file ends before the unit"),
            ("TILT=NONE\n1 1 x", "`x` is no number"),
            (
                "TILT=NONE\n1 1 1 2 1 4 1 0 0 0 1 1 1",
                "the type of photometry is 4; expected 1 (C), 2 (B) or 3 (A)",
            ),
            ("TILT=NONE\n1 1 1 1e9 1 1", "more than the limit"),
            (
                "TILT=NONE\n1 1 1 2 1 1 1 0 0 0 1 1 1\n90 0\n0\n1 1",
                "a.ies:3:1: the vertical angles do not increase",
            ),
            ("TILT=NONE\n1 1 1 2 1 1 1 0 0 0 1 1 1\n0 90\n0\n0 0", "no light"),
            ("TILT=NONE\n1 1 1 2 1 1 1 0 0 0 1 1 1\n0 90\n0\n0 -1", "below 0"),
        ] {
            let error = of(text).unwrap_err().to_string();
            assert!(error.contains(expected), "{text}: {error}");
        }
    }
}
