//! Values of command-line options, spelled as in scene files.

use std::fmt::Display;
use std::ops::Range;
use std::str::FromStr;
use std::time::Duration;

use clap::builder::{PossibleValuesParser, TypedValueParser};
use glam::DVec3;
use lookfrom_scene::Location;
use lookfrom_scene::image::linear_from_srgb;
use lookfrom_scene::scene::Bounds;
use lookfrom_scene::settings::{Background, Filter, LightPathLayer, PixelBounds, Sensor, SpectralFilm};
use lookfrom_scene::spectrum::CameraSensor;
use lookfrom_scene::studio::Viewpoint;

use lookfrom::session::{Exposure, Fireflies, MOST_SAMPLES};

/// Views by name.
pub(crate) type Views = Vec<(&'static str, Viewpoint)>;

/// Switches.
pub(crate) const ON_OFF: &[(&str, bool)] = &[("on", true), ("off", false)];

/// Firefly filters.
pub(crate) const FIREFLIES: &[(&str, Fireflies)] = &[("off", Fireflies::Keep), ("median", Fireflies::Spread)];

/// Units of time, in seconds. A unit whose name ends with that of another (`ms`, `s`) comes before it.
const UNITS: [(&str, f64); 4] = [("ms", 1e-3), ("s", 1.0), ("m", 60.0), ("h", 3600.0)];

/// The largest filter radius in pixels, as in scene files.
const GREATEST_RADIUS: f32 = 16.0;

/// The greatest number of a frame.
const MOST_FRAMES: u32 = 1 << 24;

/// `60s`, `500ms`, `2m`, `1.5h`: a time of more than 0 and at most a year.
pub(crate) fn duration(typed: &str) -> Result<Duration, String> {
    let unit = UNITS.iter().find_map(|(unit, seconds)| Some((typed.strip_suffix(unit)?, seconds)));
    let seconds = unit.and_then(|(number, seconds)| Some(number.trim().parse::<f64>().ok()? * seconds));
    match seconds {
        Some(seconds) if seconds > 0.0 && seconds <= 366.0 * 86_400.0 => Ok(Duration::from_secs_f64(seconds)),
        _ => Err("expected a time with its unit, ms, s, m or h: 500ms, 60s, 2m, 1.5h".to_owned()),
    }
}

/// `2GiB`, `500MB`, `1.5 GB`: bytes in units of 1024 or of 1000.
pub(crate) fn memory(typed: &str) -> Result<u64, String> {
    const UNITS: [(&str, u64); 7] = [
        ("kib", 1 << 10),
        ("mib", 1 << 20),
        ("gib", 1 << 30),
        ("tib", 1 << 40),
        ("kb", 1_000),
        ("mb", 1_000_000),
        ("gb", 1_000_000_000),
    ];
    let lower = typed.to_ascii_lowercase();
    let unit = UNITS.iter().find_map(|(unit, bytes)| Some((lower.strip_suffix(unit)?, *bytes)));
    let size = unit.and_then(|(number, bytes)| Some(number.trim().parse::<f64>().ok()? * bytes as f64));
    match size {
        Some(size) if (1.0..1e18).contains(&size) => Ok(size as u64),
        _ => Err("expected a size with its unit, KiB, MiB, GiB, TiB, KB, MB or GB: 2GiB, 500MB".to_owned()),
    }
}

/// Parser of the words of a table, which the help and completions list.
pub(crate) fn word<T: Copy + Send + Sync>(
    words: &'static [(&'static str, T)],
) -> impl TypedValueParser<Value = T> {
    PossibleValuesParser::new(words.iter().map(|&(word, _)| word)).try_map(move |typed| {
        let known = words.iter().find(|(word, _)| *word == typed);
        known.map(|&(_, value)| value).ok_or_else(|| format!("unknown value {typed:?}"))
    })
}

