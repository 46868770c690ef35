//! Remedies in the words of the command: the flags that would help.

use lookfrom_scene::Remedy;

/// A remedy as one would type it.
pub(crate) fn in_flags(remedy: &Remedy) -> String {
    let words = match remedy {
        Remedy::Words(words) => words,
        Remedy::Up(axis) => return format!("--up {axis} shows it otherwise"),
        Remedy::Exposure(stops) => return format!("--exposure {stops} repeats it"),
        Remedy::OpaqueBackground => {
            "a .png, .webp or .exr holds transparency; --background white, or any other colour, is for all formats"
        }
        Remedy::InstancedLights => "with --instanced-lights each instance is a light",
        Remedy::MoreMemory => {
            "`--memory SIZE` sets another limit, such as 16GiB; if the size is not true, the file is damaged"
        }
        Remedy::SmallerPicture => {
            "a smaller --size takes less; --crop X0,Y0,X1,Y1 --film -o PART.exr renders some rows of it, and `lookfrom merge` \
             adds such parts up, without having all in memory if they have --denoise off; `--memory SIZE` sets another limit, such as 16GiB"
        }
        Remedy::KeptFilm => "render it with --film",
        Remedy::SamePicture => {
            "give --size, --crop, --layers, --light-path, --spectral-buckets, --background and --denoise as when it was begun"
        }
        Remedy::SpectralLight => {
            "with --color spectral light has wavelengths; --spectral-buckets 0 makes a picture of colours alone"
        }
    };
    words.to_owned()
}
