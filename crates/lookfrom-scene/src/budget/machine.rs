//! The memory that this process may use: the least of what the machine, the control groups of the process and its own limit
//! allow, as files of Linux tell it (`/proc`, cgroup versions 1 and 2).

use std::path::Path;

/// The memory of a machine that does not tell it.
const FALLBACK: u64 = 8 << 30;

/// Bytes.
pub(super) fn memory() -> u64 {
    let file = |path: &str| std::fs::read_to_string(path).unwrap_or_default();
    let machine =
        number_after(&file("/proc/meminfo"), "MemTotal:").map(|kibibytes| kibibytes.saturating_mul(1024));
    let own = number_after(&file("/proc/self/limits"), "Max address space");
    let groups = limit_files(&file("/proc/self/cgroup"));
    let groups = groups.iter().filter_map(|path| file(path).trim().parse().ok());
    machine.into_iter().chain(own).chain(groups).min().unwrap_or(FALLBACK)
}

/// The number that follows `name` at the beginning of a line; `None` for a word such as `unlimited`.
fn number_after(text: &str, name: &str) -> Option<u64> {
    let rest = text.lines().find_map(|line| line.strip_prefix(name))?;
    rest.split_whitespace().next()?.parse().ok()
}

/// The files with the limits of the control groups that `/proc/self/cgroup` names, and of the groups around them. A
/// container may see its own group as the root.
fn limit_files(groups: &str) -> Vec<String> {
    let mut files = Vec::new();
    for line in groups.lines() {
        let mut fields = line.splitn(3, ':').skip(1);
        let (Some(controllers), Some(group)) = (fields.next(), fields.next()) else { continue };
        let (root, name) = match controllers {
            "" => ("/sys/fs/cgroup", "memory.max"),
            _ if controllers.split(',').any(|one| one == "memory") => {
                ("/sys/fs/cgroup/memory", "memory.limit_in_bytes")
            }
            _ => continue,
        };
        let folders = Path::new(group.trim_start_matches('/')).ancestors();
        files.extend(folders.map(|folder| Path::new(root).join(folder).join(name).display().to_string()));
    }
    files
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_follow_their_names() {
        let limits =
            "Limit      Soft Limit  Hard Limit  Units\nMax address space   3072000000   unlimited   bytes\n";
        assert_eq!(number_after(limits, "Max address space"), Some(3_072_000_000));
        assert_eq!(number_after("Max address space  unlimited unlimited bytes", "Max address space"), None);
        assert_eq!(number_after("MemTotal:       24683520 kB\n", "MemTotal:"), Some(24_683_520));
    }

    #[test]
    fn limits_of_both_versions_are_found() {
        let second =
            ["/sys/fs/cgroup/a/b/memory.max", "/sys/fs/cgroup/a/memory.max", "/sys/fs/cgroup/memory.max"];
        assert_eq!(limit_files("0::/a/b\n"), second);
        let first = "5:cpu,cpuacct:/x\n4:memory:/docker/1\n";
        let folder = "/sys/fs/cgroup/memory";
        let names =
            ["docker/1/", "docker/", ""].map(|group| format!("{folder}/{group}memory.limit_in_bytes"));
        assert_eq!(limit_files(first), names);
    }
}
