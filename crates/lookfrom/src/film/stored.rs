//! The sums of a film as words of 32 bits, for the channels of its file.
//!
//! Each number of a pixel is one channel or several: of `sum.R`, which has 128 bits, `film.sum.R.0` has the lowest 32, and
//! `film.sum.R.3` the highest, in two's complement. The names of all channels are in [`Film::stored_channels`]; what the
//! numbers mean is said at the fields of the sums.

use lookfrom_scene::Result;
use lookfrom_scene::settings::PixelBounds;

use super::plane::SIDE;
use super::{Film, FilmTile, Pixel};
use crate::aov::{AovSums, LayerSums};

/// A number, or several, that are stored as words, the lowest first.
pub(super) trait Stored: Sized {
    /// Number of words.
    const WORDS: usize;

    /// Passes the words on.
    fn store(&self, put: &mut impl FnMut(u32));

    /// The inverse of [`Stored::store`].
    fn load(take: &mut impl FnMut() -> u32) -> Self;

    /// Number of numbers.
    const NUMBERS: usize;

    /// Passes the numbers on, each as one whose upper bits repeat its highest.
    fn put_numbers(&self, put: &mut impl FnMut(i128));

    /// The inverse of [`Stored::put_numbers`].
    fn take_numbers(take: &mut impl FnMut() -> i128) -> Self;
}

macro_rules! store_integers {
    ($($integer:ty: $signed:ty),*) => {$(
        impl Stored for $integer {
            const WORDS: usize = size_of::<$integer>() / 4;

            fn store(&self, put: &mut impl FnMut(u32)) {
                self.to_le_bytes().chunks_exact(4).for_each(|word| put(u32::from_le_bytes([word[0], word[1], word[2], word[3]])));
            }

            fn load(take: &mut impl FnMut() -> u32) -> Self {
                let mut bytes = [0; size_of::<$integer>()];
                bytes.chunks_exact_mut(4).for_each(|word| word.copy_from_slice(&take().to_le_bytes()));
                Self::from_le_bytes(bytes)
            }

            const NUMBERS: usize = 1;

            #[inline(always)]
            fn put_numbers(&self, put: &mut impl FnMut(i128)) {
                put(*self as $signed as i128);
            }

            #[inline(always)]
            fn take_numbers(take: &mut impl FnMut() -> i128) -> Self {
                take() as $integer
            }
        }
    )*};
}

store_integers!(u32: i32, u64: i64, i64: i64, u128: i128, i128: i128);

impl<T: Stored, const N: usize> Stored for [T; N] {
    const WORDS: usize = N * T::WORDS;

    fn store(&self, put: &mut impl FnMut(u32)) {
        self.iter().for_each(|number| number.store(put));
    }

    fn load(take: &mut impl FnMut() -> u32) -> Self {
        std::array::from_fn(|_| T::load(take))
    }

    const NUMBERS: usize = N * T::NUMBERS;

    #[inline(always)]
    fn put_numbers(&self, put: &mut impl FnMut(i128)) {
        self.iter().for_each(|number| number.put_numbers(put));
    }

    #[inline(always)]
    fn take_numbers(take: &mut impl FnMut() -> i128) -> Self {
        std::array::from_fn(|_| T::take_numbers(take))
    }
}

/// Implements [`Stored`] for a struct, field by field, and [`Sums`], with the names of its numbers where its fields do not
/// have names of their own.
macro_rules! store_fields {
    (@channels $prefix:ident, $kind:ty) => { <$kind>::channels($prefix) };
    (@channels $prefix:ident, $kind:ty, $names:expr) => { channels_of($prefix, &$names, <$kind>::WORDS) };
    ($sums:ty { $($field:ident: $kind:ty $(= $names:expr)?),* $(,)? }) => {
        impl Stored for $sums {
            const WORDS: usize = 0 $(+ <$kind>::WORDS)*;

            fn store(&self, put: &mut impl FnMut(u32)) {
                $(self.$field.store(put);)*
            }

            fn load(take: &mut impl FnMut() -> u32) -> Self {
                Self { $($field: <$kind>::load(take)),* }
            }

            const NUMBERS: usize = 0 $(+ <$kind>::NUMBERS)*;

            #[inline(always)]
            fn put_numbers(&self, put: &mut impl FnMut(i128)) {
                $(self.$field.put_numbers(put);)*
            }

            #[inline(always)]
            fn take_numbers(take: &mut impl FnMut() -> i128) -> Self {
                Self { $($field: <$kind>::take_numbers(take)),* }
            }
        }

        impl Sums for $sums {
            fn channels(prefix: &str) -> Vec<String> {
                let mut channels = Vec::new();
                $(channels.extend(store_fields!(@channels prefix, $kind $(, $names)?));)*
                channels
            }

            fn merge(&mut self, other: &Self) {
                // The method of the type itself.
                <$sums>::merge(self, other);
            }
        }
    };
}
pub(super) use store_fields;

