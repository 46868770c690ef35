use std::path::Path;

use super::*;
use crate::error::ErrorKind;
use crate::files::{LoadContext, Memory};

fn read(text: &str) -> crate::Result<Curve> {
    let files = Memory([("a.spd".into(), text.as_bytes().to_vec())].into());
    read_spd(Path::new("a.spd"), &mut LoadContext::new(&files))
}

#[test]
fn tables_are_linear_between_entries_and_0_outside() {
    let curve = Curve::Tabulated { wavelengths: vec![400.0, 500.0, 600.0], values: vec![1.0, 3.0, 2.0] };
    for (nm, value) in
        [(399.9, 0.0), (400.0, 1.0), (450.0, 2.0), (500.0, 3.0), (575.0, 2.25), (600.0, 2.0), (600.1, 0.0)]
    {
        assert!((curve.at(nm) - value).abs() < 1e-6, "{nm}: {} ≠ {value}", curve.at(nm));
    }
    assert_eq!(curve.at(f32::NAN), 0.0);
    let one = Curve::Tabulated { wavelengths: vec![400.0], values: vec![7.0] };
    assert_eq!((one.at(399.0), one.at(400.0), one.at(401.0)), (0.0, 7.0, 0.0));
}

#[test]
fn a_black_body_follows_planck() {
    for kelvin in [500.0_f32, 2856.0, 6500.0, 20_000.0] {
        let curve = Curve::Blackbody { kelvin };
        let peak = 2.897_772e6 / kelvin;
        assert!((curve.at(peak) - 1.0).abs() < 1e-6);
        assert!(curve.at(peak * 1.1) < 1.0 && curve.at(peak * 0.9) < 1.0);
    }
    // By hand: Planck at 500 nm over Planck at the peak (1014.6 nm) for 2856 K.
    let planck = |nm: f64| 1.0 / (nm.powi(5) * ((1.438_776_9e7 / (nm * 2856.0)).exp() - 1.0));
    let expected = planck(500.0) / planck(2.897_772_1e6 / 2856.0);
    let curve = Curve::Blackbody { kelvin: 2856.0 };
    assert!((f64::from(curve.at(500.0)) - expected).abs() < 1e-5);
    for kelvin in [0.0, -5.0, f32::NAN] {
        assert_eq!(Curve::Blackbody { kelvin }.at(500.0), 0.0);
    }
    for kelvin in [1e-30, 1.0, 1e30] {
        assert!(Curve::Blackbody { kelvin }.at(500.0).is_finite());
    }
    assert_eq!(Curve::Blackbody { kelvin: 6500.0 }.at(0.0), 0.0);
}

/// The chromaticity of a light source.
fn xy(light: &Curve) -> [f64; 2] {
    let [x, y, z] = observer::xyz(light);
    [x / (x + y + z), y / (x + y + z)]
}

fn near(a: [f64; 2], b: [f64; 2], tolerance: f64) -> bool {
    (a[0] - b[0]).abs() < tolerance && (a[1] - b[1]).abs() < tolerance
}

#[test]
fn lights_have_their_published_chromaticities() {
    // CIE 15, table T.3; black bodies from Wyszecki and Stiles
    for (name, expected) in [
        ("stdillum-A", [0.44758, 0.40745]),
        // The D50 of pbrt-v4 is bluer than the CIE's, (0.34567, 0.35851).
        ("stdillum-D50", [0.3368, 0.358]),
        ("stdillum-D65", [0.31272, 0.32903]),
        ("stdillum-F2", [0.3721, 0.3751]),
        ("stdillum-F7", [0.3129, 0.3292]),
        ("stdillum-F11", [0.3805, 0.3769]),
        ("illum-acesD60", [0.32168, 0.33767]),
    ] {
        let found = xy(&named(name).unwrap());
        assert!(near(found, expected, 5e-4), "{name}: {found:?} ≠ {expected:?}");
    }
    let found = d50().unwrap();
    assert!(near(xy(&found), [0.34567, 0.35851], 2e-4), "{:?}", xy(&found));
    assert!((observer::xyz(&found)[1] - 1.0).abs() < 1e-6);
    for (kelvin, expected) in
        [(2856.0, [0.4475, 0.4075]), (6500.0, [0.3135, 0.3237]), (10_000.0, [0.2807, 0.2884])]
    {
        let found = xy(&Curve::Blackbody { kelvin });
        assert!(near(found, expected, 4e-4), "{kelvin} K: {found:?} ≠ {expected:?}");
    }
}

