//! Tests of the reader of measured materials: a file made here, and damaged ones.

use super::*;

/// A file of fields of numbers, each with its shape.
pub(crate) fn file(fields: &[(&str, &[u64], Vec<f32>)]) -> Vec<u8> {
    let mut header = b"tensor_file\0\x01\x00".to_vec();
    header.extend((fields.len() as u32).to_le_bytes());
    let length: usize = fields.iter().map(|(name, shape, _)| 13 + name.len() + 8 * shape.len()).sum();
    let mut offset = (header.len() + length) as u64;
    let mut data = Vec::new();
    for (name, shape, values) in fields {
        header.extend((name.len() as u16).to_le_bytes());
        header.extend(name.bytes());
        header.extend((shape.len() as u16).to_le_bytes());
        header.push(10);
        header.extend(offset.to_le_bytes());
        shape.iter().for_each(|count| header.extend(count.to_le_bytes()));
        values.iter().for_each(|value| data.extend(value.to_le_bytes()));
        offset += 4 * values.len() as u64;
    }
    header.extend(data);
    header
}

/// The fields of an isotropic material of one table, all of whose numbers are 1.
fn fields() -> Vec<(&'static str, &'static [u64], Vec<f32>)> {
    vec![
        ("phi_i", &[1], vec![0.0]),
        ("theta_i", &[2], vec![0.0, 1.5]),
        ("wavelengths", &[3], vec![400.0, 500.0, 600.0]),
        ("ndf", &[3, 2], vec![1.0; 6]),
        ("sigma", &[2, 3], vec![1.0; 6]),
        ("vndf", &[1, 2, 2, 4], vec![1.0; 16]),
        ("luminance", &[1, 2, 3, 2], vec![1.0; 12]),
        ("spectra", &[1, 2, 3, 3, 2], vec![1.0; 36]),
    ]
}

fn read(bytes: &[u8]) -> Result<Measured> {
    Measured::from_bytes(bytes, &Location::file(Path::new("a.bsdf")))
}

#[test]
fn tables_have_their_sizes() {
    let measured = read(&file(&fields())).expect("a file");
    assert!(measured.is_isotropic() && measured.is_consistent());
    let Tables::Adaptive(tables) = measured.tables else { panic!("other tables") };
    assert_eq!((tables.ndf.size, tables.sigma.size), ([2, 3], [3, 2]));
    assert_eq!((tables.vndf.size, tables.vndf.values.len()), ([4, 2], 16));
    assert_eq!((tables.spectra.size, tables.spectra.area()), ([2, 3], 6));
    assert_eq!(tables.wavelengths, [400.0, 500.0, 600.0]);
}

/// A file of MERL's kind of 2 × 1 × 2 cells.
fn half_angle_file() -> Vec<u8> {
    let mut bytes: Vec<u8> = [2_u32, 1, 2].iter().flat_map(|count| count.to_le_bytes()).collect();
    let numbers: [f64; 12] = [150.0, 300.0, 450.0, -1.0, 1500.0, 0.0, 0.0, 3000.0, 0.0, 1500.0, 0.0, 0.0];
    bytes.extend(numbers.iter().flat_map(|number| number.to_le_bytes()));
    bytes
}

#[test]
fn merl_s_numbers_are_scaled_and_cells_without_one_are_black() {
    let measured = read(&half_angle_file()).expect("a file");
    assert!(measured.is_isotropic() && measured.is_consistent());
    let Tables::HalfAngle(tables) = measured.tables else { panic!("other tables") };
    assert_eq!(tables.counts, [2, 1, 2]);
    assert_eq!(tables.values, [[0.1, 1.15, 0.0], [0.2, 0.0, 1.66], [0.3, 0.0, 0.0], [0.0, 2.3, 0.0]]);
}

#[test]
fn damaged_files_of_merl_s_are_told() {
    let cut = |bytes: Vec<u8>| read(&bytes).expect_err("damaged").to_string();
    let mut own = half_angle_file();
    own[..12].copy_from_slice(&[90_u32, 90, 180].map(u32::to_le_bytes).concat());
    assert!(cut(own).contains("108 bytes for 90 × 90 × 180 cells"));
    let mut endless = half_angle_file();
    endless[12..20].copy_from_slice(&f64::INFINITY.to_le_bytes());
    assert!(cut(endless).contains("not finite"));
    let mut huge = half_angle_file();
    huge[..12].fill(0xFF);
    assert!(cut(huge).contains("not a file of measured tables"));
}

#[test]
fn what_is_wrong_is_said() {
    let with = |name: &str, shape: &'static [u64], values: Vec<f32>| {
        let mut fields = fields();
        let field = fields.iter_mut().find(|field| field.0 == name).expect("a field");
        (field.1, field.2) = (shape, values);
        read(&file(&fields)).expect_err(name).to_string()
    };
    let whole = file(&fields());
    let cases = [
        (read(b"P6 1 1").expect_err("a picture").to_string(), "not a file of measured tables"),
        (read(&whole[..60]).expect_err("a part").to_string(), "ends within the list"),
        (read(&whole[..whole.len() - 1]).expect_err("a part").to_string(), "end after the file"),
        (read(&file(&fields()[1..])).expect_err("no φ").to_string(), "there is no field \"phi_i\""),
        (with("theta_i", &[2], vec![1.0, 1.0]), "do not increase"),
        (with("ndf", &[3, 2], vec![f32::NAN; 6]), "negative or not finite"),
        (with("ndf", &[1, 6], vec![1.0; 6]), "less than two rows"),
        (with("vndf", &[2, 1, 2, 4], vec![1.0; 16]), "expected [1, 2]"),
        (with("luminance", &[1, 2, 2, 3], vec![1.0; 12]), "different sizes"),
        (with("sigma", &[1 << 40, 1 << 40], vec![1.0; 6]), "end after the file"),
        (with("phi_i", &[3], vec![0.0, 0.7, 1.5707964]), "1/4 of all azimuths"),
    ];
    for (message, expected) in cases {
        assert!(message.contains(expected), "{message:?} has no {expected:?}");
    }
}
