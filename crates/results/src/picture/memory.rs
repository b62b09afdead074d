//! Memory that pictures can still get.

/// Bytes that programs can still get, where the system tells.
pub(super) fn free() -> Option<u64> {
    available(&std::fs::read_to_string("/proc/meminfo").ok()?)
}

/// The same, in the words of Linux.
fn available(meminfo: &str) -> Option<u64> {
    let line = meminfo.lines().find_map(|line| line.strip_prefix("MemAvailable:"))?;
    1024_u64.checked_mul(line.trim().strip_suffix("kB")?.trim().parse().ok()?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn memory_is_what_the_system_tells() {
        let told = "MemTotal:       24684412 kB\nMemFree:        18565432 kB\nMemAvailable:   22658312 kB\n";
        assert_eq!(available(told), Some(23_202_111_488));
        assert_eq!(available("MemTotal: many"), None);
    }
}
