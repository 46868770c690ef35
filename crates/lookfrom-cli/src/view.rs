//! `lookfrom view`: a server for a browser. Everything it serves is the library's.

use std::io;
use std::net::{IpAddr, Ipv4Addr};
use std::process::{Command, Stdio};

use lookfrom_view::{Server, Settings};

use crate::args::ViewArguments;
use crate::exit::{Failure, INTERRUPTED, answer, say};
use crate::{interrupt, prepare};

/// Serves until Ctrl-C, and returns the exit code. `typed` are the arguments by which `render` opens the same session.
pub(crate) fn run(arguments: &ViewArguments, typed: &[String]) -> u8 {
    serve(arguments, typed).map_or_else(|failure| failure.report(), |()| INTERRUPTED)
}

fn serve(arguments: &ViewArguments, typed: &[String]) -> Result<(), Failure> {
    let ViewArguments { scene, host, port, open, reference, common, overrides } = arguments;
    prepare::use_threads(common)?;
    // A misspelt name would never be there to read. Everything else that is wrong may be mended while the page is open.
    if !scene.is_file() {
        let at = lookfrom_scene::Location::file(scene);
        let error = lookfrom_scene::Error::new(lookfrom_scene::ErrorKind::Io, &at, "no such file");
        return Err(Failure::Scene(error.hint("check the name")));
    }
    let host = host.unwrap_or(IpAddr::V4(Ipv4Addr::LOCALHOST));
    let settings = Settings {
        scene: scene.clone(),
        options: overrides.options(common, None),
        environment: overrides.model.environment.clone(),
        reference: reference.clone(),
        typed: typed.to_vec(),
        host,
        port: *port,
    };
    let refused = |error: io::Error| Failure::Output(format!("cannot serve at {host}, port {port}: {error}"));
    let server = Server::bind(settings).map_err(refused)?;
    let url = server.url();
    answer(&url)?;
    if !host.is_loopback() {
        say(
            "warning: --host makes the scene and its pictures available to whoever can reach this machine and learns the address",
        );
    }
    if *open && let Err(error) = open_browser(&url) {
        say(&format!("warning: no browser could be opened: {error}"));
    }
    interrupt::listen();
    interrupt::keeping(|| server.run(interrupt::asked)).map_err(refused)
}

/// Opens an address in the user's browser.
fn open_browser(url: &str) -> io::Result<()> {
    let mut command = match std::env::consts::OS {
        "macos" => Command::new("open"),
        "windows" => {
            let mut command = Command::new("cmd");
            command.args(["/C", "start", ""]);
            command
        }
        _ => Command::new("xdg-open"),
    };
    let quiet = command.arg(url).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    quiet.spawn().map(|_| ())
}
