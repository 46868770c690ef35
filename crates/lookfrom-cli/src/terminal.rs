//! Pictures in the terminal: by graphics where it has them, else by coloured half blocks.
//!
//! The capabilities of a terminal are concluded from its environment: not every terminal answers when escape codes ask for
//! them.

mod blocks;
mod kitty;
mod sixel;

use console::Term;
use image::RgbaImage;
use image::imageops::thumbnail;
use lookfrom::session::Shown;

use crate::exit::{self, Failure};

/// A way to draw a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Way {
    /// The graphics protocol of kitty: a PNG.
    Kitty,
    /// Sixels: rows of six pixels with a palette of 256 colours.
    Sixel,
    /// Half blocks in 24-bit colour.
    Blocks,
    /// Half blocks in 256 colours.
    Blocks256,
}

/// The pictures that are asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Show {
    /// Whatever the terminal can do, if stderr is one.
    Auto,
    /// This way, whatever stderr is.
    Always(Way),
    Off,
}

impl Show {
    pub(crate) const WORDS: &[(&str, Self)] = &[
        ("auto", Self::Auto),
        ("kitty", Self::Always(Way::Kitty)),
        ("sixel", Self::Always(Way::Sixel)),
        ("blocks", Self::Always(Way::Blocks)),
        ("off", Self::Off),
    ];

    /// The way to draw on stderr, if any.
    pub(crate) fn way(self) -> Option<Way> {
        match self {
            Self::Off => None,
            Self::Always(way) => Some(way),
            Self::Auto if exit::stderr_is_terminal() => way_of(&|name| std::env::var(name).ok()),
            Self::Auto => None,
        }
    }
}

/// The way in which a terminal with this environment shows pictures, if any.
fn way_of(variable: &dyn Fn(&str) -> Option<String>) -> Option<Way> {
    let of = |name| variable(name).unwrap_or_default();
    let (terminal, program) = (of("TERM"), of("TERM_PROGRAM"));
    if terminal.is_empty() || terminal == "dumb" {
        return None;
    }
    let blocks = match of("COLORTERM").as_str() {
        "truecolor" | "24bit" => Way::Blocks,
        _ if terminal.ends_with("direct") => Way::Blocks,
        _ => Way::Blocks256,
    };
    // What runs inside of these does not reach the terminal's graphics.
    let is_inside = variable("TMUX").is_some()
        || ["screen", "tmux", "zellij"].iter().any(|name| terminal.starts_with(name));
    if is_inside || variable("ZELLIJ").is_some() {
        return Some(blocks);
    }
    let has_kitty = variable("KITTY_WINDOW_ID").is_some()
        || variable("KONSOLE_VERSION").and_then(|version| version.parse().ok()) >= Some(220_400)
        || ["kitty", "ghostty"].iter().any(|name| terminal.contains(name))
        || ["WezTerm", "ghostty"].contains(&program.as_str());
    let has_sixel = ["sixel", "foot", "mlterm", "contour"].iter().any(|name| terminal.contains(name))
        || ["iTerm.app", "mintty"].contains(&program.as_str());
    Some(if has_kitty {
        Way::Kitty
    } else if has_sixel {
        Way::Sixel
    } else {
        blocks
    })
}

/// Columns and rows of a terminal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Size {
    columns: u32,
    rows: u32,
}

/// Rows of the terminal that stay free, for the lines about the render.
const FREE_ROWS: u32 = 6;

/// Pixels of a character, where graphics are measured in them: as wide and high as those of common fonts.
const CHARACTER: [u32; 2] = [10, 20];

/// Draws a picture on stderr, not larger than the terminal, and not larger than it is.
///
/// # Errors
/// `Output` where the picture cannot be encoded.
pub(crate) fn draw(shown: &Shown, way: Way) -> Result<(), Failure> {
    let (rows, columns) = Term::stderr().size();
    let text = drawn(shown, way, Size { columns: columns.into(), rows: rows.into() });
    exit::show(
        text.map_err(|error| Failure::Output(format!("--show: {}", error.message)))?.trim_end_matches('\n'),
    );
    Ok(())
}