/// `N`, the samples from 0 on, or `FROM..BEFORE`.
pub(crate) fn samples(typed: &str) -> Result<Range<u32>, String> {
    let (start, end) = typed.split_once("..").unwrap_or(("0", typed));
    let number = |typed: &str| typed.trim().parse::<u32>().ok().filter(|&number| number <= MOST_SAMPLES);
    match (number(start), number(end)) {
        (Some(start), Some(end)) if start < end => Ok(start..end),
        _ => Err(format!("expected a whole number from 1 to {MOST_SAMPLES}, or two, such as 256..512")),
    }
}

/// `FROM..BEFORE`: frames of an animation.
pub(crate) fn frames(typed: &str) -> Result<Range<u32>, String> {
    let number = |typed: &str| typed.trim().parse::<u32>().ok().filter(|&number| number <= MOST_FRAMES);
    match typed.split_once("..").map(|(start, end)| (number(start), number(end))) {
        Some((Some(start), Some(end))) if start < end => Ok(start..end),
        _ => {
            Err("expected the first frame and the one after the last, counted from 0, such as 0..48"
                .to_owned())
        }
    }
}

/// Frames per second: a number, or a fraction, as those of television are.
pub(crate) fn frame_rate(typed: &str) -> Result<f64, String> {
    let number = |typed: &str| typed.trim().parse::<f64>().ok();
    let rate = match typed.split_once('/') {
        Some((frames, seconds)) => {
            number(frames).zip(number(seconds)).map(|(frames, seconds)| frames / seconds)
        }
        None => number(typed),
    };
    rate.filter(|rate| (1e-3..=1e6).contains(rate))
        .ok_or_else(|| "expected a number from 0.001 to 1000000, or a fraction such as 24000/1001".to_owned())
}

/// `I/N`: part I of N, from 1.
pub(crate) fn part(typed: &str) -> Result<[u32; 2], String> {
    let parts = typed.split_once('/').and_then(|(part, parts)| {
        Some([part.trim().parse::<u32>().ok()?, parts.trim().parse::<u32>().ok()?])
    });
    let parts = parts.filter(|&[part, parts]| (1..=parts).contains(&part) && parts <= MOST_SAMPLES);
    parts.ok_or_else(|| "expected a part and the number of parts, such as 1/64, the first of 64".to_owned())
}

/// `X,Y,Z`: three finite numbers.
pub(crate) fn vector(typed: &str) -> Result<DVec3, String> {
    let vector = DVec3::from_array(separated(typed, "three numbers, X,Y,Z")?);
    if vector.is_finite() { Ok(vector) } else { Err("expected finite numbers".to_owned()) }
}

/// `X0,Y0,Z0,X1,Y1,Z1`: a box.
pub(crate) fn bounds(typed: &str) -> Result<Bounds, String> {
    let [x0, y0, z0, x1, y1, z1] = separated(typed, "six numbers, X0,Y0,Z0,X1,Y1,Z1")?;
    let bounds = Bounds { min: DVec3::new(x0, y0, z0), max: DVec3::new(x1, y1, z1) };
    match bounds.min.is_finite() && bounds.max.is_finite() && bounds.min.cmple(bounds.max).all() {
        true => Ok(bounds),
        false => Err("expected finite numbers with X0 ≤ X1, Y0 ≤ Y1 and Z0 ≤ Z1".to_owned()),
    }
}

/// Stops, or `auto`.
pub(crate) fn exposure(typed: &str) -> Result<Exposure, String> {
    let stops = || typed.parse().ok().filter(|stops| (-64.0..=64.0).contains(stops)).map(Exposure::Stops);
    let exposure = if typed == "auto" { Some(Exposure::Auto) } else { stops() };
    exposure.ok_or_else(|| "expected stops from -64 to 64, or auto".to_owned())
}

