//! `cargo xtask no-std`: the proof that the kernel needs no std, no allocator, and cannot panic.
//!
//! 1. `crates/kernel/proof` must link. Its panic handler calls a function that is defined nowhere, so it links only if
//!    no panic is reachable; it has no libc and no allocator, so nothing can use one.
//! 2. Every method of every lobe and every free function of the kernel, as found in the kernel's sources, must be among
//!    its symbols for each kind of number: what is absent has not been proved.
//! 3. No other function may be among them. A list of what is allowed cannot miss what it does not know.
//! 4. It must run and exit with 0.
//! 5. With a planted panic it must not link, for exactly that reason: a check that cannot fail does not count.
//!
//! The statement is about optimised builds: without optimisation, panics remain in code that is never reached.

use crate::cargo::{Outcome, cargo, must, program, root};
use crate::elf::functions;
use crate::sources::{free_functions, lobes};
use std::collections::BTreeSet;
use std::process::{Command, ExitCode};

/// The kinds of number.
const NUMBERS: [&str; 3] = ["f32", "f64", "F32x8"];
/// The methods of the trait `Lobe`, each with what it prepares, reading the parameters, and the closure; `claims` are those methods
/// that instruments ask.
const METHODS: [&str; 7] = ["read", "eval", "sample", "delta", "closure", "albedo_estimate", "claims"];
/// Types whose methods the proof calls in one function per number.
const TYPES: [&str; 8] = ["Closure", "Unguarded", "Surface", "Surface_claims", "Frame", "Rgb", "Table", "units"];
/// Functions that have no number, and what a program without std must bring along.
const OTHERS: [&str; 5] = ["lanes", "prove", "_start", "memcpy", "memset"];
/// What the panic handler calls.
const UNDEFINED: &str = "gonio_kernel_can_panic";

pub(crate) fn run() -> Outcome {
    if !cfg!(all(target_os = "linux", target_arch = "x86_64")) {
        println!("no-std: did not run: the proof starts and ends by system calls of Linux on x86-64");
        return Ok(ExitCode::SUCCESS);
    }
    let expected = expected()?;
    must(&mut build())?;
    let binary = root().join("target/no-std/release/gonio-kernel-proof");
    let image = std::fs::read(&binary).map_err(|e| format!("{}: {e}", binary.display()))?;
    let found = functions(&image).ok_or_else(|| format!("{}: not an ELF file of 64 bits", binary.display()))?;
    compare(&expected, &found)?;
    must(&mut program(&binary))?;
    println!(
        "no-std: links without std, allocator or panic; {} functions are there, no other is; it runs ({} KB)",
        found.len(),
        image.len() / 1024
    );
    planted_panic()?;
    println!("no-std: with a planted panic it does not link, because of {UNDEFINED}");
    Ok(ExitCode::SUCCESS)
}

fn build() -> Command {
    let mut command = cargo();
    // From the root, so that the flags of .cargo/config.toml hold.
    command.args(["build", "--release", "--quiet", "--locked", "--target-dir", "target/no-std"]);
    command.args(["--manifest-path", "crates/kernel/proof/Cargo.toml"]);
    command
}

/// Must fail in the linker, for want of [`UNDEFINED`] and of nothing else.
fn planted_panic() -> Result<(), String> {
    let output = build().args(["--features", "plant-panic"]).output().map_err(|e| e.to_string())?;
    if output.status.success() {
        return Err("the proof links with a planted panic: it proves nothing".to_owned());
    }
    let errors = String::from_utf8_lossy(&output.stderr);
    // lld: `undefined symbol: name`; bfd: "undefined reference to `name'".
    let undefined: Vec<&str> = errors.lines().filter(|line| line.contains("undefined ")).collect();
    if undefined.is_empty() || undefined.iter().any(|line| !line.contains(UNDEFINED)) {
        return Err(format!("the proof with a planted panic failed for another reason:\n{errors}"));
    }
    Ok(())
}

/// The symbols that the kernel's sources call for.
fn expected() -> Result<BTreeSet<String>, String> {
    let lobes = lobes()?;
    let methods = lobes.iter().flat_map(|lobe| METHODS.map(|method| format!("{lobe}_{method}")));
    let generic = methods.chain(free_functions()?).chain(TYPES.map(str::to_owned));
    let each = generic.flat_map(|name| NUMBERS.map(|number| format!("{name}_{number}")));
    Ok(each.chain(OTHERS.map(str::to_owned)).collect())
}

/// Both sets must be the same, except that copying may have been inlined, and that the optimiser may have kept functions of the
/// kernel, of the proof and of `core` apart that it could have inlined. A panic in one of them would not have linked either.
fn compare(expected: &BTreeSet<String>, found: &BTreeSet<String>) -> Result<(), String> {
    let missing: Vec<_> = expected.difference(found).filter(|name| !name.starts_with("mem")).collect();
    if !missing.is_empty() {
        return Err(format!("not proved: {missing:?}. Add what is missing to crates/kernel/proof/src."));
    }
    let surplus: Vec<_> = found.difference(expected).filter(|name| !is_kept_apart(name)).collect();
    if !surplus.is_empty() {
        return Err(format!("functions that nobody allowed: {surplus:?}"));
    }
    Ok(())
}

/// A mangled function of the kernel, the proof or `core`; of nothing that needs an allocator or a system.
fn is_kept_apart(name: &str) -> bool {
    let ours = ["gonio_kernel", "4core", "$LT$core.."];
    name.starts_with("_ZN")
        && ours.iter().any(|part| name.contains(part))
        && !name.contains("5alloc")
        && !name.contains("3std")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn set(names: &[&str]) -> BTreeSet<String> {
        names.iter().map(|&name| name.to_owned()).collect()
    }

    #[test]
    fn a_missing_lobe_fails_and_is_named() {
        let error = compare(&set(&["Eon_eval_f32", "prove"]), &set(&["prove"])).unwrap_err();
        assert!(error.contains("Eon_eval_f32"), "{error}");
    }

    #[test]
    fn a_function_from_elsewhere_fails_and_is_named() {
        let error = compare(&set(&["prove"]), &set(&["prove", "fmodf"])).unwrap_err();
        assert!(error.contains("fmodf"), "{error}");
    }

    #[test]
    fn the_sources_call_for_every_lobe_and_number() {
        let expected = expected().unwrap();
        for name in ["Conductor_eval_F32x8", "Mirror_delta_f64", "sin_cos_turns_f32"] {
            assert!(expected.contains(name), "{name} is not among {expected:?}");
        }
        assert!(!expected.iter().any(|name| name.starts_with("AnyLobe")));
    }

    #[test]
    fn functions_of_the_kernel_may_stand_apart_and_those_of_std_may_not() {
        assert!(is_kept_apart("_ZN12gonio_kernel6energy13facet_cosines17h0a0785e546ae1bebE"));
        assert!(is_kept_apart("_ZN91_$LT$core..slice..iter..Iter$LT$T$GT$4fold17h078780c9aecb34bfE"));
        assert!(!is_kept_apart("_ZN3std2io5stdio6_print17h0123456789abcdefE"));
        assert!(!is_kept_apart("_ZN5alloc7raw_vec12handle_error17h0123456789abcdefE"));
        assert!(!is_kept_apart("malloc"));
    }
}
