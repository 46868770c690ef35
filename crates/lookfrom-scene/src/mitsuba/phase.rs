//! Phase functions: one lobe, or two that are blended.

use std::rc::Rc;

use super::Reader;
use super::plugin::Plugin;
use crate::error::{Error, ErrorKind, Result};
use crate::medium::DraineLobe;

impl Reader<'_, '_> {
    /// The mean cosine of a lobe of Henyey and Greenstein, and a lobe of Draine beside it.
    pub(super) fn phase(&mut self, plugin: &Rc<Plugin>) -> Result<(f32, Option<DraineLobe>)> {
        let mut lobes = Vec::new();
        self.add_lobes(plugin, 1.0, &mut lobes)?;
        // The lobe that is none of Henyey and Greenstein is the second one.
        lobes.sort_by(|a: &DraineLobe, b| a.alpha.total_cmp(&b.alpha).then(a.g.abs().total_cmp(&b.g.abs())));
        match lobes[..] {
            [only] if only.alpha == 0.0 => Ok((only.g, None)),
            [only] => Ok((0.0, Some(only))),
            [first, second] if first.alpha == 0.0 => Ok((first.g, Some(second))),
            _ => {
                let message = "a blend of more than two phases, or of two of Rayleigh's";
                Err(Error::new(ErrorKind::Unsupported, &plugin.at, message))
            }
        }
    }

    /// Adds the lobes of a phase function that has a share, those of Henyey and Greenstein with α = 0; equal ones together.
    fn add_lobes(&mut self, plugin: &Rc<Plugin>, share: f32, lobes: &mut Vec<DraineLobe>) -> Result<()> {
        let (g, alpha) = match &*plugin.kind {
            "isotropic" => (0.0, 0.0),
            "rayleigh" => (0.0, 1.0),
            "hg" => {
                let g = plugin.float_where("g", 0.8, "a number between −1 and 1", |g| g.abs() < 1.0)?;
                (g as f32, 0.0)
            }
            "blendphase" => {
                let weight = self.coefficient(plugin, "weight", 0.5)?[0].clamp(0.0, 1.0);
                let [first, second] = plugin.two_parts("phase", &self.ids)?;
                return self.within(plugin, |reader| {
                    reader.add_lobes(&first, share * (1.0 - weight), lobes)?;
                    reader.add_lobes(&second, share * weight, lobes)
                });
            }
            _ => return Err(plugin.unsupported(&["blendphase", "hg", "isotropic", "rayleigh"])),
        };
        match lobes.iter_mut().find(|known| (known.g, known.alpha) == (g, alpha)) {
            Some(known) => known.share += share,
            None if share > 0.0 => lobes.push(DraineLobe { g, alpha, share }),
            None => {}
        }
        Ok(())
    }
}
