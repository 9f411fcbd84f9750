//! Source trees with a cycle each, and some without: what the test of imports must find, and what it must let pass.

use super::cycles::cycles;
use super::imports;
use super::modules::Crate;

/// The cycles of a crate that is given as files.
fn found(files: &[(&str, &str)]) -> Vec<String> {
    let files = files.iter().map(|&(name, text)| (name.to_owned(), text.to_owned())).collect();
    cycles(&imports::of(&Crate::read(&files, "lib.rs").unwrap()))
}

#[test]
fn two_modules_that_use_each_other_are_found() {
    let a = "use crate::b::B;\npub struct A(B);";
    let b = "pub struct B;\n\nuse crate::a::A;\nfn f(_: A) {}";
    let cycle = "a → b (a.rs:1) → a (b.rs:3)";
    assert_eq!(found(&[("lib.rs", "mod a; mod b;"), ("a.rs", a), ("b.rs", b)]), [cycle]);
    let nested = "use crate::{b::{self, B as C}, c::*};\nfn f(_: C) {}";
    let a = found(&[
        ("lib.rs", "mod a; mod b; mod c;"),
        ("a.rs", &format!("{nested} pub struct A;")),
        ("b.rs", b),
        ("c.rs", ""),
    ]);
    assert_eq!(a, [cycle]);
}

#[test]
fn a_cycle_of_three_is_found() {
    let files = [
        ("lib.rs", "mod a; mod b; mod c;"),
        ("a.rs", "use crate::b::f; pub fn a() { f() }"),
        ("b.rs", "use crate::c::f as g; pub fn f() { g() }"),
        ("c.rs", "pub fn f() { super::a::a() }"),
    ];
    assert_eq!(found(&files), ["a → b (a.rs:1) → c (b.rs:1) → a (c.rs:1)"]);
}

#[test]
fn a_path_in_an_expression_a_type_or_a_macro_is_found() {
    let a = "use crate::b::B;\npub fn a(_: B) {}\npub struct Width;\nimpl Width { pub const EIGHT: usize = 8; }";
    let calls = [
        "pub struct B;\nfn f() { crate::a::a(B) }",
        "pub struct B;\nfn f() -> Option<super::a::Width> { None }",
        "pub struct B;\nconst N: [u8; crate::a::Width::EIGHT] = [0; 8];",
        "pub struct B;\nfn f() { assert_eq!(1 + 1, crate::a::Width::EIGHT); }",
        "pub struct B;\nmacro_rules! width { () => { $crate::a::Width::EIGHT } }",
        "pub struct B;\nfn f() { use crate::a; a::a(B) }",
        "pub struct B;\nmod inner { fn f() { super::super::a::a(crate::b::B) } }",
    ];
    for b in calls {
        let cycles = found(&[("lib.rs", "mod a; mod b;"), ("a.rs", a), ("b.rs", b)]);
        assert_eq!(cycles, ["a → b (a.rs:1) → a (b.rs:2)"], "{b}");
    }
}

#[test]
fn parent_and_child_that_use_each_other_are_found() {
    let child = ("a/child.rs", "use super::Shared;\npub fn f(_: Shared) {}");
    for parent in
        ["mod child;\npub struct Shared;\nuse child::f;", "mod child;\npub struct Shared;\nfn g() { child::f(Shared) }"]
    {
        let cycles = found(&[("lib.rs", "mod a;"), ("a.rs", parent), child]);
        assert_eq!(cycles, ["a → a::child (a.rs:3) → a (a/child.rs:1)"], "{parent}");
    }
    // What a child takes with a star, and what the parent calls by a name that it passes on.
    let child = ("a/child.rs", "use super::*;\npub fn f(_: Shared) {}");
    let cycles = found(&[
        ("lib.rs", "mod a;"),
        ("a/mod.rs", "mod child;\npub use child::f;\npub struct Shared; fn g() { f(Shared) }"),
        child,
    ]);
    assert_eq!(cycles, ["a → a::child (a/mod.rs:3) → a (a/child.rs:1)"]);
}

#[test]
fn a_name_that_is_passed_on_counts_for_the_module_that_defines_it() {
    let files = [
        ("lib.rs", "mod a; mod b; pub use a::A; pub use b::B;"),
        ("a.rs", "use crate::B;\npub struct A(B);"),
        ("b.rs", "pub struct B;\nimpl B { fn f(_: crate::A) {} }"),
    ];
    assert_eq!(found(&files), ["a → b (a.rs:1) → a (b.rs:2)"]);
}

#[test]
fn a_macro_counts_as_an_item() {
    let files = [
        ("lib.rs", "#[macro_use] mod a; mod b;"),
        ("a.rs", "use crate::b::B;\n#[macro_export]\nmacro_rules! make { () => {} }\nfn f(_: B) {}"),
        ("b.rs", "crate::make!();\npub struct B;"),
    ];
    assert_eq!(found(&files), ["a → b (a.rs:1) → a (b.rs:1)"]);
    let bare = [files[0], files[1], ("b.rs", "pub struct B;\nmake!();")];
    assert_eq!(found(&bare), ["a → b (a.rs:1) → a (b.rs:2)"]);
}

#[test]
fn what_a_parent_only_passes_on_is_no_import() {
    let files = [
        ("lib.rs", "mod a; pub use a::{f, Shared};"),
        ("a.rs", "mod child;\npub(crate) use child::f;\npub struct Shared;"),
        ("a/child.rs", "use super::Shared;\npub fn f(_: Shared) -> crate::Shared { crate::Shared }"),
    ];
    assert_eq!(found(&files), [""; 0]);
}

#[test]
fn tests_and_other_crates_are_no_imports() {
    let files = [
        ("lib.rs", "mod a; mod b; #[cfg(test)] mod absent;"),
        ("a.rs", "use crate::b::B;\npub struct A(B);"),
        (
            "b.rs",
            "use a::Outside;\npub struct B(Outside, ::a::A);\n#[cfg(test)] use crate::a::A;\n\
             #[cfg(all(test, unix))] mod tests { use crate::a::A; }\n#[test] fn t() { crate::a::A::f() }",
        ),
    ];
    assert_eq!(found(&files), [""; 0]);
    let not_a_test = [files[0], files[1], ("b.rs", "pub struct B;\n#[cfg(not(test))]\nuse crate::a::A;")];
    assert_eq!(found(&not_a_test), ["a → b (a.rs:1) → a (b.rs:3)"]);
}

#[test]
fn a_file_is_found_by_its_path_attribute() {
    let files = [
        ("lib.rs", "#[path = \"other/place.rs\"] mod a; mod b;"),
        ("other/place.rs", "use crate::b::B;\npub struct A(B);"),
        ("b.rs", "pub struct B;\nfn f(_: crate::a::A) {}"),
    ];
    assert_eq!(found(&files), ["a → b (other/place.rs:1) → a (b.rs:2)"]);
}