/// Sums of a pixel.
pub(super) trait Sums: Stored + Copy + Default + PartialEq {
    /// The names of the channels, in the order of the words.
    fn channels(prefix: &str) -> Vec<String>;

    /// Adds other sums, of which the default changes nothing.
    fn merge(&mut self, other: &Self);
}

/// The channels of numbers that have `words` words together.
pub(super) fn channels_of(prefix: &str, names: &[&str], words: usize) -> Vec<String> {
    let each = words / names.len();
    names.iter().flat_map(|name| (0..each).map(move |word| format!("{prefix}.{name}.{word}"))).collect()
}

store_fields!(Pixel {
    sums: [i128; 3] = ["sum.R", "sum.G", "sum.B"],
    squares: [u128; 3] = ["square.X", "square.Y", "square.Z"],
    samples: u64 = ["samples"],
});

store_fields!(AovSums {
    albedo: [i64; 3] = ["albedo.R", "albedo.G", "albedo.B"],
    ns: [i64; 3] = ["ns.X", "ns.Y", "ns.Z"],
    samples: u64 = ["samples"],
    hits: u64 = ["hits"],
    first: u32 = ["first"],
    ng: [u32; 3] = ["first_ng.X", "first_ng.Y", "first_ng.Z"],
    position: [u32; 3] = ["first_p.X", "first_p.Y", "first_p.Z"],
});

store_fields!(LayerSums {
    shared: AovSums,
    ng: [i64; 3] = ["ng.X", "ng.Y", "ng.Z"],
    places: [i128; 5] = ["p.X", "p.Y", "p.Z", "u", "v"],
});

/// Evaluates an expression for each kind of sums that films or tiles may have: with all of that kind, of each of these films,
/// borrowed by `&` or `&mut`.
macro_rules! for_each_plane {
    (@one $plane_of:ident; $([$($borrow:tt)+] $film:expr => $plane:ident),+; $body:expr) => {{
        $(let $plane = $($borrow)+ $film.$plane_of;)+
        $body
    }};
    (@list $planes_of:ident; $([$($borrow:tt)+] $film:expr => $plane:ident),+; $body:expr) => {
        for index in 0..[$($film.$planes_of.len()),+].into_iter().min().unwrap_or(0) {
            $(let $plane = $($borrow)+ $film.$planes_of[index];)+
            $body
        }
    };
    ([$($borrow:tt)+] $($rest:tt)+) => {{
        for_each_plane!(@one pixels; [$($borrow)+] $($rest)+);
        for_each_plane!(@one alphas; [$($borrow)+] $($rest)+);
        for_each_plane!(@one alpha_squares; [$($borrow)+] $($rest)+);
        for_each_plane!(@one weights; [$($borrow)+] $($rest)+);
        for_each_plane!(@one unsigned_alphas; [$($borrow)+] $($rest)+);
        for_each_plane!(@list unsigned_light; [$($borrow)+] $($rest)+);
        for_each_plane!(@list unsigned_buckets; [$($borrow)+] $($rest)+);
        for_each_plane!(@one channels; [$($borrow)+] $($rest)+);
        for_each_plane!(@one layers; [$($borrow)+] $($rest)+);
        for_each_plane!(@one features; [$($borrow)+] $($rest)+);
        for_each_plane!(@one motions; [$($borrow)+] $($rest)+);
        for_each_plane!(@list light_paths; [$($borrow)+] $($rest)+);
        for_each_plane!(@list buckets; [$($borrow)+] $($rest)+);
    }};
}

pub(super) use for_each_plane;

impl Sums for i128 {
    fn channels(prefix: &str) -> Vec<String> {
        channels_of(prefix, &["sum"], Self::WORDS)
    }

    fn merge(&mut self, other: &Self) {
        *self = self.wrapping_add(*other);
    }
}

impl Sums for u128 {
    fn channels(prefix: &str) -> Vec<String> {
        channels_of(prefix, &["square"], Self::WORDS)
    }