/// `x`, `-z` …, or `X,Y,Z`.
pub(crate) fn direction(typed: &str) -> Result<DVec3, String> {
    match typed {
        "x" => Ok(DVec3::X),
        "y" => Ok(DVec3::Y),
        "z" => Ok(DVec3::Z),
        "-x" => Ok(DVec3::NEG_X),
        "-y" => Ok(DVec3::NEG_Y),
        "-z" => Ok(DVec3::NEG_Z),
        _ => vector(typed).map_err(|error| format!("{error}, or one of x, y, z, -x, -y, -z")),
    }
}

/// `X0,Y0,X1,Y1`: a window of at least one pixel.
pub(crate) fn crop(typed: &str) -> Result<PixelBounds, String> {
    let [x0, y0, x1, y1] = separated(typed, "four whole numbers of pixels, X0,Y0,X1,Y1")?;
    if x0 < x1 && y0 < y1 {
        Ok(PixelBounds { x0, y0, x1, y1 })
    } else {
        Err("expected X0 < X1 and Y0 < Y1: pixels are counted from the top left".to_owned())
    }
}

/// `FROM,TO`: a range of wavelengths in nm.
pub(crate) fn wavelengths(typed: &str) -> Result<[f32; 2], String> {
    let range = separated(typed, SpectralFilm::RANGE)?;
    if SpectralFilm::is_range(range) { Ok(range) } else { Err(format!("expected {}", SpectralFilm::RANGE)) }
}

fn separated<T: FromStr + Copy + Default, const N: usize>(
    typed: &str,
    expected: &str,
) -> Result<[T; N], String> {
    let numbers: Option<Vec<T>> = typed.split(',').map(|number| number.trim().parse().ok()).collect();
    numbers.and_then(|numbers| numbers.try_into().ok()).ok_or_else(|| format!("expected {expected}"))
}

/// `N` or `WxH`: width and height.
pub(crate) fn size(typed: &str) -> Result<[u32; 2], String> {
    let side = |typed: &str| typed.trim().parse::<u32>().ok().filter(|&side| side > 0);
    let (width, height) = typed.split_once(['x', '×']).unwrap_or((typed, typed));
    match (side(width), side(height)) {
        (Some(width), Some(height)) => Ok([width, height]),
        _ => Err("expected pixels, such as 256 for a square or 640x360".to_owned()),
    }
}

/// `X,Y`: column and row of a pixel.
#[cfg(feature = "view")]
pub(crate) fn pixel(typed: &str) -> Result<[u32; 2], String> {
    separated(typed, "column and row of a pixel, such as 120,240")
}

/// `C` or `CxR`: columns, and rows.
pub(crate) fn sheet(typed: &str) -> Result<(u32, Option<u32>), String> {
    let side = |typed: &str| typed.trim().parse::<u32>().ok().filter(|&side| (1..=1000).contains(&side));
    let sides = match typed.split_once(['x', '×']) {
        None => side(typed).map(|columns| (columns, None)),
        Some((columns, rows)) => side(columns).zip(side(rows).map(Some)),
    };
    sides.ok_or_else(|| {
        "expected columns, such as 4, or columns and rows, such as 4x2; at most 1000".to_owned()
    })
}

/// `front,top` or `all`.
pub(crate) fn views(typed: &str) -> Result<Views, String> {
    if typed == "all" {
        return Ok(Viewpoint::WORDS.to_vec());
    }
    let view = |typed: &str| {
        let known = Viewpoint::WORDS.iter().find(|(word, _)| *word == typed.trim());
        known.copied().ok_or_else(|| {
            let words: Vec<&str> = Viewpoint::WORDS.iter().map(|&(word, _)| word).collect();
            format!("there is no view {typed:?}; the views are {}, or all", words.join(", "))
        })
    };
    let views = typed.split(',').map(view).collect::<Result<Views, String>>()?;
    let mut names: Vec<&str> = views.iter().map(|&(name, _)| name).collect();
    names.sort_unstable();
    match names.windows(2).find(|pair| pair[0] == pair[1]) {
        Some(pair) => Err(format!("the view {} twice", pair[0])),
        None => Ok(views),
    }
}