/// The text that draws a picture, with the line feeds that place the cursor below it.
fn drawn(shown: &Shown, way: Way, size: Size) -> lookfrom_scene::Result<String> {
    let rows = size.rows.saturating_sub(FREE_ROWS).max(4);
    let most = match way {
        Way::Kitty | Way::Sixel => [size.columns * CHARACTER[0], rows * CHARACTER[1]],
        // A half block is a column wide and half a row high.
        Way::Blocks | Way::Blocks256 => [size.columns, rows * 2],
    };
    let small = reduced(shown, most);
    Ok(match way {
        Way::Kitty => {
            kitty::text(&small.encode(lookfrom::session::Format::Png)?, small.width.div_ceil(CHARACTER[0]))
        }
        Way::Sixel => sixel::text(&small),
        Way::Blocks => blocks::text(&small, blocks::true_color),
        Way::Blocks256 => blocks::text(&small, blocks::nearest_of_256),
    })
}

/// The picture at a size that fits, by the means of its pixels.
fn reduced(shown: &Shown, most: [u32; 2]) -> Shown {
    let [width, height] = fitted([shown.width, shown.height], most);
    let picture = RgbaImage::from_raw(shown.width, shown.height, shown.rgba.clone());
    match picture {
        Some(picture) if [width, height] != [shown.width, shown.height] => Shown {
            width,
            height,
            rgba: thumbnail(&picture, width, height).into_raw(),
            has_alpha: shown.has_alpha,
        },
        _ => shown.clone(),
    }
}

/// The largest size with the same shape that is within another one, and not enlarged.
fn fitted([width, height]: [u32; 2], most: [u32; 2]) -> [u32; 2] {
    if width <= most[0] && height <= most[1] {
        return [width, height];
    }
    let [w, h, most_w, most_h] = [width, height, most[0], most[1]].map(u64::from);
    let [w, h] = match w * most_h > h * most_w {
        true => [most_w, (h * most_w + w / 2) / w],
        false => [(w * most_h + h / 2) / h, most_h],
    };
    [w.max(1) as u32, h.max(1) as u32]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn way(variables: &[(&str, &str)]) -> Option<Way> {
        way_of(&|name| {
            variables.iter().find(|(known, _)| *known == name).map(|(_, value)| (*value).to_owned())
        })
    }

    #[test]
    fn terminals_are_known_by_their_environment() {
        let xterm = ("TERM", "xterm-256color");
        assert_eq!(way(&[]), None);
        assert_eq!(way(&[("TERM", "dumb")]), None);
        assert_eq!(way(&[xterm]), Some(Way::Blocks256));
        assert_eq!(way(&[xterm, ("COLORTERM", "truecolor")]), Some(Way::Blocks));
        assert_eq!(way(&[("TERM", "xterm-kitty")]), Some(Way::Kitty));
        assert_eq!(way(&[xterm, ("TERM_PROGRAM", "WezTerm")]), Some(Way::Kitty));
        assert_eq!(way(&[xterm, ("KONSOLE_VERSION", "220401")]), Some(Way::Kitty));
        assert_eq!(way(&[xterm, ("KONSOLE_VERSION", "210401")]), Some(Way::Blocks256));
        assert_eq!(way(&[("TERM", "foot")]), Some(Way::Sixel));
        assert_eq!(way(&[xterm, ("TERM_PROGRAM", "iTerm.app")]), Some(Way::Sixel));
        let inside = [("TERM", "screen-256color"), ("KITTY_WINDOW_ID", "1"), ("COLORTERM", "24bit")];
        assert_eq!(way(&inside), Some(Way::Blocks));
    }

    #[test]
    fn pictures_fit_and_keep_their_shape() {
        assert_eq!(fitted([640, 480], [80, 40]), [53, 40]);
        assert_eq!(fitted([640, 100], [80, 40]), [80, 13]);
        assert_eq!(fitted([20, 10], [80, 40]), [20, 10]);
        assert_eq!(fitted([100_000, 1], [80, 40]), [80, 1]);
        assert_eq!(fitted([1, u32::MAX], [80, 40]), [1, 40]);
    }
}
