//! Texture maps of MTL: options, then a file name.

use crate::error::Location;
use crate::model::number::parse_f32;
use crate::model::scan::Scanner;
use crate::texture::Channel;

/// A texture map as it is written.
#[derive(Clone, Debug, PartialEq)]
pub struct Map {
    /// The location of its name.
    pub at: Location,
    /// The file name as it is written, with `/` between folders.
    pub file: String,
    /// `-s`: factor of the texture coordinates.
    pub scale: [f32; 2],
    /// `-o`: then this is added.
    pub offset: [f32; 2],
    /// `-clamp on`: nothing of the picture outside [0, 1].
    pub clamp: bool,
    /// `-mm base gain`: values are base + gain · texel.
    pub range: [f32; 2],
    /// `-bm`: multiplies heights, or the slopes of normals.
    pub strength: f32,
    /// `-imfchan`: the channel that is the number, where the map is one; [`Channel::Rgb`] is the luminance.
    pub channel: Option<Channel>,
}

impl Map {
    /// The range of a map without `-mm`.
    pub const WHOLE_RANGE: [f32; 2] = [0.0, 1.0];

    /// The rest of a statement; `None` if there is no file name, which may contain spaces.
    pub(super) fn read(scanner: &mut Scanner<'_>, file: &Location) -> Option<Self> {
        let mut map = Self {
            at: file.clone(),
            file: String::new(),
            scale: [1.0; 2],
            offset: [0.0; 2],
            clamp: false,
            range: Self::WHOLE_RANGE,
            strength: 1.0,
            channel: None,
        };
        loop {
            let before = scanner.clone();
            let option = scanner.word();
            // Minimum and maximum number of arguments; those beyond the minimum must be numbers.
            let (least, most) = match option {
                b"-s" | b"-o" | b"-t" => (1, 3),
                b"-mm" => (2, 2),
                b"-clamp" | b"-blendu" | b"-blendv" | b"-cc" | b"-imfchan" | b"-type" | b"-bm"
                | b"-boost" | b"-texres" => (1, 1),
                _ => {
                    *scanner = before;
                    let name = scanner.rest_of_line();
                    map.at = scanner.at(file);
                    let name = String::from_utf8_lossy(name.trim_ascii()).replace('\\', "/");
                    map.file = name.trim_matches('"').trim().to_owned();
                    return (!map.file.is_empty()).then_some(map);
                }
            };
            let mut numbers = Vec::new();
            for taken in 0..most {
                let before = scanner.clone();
                let word = scanner.word();
                match parse_f32(word).filter(|value| value.is_finite()) {
                    Some(number) => numbers.push(number),
                    None if taken < least => map.set(option, word),
                    None => {
                        *scanner = before;
                        break;
                    }
                }
            }
            let pair = |otherwise: [f32; 2]| {
                [
                    numbers.first().copied().unwrap_or(otherwise[0]),
                    numbers.get(1).copied().unwrap_or(otherwise[1]),
                ]
            };
            match option {
                b"-s" => map.scale = pair(map.scale),
                b"-o" => map.offset = pair(map.offset),
                b"-mm" => map.range = pair(map.range),
                b"-bm" => map.strength = numbers.first().copied().unwrap_or(map.strength),
                _ => {}
            }
        }
    }

    /// An option whose argument is a word.
    fn set(&mut self, option: &[u8], word: &[u8]) {
        match (option, word) {
            (b"-clamp", b"on") => self.clamp = true,
            (b"-imfchan", b"r") => self.channel = Some(Channel::Red),
            (b"-imfchan", b"g") => self.channel = Some(Channel::Green),
            (b"-imfchan", b"b") => self.channel = Some(Channel::Blue),
            (b"-imfchan", b"m") => self.channel = Some(Channel::Alpha),
            (b"-imfchan", b"l") => self.channel = Some(Channel::Rgb),
            _ => {}
        }
    }
}
