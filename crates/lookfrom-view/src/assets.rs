//! The files of the page.

use std::borrow::Cow;

use rust_embed::Embed;

/// `assets/`: embedded in release builds, read from disk in builds with debug assertions.
#[derive(Embed)]
#[folder = "assets"]
#[allow_missing = true]
struct Assets;

/// A file of the page, and its media type; `None` for any other name.
pub(crate) fn asset(name: &str) -> Option<(&'static str, Cow<'static, [u8]>)> {
    let (_, extension) = name.rsplit_once('.')?;
    let mime = match extension {
        "html" => "text/html; charset=utf-8",
        "js" | "mjs" => "text/javascript; charset=utf-8",
        "css" => "text/css; charset=utf-8",
        "json" => "application/json",
        "svg" => "image/svg+xml",
        "png" => "image/png",
        "woff2" => "font/woff2",
        "txt" => "text/plain; charset=utf-8",
        _ => return None,
    };
    Some((mime, Assets::get(name)?.data))
}
