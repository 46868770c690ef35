//! The spectral modes of paths side by side, and their times.

use lookfrom_simd::{Simd, f32x8, prelude::*};

use crate::core::lanes::{LANES, by_lane, splat_spectrum};
use crate::core::spectrum::Spectrum;
use crate::core::times::Times;
use crate::integrator::{Path, SpectralModes};
use crate::light::EmissionSpectrum;
use crate::shading::texture::{SpectralMode, SpectrumTexture, TexturePoint};
use crate::world::World;

/// The spectral modes of eight paths.
pub(in crate::integrator) struct Modes<'a> {
    by_lane: [&'a SpectralMode; LANES],
    /// Whether all are RGB: the modes of a picture are of one kind.
    are_rgb: bool,
    /// The times while the shutter is open; 0 where nothing moves.
    times: [f32; LANES],
}

impl<'a> Modes<'a> {
    #[inline(always)]
    pub(in crate::integrator) fn of<S>(
        paths: &[&Path<S>; LANES],
        modes: &'a SpectralModes,
        times: &Times,
    ) -> Self {
        let times = match times.is_empty() {
            true => [0.0; LANES],
            false => by_lane!(lane => times.of(paths[lane].slot as usize)),
        };
        let first = &modes[paths[0].slot as usize];
        if matches!(first, SpectralMode::Rgb) {
            return Self { by_lane: [first; LANES], are_rgb: true, times };
        }
        let by_lane = by_lane!(lane => &modes[paths[lane].slot as usize]);
        Self { by_lane, are_rgb: false, times }
    }

    /// The mode of one path, and its time.
    pub(in crate::integrator) fn of_one(mode: &'a SpectralMode, time: f32) -> Self {
        Self { by_lane: [mode; LANES], are_rgb: matches!(mode, SpectralMode::Rgb), times: [time; LANES] }
    }

    /// The modes by lane.
    #[inline(always)]
    pub(in crate::integrator) fn all(&self) -> &[&'a SpectralMode; LANES] {
        &self.by_lane
    }

    /// Whether all are RGB.
    #[inline(always)]
    pub(in crate::integrator) fn are_rgb(&self) -> bool {
        self.are_rgb
    }

    /// The time of a lane.
    #[inline(always)]
    pub(in crate::integrator) fn time(&self, lane: usize) -> f32 {
        self.times[lane]
    }

    /// The mode of a lane.
    #[inline(always)]
    pub(in crate::integrator) fn lane(&self, lane: usize) -> &'a SpectralMode {
        self.by_lane[lane]
    }

    /// The spectra of a colour that does not vary.
    #[inline(always)]
    pub(in crate::integrator) fn constant<S: Simd>(
        &self,
        simd: S,
        world: &World,
        color: &SpectrumTexture,
    ) -> Spectrum<f32x8<S>> {
        let textures = &world.textures;
        match self.are_rgb {
            true => splat_spectrum(simd, textures.spectrum(color, &TexturePoint::NOWHERE, self.by_lane[0])),
            false => textures.constants(simd, &[color; LANES], &self.by_lane),
        }
    }

    /// The emission of a light whose colour does not vary.
    #[inline(always)]
    pub(in crate::integrator) fn emission<S: Simd>(
        &self,
        simd: S,
        world: &World,
        light: &EmissionSpectrum,
    ) -> Spectrum<f32x8<S>> {
        self.constant(simd, world, &light.color) * f32x8::splat(simd, light.scale)
    }
}
