//! The catalog: every model of the kernel in every variant, and surfaces made of them.
//!
//! A *variant* is a model with each of its choices made: all combinations of words and ways that its rules allow, read from its
//! declaration, one of those that run the same code. Models come from the kernel's table ([`gonio_kernel::for_each_lobe`]): a new one
//! has its variants, rows, sweeps, plots and comparisons without a line here.
//!
//! A *row* is a surface that the instruments measure: each variant at usual values and at the ends of what plots show, and those that
//! somebody thought worth a look, written by the keys of material files (`rows.rs`).

mod rows;
mod source;

pub(crate) use rows::{Row, rows};
pub(crate) use source::Given;

use crate::random::Random;
use crate::test_bsdf::{DynBsdf, Number};
use gonio_kernel::lobe::AnyLobe;
use gonio_kernel::model::Parameter;
use gonio_kernel::{Lobe, Model, Parameters, Surface};
use source::{EveryChoice, Keys};

/// A model with its choices made, at usual values.
#[derive(Clone, Debug)]
pub(crate) struct Variant {
    /// Its name: that of the model, and what sets it apart from the model's other variants.
    pub(crate) name: String,
    /// It, at usual values.
    pub(crate) lobe: AnyLobe<'static, f32>,
}

impl Variant {
    /// A surface of it.
    pub(crate) fn surface(&self) -> Surface<f32> {
        Surface::of(self.lobe)
    }
}

/// Every variant of every model.
pub(crate) fn variants() -> Vec<Variant> {
    let mut variants = Vec::new();
    macro_rules! every {
        ($($file:ident::$model:ident),* $(,)?) => {
            $(variants.extend(variants_of::<gonio_kernel::lobe::$model<f32>>(stringify!($model)));)*
        };
    }
    gonio_kernel::for_each_lobe!(every);
    variants
}

/// Those of one model, of the name of its type.
fn variants_of<M: Model + Parameters<Real = f32> + Into<AnyLobe<'static, f32>>>(name: &str) -> Vec<Variant> {
    let usual = |p: &'static Parameter, _| p.default.unwrap_or(p.quantity.typical);
    let mut source = EveryChoice::new(usual);
    let mut found: Vec<(Vec<String>, M)> = Vec::new();
    loop {
        if let Ok(model) = M::read(&mut source)
            && !found.iter().any(|(_, other)| other.same_code(&model))
        {
            found.push((source.words().to_vec(), model));
        }
        if !source.advance() {
            break;
        }
    }
    // What all have in common sets none apart.
    let common = |i: usize, word: &String| found.iter().all(|(words, _)| words.get(i) == Some(word));
    let named = found.iter().map(|(words, model)| {
        let apart = words.iter().enumerate().filter(|(i, word)| !word.is_empty() && !common(*i, word));
        let name = apart.fold(kebab(name), |name, (_, word)| name + " " + word);
        Variant { name, lobe: (*model).into() }
    });
    named.collect()
}

/// "RoughDielectric" as "rough-dielectric".
fn kebab(name: &str) -> String {
    let mut text = String::new();
    for c in name.chars() {
        if c.is_uppercase() && !text.is_empty() {
            text.push('-');
        }
        text.extend(c.to_lowercase());
    }
    text
}

