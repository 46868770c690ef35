//! Options of the formats of pictures.

use clap::Args;
use clap::builder::PossibleValuesParser;
use lookfrom::scene::Error;
use lookfrom::session::Format;

use crate::exit::Failure;
use crate::output::Target;
use crate::values;

#[derive(Args, Debug)]
pub(crate) struct EncodingArguments {
    /// Format where no file name says it: of -o -, of a folder and without -o [default: png]
    #[arg(long, value_name = "EXTENSION", value_parser = extensions())]
    format: Option<String>,

    /// Quality of JPEGs, from 1 to 100 [default: 90]
    #[arg(long, value_name = "N", value_parser = values::whole(1u8, 100))]
    quality: Option<u8>,

    /// Bits of a channel: 8 or 16 in PNGs [default: 8], 16 or 32 in EXRs [default: 32]
    ///
    /// Of an .exr 16 are for colours, alpha and normals: half the bytes. Its other layers, such as depths and masks, keep 32.
    #[arg(long, value_name = "8|16|32", value_parser = values::word(BITS))]
    bits: Option<u8>,
}

const BITS: &[(&str, u8)] = &[("8", 8), ("16", 16), ("32", 32)];

/// Parser of extensions of formats.
fn extensions() -> PossibleValuesParser {
    PossibleValuesParser::new(Format::EXTENSIONS.iter().map(|&(extension, _)| extension))
}

impl EncodingArguments {
    /// The extension where no file name says it.
    pub(crate) fn format(&self) -> Option<&str> {
        self.format.as_deref()
    }

    /// Targets with what is asked of their formats.
    ///
    /// # Errors
    /// `Usage` where a target is of another format.
    pub(crate) fn apply(&self, targets: Vec<Target>) -> Result<Vec<Target>, Failure> {
        targets.into_iter().map(|target| self.of_target(target)).collect()
    }

    fn of_target(&self, target: Target) -> Result<Target, Failure> {
        let format = match target.format() {
            Format::Jpeg(quality) => Format::Jpeg(self.quality.unwrap_or(quality)),
            _ if self.quality.is_some() => {
                let message = format!("--quality is for JPEGs, and {} is none", target.name());
                return Err(Failure::Usage(message));
            }
            format => format,
        };
        let Some(bits) = self.bits else { return Ok(target.of_format(format)) };
        let wrong = |error: Error| {
            Failure::Usage(format!("{} cannot have --bits {bits}: {}", target.name(), error.message))
        };
        let format = format.with_bits(bits).map_err(wrong)?;
        Ok(target.of_format(format))
    }
}
