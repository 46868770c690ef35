//! The page of `lookfrom view` without a server: the library in a worker of the browser.
//!
//! A page can be a folder of files, or one: the session that a server holds for each window is here in WebAssembly, and takes the
//! same messages. What the worker exports is in `exports`; scenes are read from `dropped` files. `build.sh` makes the page.

mod dropped;
mod exports;
mod worker;
