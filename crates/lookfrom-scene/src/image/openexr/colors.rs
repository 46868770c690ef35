//! The colours of an OpenEXR file: which part and layer they are in, and what its channels stand for.
//!
//! A channel `layer.R` belongs to a layer; the rest of its name tells what it is. Colours are R, G and B, or luminance with
//! chroma (Y, RY, BY), or X, Y and Z, or grey: Y, or an only channel. The attribute `chromaticities` tells the primaries; without it
//! they are those of Rec. 709.

use super::windows::Windows;
use super::{Decoded, Part, decode, full_name};
use crate::error::{Error, Location, Result};
use crate::files::LoadContext;
use crate::image::read::{By, Floats, Reading};
use crate::spectrum::space::Chromaticities;
use crate::suggest::nearest;

/// Layers that hold the finished picture, where a part has several: channels stand in the order of their names.
const FINISHED: [&str; 4] = ["combined", "beauty", "rgba", "rgb"];

/// The most names in a message.
const MOST_TOLD: usize = 12;

/// The channels of a layer that make colours, by their indices in the part.
#[derive(Clone, Copy, Debug)]
enum ColorChannels {
    Rgb([usize; 3]),
    LuminanceChroma([usize; 3]),
    Xyz([usize; 3]),
    Gray(usize),
}

impl ColorChannels {
    fn rank(self) -> u32 {
        match self {
            Self::Rgb(_) => 0,
            Self::LuminanceChroma(_) => 1,
            Self::Xyz(_) => 2,
            Self::Gray(_) => 3,
        }
    }
}

/// A layer of a part, and its colours if it has any.
struct Layer {
    part: usize,
    /// The name in the part: empty for channels without a layer.
    own: String,
    /// The name with that of the part.
    name: String,
    kind: Option<ColorChannels>,
    /// As `kind`, or numbers that are no colours.
    values: Option<ColorChannels>,
}

/// The colours of an OpenEXR file.
pub(in crate::image) fn decode_rgb(
    bytes: &[u8],
    at: &Location,
    reading: &Reading<'_>,
    context: &mut LoadContext<'_>,
) -> Result<Floats> {
    let windows = if reading.by == By::Standard { Windows::Display } else { Windows::Data };
    let mut decoded = decode(bytes, windows, at, context)?;
    let Colors { texels, alpha, to_rec709 } = take_colors(&mut decoded, at, reading, context)?;
    let is_opaque = alpha.iter().flatten().all(|&alpha| alpha == 1.0);
    let alpha = alpha.filter(|_| !is_opaque).unwrap_or_default();
    let Decoded { size: [width, height], memory, .. } = decoded;
    Ok(Floats { width, height, texels, alpha, to_rec709, memory })
}

/// The colours of a layer.
pub(super) struct Colors {
    pub(super) texels: Vec<[f32; 3]>,
    pub(super) alpha: Option<Vec<f32>>,
    /// As that of [`Floats`].
    pub(super) to_rec709: Option<[[f32; 3]; 3]>,
}

/// Takes the channels of the layer that `reading` selects, and leaves them without values.
pub(super) fn take_colors(
    decoded: &mut Decoded,
    at: &Location,
    reading: &Reading<'_>,
    context: &mut LoadContext<'_>,
) -> Result<Colors> {
    let Decoded { parts, chromaticities, .. } = decoded;
    let layers = layers(parts);
    let (part, kind) = match reading.layer {
        Some(name) => named(&layers, name, at)?,
        None => first(&layers, parts, at, context)?,
    };
    let chromaticities = chromaticities.map(|found| {
        let pair = |xy: ::exr::math::Vec2<f32>| [f64::from(xy.0), f64::from(xy.1)];
        Chromaticities { primaries: [found.red, found.green, found.blue].map(pair), white: pair(found.white) }
    });
    let keeps_white = reading.by == By::PbrtLight;
    let mut to_rec709 =
        chromaticities.filter(|_| !reading.is_data()).and_then(|colors| colors.rec709(keeps_white));
    let part = &mut parts[part];
    let alpha = take_alpha(part, kind);
    let mut take = |index: usize| std::mem::take(&mut part.channels[index].1);
    let planes = |[r, g, b]: [Vec<f32>; 3]| -> Vec<[f32; 3]> {
        r.into_iter().zip(g).zip(b).map(|((r, g), b)| [r, g, b]).collect()
    };
    let texels = match kind {
        ColorChannels::Rgb(channels) => planes(channels.map(take)),
        ColorChannels::Gray(channel) => {
            to_rec709 = None;
            take(channel).into_iter().map(|grey| [grey; 3]).collect()
        }
        ColorChannels::Xyz(channels) => {
            to_rec709 = Chromaticities::XYZ.rec709(keeps_white);
            planes(channels.map(take))
        }
        ColorChannels::LuminanceChroma(channels) => {
            let weights = chromaticities.unwrap_or(Chromaticities::REC709).luminance();
            let mut texels = planes(channels.map(take));
            texels.iter_mut().for_each(|texel| *texel = rgb_of_chroma(*texel, weights));
            texels
        }
    };
    Ok(Colors { texels, alpha, to_rec709 })
}

