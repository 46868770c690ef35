//! The command `lookfrom`.

use std::process::ExitCode;

fn main() -> ExitCode {
    ExitCode::from(lookfrom_cli::run(std::env::args_os()))
}