/// `1.5s`, `500ms`, `1.5`: seconds, at least 0.
pub(crate) fn moment(typed: &str) -> Result<f64, String> {
    let unit = UNITS.iter().find_map(|(unit, seconds)| Some((typed.strip_suffix(unit)?, *seconds)));
    let (number, seconds) = unit.unwrap_or((typed, 1.0));
    match number.trim().parse::<f64>() {
        Ok(number) if (0.0..=1e9).contains(&number) => Ok(number * seconds),
        _ => Err("expected a time of at least 0, such as 1.5s, 500ms or 1.5".to_owned()),
    }
}

/// `environment`, `transparent`, `white`, `black` or `#rrggbb`.
pub(crate) fn background(typed: &str) -> Result<Background, String> {
    let hex = |digits: &str| match digits.len() {
        6 => u32::from_str_radix(digits, 16).ok(),
        _ => None,
    };
    match typed {
        "environment" => Ok(Background::Environment),
        "transparent" => Ok(Background::Transparent),
        "white" => Ok(Background::Color([1.0; 3])),
        "black" => Ok(Background::Color([0.0; 3])),
        _ => match typed.strip_prefix('#').and_then(hex) {
            Some(rgb) => {
                let channel = |shift: u32| linear_from_srgb((rgb >> shift & 0xff) as f32 / 255.0);
                Ok(Background::Color([channel(16), channel(8), channel(0)]))
            }
            None => Err("expected environment, transparent, white, black or #rrggbb".to_owned()),
        },
    }
}

/// A number within a range. NaN is in no range.
pub(crate) fn between<T>(least: T, greatest: T) -> impl Fn(&str) -> Result<T, String> + Clone + Send + Sync
where
    T: FromStr + PartialOrd + Display + Copy + Send + Sync,
{
    move |typed| match typed.parse::<T>() {
        Ok(number) if (least..=greatest).contains(&number) => Ok(number),
        _ => Err(format!("expected a number from {least} to {greatest}")),
    }
}

/// A whole number within a range.
pub(crate) fn whole<T>(least: T, greatest: T) -> impl Fn(&str) -> Result<T, String> + Clone + Send + Sync
where
    T: FromStr + PartialOrd + Display + Copy + Send + Sync,
{
    move |typed| match typed.parse::<T>() {
        Ok(number) if (least..=greatest).contains(&number) => Ok(number),
        _ => Err(format!("expected a whole number from {least} to {greatest}")),
    }
}

/// An angle between 0° and 180°, both excluded.
pub(crate) fn field_of_view(typed: &str) -> Result<f64, String> {
    match typed.parse::<f64>() {
        Ok(degrees) if degrees > 0.0 && degrees < 180.0 => Ok(degrees),
        _ => Err("expected degrees between 0 and 180, both excluded".to_owned()),
    }
}

/// A layer of a light-path expression.
pub(crate) fn light_path(typed: &str) -> Result<LightPathLayer, String> {
    let Some((name, expression)) = typed.split_once('=') else {
        return Err("expected NAME=EXPRESSION, as in direct=C<RD>[LB]".to_owned());
    };
    let at = Location { file: format!("--light-path {name}").into(), ..Location::default() };
    Ok(LightPathLayer { name: name.to_owned(), expression: expression.to_owned(), at })
}

/// `NAME=VALUE`.
pub(crate) fn definition(typed: &str) -> Result<(String, String), String> {
    match typed.split_once('=') {
        Some((name, value)) if !name.trim().is_empty() => {
            Ok((name.trim().to_owned(), value.trim().to_owned()))
        }
        _ => Err("expected NAME=VALUE, as in radius=2".to_owned()),
    }
}