/// The opacity of the layer that has colours.
fn take_alpha(part: &mut Part, colors: ColorChannels) -> Option<Vec<f32>> {
    let (ColorChannels::Rgb([first, ..])
    | ColorChannels::LuminanceChroma([first, ..])
    | ColorChannels::Xyz([first, ..])
    | ColorChannels::Gray(first)) = colors;
    let layer_of = |name: &str| name.rsplit_once('.').map(|(layer, _)| layer.to_owned());
    let layer = layer_of(&part.channels[first].0);
    let is_alpha = |name: &str| {
        let own = name.rsplit('.').next().unwrap_or_default();
        layer_of(name) == layer && ["a", "alpha"].iter().any(|known| known.eq_ignore_ascii_case(own))
    };
    let found =
        part.channels.iter_mut().enumerate().find(|(index, (name, _))| *index != first && is_alpha(name));
    found.map(|(_, (_, values))| std::mem::take(values))
}

/// Colours of luminance Y and the chroma RY = (R − Y) / Y, BY = (B − Y) / Y.
fn rgb_of_chroma([y, ry, by]: [f32; 3], weights: [f32; 3]) -> [f32; 3] {
    let (r, b) = ((ry + 1.0) * y, (by + 1.0) * y);
    [r, (y - r * weights[0] - b * weights[2]) / weights[1], b]
}

/// All layers, in the order of the file.
fn layers(parts: &[Part]) -> Vec<Layer> {
    let mut layers = Vec::new();
    for (index, part) in parts.iter().enumerate() {
        let mut members: Vec<(&str, Vec<(usize, &str)>)> = Vec::new();
        for (channel, (name, _)) in part.channels.iter().enumerate() {
            let (layer, base) = name.rsplit_once('.').unwrap_or(("", name));
            match members.iter_mut().find(|(known, _)| *known == layer) {
                Some((_, channels)) => channels.push((channel, base)),
                None => members.push((layer, vec![(channel, base)])),
            }
        }
        layers.extend(members.into_iter().map(|(own, channels)| {
            let name = match &part.name {
                Some(part) if own.is_empty() => part.clone(),
                part => full_name(part.as_deref(), own),
            };
            let kind = kind(&channels, name.is_empty());
            let values = kind.or_else(|| values(&channels));
            Layer { part: index, own: own.to_owned(), name, kind, values }
        }));
    }
    layers
}

/// The kind of colour that the channels of a layer make, if they are colours.
fn kind(channels: &[(usize, &str)], is_unnamed: bool) -> Option<ColorChannels> {
    all(channels, [&["R", "red"], &["G", "green"], &["B", "blue"]])
        .map(ColorChannels::Rgb)
        .or_else(|| all(channels, [&["Y"], &["RY"], &["BY"]]).map(ColorChannels::LuminanceChroma))
        // X, Y and Z of a layer with a name are positions or directions.
        .or_else(|| all(channels, [&["X"], &["Y"], &["Z"]]).filter(|_| is_unnamed).map(ColorChannels::Xyz))
        .or_else(|| {
            let is_vector = all(channels, [&["X"], &["Y"], &["Z"]]).is_some();
            find(channels, &["Y"]).filter(|_| !is_vector).map(ColorChannels::Gray)
        })
}