/// A lobe by its `type` and keys, as in a material file.
///
/// # Panics
/// No such model, or not with these keys.
pub(crate) fn lobe(model: &str, keys: &[(&'static str, Given)]) -> AnyLobe<'static, f32> {
    AnyLobe::read(&mut Keys { model, keys }).unwrap_or_else(|error: String| panic!("{model} {keys:?}: {error}"))
}

/// The lobe at usual values whose channels differ, where the model's rules allow that.
fn coloured(lobe: &AnyLobe<'static, f32>) -> AnyLobe<'static, f32> {
    let coloured: AnyLobe<'static, f32> = lobe.map(&mut |p, channel, x| {
        let [lo, hi] = p.quantity.shown;
        let end = [hi, f64::from(x), lo][channel] as f32;
        if p.is_color { x + 0.4 * (end - x) } else { x }
    });
    if coloured.domain() { coloured } else { *lobe }
}

/// The lobe at the ends of what plots show: the upper ends, and both by turns for the channels of colours.
fn extreme(lobe: &AnyLobe<'static, f32>) -> AnyLobe<'static, f32> {
    let mut colours = 0_usize;
    lobe.map(&mut |p, _, _| {
        let [lo, hi] = p.quantity.shown;
        colours += usize::from(p.is_color);
        (if p.is_color && colours % 2 == 1 { lo } else { hi }) as f32
    })
}

/// A value of a parameter's domain, ends included.
pub(crate) fn random_value(p: &Parameter, random: &mut Random) -> f32 {
    let (lo, hi) = (p.quantity.lo, p.quantity.hi);
    let x = match random.bits() % 8 {
        0 => lo,
        1 => hi,
        _ => match p.quantity.log_from {
            Some(from) => random.log_between(from, hi),
            None => random.between(lo, hi),
        },
    };
    (x as f32).clamp(lo as f32, hi as f32)
}

/// Draws values of all numbers of a lobe in its domain.
pub(crate) struct RandomValues<'a, 't> {
    bsdf: &'a dyn DynBsdf<'t>,
    numbers: Vec<Number>,
    /// Of a lobe with a rule over several numbers, which may be broken where each lies in its own domain: what did obey it, of late.
    lawful: Option<Vec<Vec<f32>>>,
    next: usize,
}

/// How many are kept.
const LAWFUL: usize = 4096;

impl<'a, 't> RandomValues<'a, 't> {
    /// Of this lobe.
    pub(crate) fn new(bsdf: &'a dyn DynBsdf<'t>) -> Self {
        let numbers = bsdf.numbers();
        let own = numbers.iter().map(|number| number.value).collect();
        let mut values = Self { bsdf, numbers, lawful: None, next: 0 };
        let mut random = Random::new(0);
        if (0..256).any(|_| !bsdf.domain_at(&values.any(&mut random))) {
            values.lawful = Some(vec![own]);
            (0..LAWFUL).for_each(|_| drop(values.draw(&mut random)));
        }
        values
    }

    fn any(&self, random: &mut Random) -> Vec<f32> {
        self.numbers.iter().map(|number| random_value(number.parameter, random)).collect()
    }

    /// Values in the order of its numbers. Where they break a rule, earlier ones that did not take their place.
    pub(crate) fn draw(&mut self, random: &mut Random) -> Vec<f32> {
        let values = self.any(random);
        let Some(lawful) = &mut self.lawful else { return values };
        if !self.bsdf.domain_at(&values) {
            return lawful[(random.bits() % lawful.len() as u64) as usize].clone();
        }
        if lawful.len() < LAWFUL {
            lawful.push(values.clone());
        } else {
            lawful[self.next % LAWFUL].clone_from(&values);
            self.next += 1;
        }
        values
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use gonio_kernel::model::ModelInfo;

    #[test]
    fn every_model_has_variants_and_their_names_tell_them_apart() {
        let variants = variants();
        let mut models = 0;
        AnyLobe::<f32>::each_model(&mut |_: &'static ModelInfo| models += 1);
        let heads: std::collections::BTreeSet<&str> =
            variants.iter().filter_map(|variant| variant.name.split(' ').next()).collect();
        assert_eq!(heads.len(), models, "{heads:?}");
        for (i, variant) in variants.iter().enumerate() {
            assert!(variants[..i].iter().all(|other| other.name != variant.name), "{}", variant.name);
            assert!(variant.lobe.domain() && coloured(&variant.lobe).domain(), "{}", variant.name);
            assert!(extreme(&variant.lobe).domain(), "{:?}", extreme(&variant.lobe));
        }
        let has = |name: &str| variants.iter().any(|variant| variant.name == name);
        for name in ["lambert", "conductor f0 kulla-conty", "conductor beckmann separable eta+k", "eon fitted"] {
            assert!(has(name), "{name} is not among {:?}", variants.iter().map(|v| &v.name).collect::<Vec<_>>());
        }
    }

    #[test]
    fn the_ends_of_every_domain_lie_in_it() {
        for variant in variants() {
            let moved = |end: fn(&Parameter) -> f64| -> AnyLobe<'static, f32> {
                variant.lobe.map(&mut |p, _, x| {
                    // What obeys a rule with others stays.
                    let alone = variant.lobe.map(&mut |q, _, y| if p.key == q.key { end(p) as f32 } else { y });
                    let alone: AnyLobe<'static, f32> = alone;
                    if alone.domain() { end(p) as f32 } else { x }
                })
            };
            assert!(moved(|p| p.quantity.lo).domain() && moved(|p| p.quantity.hi).domain(), "{}", variant.name);
        }
    }

    #[test]
    fn random_values_obey_the_rules_and_reach_the_ends() {
        for variant in variants() {
            let surface = variant.surface();
            let (numbers, mut random) = (DynBsdf::numbers(&surface), Random::new(3));
            let mut values = RandomValues::new(&surface);
            let all: Vec<Vec<f32>> = (0..500).map(|_| values.draw(&mut random)).collect();
            for (i, number) in numbers.iter().enumerate() {
                let own = |end: f64| all.iter().any(|values| values[i] == end as f32);
                assert!(own(number.parameter.quantity.lo) && own(number.parameter.quantity.hi), "{}", variant.name);
            }
            assert!(all.iter().all(|values| surface.domain_at(values)), "{}", variant.name);
        }
    }
}
