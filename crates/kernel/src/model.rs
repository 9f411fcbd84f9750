//! `Parameters` and `Model`: a scattering model is declared once, and all else about its parameters follows.
//!
//! - A [`Quantity`] is a domain with a meaning: [`REFLECTANCE`], [`ALPHA`].
//! - A [`Parameter`] is a quantity with a key, a default and a sentence: `base_color`, a reflectance, 0.8.
//! - A [`choice!`](crate::choice) is one of a few words, each of which runs code of its own.
//! - A [`group!`](crate::group) is a set of parameters that models share; [`one_of!`](crate::one_of) one that can be given in
//!   several ways (roughness, or alpha, or alpha_x with alpha_y).
//! - A [`model!`](crate::model!) is a struct of these with a name, its `type` in material files.
//!
//! From the declaration come the struct, generic over [`Real`]; its twins in `f64` and in eight lanes ([`Parameters::to`],
//! [`Parameters::gather`]); its keys in files ([`Parameters::read`], from any [`Source`]) and their table in the documentation
//! ([`Parameters::ENTRIES`]); its domain; which parameters can take a texture (every number and colour; the renderer offers colours); and what instruments sweep, nudge
//! and plot ([`Parameters::map`]). Combinations of lobes are made of parameters too.
//!
//! ```
//! use gonio_kernel::model::{Parameters, REFLECTANCE, ROUGHNESS};
//! use gonio_kernel::{Rgb, model};
//!
//! model! {
//!     /// A cloth.
//!     pub struct Velvet<R> = "velvet" {
//!         /// Part of the light that is scattered.
//!         base_color: Rgb<R> = 0.8 in REFLECTANCE,
//!         /// 0.1 is satin, 0.5 felt.
//!         roughness: R = 0.3 in ROUGHNESS,
//!     }
//! }
//!
//! let red = Velvet { base_color: Rgb::new(0.8_f32, 0.1, 0.1), roughness: 0.3 };
//! assert!(Parameters::in_domain(&red));
//! assert_eq!(red.to::<f64>().roughness, f64::from(0.3_f32));
//! assert!(!Parameters::in_domain(&Velvet { roughness: 1.5, ..red }));
//! ```

mod entry;
mod macros;
pub(crate) mod quantity;
mod source;

pub use entry::{Entry, ModelInfo, Parameter, Words, each_key};
#[doc(hidden)]
pub use macros::__ways;
pub use quantity::{
    ALPHA, COATING_ALPHA, COATING_INDEX, COATING_ROUGHNESS, ETA, EXPONENT, EXTINCTION, INDEX, MICROFACET_ROUGHNESS,
    Quantity, REFLECTANCE, ROUGHNESS, Role, WEIGHT,
};
pub use source::{Problem, Source};

use crate::energy::AlbedoCurve;
#[cfg(feature = "wide")]
use crate::lanes::F32x8;
use crate::real::Real;

/// Anything made of parameters. [`Parameters::map`] is the one walk over all numbers.
pub trait Parameters: Copy {
    /// The arithmetic.
    type Real: Real;
    /// The same in another arithmetic.
    type Of<S: Real>: Parameters<Real = S>;
    /// Keys, domains, defaults, meanings; empty for combinations of models.
    const ENTRIES: &'static [Entry];