/// Three numbers as they are, or one, of a layer that is asked for by its name.
fn values(channels: &[(usize, &str)]) -> Option<ColorChannels> {
    match channels {
        &[(only, _)] => Some(ColorChannels::Gray(only)),
        _ => all(channels, [&["X"], &["Y"], &["Z"]]).map(ColorChannels::Rgb),
    }
}

fn all(channels: &[(usize, &str)], [a, b, c]: [&[&str]; 3]) -> Option<[usize; 3]> {
    Some([find(channels, a)?, find(channels, b)?, find(channels, c)?])
}

fn find(channels: &[(usize, &str)], names: &[&str]) -> Option<usize> {
    let is_named = |name: &str| names.iter().any(|known| known.eq_ignore_ascii_case(name));
    channels.iter().find(|(_, name)| is_named(name)).map(|&(channel, _)| channel)
}

/// The first layer with colours: of the first part that has any, channels without a layer before layers, and among these one
/// that is named as the finished picture. Where there were others, a note tells which one it is.
fn first(
    layers: &[Layer],
    parts: &[Part],
    at: &Location,
    context: &mut LoadContext<'_>,
) -> Result<(usize, ColorChannels)> {
    let is_finished = |layer: &Layer| {
        let last = layer.own.rsplit('.').next().unwrap_or_default();
        FINISHED.iter().any(|name| name.eq_ignore_ascii_case(last))
    };
    let colored = layers.iter().filter_map(|layer| Some((layer, layer.kind?)));
    let rank = |(layer, kind): &(&Layer, ColorChannels)| {
        (kind.rank(), layer.part, !layer.own.is_empty(), !is_finished(layer))
    };
    if let Some((layer, kind)) = colored.clone().min_by_key(rank) {
        let others: Vec<&str> = colored
            .filter(|(other, its_kind)| other.name != layer.name && its_kind.rank() == kind.rank())
            .map(|(other, _)| other.name.as_str())
            .take(MOST_TOLD)
            .collect();
        if !layer.own.is_empty() && !others.is_empty() {
            let others = others.join(", ");
            let message =
                format!("the layer {} is taken; `layer` would take another one: {others}", layer.name);
            context.notice(at, message);
        }
        return Ok((layer.part, kind));
    }
    let all = || parts.iter().flat_map(|part| part.channels.iter().map(move |channel| (part, channel)));
    if let (1, Some(layer)) = (all().count(), layers.first()) {
        return Ok((layer.part, ColorChannels::Gray(0)));
    }
    let names: Vec<String> =
        all().take(MOST_TOLD).map(|(part, (name, _))| full_name(part.name.as_deref(), name)).collect();
    Err(Error::invalid(at, format!("has the channels {}; expected R, G and B, or Y", names.join(", ")))
        .hint("write the picture again with channels of these names, or name a layer"))
}

/// The layer with this name, or whose name ends so.
fn named(layers: &[Layer], name: &str, at: &Location) -> Result<(usize, ColorChannels)> {
    let is_end = |layer: &&Layer| layer.name.strip_suffix(name).is_some_and(|rest| rest.ends_with('.'));
    let found = layers.iter().find(|layer| layer.name == name).or_else(|| layers.iter().find(is_end));
    let Some(layer) = found else {
        let known = || layers.iter().map(|layer| layer.name.as_str()).filter(|name| !name.is_empty());
        let error = Error::invalid(at, format!("there is no layer {name:?} in it"));
        let some: Vec<&str> = known().take(MOST_TOLD).collect();
        return Err(match nearest(name, known()) {
            Some(meant) => error.hint(format!("did you mean {meant:?}?")),
            None if some.is_empty() => error.hint("it has no layers"),
            None => error.hint(format!("there are: {}", some.join(", "))),
        });
    };
    match layer.values {
        Some(kind) => Ok((layer.part, kind)),
        None => Err(Error::invalid(at, format!("the layer {name:?} has no R, G and B, nor Y"))
            .hint("name a layer of colours, of X, Y and Z, or of one channel")),
    }
}