/// `NAME`, `NAME:RADIUS` or `NAME:X:Y`.
pub(crate) fn filter(typed: &str) -> Result<Filter, String> {
    let (name, radii) = typed.split_once(':').map_or((typed, None), |(name, radii)| (name, Some(radii)));
    let Some(&(_, mut filter)) = Filter::WORDS.iter().find(|(word, _)| *word == name) else {
        let known: Vec<&str> = Filter::WORDS.iter().map(|&(word, _)| word).collect();
        return Err(format!("expected NAME or NAME:RADIUS; the names are {}", known.join(", ")));
    };
    if let Some(radii) = radii {
        let radius = |typed: &str| match typed.parse() {
            Ok(radius) if radius > 0.0 && radius <= GREATEST_RADIUS => Ok(radius),
            _ => Err(format!(
                "expected a radius in pixels, more than 0 and at most {GREATEST_RADIUS}, or one along x and one along \
                 y, {name}:0.5:1"
            )),
        };
        let (x, y) = radii.split_once(':').unwrap_or((radii, radii));
        filter.radius = [radius(x)?, radius(y)?];
    }
    Ok(filter)
}

/// Samples per pixel of picture and reference, `N,M`.
pub(crate) fn sample_counts(typed: &str) -> Result<[u64; 2], String> {
    let numbers: Option<Vec<u64>> = typed.split(',').map(|number| number.trim().parse().ok()).collect();
    match numbers.as_deref() {
        Some(&[picture, reference]) if picture > 0 && reference > 0 => Ok([picture, reference]),
        _ => Err("expected two numbers of samples per pixel, of the picture and of the reference: 64,1024"
            .to_owned()),
    }
}

