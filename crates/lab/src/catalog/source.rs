//! Sources of parameters that are no files: one that goes through all choices, and one that names a few keys.

use gonio_kernel::model::{Entry, Parameter, Problem, Source, Words};
use gonio_kernel::{Real, Rgb};

/// Goes through every combination of words and ways, numbers being those of a function of the parameter and the channel.
///
/// What is met while one combination is read decides what further choices there are, so it counts like an odometer whose number of
/// wheels depends on the wheels before.
pub(super) struct EveryChoice<F> {
    number: F,
    /// The wheels: what is chosen, and of how many.
    wheels: Vec<(usize, usize)>,
    at: usize,
    /// What this combination is called: the keys of a way, and words but for the usual ones.
    words: Vec<String>,
}

impl<F> EveryChoice<F> {
    /// At the first combination.
    pub(super) fn new(number: F) -> Self {
        Self { number, wheels: Vec::new(), at: 0, words: Vec::new() }
    }

    /// The words of the combination that was read.
    pub(super) fn words(&self) -> &[String] {
        &self.words
    }

    /// Goes on to the next combination, if there is one.
    pub(super) fn advance(&mut self) -> bool {
        self.at = 0;
        self.words.clear();
        while let Some((digit, of)) = self.wheels.pop() {
            if digit + 1 < of {
                self.wheels.push((digit + 1, of));
                return true;
            }
        }
        false
    }

    fn choose(&mut self, of: usize, name: impl FnOnce(usize) -> String) -> usize {
        if self.at == self.wheels.len() {
            self.wheels.push((0, of));
        }
        let (digit, _) = self.wheels[self.at];
        self.at += 1;
        self.words.push(name(digit));
        digit
    }
}

impl<R: Real, F: FnMut(&'static Parameter, usize) -> f64> Source<R> for EveryChoice<F> {
    type Error = ();

    fn model(&self) -> &str {
        ""
    }
    fn has(&self, _key: &str) -> bool {
        false
    }
    fn number(&mut self, parameter: &'static Parameter) -> Result<Option<R>, ()> {
        Ok(Some(R::lit((self.number)(parameter, 0))))
    }
    fn color(&mut self, parameter: &'static Parameter) -> Result<Option<Rgb<R>>, ()> {
        let [r, g, b] = [0, 1, 2].map(|channel| R::lit((self.number)(parameter, channel)));
        Ok(Some(Rgb::new(r, g, b)))
    }
    fn word(&mut self, words: &'static Words) -> Result<Option<usize>, ()> {
        let name = |digit| if words.default == Some(digit) { "" } else { words.each().nth(digit).unwrap_or("") };
        Ok(Some(self.choose(words.words.len(), |digit| name(digit).to_owned())))
    }
    fn refuse(&mut self, _problem: Problem) {}
    fn way(&mut self, ways: &'static [&'static [Entry]]) -> Result<usize, ()> {
        Ok(self.choose(ways.len(), |digit| {
            let mut keys = Vec::new();
            gonio_kernel::model::each_key(ways[digit], &mut |key| keys.push(key));
            keys.join("+")
        }))
    }
}

/// A value of a row of the catalog.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Given {
    /// A number, or three equal ones.
    Number(f32),
    /// Three.
    Color([f32; 3]),
    /// A word.
    Word(&'static str),
}

impl From<f32> for Given {
    fn from(x: f32) -> Self {
        Self::Number(x)
    }
}
impl From<[f32; 3]> for Given {
    fn from(color: [f32; 3]) -> Self {
        Self::Color(color)
    }
}
impl From<&'static str> for Given {
    fn from(word: &'static str) -> Self {
        Self::Word(word)
    }
}

/// A model with a few keys, as a material file would give them.
pub(super) struct Keys<'a> {
    pub(super) model: &'a str,
    pub(super) keys: &'a [(&'static str, Given)],
}

impl Keys<'_> {
    fn find(&self, key: &str) -> Option<Given> {
        self.keys.iter().find(|(name, _)| *name == key).map(|(_, given)| *given)
    }
}

impl<R: Real> Source<R> for Keys<'_> {
    type Error = String;

    fn model(&self) -> &str {
        self.model
    }
    fn has(&self, key: &str) -> bool {
        self.find(key).is_some()
    }
    fn number(&mut self, parameter: &'static Parameter) -> Result<Option<R>, String> {
        match self.find(parameter.key) {
            None => Ok(None),
            Some(Given::Number(x)) => Ok(Some(R::lit(f64::from(x)))),
            Some(other) => Err(format!("{}: {other:?} is not a number", parameter.key)),
        }
    }
    fn color(&mut self, parameter: &'static Parameter) -> Result<Option<Rgb<R>>, String> {
        match self.find(parameter.key) {
            None => Ok(None),
            Some(Given::Number(x)) => Ok(Some(Rgb::splat(R::lit(f64::from(x))))),
            Some(Given::Color(color)) => {
                let [r, g, b] = color.map(|x| R::lit(f64::from(x)));
                Ok(Some(Rgb::new(r, g, b)))
            }
            Some(other) => Err(format!("{}: {other:?} is not a colour", parameter.key)),
        }
    }
    fn word(&mut self, words: &'static Words) -> Result<Option<usize>, String> {
        match self.find(words.key) {
            None => Ok(None),
            Some(Given::Word(word)) => words.find(word).map(Some).ok_or(format!("{}: {word} is not known", words.key)),
            Some(other) => Err(format!("{}: {other:?} is not a word", words.key)),
        }
    }
    fn refuse(&mut self, problem: Problem) -> String {
        format!("{}: {problem:?}", self.model)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_combination_is_read_once_also_where_a_choice_depends_on_another() {
        let mut source = EveryChoice::new(());
        let mut seen = Vec::new();
        loop {
            let first = source.choose(2, |digit| digit.to_string());
            // The second wheel exists only behind the first digit 1, and has three digits.
            let second = if first == 1 { source.choose(3, |digit| digit.to_string()) } else { 9 };
            seen.push((first, second));
            if !source.advance() {
                break;
            }
        }
        assert_eq!(seen, [(0, 9), (1, 0), (1, 1), (1, 2)]);
    }
}
