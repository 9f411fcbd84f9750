//! Whether this processor has the instructions that this build was compiled to.
//!
//! The lane width is chosen at compile time, so a build for x86-64-v3 ends in an illegal instruction on an older machine.
//! A sentence is better. `cpuid` is asked directly: `is_x86_feature_detected!` is answered by the compiler for features
//! that the build takes for granted, which is exactly when the question matters.

/// What is missing, as one sentence; `None` if everything that this build uses is there.
#[cfg(target_arch = "x86_64")]
#[inline(never)]
pub fn missing_instructions() -> Option<String> {
    use raw_cpuid::CpuId;

    let cpuid = CpuId::new();
    let basic = cpuid.get_feature_info();
    let extended = cpuid.get_extended_feature_info();
    let amd = cpuid.get_extended_processor_and_feature_identifiers();
    let basic = |has: fn(&raw_cpuid::FeatureInfo) -> bool| basic.as_ref().is_some_and(has);
    let extended = |has: fn(&raw_cpuid::ExtendedFeatures) -> bool| extended.as_ref().is_some_and(has);
    // (name, compiled to, found)
    let table = [
        ("AVX2", cfg!(target_feature = "avx2"), extended(|f| f.has_avx2())),
        ("FMA", cfg!(target_feature = "fma"), basic(|f| f.has_fma())),
        ("BMI1", cfg!(target_feature = "bmi1"), extended(|f| f.has_bmi1())),
        ("BMI2", cfg!(target_feature = "bmi2"), extended(|f| f.has_bmi2())),
        ("F16C", cfg!(target_feature = "f16c"), basic(|f| f.has_f16c())),
        ("LZCNT", cfg!(target_feature = "lzcnt"), amd.as_ref().is_some_and(|f| f.has_lzcnt())),
        ("MOVBE", cfg!(target_feature = "movbe"), basic(|f| f.has_movbe())),
        ("OSXSAVE", cfg!(target_feature = "avx"), basic(|f| f.has_oxsave())),
    ];
    let missing: Vec<&str> = table.iter().filter(|(_, used, found)| *used && !found).map(|(name, ..)| *name).collect();
    (!missing.is_empty()).then(|| {
        format!(
            "this build of gonio needs a processor with AVX2 (x86-64-v3, from 2013 on); this one lacks {}",
            missing.join(", ")
        )
    })
}

/// Other architectures are compiled to their baseline: nothing can be missing.
#[cfg(not(target_arch = "x86_64"))]
pub fn missing_instructions() -> Option<String> {
    None
}

/// The processor's own name, for reports.
pub(crate) fn name() -> String {
    #[cfg(target_arch = "x86_64")]
    if let Some(brand) = raw_cpuid::CpuId::new().get_processor_brand_string() {
        return brand.as_str().trim().to_owned();
    }
    std::env::consts::ARCH.to_owned()
}