#[test]
fn daylight_of_6500_is_d65() {
    let (series, table) = (daylight::daylight(6500.0), named("stdillum-D65").unwrap());
    let scale = table.at(560.0) / series.at(560.0);
    for nm in (360..=830).step_by(5) {
        let difference = series.at(nm as f32) * scale - table.at(nm as f32);
        assert!(difference.abs() < 2e-3, "{nm}: {difference}");
    }
    assert!(near(xy(&daylight::daylight(10_000.0)), [0.2788, 0.2919], 1e-3));
    assert_eq!(daylight::daylight(3000.0), Curve::Blackbody { kelvin: 3000.0 * (1.4388 / 1.4380) });
    assert!(matches!(daylight::daylight(f32::NAN), Curve::Blackbody { .. }));
}

#[test]
fn named_curves_are_whole() {
    let mut count = 0;
    for name in names() {
        let curve = named(name).unwrap_or_else(|| panic!("{name} is in the list"));
        let Curve::Tabulated { wavelengths, values } = &curve else { panic!("{name} is a table") };
        assert_eq!(wavelengths.len(), values.len(), "{name}");
        assert!(wavelengths.windows(2).all(|pair| pair[0] < pair[1]), "{name}: {wavelengths:?}");
        assert!(values.iter().all(|&value| (0.0..30.0).contains(&value)), "{name}");
        // No gap at the ends
        assert!(wavelengths[0] <= 360.0 && wavelengths[wavelengths.len() - 1] >= 830.0, "{name}");
        if name.contains("illum-") {
            assert!((observer::xyz(&curve)[1] - 1.0).abs() < 1e-6, "{name}");
        }
        count += 1;
    }
    assert_eq!(count, 14 + 7 + 16 + 3);
    assert_eq!(named("metal-Au"), None);
    assert_eq!(named("glass-SF11"), named("glass-F11"));
}

/// Schott's data sheet of N-BK7: the coefficients, and the indices from the ultraviolet line i to the infrared line r.
#[test]
fn formulas_have_the_indices_of_a_data_sheet() {
    let sellmeier = Dispersion::Sellmeier(vec![
        [1.039_612_12, 0.006_000_698_67],
        [0.231_792_344, 0.020_017_914_4],
        [1.010_469_45, 103.560_653],
    ]);
    let cauchy = Dispersion::of_abbe(1.5168, 64.17);
    for (nm, index) in
        [(404.7, 1.53024), (486.1, 1.52238), (587.6, 1.51680), (656.3, 1.51432), (706.5, 1.51289)]
    {
        assert!((sellmeier.at(nm) - index).abs() < 6e-6, "{nm}: {}", sellmeier.at(nm));
        // Two terms meet the line d and the difference of F and C.
        assert!((cauchy.at(nm) - index).abs() < 6e-4, "{nm}: {}", cauchy.at(nm));
        let curve = sellmeier.curve().expect("a glass");
        assert!((f64::from(curve.at(nm as f32)) - index).abs() < 7e-6);
    }
    let [f, d, c] = [486.1327, 587.5618, 656.2725].map(|nm| cauchy.at(nm));
    assert!((d - 1.5168).abs() < 1e-12 && ((d - 1.0) / (f - c) - 64.17).abs() < 1e-9);
    assert_eq!(Dispersion::Cauchy(vec![1.5, 0.01, 0.002]).at(500.0), 1.5 + 0.01 / 0.25 + 0.002 / 0.0625);

    assert_eq!(Dispersion::Sellmeier(vec![[1.0, 0.16]]).curve(), Err(360), "beyond its resonance");
    assert_eq!(Dispersion::Cauchy(vec![f64::MAX]).curve(), Err(360));
}

#[test]
fn named_curves_have_known_values() {
    let at = |name: &str, nm: f32| named(name).unwrap().at(nm);
    // Gold, between the entries at 495.94 and 506.06 nm
    let t = (500.0 - 495.936_7) / (506.057_86 - 495.936_7);
    assert!((at("metal-Au-k", 500.0) - (1.84 + t * (1.9565 - 1.84))).abs() < 1e-5);
    assert!((at("metal-Au-eta", 495.936_7) - 0.916).abs() < 1e-5);
    assert!((at("metal-CuZn-k", 500.0) - 2.25).abs() < 1e-6);
    assert!((at("metal-TiO2-eta", 559.982) - 2.94).abs() < 1e-4);
    // n_d of the glasses at the sodium line, from their catalogues
    for (name, index) in [
        ("glass-BK7", 1.5168),
        ("glass-BAF10", 1.67),
        ("glass-FK51A", 1.48656),
        ("glass-LASF9", 1.85025),
        ("glass-SF5", 1.6727),
        ("glass-SF10", 1.72825),
        ("glass-SF11", 1.78472),
    ] {
        assert!((at(name, 587.56) - index).abs() < 5e-4, "{name}: {}", at(name, 587.56));
    }
}