    /// Each number replaced by f(its parameter, its channel, the number).
    fn map<S: Real>(&self, f: &mut impl FnMut(&'static Parameter, usize, Self::Real) -> S) -> Self::Of<S>;
    /// Eight side by side that run the same code ([`Parameters::same_code`]); a lane that does not has the first one's numbers.
    #[cfg(feature = "wide")]
    fn gather(lanes: [&Self::Of<f32>; 8]) -> Self::Of<F32x8>;
    /// Whether both run the same code: equal choices, equal ways, equal models.
    fn same_code(&self, other: &Self) -> bool;
    /// Calls `visit` with all that decides which code runs: the names of models, ways and words, in order. Two that run the same
    /// code say the same.
    fn each_choice(&self, visit: &mut dyn FnMut(&'static str));
    /// Whether every number lies in its domain and every rule over several holds.
    fn in_domain(&self) -> <Self::Real as Real>::Mask;
    /// The directional albedo over the angle, erring upwards, of a lobe that can lie on top of others: they receive what is left
    /// ([`crate::lobe::Layer`]). None for a lobe that nothing shines through.
    #[inline(always)]
    fn albedo_curve(&self) -> Option<AlbedoCurve<Self::Real>> {
        None
    }
    /// Reads the parameters from a file or whatever else names them.
    ///
    /// # Errors
    /// What the source says.
    fn read<S: Source<Self::Real>>(source: &mut S) -> Result<Self, S::Error>;

    /// It at usual values: each number its default or what its quantity says is typical, the first of all ways and words. None if
    /// a rule over several parameters forbids that.
    ///
    /// ```
    /// use gonio_kernel::{lobe::Phong, model::Parameters};
    /// assert_eq!(Phong::<f64>::typical().unwrap().exponent, 30.0);
    /// ```
    fn typical() -> Option<Self> {
        Self::read(&mut source::Typical).ok()
    }
    /// The same in another arithmetic, each number rounded to it.
    ///
    /// ```
    /// use gonio_kernel::{Rgb, lobe::Lambert, model::Parameters};
    /// let double = Lambert::new(Rgb::splat(0.5_f32)).to::<f64>();
    /// assert_eq!(double.albedo.g, 0.5);
    /// ```
    #[inline(always)]
    fn to<S: Real>(&self) -> Self::Of<S>
    where
        Self: Parameters<Real = f32>,
    {
        self.map(&mut |_, _, x| S::lit(f64::from(x)))
    }
}

/// A model, or an enum of models, that files can name.
pub trait Model: Parameters {
    /// Whether `type = name` with these keys is this model.
    fn is_named(name: &str, has: &dyn Fn(&str) -> bool) -> bool;
    /// The name of this model, its `type` in material files.
    fn model_name(&self) -> &'static str;
    /// Calls `visit` with each model's declaration.
    fn each_model(visit: &mut dyn FnMut(&'static ModelInfo));
}

/// One of a few words, each of which runs code of its own.
pub trait Choice: Copy + PartialEq + 'static {
    /// The words in material files, in the order of [`Choice::ALL`], each with its other spellings behind it.
    const WORDS: &'static [&'static [&'static str]];
    /// All choices.
    const ALL: &'static [Self];

    /// Its word.
    fn word(self) -> &'static str {
        let mut known = Self::ALL.iter().zip(Self::WORDS);
        known.find(|(choice, _)| **choice == self).and_then(|(_, words)| words.first().copied()).unwrap_or("")
    }
    /// The choice of that word, in any spelling.
    fn named(word: &str) -> Option<Self> {
        let known = Self::WORDS.iter().position(|words| words.contains(&word))?;
        Self::ALL.get(known).copied()
    }
}

/// A number of a file, or its default.
#[doc(hidden)]
pub fn read_number<S: Source<R>, R: Real>(source: &mut S, p: &'static Parameter) -> Result<R, S::Error> {
    match (source.number(p)?, p.default) {
        (Some(x), _) => Ok(x),
        (None, Some(default)) => Ok(R::lit(default)),
        (None, None) => Err(source.refuse(Problem::Missing(p.key))),
    }
}

/// A colour of a file, or its default, a grey.
#[doc(hidden)]
pub fn read_color<S: Source<R>, R: Real>(source: &mut S, p: &'static Parameter) -> Result<crate::Rgb<R>, S::Error> {
    match (source.color(p)?, p.default) {
        (Some(c), _) => Ok(c),
        (None, Some(default)) => Ok(crate::Rgb::splat(R::lit(default))),
        (None, None) => Err(source.refuse(Problem::Missing(p.key))),
    }
}

/// A word of a file, or its default.
#[doc(hidden)]
pub fn read_word<C: Choice, R: Real, S: Source<R>>(source: &mut S, words: &'static Words) -> Result<C, S::Error> {
    let which = source.word(words)?.or(words.default);
    match which.and_then(|which| C::ALL.get(which)) {
        Some(choice) => Ok(*choice),
        None => Err(source.refuse(Problem::Missing(words.key))),
    }
}
