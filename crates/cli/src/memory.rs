//! Whether a run fits into the memory of this machine.

use crate::codes;
use crate::render::{self, Report};
use crate::units::bytes;
use tdem_case::Memory;

/// Warns of a run that takes more memory than there is. Where the system does not tell, nothing is said.
pub(crate) fn warn(memory: &Memory) {
    let told = std::fs::read_to_string("/proc/meminfo").ok();
    if let Some(report) = told.and_then(|told| too_little(memory.run_bytes, available(&told)?)) {
        render::warn(&report.into());
    }
}

fn too_little(needed: u64, available: u64) -> Option<Report> {
    let message = format!("the run needs about {} of memory, of which {} are free", bytes(needed), bytes(available));
    (needed > available).then(|| {
        Report::new(codes::MEMORY, message)
            .help("take fewer particles, a model without moments, or output.ledger = false; or a larger machine")
    })
}

/// Memory that programs can still get, bytes, where the system tells.
pub(crate) fn free() -> Option<u64> {
    available(&std::fs::read_to_string("/proc/meminfo").ok()?)
}

/// Memory of the machine, or of the part of it that this process may use, bytes, where the system tells.
pub(crate) fn total() -> Option<u64> {
    let machine = entry(&std::fs::read_to_string("/proc/meminfo").ok()?, "MemTotal:")?;
    let group = std::fs::read_to_string("/sys/fs/cgroup/memory.max").ok();
    let allowed = group.and_then(|limit| limit.trim().parse::<u64>().ok());
    Some(machine.min(allowed.unwrap_or(u64::MAX)))
}

fn available(meminfo: &str) -> Option<u64> {
    entry(meminfo, "MemAvailable:")
}

/// A line of what Linux tells, bytes.
fn entry(meminfo: &str, name: &str) -> Option<u64> {
    let line = meminfo.lines().find_map(|line| line.strip_prefix(name))?;
    Some(1024 * line.trim().strip_suffix("kB")?.trim().parse::<u64>().ok()?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_run_that_does_not_fit_is_warned_of() {
        let told = "MemTotal:       24684412 kB\nMemFree:        18565432 kB\nMemAvailable:   22658312 kB\n";
        assert_eq!(available(told), Some(23_202_111_488));
        assert_eq!(available("MemTotal: many"), None);
        assert!(too_little(23_202_111_488, 23_202_111_488).is_none());
        let report = format!("{:?}", too_little(30_000_000_000, 23_202_111_488));
        assert!(report.contains("30 GB of memory, of which 23.2 GB are free"), "{report}");
    }
}
