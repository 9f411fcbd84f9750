//! The proof that the kernel needs neither std nor an allocator and cannot panic: this program links.
//!
//! The panic handler calls a function that is defined nowhere. If any panic is reachable in the optimised program, the
//! call survives and the linker reports `gonio_kernel_can_panic`. A generic function has no code until it is used, so the
//! program uses everything: each lobe of [`gonio_kernel::for_each_lobe`] and each free function of the kernel, for `f32`,
//! `f64` and eight lanes, under a symbol of its own that `cargo xtask no-std` looks up afterwards. Arguments come from and
//! results go to `black_box`; without it the optimiser throws the kernel away and an empty proof passes too.
//!
//! This package stands outside the workspace and its ban on unsafe code: `extern`, exported names and a `_start` in
//! assembly are what a program without std is made of.
#![no_std]
#![no_main]

mod functions;
mod lobes;
mod types;

use core::hint::black_box;
use gonio_kernel::{Real, Rgb, Vec3};

unsafe extern "C" {
    /// Defined nowhere.
    safe fn gonio_kernel_can_panic() -> !;
}

#[panic_handler]
fn panic(_: &core::panic::PanicInfo) -> ! {
    gonio_kernel_can_panic()
}

// The start: a stack aligned for 32-byte spills, the proof, then exit(0) of Linux. And copying: every compiler for every
// target asks for memcpy and memset (a surface in lanes is about 2 KB), which libc or `compiler_builtins` supply elsewhere.
core::arch::global_asm!(
    ".globl _start, memcpy, memset",
    ".type _start, @function",
    ".type memcpy, @function",
    ".type memset, @function",
    "_start: xor ebp, ebp",
    "and rsp, -64",
    "call prove",
    "xor edi, edi",
    "mov eax, 60",
    "syscall",
    "ud2",
    "memcpy: mov rax, rdi",
    "mov rcx, rdx",
    "rep movsb",
    "ret",
    "memset: mov r8, rdi",
    "mov eax, esi",
    "mov rcx, rdx",
    "rep stosb",
    "mov rax, r8",
    "ret",
);

#[unsafe(no_mangle)]
extern "C" fn prove() {
    lobes::prove();
    functions::prove();
    types::prove();
    #[cfg(feature = "plant-panic")]
    black_box(planted(&[1.0, 2.0], black_box(1)));
}

/// The planted fault of the feature `plant-panic`: n may be 2 for all that the compiler knows.
#[cfg(feature = "plant-panic")]
#[unsafe(no_mangle)]
#[inline(never)]
extern "C" fn planted(table: &[f32; 2], n: usize) -> f32 {
    table[n]
}

/// A number that the optimiser knows nothing about.
#[inline(always)]
fn some<R: Real>(x: f64) -> R {
    black_box(R::lit(x))
}

/// A colour that the optimiser knows nothing about.
#[inline(always)]
fn colour<R: Real>(x: f64) -> Rgb<R> {
    Rgb::new(some(x), some(0.5 * x), some(0.25 * x))
}

/// A direction that the optimiser knows nothing about.
#[inline(always)]
fn direction<R: Real>(x: f64, y: f64, z: f64) -> Vec3<R> {
    Vec3::new(some(x), some(y), some(z))
}
