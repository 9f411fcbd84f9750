//! The circumstances of a measurement: how the program was built, and on what it runs.

use crate::cpu;
use gonio_report::Environment;

/// Those of this process.
pub(crate) fn here() -> Environment {
    let features = [
        ("avx", cfg!(target_feature = "avx")),
        ("avx2", cfg!(target_feature = "avx2")),
        ("avx512f", cfg!(target_feature = "avx512f")),
        ("bmi1", cfg!(target_feature = "bmi1")),
        ("bmi2", cfg!(target_feature = "bmi2")),
        ("f16c", cfg!(target_feature = "f16c")),
        ("fma", cfg!(target_feature = "fma")),
        ("lzcnt", cfg!(target_feature = "lzcnt")),
        ("movbe", cfg!(target_feature = "movbe")),
        ("neon", cfg!(target_feature = "neon")),
        ("sse4.2", cfg!(target_feature = "sse4.2")),
    ];
    Environment {
        target: option_env!("GONIO_TARGET").unwrap_or(std::env::consts::ARCH),
        target_features: features.iter().filter(|(_, on)| *on).map(|(name, _)| *name).collect(),
        rustc: option_env!("GONIO_RUSTC"),
        debug_assertions: cfg!(debug_assertions),
        processor: cpu::name(),
        threads: std::thread::available_parallelism().map_or(1, usize::from),
    }
}
