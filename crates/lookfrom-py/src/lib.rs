//! The Python package `lookfrom`: this library is its module `_lookfrom`, which the Python code in `python/lookfrom` uses. It
//! takes arrays of numpy, calls the other crates without the GIL, and returns arrays.

// Axes are indices into several arrays at once.
#![allow(clippy::needless_range_loop)]

use pyo3::prelude::*;

mod arrays;
mod error;
mod parallel;
mod pictures;
mod rays;

#[pymodule]
mod _lookfrom {
    #[pymodule_export]
    use crate::error::Error;
    #[pymodule_export]
    use crate::pictures::command::{keyword_list, run_command};
    #[pymodule_export]
    use crate::pictures::replace::replace_files;
    #[pymodule_export]
    use crate::pictures::{Film, Page, Picture, SceneError, Session};
    #[pymodule_export]
    use crate::rays::Tree;
}
