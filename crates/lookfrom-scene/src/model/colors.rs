//! The range of the colours of vertices, which files do not tell: 0 to 1, or 0 to 255.

use crate::error::Location;
use crate::files::LoadContext;

/// Colours that are brighter than this are bytes.
const BRIGHTEST: f32 = 16.0;

/// The meaning of the values of colours.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Range {
    /// 1 is white.
    Unit,
    /// 255 is white.
    Bytes,
}

/// The range of all these values, with a note if it is that of bytes, and a warning if some are above 1 all the same; `above` says
/// what becomes of those.
pub(crate) fn range(
    values: impl Iterator<Item = f32>,
    above: &str,
    file: &Location,
    context: &mut LoadContext<'_>,
) -> Range {
    let (mut most, mut bright) = (0.0_f32, 0_usize);
    for value in values.filter(|value| value.is_finite()) {
        most = most.max(value);
        bright += usize::from(value > 1.0);
    }
    if most > BRIGHTEST && most <= 255.0 {
        context.notice(file, format!("the colours of vertices reach {most}: 255 is taken to be white"));
        return Range::Bytes;
    }
    if bright > 0 {
        context.warn(file, format!("{bright} colours of vertices are above 1, up to {most}: {above}"));
    }
    Range::Unit
}
