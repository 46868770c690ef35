//! The Python package `lookfrom`: this library is its module `_lookfrom`, which the Python code in `python/lookfrom` uses. It
//! takes arrays of numpy, calls the other crates without the GIL, and returns arrays.

use pyo3::prelude::*;

#[pymodule]
mod _lookfrom {
    #[pymodule_export]
    use crate::error::Error;
}

mod error;
