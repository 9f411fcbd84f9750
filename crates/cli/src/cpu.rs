//! Whether this processor has the instructions that this build was compiled to.
//!
//! The lane width is chosen at compile time, so a build for x86-64-v3 ends in an illegal instruction on an older machine.
//! A sentence is better. `cpuid` is asked directly: `is_x86_feature_detected!` is answered by the compiler for features
//! that the build takes for granted, which is exactly when the question matters.
//!
//! The question must not itself need the answer. This file is compiled to the same instructions as the rest, so it is
//! written such that there is nothing to vectorise or to shift: one register and one bit at a time, and texts that are written as they are,
//! by the standard library, which is compiled to the baseline. Held by running it under `qemu-x86_64 -cpu Nehalem`.

#[cfg(target_arch = "x86_64")]
use std::io::{Write, stderr};

/// Whether this processor can run this build; if not, one sentence on standard error says what it lacks.
#[cfg(target_arch = "x86_64")]
#[inline(never)]
pub fn processor_suffices() -> bool {
    let missing = missing();
    if missing == 0 {
        return true;
    }
    // If standard error is gone, there is nobody to tell.
    let _ = stderr().write_all(
        b"error: this build of gonio needs a processor with AVX2 (x86-64-v3, made since 2013); this one lacks",
    );
    for (flag, name) in &NAMES {
        if missing & flag != 0 {
            let _ = stderr().write_all(name.as_bytes());
        }
    }
    let _ = stderr().write_all(b"\n");
    false
}

/// The flags of [`missing`].
#[cfg(target_arch = "x86_64")]
static NAMES: [(u32, &str); 8] = [
    (1, " AVX2"),
    (2, " FMA"),
    (4, " BMI1"),
    (8, " BMI2"),
    (16, " F16C"),
    (32, " LZCNT"),
    (64, " MOVBE"),
    (128, " OSXSAVE"),
];

/// A flag for each feature that the build uses and the processor lacks. Bits of the registers: Intel SDM, volume 2A, CPUID.
#[cfg(target_arch = "x86_64")]
fn missing() -> u32 {
    use raw_cpuid::native_cpuid::cpuid_count;

    let basic = cpuid_count(1, 0).ecx;
    let extended = if cpuid_count(0, 0).eax >= 7 { cpuid_count(7, 0).ebx } else { 0 };
    let amd = if cpuid_count(0x8000_0000, 0).eax > 0x8000_0000 { cpuid_count(0x8000_0001, 0).ecx } else { 0 };
    lack(cfg!(target_feature = "avx2"), extended, 1 << 5, 1)
        | lack(cfg!(target_feature = "fma"), basic, 1 << 12, 2)
        | lack(cfg!(target_feature = "bmi1"), extended, 1 << 3, 4)
        | lack(cfg!(target_feature = "bmi2"), extended, 1 << 8, 8)
        | lack(cfg!(target_feature = "f16c"), basic, 1 << 29, 16)
        | lack(cfg!(target_feature = "lzcnt"), amd, 1 << 5, 32)
        | lack(cfg!(target_feature = "movbe"), basic, 1 << 22, 64)
        | lack(cfg!(target_feature = "avx"), basic, 1 << 27, 128)
}

/// The flag if the feature is used and its bit is not set. Not inlined: eight of these side by side were vectorised. No
/// variable shift: that became `shlx`, which is one of the instructions in question.
#[cfg(target_arch = "x86_64")]
#[inline(never)]
fn lack(used: bool, register: u32, bit: u32, flag: u32) -> u32 {
    if used && register & bit == 0 { flag } else { 0 }
}

/// Other architectures are compiled to their baseline: nothing can be missing.
#[cfg(not(target_arch = "x86_64"))]
pub fn processor_suffices() -> bool {
    true
}

/// The processor's own name, for reports.
pub(crate) fn name() -> String {
    #[cfg(target_arch = "x86_64")]
    if let Some(brand) = raw_cpuid::CpuId::new().get_processor_brand_string() {
        return brand.as_str().trim().to_owned();
    }
    std::env::consts::ARCH.to_owned()
}

#[cfg(all(test, target_arch = "x86_64"))]
mod tests {
    #[test]
    fn the_bits_are_those_that_raw_cpuid_names() {
        // This build runs here, so nothing that it uses can be missing.
        assert_eq!(super::missing(), 0);
        let cpuid = raw_cpuid::CpuId::with_cpuid_fn(|leaf, _| raw_cpuid::CpuIdResult {
            eax: if leaf == 0 { 7 } else { 0x8000_0001 },
            ebx: (1 << 5 | 1 << 3 | 1 << 8) * u32::from(leaf == 7),
            ecx: if leaf == 1 { 1 << 12 | 1 << 29 | 1 << 22 | 1 << 27 } else { 1 << 5 },
            edx: 0,
        });
        let (basic, extended) = (cpuid.get_feature_info().unwrap(), cpuid.get_extended_feature_info().unwrap());
        assert!(extended.has_avx2() && extended.has_bmi1() && extended.has_bmi2());
        assert!(basic.has_fma() && basic.has_f16c() && basic.has_movbe() && basic.has_oxsave());
    }
}