    fn merge(&mut self, other: &Self) {
        *self = self.saturating_add(*other);
    }
}

impl Film {
    /// The names of the channels that hold its sums exactly, each of 32-bit unsigned integers.
    pub fn stored_channels(&self) -> Vec<String> {
        self.layout.channels()
    }

    /// Writes a row of all channels: the bytes of `width` numbers of the first, in little endian, of the second … Pixels
    /// outside of [`Film::area`] are left as they are.
    pub(crate) fn store_row(&self, row: u32, bytes: &mut [u8]) {
        let PixelBounds { x0, y0, x1, y1 } = self.area;
        if !(y0..y1).contains(&row) {
            return;
        }
        let mut to = Row { bytes, width: self.width as usize, first: 0 };
        for_each_plane!([&] self => plane; {
            if !plane.is_empty() {
                to.store(x0, |each| plane.row(row, x0, x1, each));
            }
        });
    }
}

/// Rows of the numbers of a film's file, which are added to a film.
#[derive(Debug)]
pub(crate) struct StoredRows<'a> {
    film: &'a mut Film,
    /// The pixels of the file's film.
    area: PixelBounds,
    /// The rows of a band that have been read.
    band: FilmTile,
}

impl<'a> StoredRows<'a> {
    /// For a film of the same kinds of sums, which has these pixels.
    ///
    /// # Errors
    /// `Limit` if there is no memory for it.
    pub(crate) fn of(film: &'a mut Film, area: PixelBounds) -> Result<Self> {
        let band = film.tile(PixelBounds { y1: area.y0, ..area })?;
        Ok(Self { film, area, band })
    }

    /// Adds a row that [`Film::store_row`] wrote, once: `numbers(k)` are those of channel `k`.
    ///
    /// # Errors
    /// `Limit` if there is no memory for it.
    pub(crate) fn load<'b>(&mut self, row: u32, numbers: impl Fn(usize) -> &'b [u32]) -> Result<()> {
        let area @ PixelBounds { x0, y0, x1, y1 } = self.area;
        if !(y0..y1).contains(&row) {
            return Ok(());
        }
        if !(self.band.area.y0..self.band.area.y1).contains(&row) {
            self.flush()?;
            let top = row / SIDE * SIDE;
            let band = PixelBounds { y0: top.max(y0), y1: y1.min(top + SIDE), ..area };
            self.band = self.film.tile(band)?;
        }
        let pixels = self.band.row(row, x0, x1);
        let mut first = 0;
        for_each_plane!([&mut] self.band => plane; {
            load(plane.get_mut(pixels.clone()), x0 as usize, &mut first, &numbers);
        });
        Ok(())
    }

    /// Moves the rows of the band to the film, after the last row and between bands.
    ///
    /// # Errors
    /// None for sums of the same kinds.
    pub(crate) fn flush(&mut self) -> Result<()> {
        self.film.add_tile(&self.band)
    }
}

/// A row of all channels, which is filled plane by plane.
struct Row<'a> {
    bytes: &'a mut [u8],
    width: usize,
    /// The first channel of the next plane.
    first: usize,
}

impl Row<'_> {
    /// Stores sums, of pixels from column `x0` on, that are told one after the other.
    fn store<T: Stored>(&mut self, x0: u32, tell: impl FnOnce(&mut dyn FnMut(T))) {
        let Self { bytes, width, first } = self;
        let mut x = x0 as usize;
        tell(&mut |sums| {
            let mut at = (*first * *width + x) * 4;
            sums.store(&mut |word| {
                bytes[at..at + 4].copy_from_slice(&word.to_le_bytes());
                at += *width * 4;
            });
            x += 1;
        });
        *first += T::WORDS;
    }
}

/// Fills a row of a plane, if there is such a plane, from channel `first` on, and moves `first` behind its channels.
fn load<'a, T: Stored>(
    plane: Option<&mut [T]>,
    x0: usize,
    first: &mut usize,
    numbers: &impl Fn(usize) -> &'a [u32],
) {
    let Some(plane) = plane else { return };
    let channels: Vec<&[u32]> = (*first..*first + T::WORDS).map(numbers).collect();
    for (x, sums) in (x0..).zip(plane) {
        let mut words = channels.iter().map(|channel| channel[x]);
        *sums = T::load(&mut || words.next().unwrap_or(0));
    }
    *first += T::WORDS;
}
