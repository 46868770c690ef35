//! The argument for the memory that files may take.

use std::sync::OnceLock;

use clap::Args;
use lookfrom_scene::Budget;

use crate::values;

#[derive(Args, Clone, Copy, Debug, Default)]
pub(crate) struct MemoryArguments {
    /// Memory for all that is read, compiled and rendered: 2GiB, 500MB [default: three quarters of the machine's]
    ///
    /// Of the machine's memory, of what its control group (cgroup) may have, and of `ulimit -v` the least counts. A file that needs
    /// more is an error, before it is allocated. Small things are not counted: allow for a quarter more.
    #[arg(long, value_name = "SIZE", value_parser = values::memory)]
    memory: Option<u64>,
}

impl MemoryArguments {
    /// The budget of that size. All that one call of the command reads shares it.
    pub(crate) fn budget(self) -> Budget {
        static OF_CALL: OnceLock<Budget> = OnceLock::new();
        OF_CALL.get_or_init(|| self.memory.map_or_else(Budget::default, Budget::new)).clone()
    }
}
