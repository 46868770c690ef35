//! Values of the channels of an OpenEXR file as floats, without those of a film.

use ::exr::block::chunk::TileCoordinates;
use ::exr::block::lines::LineRef;
use ::exr::error::{Error, Result, UnitResult};
use ::exr::image::read::any_channels::{ReadSamples, SamplesReader};
use ::exr::math::Vec2;
use ::exr::meta::attribute::{ChannelDescription, SampleType};
use ::exr::meta::header::Header;
use ::exr::prelude::f16;

/// Whether a channel is part of the picture: the sums of a film are not (lookfrom's film files).
pub(super) fn is_shown(channel: &ChannelDescription) -> bool {
    !channel.name.to_string().starts_with("film.")
}

/// Reads the channels that [`is_shown`] selects, of the largest resolution.
pub(super) struct ShownValues;

/// The values of a channel, row by row; none of a channel that is left out.
pub(super) struct Values {
    width: usize,
    kind: SampleType,
    values: Option<Vec<f32>>,
}

impl ReadSamples for ShownValues {
    type Reader = Values;

    fn create_sample_reader(&self, header: &Header, channel: &ChannelDescription) -> Result<Values> {
        let Vec2(width, height) = header.layer_size;
        let values = is_shown(channel).then(|| vec![0.0; width * height]);
        Ok(Values { width, kind: channel.sample_type, values })
    }
}

impl SamplesReader for Values {
    type Samples = Option<Vec<f32>>;

    fn filter_block(&self, tile: TileCoordinates) -> bool {
        self.values.is_some() && tile.level_index == Vec2(0, 0)
    }

    fn read_line(&mut self, line: LineRef<'_>) -> UnitResult {
        let Some(values) = &mut self.values else { return Ok(()) };
        let Vec2(left, row) = line.location.position;
        let first = row * self.width + left;
        let values = values.get_mut(first..first + line.location.sample_count);
        let values = values.ok_or(Error::Invalid("a line of pixels outside of the picture".into()))?;
        match self.kind {
            SampleType::F32 => line.read_samples_into_slice(values),
            SampleType::F16 => read_each::<f16>(&line, values, f16::to_f32),
            SampleType::U32 => read_each::<u32>(&line, values, |number| number as f32),
        }
    }

    fn into_samples(self) -> Option<Vec<f32>> {
        self.values
    }
}

fn read_each<T: ::exr::io::Data>(line: &LineRef<'_>, values: &mut [f32], float: fn(T) -> f32) -> UnitResult {
    for (value, sample) in values.iter_mut().zip(line.read_samples::<T>()) {
        *value = float(sample?);
    }
    Ok(())
}