#[test]
fn the_observer_weighs_green_most() {
    let [x, y, z] = observer::matching();
    let integral = |f: &[f32]| f.iter().map(|&v| f64::from(v)).sum::<f64>();
    assert!((integral(y) / observer::Y_INTEGRAL - 1.0).abs() < 1e-6);
    // All three have nearly the same integral: an equal-energy spectrum is grey.
    assert!((integral(x) / integral(y) - 1.0).abs() < 1e-3 && (integral(z) / integral(y) - 1.0).abs() < 1e-3);
    assert_eq!(y[(555 - 360) as usize], 1.0);
}

#[test]
fn spaces_agree_with_their_standards() {
    // IEC 61966-2-1 and BT.2087
    let xyz = space::xyz_from("sRGB").unwrap();
    let expected = [[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]];
    for (found, expected) in xyz.iter().flatten().zip(expected.iter().flatten()) {
        assert!((found - expected).abs() < 3e-4, "{xyz:?}");
    }
    let matrix = space::rec709_from("rec2020").unwrap();
    let expected = [[1.6605, -0.5876, -0.0728], [-0.1246, 1.1329, -0.0083], [-0.0182, -0.1006, 1.1187]];
    for (found, expected) in matrix.iter().flatten().zip(expected.iter().flatten()) {
        assert!((found - expected).abs() < 2e-4, "{matrix:?}");
    }
    for name in space::names() {
        let surface = space::reflectance_rec709_from(name).unwrap();
        let light = space::rec709_from(name).unwrap();
        for (surface, light) in surface.iter().zip(light) {
            assert!((surface.iter().sum::<f32>() - 1.0).abs() < 1e-5, "{name}: white stays white");
            let is_d65 = name != "aces2065-1";
            assert_eq!((light.iter().sum::<f32>() - 1.0).abs() < 1e-5, is_d65, "{name}");
        }
    }
    assert_eq!(space::rec709_from("cmyk"), None);
}

#[test]
fn spd_files_are_read() {
    let curve = Curve::Tabulated { wavelengths: vec![400.0, 500.5], values: vec![0.5, -2e-3] };
    for text in
        ["400 .5\n500.5 -2e-3\n", "# gold\r\n400 0.5 # first\r\n\r\n500.5\t-0.002", "400 .5 500.5 -.002"]
    {
        assert_eq!(read(text).unwrap(), curve, "{text:?}");
    }
}

#[test]
fn spd_errors_say_where() {
    for (text, kind, line, says) in [
        ("400 1\n500 one", ErrorKind::Syntax, 2, "found `one`"),
        ("400 1\n\n400 2", ErrorKind::Invalid, 3, "is not above the previous"),
        ("400 nan", ErrorKind::Invalid, 1, "not a finite"),
        ("400 1\n500", ErrorKind::Syntax, 0, "has no value"),
        ("# nothing\n", ErrorKind::Invalid, 0, "no wavelength"),
        ("400,1\n", ErrorKind::Syntax, 1, "found `400,1`"),
    ] {
        let error = read(text).unwrap_err();
        assert_eq!((error.kind, error.at.line), (kind, line), "{text:?}: {error}");
        assert!(error.message.contains(says) && error.hint.is_some(), "{error}");
    }
    let files = Memory([("a.spd".into(), b"400 1 500 2 600 3".to_vec())].into());
    let mut context = LoadContext::new(&files);
    context.limits.elements = 2;
    assert_eq!(read_spd(Path::new("a.spd"), &mut context).unwrap_err().kind, ErrorKind::Limit);
    assert_eq!(read_spd(Path::new("b.spd"), &mut context).unwrap_err().kind, ErrorKind::Io);
}

#[test]
#[ignore = "needs LOOKFROM_SHARED"]
fn the_shared_gold_is_ours() {
    let folder = lookfrom_test_data::shared("scenes/killeroos/spds");
    for (file, name) in [("Au.eta.spd", "metal-Au-eta"), ("Au.k.spd", "metal-Au-k")] {
        let read = read_spd(&folder.join(file), &mut LoadContext::new(&crate::Disk)).unwrap();
        let named = named(name).unwrap();
        for nm in 360..=830 {
            assert!((read.at(nm as f32) - named.at(nm as f32)).abs() < 1e-5, "{file} at {nm}");
        }
    }
}

