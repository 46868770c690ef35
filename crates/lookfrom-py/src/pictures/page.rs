//! The page of `lookfrom view`, served by this process.

use std::net::{IpAddr, Ipv4Addr};
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;

use lookfrom_view::{Address, Server, Settings};
use pyo3::exceptions::PyOSError;
use pyo3::prelude::*;

use super::command::{Words, asked};

/// A server of one scene's page, which runs until it is closed or dropped.
#[pyclass(frozen, module = "lookfrom._lookfrom")]
pub(crate) struct Page {
    url: String,
    is_closed: Arc<AtomicBool>,
    thread: Mutex<Option<JoinHandle<()>>>,
}

#[pymethods]
impl Page {
    /// Serves the scene of a file on this machine only.
    #[new]
    fn new(scene: PathBuf, words: Words, port: u16) -> PyResult<Self> {
        let asked = asked(words)?;
        let settings = Settings {
            scene,
            options: asked.options,
            environment: asked.environment,
            reference: None,
            typed: asked.typed,
        };
        let address = Address { host: IpAddr::V4(Ipv4Addr::LOCALHOST), port, may_be_framed: true };
        let refused = |error: std::io::Error| PyOSError::new_err(format!("no page at port {port}: {error}"));
        let server = Server::bind(settings, address).map_err(refused)?;
        let (url, is_closed) = (server.url(), Arc::new(AtomicBool::new(false)));
        let asked_to_close = is_closed.clone();
        let thread = std::thread::Builder::new().name("page".to_owned()).spawn(move || {
            // What it could report, a closed window and a busy system, ends the page as well.
            let _ = server.run(|| asked_to_close.load(Ordering::Relaxed));
        });
        let thread = Mutex::new(Some(thread.map_err(refused)?));
        Ok(Self { url, is_closed, thread })
    }

    /// The address, with the token.
    #[getter]
    fn url(&self) -> String {
        self.url.clone()
    }

    /// Ends the page, and waits until it has ended.
    fn close(&self, py: Python<'_>) {
        self.is_closed.store(true, Ordering::Relaxed);
        let thread = self.thread.lock().unwrap_or_else(PoisonError::into_inner).take();
        if let Some(thread) = thread {
            py.detach(|| {
                let _ = thread.join();
            });
        }
    }
}

impl Drop for Page {
    fn drop(&mut self) {
        self.is_closed.store(true, Ordering::Relaxed);
    }
}
