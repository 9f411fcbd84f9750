//! The resident memory of this process.

/// Bytes, where the system tells: on Linux, the second field of /proc/self/statm, in pages of 4 KiB.
pub(super) fn resident() -> Option<i64> {
    const PAGE: i64 = 4096; // x86-64, which the tracer needs
    let text = std::fs::read_to_string("/proc/self/statm").ok()?;
    let pages: i64 = text.split_whitespace().nth(1)?.parse().ok()?;
    Some(pages * PAGE)
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    #[test]
    fn memory_that_is_touched_is_resident() {
        let before = super::resident().unwrap();
        let touched = vec![1_u8; 64 << 20];
        let grown = super::resident().unwrap() - before;
        assert!(grown > 48 << 20, "{grown} of {} bytes", touched.len());
    }
}