/// Sums over the responses of each camera's red, green and blue, so that no number changes unnoticed.
const SUMS_OF_RESPONSES: &[(&str, [f64; 3])] = &[
    ("canon_eos_100d", [4.819924, 9.856912, 7.099039]),
    ("canon_eos_1dx_mkii", [5.341798, 10.199717, 6.994573]),
    ("canon_eos_200d", [5.594447, 10.213169, 6.885481]),
    ("canon_eos_200d_mkii", [5.396714, 10.284562, 6.937101]),
    ("canon_eos_5d", [4.382393, 8.809695, 6.283319]),
    ("canon_eos_5d_mkii", [4.214292, 9.251356, 6.168651]),
    ("canon_eos_5d_mkiii", [4.484123, 9.625701, 6.299909]),
    ("canon_eos_5d_mkiv", [4.992194, 10.219386, 7.478424]),
    ("canon_eos_5ds", [4.447982, 9.841008, 6.172539]),
    ("canon_eos_m", [4.746938, 9.764003, 7.060697]),
    ("hasselblad_l1d_20c", [3.486208, 9.750814, 5.906690]),
    ("nikon_d810", [4.656981, 9.239415, 7.463092]),
    ("nikon_d850", [4.428167, 8.621736, 6.649898]),
    ("sony_ilce_6400", [3.928346, 10.397300, 6.522820]),
    ("sony_ilce_7m3", [3.961588, 9.522420, 6.671254]),
    ("sony_ilce_7rm3", [3.770776, 9.569875, 6.611200]),
    ("sony_ilce_9", [4.090399, 9.599525, 7.202757]),
];

#[test]
fn cameras_have_their_responses() {
    let names: Vec<&str> = CameraSensor::all().map(CameraSensor::name).collect();
    assert_eq!(names, SUMS_OF_RESPONSES.iter().map(|(name, _)| *name).collect::<Vec<_>>());
    for (name, sums) in SUMS_OF_RESPONSES {
        let responses = CameraSensor::named(name).expect("a camera").responses();
        for ((response, sum), peak) in responses.iter().zip(sums).zip([580..=610, 520..=520, 450..=480]) {
            let at = |nm: u16| f64::from(response.at(f32::from(nm)));
            let table = || (380..=720).step_by(10);
            assert!((table().map(at).sum::<f64>() - sum).abs() < 2e-6, "{name}");
            assert!(table().all(|nm| at(nm) > 0.0 && at(nm) <= 1.0), "{name}");
            let greatest = table().max_by(|&a, &b| at(a).total_cmp(&at(b))).expect("one");
            assert!(peak.contains(&greatest), "{name}: {greatest} nm");
            // Beyond the table, the first and the last value go on.
            let is_same = |a: f64, b: f64| (a - b).abs() <= 1e-6 * b;
            assert!(is_same(at(360), at(380)) && is_same(at(830), at(720)), "{name}");
        }
        assert_eq!(responses[1].at(520.0), 1.0, "{name}");
    }
    assert_eq!(CameraSensor::named("cie1931"), None);
}

#[test]
fn swatches_are_those_of_the_chart() {
    let swatches: Vec<Curve> = swatches().collect();
    assert_eq!(swatches.len(), 24);
    assert_eq!(
        (swatches[18].at(380.0), swatches[18].at(730.0), swatches[18].at(830.0)),
        (0.189, 0.933, 0.933)
    );
    // Luminance factors in daylight, within the spread of charts: the grey steps, and blue, green and red.
    let white = named("stdillum-D65").expect("one of ours");
    let luminance = |swatch: &Curve| {
        let sum =
            |nm: u32| f64::from(observer::matching()[1][(nm - SHORTEST) as usize] * white.at(nm as f32));
        let lit = |nm: u32| sum(nm) * f64::from(swatch.at(nm as f32));
        (SHORTEST..=LONGEST).map(lit).sum::<f64>() / (SHORTEST..=LONGEST).map(sum).sum::<f64>()
    };
    for (index, expected) in [
        (18, 0.90),
        (19, 0.59),
        (20, 0.36),
        (21, 0.19),
        (22, 0.09),
        (23, 0.032),
        (12, 0.062),
        (13, 0.23),
        (14, 0.12),
    ] {
        let found = luminance(&swatches[index]);
        assert!((found / expected - 1.0).abs() < 0.05, "{index}: {found}");
    }
}