/// A sensor, `NAME` or `NAME,KELVIN`.
pub(crate) fn sensor(typed: &str) -> Result<Sensor, String> {
    let (name, kelvin) = match typed.split_once(',') {
        Some((name, kelvin)) => (name.trim(), Some(kelvin.trim())),
        None => (typed.trim(), None),
    };
    let camera = match CameraSensor::named(name) {
        None if name != Sensor::OBSERVER => {
            let cameras = CameraSensor::all().map(CameraSensor::name);
            let known: Vec<&str> = std::iter::once(Sensor::OBSERVER).chain(cameras).collect();
            return Err(format!(
                "expected a sensor, with an optional white balance after a comma: canon_eos_5d_mkiv,5000; the sensors are {}",
                known.join(", ")
            ));
        }
        camera => camera,
    };
    let white_balance = match kelvin.map(str::parse) {
        None => None,
        Some(Ok(kelvin)) if (500.0..=100_000.0).contains(&kelvin) => Some(kelvin),
        Some(_) => {
            return Err("expected a white balance in kelvin from 500 to 100000 after the comma".to_owned());
        }
    };
    Ok(Sensor { camera, white_balance, ..Sensor::default() })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_filter_keeps_its_name_and_takes_a_radius() {
        for (name, shape) in Filter::WORDS {
            assert_eq!(filter(name).as_ref(), Ok(shape));
            for radii in ["3.5", "3.5:2"] {
                let typed = format!("{name}:{radii}");
                let told = filter(&typed).unwrap().to_string();
                assert_eq!(told.split(' ').next(), Some(&*typed));
            }
        }
        for wrong in [
            "",
            "cone",
            "box:",
            "box:0",
            "box:-1",
            "box:17",
            "box:NaN",
            "box:inf",
            "box:1:",
            "box:1:17",
            "box:1:2:3",
        ] {
            assert!(filter(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn times_have_units() {
        assert_eq!(duration("500ms"), Ok(Duration::from_millis(500)));
        assert_eq!(duration("60s"), duration("1m"));
        assert_eq!(duration("1.5h"), duration("90 m"));
        for wrong in ["", "5", "s", "0s", "-1s", "NaNs", "infs", "1e99h", "5 days", "1m30s"] {
            assert!(duration(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn sizes_moments_and_backgrounds() {
        assert_eq!((size("256"), size("640x360")), (Ok([256, 256]), Ok([640, 360])));
        for wrong in ["", "0", "x", "640x", "640x0", "-1", "1.5", "1x2x3"] {
            assert!(size(wrong).is_err(), "{wrong}");
        }
        assert_eq!(
            (moment("1.5s"), moment("500ms"), moment("0"), moment("2")),
            (Ok(1.5), Ok(0.5), Ok(0.0), Ok(2.0))
        );
        for wrong in ["", "-1s", "s", "NaN", "inf"] {
            assert!(moment(wrong).is_err(), "{wrong}");
        }
        assert_eq!((frame_rate("25"), frame_rate("24000/1001")), (Ok(25.0), Ok(24000.0 / 1001.0)));
        for wrong in ["", "0", "-24", "24/0", "24/", "inf", "NaN", "1/1/1"] {
            assert!(frame_rate(wrong).is_err(), "{wrong}");
        }
        for name in ["environment", "transparent", "#ffffff", "#000000", "#2080c0"] {
            assert_eq!(background(name).unwrap().to_string(), name);
        }
        for wrong in ["", "#fff", "#gggggg", "red"] {
            assert!(background(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn sheets_and_views() {
        assert_eq!((sheet("4x2"), sheet("3")), (Ok((4, Some(2))), Ok((3, None))));
        for wrong in ["", "0", "4x", "4x0", "x2", "1001", "-1"] {
            assert!(sheet(wrong).is_err(), "{wrong}");
        }
        let names = |typed| views(typed).map(|views| views.iter().map(|(name, _)| *name).collect::<Vec<_>>());
        assert_eq!(names("top, front"), Ok(vec!["top", "front"]));
        assert_eq!(names("all").unwrap().len(), Viewpoint::WORDS.len());
        for wrong in ["", "front,", "Top", "front,front", "all,top"] {
            assert!(views(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn samples_and_parts() {
        assert_eq!((samples("64"), samples("256..512")), (Ok(0..64), Ok(256..512)));
        for wrong in ["", "0", "-1", "1..1", "2..1", "1..", "..4", "0..16777217", "x..y", "1..2..3"] {
            assert!(samples(wrong).is_err(), "{wrong}");
        }
        assert_eq!((part("3/64"), part("1/1")), (Ok([3, 64]), Ok([1, 1])));
        for wrong in ["", "0/4", "5/4", "1", "1/0", "-1/4", "1/2/3"] {
            assert!(part(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn numbers_between_commas() {
        assert_eq!(vector("-1, 2e3,.5"), Ok(DVec3::new(-1.0, 2000.0, 0.5)));
        for wrong in ["", "1,2", "1,2,3,4", "1,,3", "1,2,x", "1,2,inf", "NaN,0,0"] {
            assert!(vector(wrong).is_err(), "{wrong}");
        }
        assert_eq!([direction("-x"), direction("0,0,2")], [Ok(DVec3::NEG_X), Ok(DVec3::new(0.0, 0.0, 2.0))]);
        assert!(direction("w").is_err() && direction("+y").is_err());
        assert_eq!(crop("1,2,3,4"), Ok(PixelBounds { x0: 1, y0: 2, x1: 3, y1: 4 }));
        for wrong in ["1,2,1,4", "1,4,3,4", "3,2,1,4", "-1,0,1,1", "0,0,1.5,1", "0,0,1"] {
            assert!(crop(wrong).is_err(), "{wrong}");
        }
        assert!(
            field_of_view("0").is_err() && field_of_view("180").is_err() && field_of_view("NaN").is_err()
        );
        assert_eq!(whole(1, 9)("x"), Err("expected a whole number from 1 to 9".to_owned()));
        assert_eq!(
            [whole(0u32, 9)("-1").is_err(), whole(1, 9)("10").is_err(), whole(1, 9)("2.5").is_err()],
            [true; 3]
        );
        assert!(between(0.0, 1.0)("NaN").is_err() && between(0.0, 1.0)("1").is_ok());
    }
}
