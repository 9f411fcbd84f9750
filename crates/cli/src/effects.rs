//! `gonio effects`: what a scene calls for, and what in it does so.

use crate::output::{Target, write_text};
use crate::scene::load;
use anyhow::Result;
use gonio_kernel::lobe::AnyLobe;
use gonio_kernel::model::Model;
use gonio_tracer::{Effect, SceneEffects};
use serde::Serialize;
use std::fmt::Write;
use std::path::PathBuf;
use std::process::ExitCode;

/// Most parts that are named of those that need an effect; JSON names all.
const NAMED: usize = 4;

/// Say which effects a scene calls for, and by which of its parts.
///
/// A render looks at these and leaves out the rest: code of models that no material is made of, lights of kinds that are not
/// there, and so on. What is left out never changes a pixel.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// Scene file (.toml), or an OBJ file alone
    scene: PathBuf,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

/// What is needed, by whom, and what is not.
#[derive(Serialize)]
struct Report<'a> {
    needed: Vec<Needed<'a>>,
    not_needed: Vec<&'static str>,
    models: Vec<Needed<'a>>,
    models_not_needed: Vec<&'static str>,
}

#[derive(Serialize)]
struct Needed<'a> {
    name: &'static str,
    by: &'a [String],
}

/// Prints them.
///
/// # Errors
/// The scene cannot be read or placed.
pub(crate) fn run(args: &Args) -> Result<ExitCode> {
    let world = load(&args.scene)?;
    let report = Report::of(world.effects());
    let text = if args.json { serde_json::to_string_pretty(&report)? + "\n" } else { report.text() };
    write_text(&Target::Stdout, &text)?;
    Ok(ExitCode::SUCCESS)
}

impl<'a> Report<'a> {
    fn of(effects: &'a SceneEffects) -> Self {
        let needed = effects.set().iter().map(|e| Needed { name: e.name(), by: effects.needed_by(e) });
        let not_needed = Effect::ALL.iter().filter(|&&e| !effects.set().has(e)).map(|e| e.name());
        let models: Vec<_> = effects.models().map(|(name, by)| Needed { name, by }).collect();
        let mut models_not_needed = Vec::new();
        AnyLobe::<f32>::each_model(&mut |model| {
            if !models.iter().any(|m| m.name == model.name) && !models_not_needed.contains(&model.name) {
                models_not_needed.push(model.name);
            }
        });
        Self { needed: needed.collect(), not_needed: not_needed.collect(), models, models_not_needed }
    }

    fn text(&self) -> String {
        let mut text = String::new();
        for (title, needed, not_needed) in
            [("effects", &self.needed, &self.not_needed), ("models", &self.models, &self.models_not_needed)]
        {
            let width = needed.iter().map(|n| n.name.len()).max().unwrap_or(0);
            let _ = writeln!(text, "{title} needed");
            for Needed { name, by } in needed {
                let more = by.len().saturating_sub(NAMED);
                let more = if more > 0 { format!(" and {more} more") } else { String::new() };
                let _ = writeln!(text, "  {name:width$}  {}{more}", by[..by.len().min(NAMED)].join(", "));
            }
            let _ = writeln!(text, "{title} not needed\n  {}", not_needed.join(", "));
        }
        text
    }
}
