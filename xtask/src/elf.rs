//! The functions that an ELF file defines: as much of the format as that takes (System V ABI, "Object Files").
//!
//! | structure | field | offset and size in bytes |
//! |---|---|---|
//! | file header | section headers: where, size of one, how many | 40 (8), 58 (2), 60 (2) |
//! | section header | type, offset, size, index of its strings | 4 (4), 24 (8), 32 (8), 40 (4) |
//! | symbol | name, kind in the low four bits, section | 0 (4), 4 (1), 6 (2) |

use std::collections::BTreeSet;

/// Type of the section that holds all symbols.
const SHT_SYMTAB: u64 = 2;
/// Size of one symbol.
const SYMBOL: usize = 24;
/// Kind of a symbol that is a function.
const STT_FUNC: u64 = 2;

/// The names of all functions defined in `file`; none if it is not a little-endian ELF file of 64 bits with symbols.
pub(crate) fn functions(file: &[u8]) -> Option<BTreeSet<String>> {
    if file.get(..6)? != b"\x7fELF\x02\x01" {
        return None;
    }
    let at = usize::try_from(number(file, 40, 8)?).ok()?;
    let (size, count) = (number(file, 58, 2)? as usize, number(file, 60, 2)? as usize);
    let section = |index: usize| file.get(at + index * size..)?.get(..size);
    let symbols = (0..count).filter_map(section).find(|s| number(s, 4, 4) == Some(SHT_SYMTAB))?;
    let strings = contents(file, section(number(symbols, 40, 4)? as usize)?)?;

    let mut names = BTreeSet::new();
    for symbol in contents(file, symbols)?.chunks_exact(SYMBOL) {
        let defined = number(symbol, 6, 2)? != 0;
        if defined && number(symbol, 4, 1)? & 15 == STT_FUNC {
            let name = strings.get(number(symbol, 0, 4)? as usize..)?.split(|&byte| byte == 0).next()?;
            names.insert(String::from_utf8_lossy(name).into_owned());
        }
    }
    Some(names)
}

/// The bytes of the section with this header.
fn contents<'a>(file: &'a [u8], header: &[u8]) -> Option<&'a [u8]> {
    let (offset, size) = (number(header, 24, 8)? as usize, number(header, 32, 8)? as usize);
    file.get(offset..)?.get(..size)
}

/// The little-endian number of `size` bytes at `at`.
fn number(bytes: &[u8], at: usize, size: usize) -> Option<u64> {
    let bytes = bytes.get(at..)?.get(..size)?;
    Some(bytes.iter().rev().fold(0, |sum, &byte| sum << 8 | u64::from(byte)))
}

#[cfg(all(test, target_os = "linux", target_pointer_width = "64", target_endian = "little"))]
mod tests {
    use super::*;

    #[test]
    fn this_very_program_defines_main() {
        let image = std::fs::read(std::env::current_exe().unwrap()).unwrap();
        assert!(functions(&image).unwrap().contains("main"));
    }

    #[test]
    fn what_is_not_elf_or_cut_short_has_no_functions() {
        assert_eq!(functions(b"#!/bin/sh"), None);
        let image = std::fs::read(std::env::current_exe().unwrap()).unwrap();
        assert_eq!(functions(&image[..200]), None);
    }
}
