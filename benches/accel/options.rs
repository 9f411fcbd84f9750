//! The command line.

use super::contenders::Builder;
use crate::scenes::{Character, Scene};
use gonio_accel::Intersect;
use std::fs;
use std::path::PathBuf;

/// What to do.
pub(crate) enum Mode {
    Rows,
    Ratio,
    Build,
    Threads,
    Sizes,
    Instances,
    /// As a child: build once and tell what memory it took.
    Memory(Builder),
    /// As a child: cast the rays of a set whenever told to.
    Trace,
}

/// Everything that can be asked for.
pub(crate) struct Options {
    pub(crate) mode: Mode,
    pub(crate) rounds: usize,
    pub(crate) rays: usize,
    pub(crate) scenes: Vec<Character>,
    pub(crate) tests: Vec<Intersect>,
    /// Another size than the full one.
    pub(crate) triangles: Option<usize>,
    /// The largest scene of `--sizes`.
    pub(crate) most: usize,
    pub(crate) json: Option<PathBuf>,
    pub(crate) svg: Option<PathBuf>,
}

impl Options {
    /// Without a mode of ours, all arguments are criterion's.
    pub(crate) fn parse(arguments: &[String]) -> Result<Self, String> {
        let mut options = Self {
            mode: Mode::Rows,
            rounds: 5,
            rays: 768 * 384,
            scenes: Character::ALL.to_vec(),
            tests: vec![Intersect::Robust, Intersect::Fast],
            triangles: None,
            most: 10_000_000,
            json: None,
            svg: None,
        };
        const MODES: [&str; 7] = ["--ratio", "--build", "--threads", "--sizes", "--instances", "--memory", "--trace"];
        if !arguments.iter().any(|argument| MODES.contains(&argument.as_str())) {
            return Ok(options);
        }
        let mut arguments = arguments.iter();
        while let Some(option) = arguments.next() {
            let mut value = || arguments.next().ok_or_else(|| format!("{option} needs a value"));
            match option.as_str() {
                "--bench" => {} // says cargo
                "--ratio" => options.mode = Mode::Ratio,
                "--build" => options.mode = Mode::Build,
                "--threads" => options.mode = Mode::Threads,
                "--sizes" => options.mode = Mode::Sizes,
                "--instances" => options.mode = Mode::Instances,
                "--memory" => options.mode = Mode::Memory(Builder::named(value()?)?),
                "--trace" => options.mode = Mode::Trace,
                "--rounds" => options.rounds = number(option, value()?)?,
                "--rays" => options.rays = number(option, value()?)?,
                "--triangles" => options.triangles = Some(number(option, value()?)?),
                "--most" => options.most = number(option, value()?)?,
                "--json" => options.json = Some(value()?.into()),
                "--svg" => options.svg = Some(value()?.into()),
                "--scene" => {
                    let name = one_of(&Character::ALL.map(Character::name), value()?)?;
                    options.scenes.retain(|scene| scene.name() == name);
                }
                "--intersect" => {
                    let name = one_of(&["robust", "fast"], value()?)?;
                    options.tests.retain(|test| test.to_string() == name);
                }
                _ => return Err(format!("no such option: {option}")),
            }
        }
        Ok(options)
    }

    /// The scene in the size that was asked for.
    pub(crate) fn scene(&self, character: Character) -> Scene {
        self.triangles.map_or_else(|| character.full_scene(), |triangles| character.scene(triangles))
    }

    /// The arguments with which a child makes the same scene and rays.
    pub(crate) fn for_child(&self, scene: Character, test: Intersect) -> Vec<String> {
        let mut arguments = vec!["--scene".to_owned(), scene.name().to_owned()];
        arguments.extend(["--intersect".to_owned(), test.to_string(), "--rays".to_owned(), self.rays.to_string()]);
        arguments.extend(self.triangles.iter().flat_map(|n| ["--triangles".to_owned(), n.to_string()]));
        arguments
    }

    /// Writes the JSON if it was asked for.
    pub(crate) fn write_json(&self, report: &impl serde::Serialize) -> Result<(), String> {
        let Some(path) = &self.json else { return Ok(()) };
        let text = serde_json::to_string_pretty(report).map_err(|e| e.to_string())? + "\n";
        fs::write(path, text).map_err(|e| format!("{}: {e}", path.display()))
    }
}

fn number(option: &str, text: &str) -> Result<usize, String> {
    let number = text.parse().ok().filter(|&n| n > 0);
    number.ok_or_else(|| format!("{option} needs a whole number above 0, not {text}"))
}

fn one_of<'a>(names: &[&'a str], name: &str) -> Result<&'a str, String> {
    let found = names.iter().find(|known| **known == name).copied();
    found.ok_or_else(|| format!("{name} is none of {}", names.join(", ")))
}
