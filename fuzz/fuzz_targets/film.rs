#![no_main]

use std::path::Path;

use lookfrom::session::FilmFile;
use lookfrom_scene::budget::Budget;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    // A film with a wrong checksum is refused at once: this one gets the right one.
    let mut bytes = bytes.to_vec();
    const MARK: &[u8] = b"crc32\0string\0\x08\0\0\0";
    if let Some(place) = bytes.windows(MARK.len()).position(|window| window == MARK) {
        let digits = place + MARK.len()..place + MARK.len() + 8;
        if let Some(zeros) = bytes.get_mut(digits.clone()) {
            zeros.fill(b'0');
            let checksum = format!("{:08x}", crc32fast::hash(&bytes));
            bytes[digits].copy_from_slice(checksum.as_bytes());
        }
    }
    if let Ok(film) = FilmFile::read(&bytes, Path::new("a.exr"), &Budget::new(64 << 20)) {
        let area = film.film.area();
        assert!(area.x0 < area.x1 && area.x1 <= film.film.width());
        assert!(
            film.film.ledger().bounds().is_none_or(|bounds| bounds.x1 <= area.x1 && bounds.y1 <= area.y1)
        );
        let _ = film.film.picture();
    }
});
