//! The exceptions of the package.

use pyo3::create_exception;
use pyo3::exceptions::PyValueError;

create_exception!(
    lookfrom,
    Error,
    PyValueError,
    "What a call was given makes no sense: the message says which argument, what it is and what it should be."
);
