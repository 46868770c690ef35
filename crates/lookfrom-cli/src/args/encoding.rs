//! Options of the formats of pictures.

use clap::Args;
use clap::builder::PossibleValuesParser;
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

    /// Bits of a channel in PNGs: 8 or 16 [default: 8]
    #[arg(long, value_name = "8|16", value_parser = values::word(BITS))]
    bits: Option<Bits>,
}

/// Bits of a channel.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Bits {
    Eight,
    Sixteen,
}

const BITS: &[(&str, Bits)] = &[("8", Bits::Eight), ("16", Bits::Sixteen)];

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
        let wrong = |option: &str, formats: &str| {
            Err(Failure::Usage(format!("{option} is for {formats}, and {} is none", target.name())))
        };
        let format = match target.format() {
            Format::Jpeg(quality) => Format::Jpeg(self.quality.unwrap_or(quality)),
            _ if self.quality.is_some() => return wrong("--quality", "JPEGs"),
            Format::Png if self.bits == Some(Bits::Sixteen) => Format::Png16,
            format => format,
        };
        if self.bits == Some(Bits::Sixteen) && format != Format::Png16 {
            return wrong("--bits 16", "PNGs");
        }
        Ok(target.of_format(format))
    }
}
