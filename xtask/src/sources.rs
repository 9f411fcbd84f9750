//! Reads from the kernel's sources what there is to prove: its lobes and its free functions.
//!
//! By lines, not by a parser: rustfmt keeps `impl` and `pub fn` of a module at the start of theirs.

use crate::cargo::root;
use std::collections::BTreeSet;
use std::path::Path;

/// The types with `impl<…> Lobe<R> for Type<…>` in a file below `lobe/`.
pub(crate) fn lobes() -> Result<BTreeSet<String>, String> {
    let names = collect("crates/kernel/src/lobe", lobe)?;
    if names.is_empty() { Err("no lobe found below crates/kernel/src/lobe".to_owned()) } else { Ok(names) }
}

/// The functions `pub fn name<R: Real…>` outside any `impl`.
pub(crate) fn free_functions() -> Result<BTreeSet<String>, String> {
    collect("crates/kernel/src", free_function)
}

fn lobe(line: &str) -> Option<&str> {
    let (_, rest) = line.strip_prefix("impl<")?.split_once("> Lobe<R> for ")?;
    Some(identifier(rest))
}

fn free_function(line: &str) -> Option<&str> {
    let rest = line.strip_prefix("pub fn ")?;
    rest.contains("<R: Real").then(|| identifier(rest))
}

fn identifier(text: &str) -> &str {
    text.split(|c: char| !c.is_alphanumeric() && c != '_').next().unwrap_or(text)
}

/// What `find` finds in the lines of all Rust files below `directory`.
fn collect(directory: &str, find: fn(&str) -> Option<&str>) -> Result<BTreeSet<String>, String> {
    let mut names = BTreeSet::new();
    visit(&root().join(directory), &mut |text| names.extend(text.lines().filter_map(find).map(str::to_owned)))
        .map_err(|e| format!("{directory}: {e}"))?;
    Ok(names)
}

fn visit(directory: &Path, see: &mut dyn FnMut(&str)) -> std::io::Result<()> {
    for entry in std::fs::read_dir(directory)? {
        let path = entry?.path();
        if path.is_dir() {
            visit(&path, see)?;
        } else if path.extension().is_some_and(|e| e == "rs") {
            see(&std::fs::read_to_string(&path)?);
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lobe_is_the_type_that_implements_it() {
        assert_eq!(lobe("impl<R: Real> Lobe<R> for Conductor<R> {"), Some("Conductor"));
        assert_eq!(lobe("impl<R: Real, const N: usize> Lobe<R> for Table<R, N> {"), Some("Table"));
        assert_eq!(lobe("    impl<R: Real> Lobe<R> for Nested<R> {"), None);
    }

    #[test]
    fn a_free_function_is_public_generic_and_not_indented() {
        assert_eq!(free_function("pub fn sin_cos_turns<R: Real>(u: R) -> (R, R) {"), Some("sin_cos_turns"));
        assert_eq!(free_function("    pub fn dot<R: Real>(self) -> R {"), None);
        assert_eq!(free_function("fn polynomial<R: Real>(x: R) -> R {"), None);
    }
}
