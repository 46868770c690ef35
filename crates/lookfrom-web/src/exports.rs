//! Exports to the worker's script: functions of numbers, and a buffer in each direction.
//!
//! The script writes into the memory at `input`, calls, and reads `output`. The only file with `unsafe`, which is in the names: an
//! exported name must be the only one of its kind, and the imported clock must have the type that is declared here. No
//! pointer is followed in Rust.
#![allow(unsafe_code)]

use crate::worker::{WORKER, Worker};

#[cfg(all(target_family = "wasm", target_os = "unknown"))]
#[link(wasm_import_module = "page")]
unsafe extern "C" {
    /// Milliseconds since any moment that stays the same.
    safe fn now() -> f64;
}

fn with<T>(act: impl FnOnce(&mut Worker) -> T) -> T {
    WORKER.with_borrow_mut(act)
}

/// Gives the library a clock; called once, before all else.
#[unsafe(no_mangle)]
extern "C" fn start() {
    #[cfg(all(target_family = "wasm", target_os = "unknown"))]
    lookfrom::core::clock::use_clock(|| std::time::Duration::from_secs_f64(now().max(0.0) / 1000.0));
}

/// Makes room for so many bytes, and returns where they are.
#[unsafe(no_mangle)]
extern "C" fn input(length: usize) -> *mut u8 {
    with(|worker| {
        worker.input = vec![0; length];
        worker.input.as_mut_ptr()
    })
}

/// The place of the output.
#[unsafe(no_mangle)]
extern "C" fn output() -> *const u8 {
    with(|worker| worker.output.as_ptr())
}

/// The bytes of the output.
#[unsafe(no_mangle)]
extern "C" fn output_length() -> usize {
    with(|worker| worker.output.len())
}

/// As [`Worker::add_file`].
#[unsafe(no_mangle)]
extern "C" fn add_file(path: usize) {
    with(|worker| worker.add_file(path));
}

/// As [`Worker::forget_files`].
#[unsafe(no_mangle)]
extern "C" fn forget_files() {
    with(Worker::forget_files);
}

/// As [`Worker::open`].
#[unsafe(no_mangle)]
extern "C" fn open_scene(scene: usize) {
    with(|worker| worker.open(scene));
}

/// As [`Worker::hear`].
#[unsafe(no_mangle)]
extern "C" fn hear() {
    with(Worker::hear);
}

/// As [`Worker::turn`].
#[unsafe(no_mangle)]
extern "C" fn turn() -> u32 {
    u32::from(with(Worker::turn))
}

/// As [`Worker::lend`].
#[unsafe(no_mangle)]
extern "C" fn lend() -> u32 {
    u32::from(with(Worker::lend))
}

/// As [`Worker::render_part`].
#[unsafe(no_mangle)]
extern "C" fn render_part() {
    with(Worker::render_part);
}

/// As [`Worker::take_part`].
#[unsafe(no_mangle)]
extern "C" fn take_part(part: usize) {
    with(|worker| worker.take_part(part));
}

/// As [`Worker::say`].
#[unsafe(no_mangle)]
extern "C" fn say() -> u32 {
    with(Worker::say)
}
