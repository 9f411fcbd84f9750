//! `Source`: what parameters are read from. A scene file, a JSON document, or an instrument that goes through all choices.

use super::entry::{Entry, Parameter, Words, each_key};
use crate::real::Real;
use crate::rgb::Rgb;

/// What is wrong with the parameters as a whole.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub enum Problem {
    /// A parameter without a default is not given.
    Missing(&'static str),
    /// None of these ways is given, or several at once.
    OneOf(&'static [&'static [Entry]]),
    /// A rule over several parameters is broken; the sentence says which.
    Rule(&'static str),
    /// No model of that name; [`super::Model::each_model`] lists those that there are.
    UnknownModel,
}

/// Named values. Whoever implements it decides what a value out of range is, and what its errors say.
pub trait Source<R: Real> {
    /// What is wrong, and where.
    type Error;

    /// The model's name: the value of `type`.
    fn model(&self) -> &str;
    /// Whether a key is there.
    fn has(&self, key: &str) -> bool;
    /// A number; none if it is not given.
    ///
    /// # Errors
    /// It is not a number, or out of range.
    fn number(&mut self, parameter: &'static Parameter) -> Result<Option<R>, Self::Error>;
    /// A colour; none if it is not given.
    ///
    /// # Errors
    /// It is not a colour, or out of range.
    fn color(&mut self, parameter: &'static Parameter) -> Result<Option<Rgb<R>>, Self::Error>;
    /// Which of a few words; none if it is not given.
    ///
    /// # Errors
    /// It is none of them.
    fn word(&mut self, words: &'static Words) -> Result<Option<usize>, Self::Error>;
    /// The error for a problem with the parameters as a whole.
    fn refuse(&mut self, problem: Problem) -> Self::Error;

    /// A rule over several parameters is broken; the sentence says which.
    ///
    /// # Errors
    /// Unless the source wants the model all the same, to see what it does outside of its domain.
    fn break_rule(&mut self, rule: &'static str) -> Result<(), Self::Error> {
        Err(self.refuse(Problem::Rule(rule)))
    }

    /// Which of several ways is given: the one whose keys are all there, and of whose rivals none is.
    ///
    /// # Errors
    /// None of them is, or several are.
    fn way(&mut self, ways: &'static [&'static [Entry]]) -> Result<usize, Self::Error> {
        let fits = |way: &'static [Entry]| {
            let mut all = true;
            each_key(way, &mut |key| all &= self.has(key));
            let mut strangers = false;
            for other in ways {
                each_key(other, &mut |key| {
                    let mut own = false;
                    each_key(way, &mut |mine| own |= mine == key);
                    strangers |= self.has(key) && !own;
                });
            }
            all && !strangers
        };
        match ways.iter().copied().position(fits) {
            Some(way) => Ok(way),
            None => Err(self.refuse(Problem::OneOf(ways))),
        }
    }
}

/// Usual values: see [`super::Parameters::typical`].
#[derive(Debug)]
pub(super) struct Typical;

impl<R: Real> Source<R> for Typical {
    type Error = ();

    fn model(&self) -> &str {
        ""
    }
    fn has(&self, _key: &str) -> bool {
        false
    }
    fn number(&mut self, parameter: &'static Parameter) -> Result<Option<R>, ()> {
        Ok(Some(R::lit(parameter.default.unwrap_or(parameter.quantity.typical))))
    }
    fn color(&mut self, parameter: &'static Parameter) -> Result<Option<Rgb<R>>, ()> {
        Source::<R>::number(self, parameter).map(|x| x.map(Rgb::splat))
    }
    fn word(&mut self, _words: &'static Words) -> Result<Option<usize>, ()> {
        Ok(Some(0))
    }
    fn refuse(&mut self, _problem: Problem) {}
    fn way(&mut self, _ways: &'static [&'static [Entry]]) -> Result<usize, ()> {
        Ok(0)
    }
}
