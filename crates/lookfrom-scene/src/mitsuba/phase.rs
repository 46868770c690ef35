//! Phase functions: one lobe, or two that are blended.

use std::rc::Rc;

use super::Reader;
use super::plugin::Plugin;
use crate::error::{Error, ErrorKind, Result};
use crate::medium::DraineLobe;

/// A lobe of Draine with its share: of Henyey and Greenstein where α is 0.
type Lobe = DraineLobe;

impl Reader<'_, '_> {
    /// The mean cosine of a lobe of Henyey and Greenstein, and a lobe of Draine beside it.
    pub(super) fn phase(&mut self, plugin: &Rc<Plugin>) -> Result<(f32, Option<DraineLobe>)> {
        let mut lobes = Vec::new();
        self.add_lobes(plugin, 1.0, &mut lobes)?;
        // The lobe that is none of Henyey and Greenstein is the second one.
        lobes.sort_by(|a: &Lobe, b| a.alpha.total_cmp(&b.alpha).then(a.g.abs().total_cmp(&b.g.abs())));
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

    /// Adds the lobes of a phase function that has a share; equal ones together.
    fn add_lobes(&mut self, plugin: &Rc<Plugin>, share: f32, lobes: &mut Vec<Lobe>) -> Result<()> {
        let (g, alpha) = match &*plugin.kind {
            "isotropic" => (0.0, 0.0),
            "rayleigh" => (0.0, 1.0),
            "hg" => {
                let g = plugin.float_where("g", 0.8, "a number between −1 and 1", |g| g.abs() < 1.0)?;
                (g as f32, 0.0)
            }
            "blendphase" => {
                let volume = self.volume(plugin, "weight", 0.5)?;
                let parts = plugin.parts("phase", &self.ids)?;
                let [(_, first), (_, second)] = &parts[..] else {
                    let message = format!("a blendphase has two phases in it, this one has {}", parts.len());
                    return Err(Error::invalid(&plugin.at, message));
                };
                if !volume.lattice.is_even() {
                    let message = "a blendphase whose weight varies in space";
                    return Err(Error::new(ErrorKind::Unsupported, &plugin.at, message));
                }
                let weight = volume.lattice.cell([0; 3])[0].clamp(0.0, 1.0);
                return self.within(plugin, |reader| {
                    reader.add_lobes(first, share * (1.0 - weight), lobes)?;
                    reader.add_lobes(second, share * weight, lobes)
                });
            }
            _ => return Err(plugin.unsupported(&["blendphase", "hg", "isotropic", "rayleigh"])),
        };
        match lobes.iter_mut().find(|known| (known.g, known.alpha) == (g, alpha)) {
            Some(known) => known.share += share,
            None if share > 0.0 => lobes.push(Lobe { g, alpha, share }),
            None => {}
        }
        Ok(())
    }
}
