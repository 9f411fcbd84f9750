//! `gonio tables`: writes the kernel's generated source, or compares it. For `cargo xtask tables`.

use crate::output::{Target, write_text};
use anyhow::{Context, Result, bail};
use std::path::PathBuf;
use std::process::ExitCode;

/// Makes the tables of the kernel (crates/kernel/src/energy/tables.rs).
#[derive(clap::Args)]
pub(crate) struct Args {
    /// Only compare the file with what would be written: an error if a byte differs.
    #[arg(long)]
    check: bool,
    /// The file.
    #[arg(long, default_value = "crates/kernel/src/energy/tables.rs")]
    out: PathBuf,
}

/// Writes or compares.
///
/// # Errors
/// If the file cannot be written, or differs.
pub(crate) fn run(args: &Args) -> Result<ExitCode> {
    let text = gonio_lab::tables::generate();
    let name = args.out.display();
    if args.check {
        let found = std::fs::read_to_string(&args.out).with_context(|| format!("{name}: cannot be read"))?;
        if let Some(line) = first_difference(&found, &text) {
            bail!("{name}:{line}: is not what `cargo xtask tables` writes");
        }
        println!("{name}: up to date");
    } else {
        write_text(&Target::File(args.out.clone()), &text)?;
        println!("{name}: written");
    }
    Ok(ExitCode::SUCCESS)
}

/// The number of the first line that differs.
fn first_difference(a: &str, b: &str) -> Option<usize> {
    if a == b {
        return None;
    }
    let same = a.split_inclusive('\n').zip(b.split_inclusive('\n')).take_while(|(a, b)| a == b).count();
    Some(same + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_line_that_differs_is_named() {
        assert_eq!(first_difference("a\nb\n", "a\nb\n"), None);
        assert_eq!(first_difference("a\nb\n", "a\nc\n"), Some(2));
        assert_eq!(first_difference("a\nb", "a\nb\n"), Some(2));
        assert_eq!(first_difference("a\n", "a\nb\n"), Some(2));
    }
}
