//! The macros of the declarations. A field's type decides what it is: `Rgb<R>` a colour, `R` a number, `Name<R>` a group, `Name`
//! a choice.

mod field;

/// One of a few words, each of which runs code of its own. Further words behind the first are older spellings.
///
/// ```
/// use gonio_kernel::{choice, model::Choice};
/// choice! {
///     /// How the threads cross.
///     pub enum Weave {
///         /// Over and under.
///         Plain = "plain" | "linen",
///         /// Over several.
///         Satin = "satin",
///     }
/// }
/// assert_eq!(Weave::named("linen"), Some(Weave::Plain));
/// assert_eq!(Weave::Satin.word(), "satin");
/// ```
#[macro_export]
macro_rules! choice {
    (
        $(#[$doc:meta])*
        $vis:vis enum $name:ident { $($(#[$each:meta])* $variant:ident = $word:literal $(| $alias:literal)*),* $(,)? }
    ) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        #[non_exhaustive]
        $vis enum $name { $($(#[$each])* $variant),* }
        impl $crate::model::Choice for $name {
            const WORDS: &'static [&'static [&'static str]] = &[$(&[$word $(, $alias)*]),*];
            const ALL: &'static [Self] = &[$(Self::$variant),*];
        }
    };
}

/// A model: a struct of parameters with a name, its `type` in material files. See [`mod@crate::model`].
///
/// `= "name" with (key | key)` is a model that shares its name with another and is meant where one of these keys is given.
/// `rule |it| condition => "sentence";` is what several parameters must obey together; `coat |it| curve;` behind the rules gives the
/// [`AlbedoCurve`](crate::energy::AlbedoCurve) of a model that can lie on top of others, or none.
#[macro_export]
macro_rules! model {
    (
        $(#[doc = $doc:literal])*
        $vis:vis struct $name:ident<R> = $model:literal $(with ($($with:literal)|+))? { $($fields:tt)* }
        $($rules:tt)*
    ) => {
        $crate::group! {
            $(#[doc = $doc])*
            $vis struct $name<R> { $($fields)* }
            $($rules)*
        }
        impl<R: $crate::Real> $crate::model::Model for $name<R> {
            #[allow(unused_variables)]
            fn is_named(name: &str, has: &dyn Fn(&str) -> bool) -> bool {
                name == $model $(&& ($(has($with))||+))?
            }
            fn model_name(&self) -> &'static str {
                $model
            }
            fn each_model(visit: &mut dyn FnMut(&'static $crate::model::ModelInfo)) {
                visit(const { &$crate::model::ModelInfo::declared(
                    $model, concat!($($doc),*), <$name<f32> as $crate::model::Parameters>::ENTRIES,
                ) });
            }
        }
    };
}

/// A set of parameters that several models share, as a struct. See [`mod@crate::model`].
#[macro_export]
macro_rules! group {
    (
        $(#[doc = $doc:literal])*
        $vis:vis struct $name:ident<R> {
            $($(#[doc = $says:literal])* $field:ident $(($key:literal))? : $t:ident $(<$r:ident>)? $(= $d:tt)? $(in $q:expr)?),* $(,)?
        }
        $(rule |$this:ident| $rule:expr => $text:literal;)*
        $(coat |$coat:ident| $curve:expr;)?
    ) => {
        $(#[doc = $doc])*
        #[derive(Clone, Copy, Debug, PartialEq)]
        $vis struct $name<R> { $($(#[doc = $says])* pub $field: $t $(<$r>)?),* }

        impl<R: $crate::Real> $crate::model::Parameters for $name<R> {
            type Real = R;
            type Of<S: $crate::Real> = $name<S>;
            const ENTRIES: &'static [$crate::model::Entry] = &[$(
                $crate::__field!(entry $crate::__key!($field $($key)?), concat!($($says),*), [$($d)?] [$($q)?] $t $(<$r>)?)
            ),*];

            #[inline(always)]
            #[allow(unused_variables)]
            fn map<S: $crate::Real>(
                &self,
                f: &mut impl FnMut(&'static $crate::model::Parameter, usize, R) -> S,
            ) -> $name<S> {
                $name { $($field: $crate::__field!(
                    map self.$field, f, $crate::__key!($field $($key)?), concat!($($says),*), [$($d)?] [$($q)?] $t $(<$r>)?
                )),* }
            }
            $crate::__if_wide! {
                #[inline(always)]
                fn gather(lanes: [&$name<f32>; 8]) -> $name<$crate::F32x8> {
                    $name { $($field: $crate::__field!(gather lanes, [.$field], $t $(<$r>)?)),* }
                }
            }
            #[inline(always)]
            #[allow(unused_variables)]
            fn same_code(&self, other: &Self) -> bool {
                true $(&& $crate::__field!(same self.$field, other.$field, $t $(<$r>)?))*
            }
            #[allow(unused_variables)]
            fn each_choice(&self, visit: &mut dyn FnMut(&'static str)) {
                $($crate::__field!(choices self.$field, visit, $t $(<$r>)?);)*
            }
            #[inline(always)]
            fn in_domain(&self) -> R::Mask {
                <R::Mask as $crate::Mask>::splat(true)
                    $(& $crate::__field!(domain self.$field, [$($q)?] $t $(<$r>)?))*
                    $(& { let $this = self; let holds: R::Mask = $rule; holds })*
            }
            $(#[inline(always)]
            fn albedo_curve(&self) -> Option<$crate::energy::AlbedoCurve<R>> {
                let $coat = self;
                $curve
            })?
            fn read<S: $crate::model::Source<R>>(source: &mut S) -> Result<Self, S::Error> {
                let read = Self { $($field: $crate::__field!(
                    read source, $crate::__key!($field $($key)?), concat!($($says),*), [$($d)?] [$($q)?] $t $(<$r>)?
                )),* };
                $({
                    let $this = &read;
                    let holds: R::Mask = $rule;
                    if !$crate::Mask::all(holds) {
                        source.break_rule($text)?;
                    }
                })*
                Ok(read)
            }
        }
    };
}

/// Parameters that can be given in several ways, as an enum of them (each runs code of its own), or as one struct of numbers with
/// other spellings. See [`mod@crate::model`].
///
/// An enum's `or (key: Choice, "sentence") => expression;` makes a value from a word. A struct's `or (key: quantity, …) =>
/// expression;` makes it from other numbers, and `or () => expression;` is its default.
#[macro_export]
macro_rules! one_of {
    (
        $(#[doc = $doc:literal])*
        $vis:vis struct $name:ident<R> { $($(#[doc = $says:literal])* $field:ident: R in $q:expr),* $(,)? }
        $(or ($($(#[doc = $osays:literal])* $ofield:ident: R in $oq:expr),*) => $made:expr;)*
    ) => {
        $(#[doc = $doc])*
        #[derive(Clone, Copy, Debug, PartialEq)]
        $vis struct $name<R> { $($(#[doc = $says])* pub $field: R),* }

        impl<R: $crate::Real> $crate::model::Parameters for $name<R> {
            type Real = R;
            type Of<S: $crate::Real> = $name<S>;
            const ENTRIES: &'static [$crate::model::Entry] = &[$crate::model::Entry::OneOf {
                doc: concat!($($doc),*),
                ways: &[
                    &[$($crate::__field!(entry stringify!($field), concat!($($says),*), [] [$q] R)),*],
                    $(&[$($crate::__field!(entry stringify!($ofield), concat!($($osays),*), [] [$oq] R)),*]),*
                ],
            }];

            #[inline(always)]
            fn map<S: $crate::Real>(
                &self,
                f: &mut impl FnMut(&'static $crate::model::Parameter, usize, R) -> S,
            ) -> $name<S> {
                $name { $($field: $crate::__field!(map self.$field, f, stringify!($field), concat!($($says),*), [] [$q] R)),* }
            }
            $crate::__if_wide! {
                #[inline(always)]
                fn gather(lanes: [&$name<f32>; 8]) -> $name<$crate::F32x8> {
                    $name { $($field: $crate::__field!(gather lanes, [.$field], R)),* }
                }
            }
            #[inline(always)]
            fn same_code(&self, _: &Self) -> bool {
                true
            }
            fn each_choice(&self, _: &mut dyn FnMut(&'static str)) {}
            #[inline(always)]
            fn in_domain(&self) -> R::Mask {
                <R::Mask as $crate::Mask>::splat(true) $(& $crate::__field!(domain self.$field, [$q] R))*
            }
            fn read<S: $crate::model::Source<R>>(source: &mut S) -> Result<Self, S::Error> {
                let ways = $crate::model::__ways::<Self>();
                let (way, mut at) = (source.way(ways)?, 0..);
                if at.next() == Some(way) {
                    return Ok(Self { $($field: $crate::__field!(read source, stringify!($field), "", [] [$q] R)),* });
                }
                $(if at.next() == Some(way) {
                    $(let $ofield: R = $crate::__field!(read source, stringify!($ofield), "", [] [$oq] R);)*
                    return Ok($made);
                })*
                Err(source.refuse($crate::model::Problem::OneOf(ways)))
            }
        }
    };
    (
        $(#[doc = $doc:literal])*
        $vis:vis enum $name:ident<R> {
            $($(#[doc = $vsays:literal])* $variant:ident {
                $($(#[doc = $says:literal])* $field:ident $(($key:literal))? : $t:ident $(<$r:ident>)? in $q:expr),* $(,)?
            }),* $(,)?
        }
        $(or ($preset:ident: $choice:ident, $psays:literal) => $made:expr;)*
    ) => {
        $(#[doc = $doc])*
        #[derive(Clone, Copy, Debug, PartialEq)]
        #[non_exhaustive]
        $vis enum $name<R> {
            $($(#[doc = $vsays])* $variant { $($(#[doc = $says])* $field: $t $(<$r>)?),* }),*
        }

        impl<R: $crate::Real> $crate::model::Parameters for $name<R> {
            type Real = R;
            type Of<S: $crate::Real> = $name<S>;
            const ENTRIES: &'static [$crate::model::Entry] = &[$crate::model::Entry::OneOf {
                doc: concat!($($doc),*),
                ways: &[
                    $(&[$($crate::__field!(
                        entry $crate::__key!($field $($key)?), concat!($($says),*), [] [$q] $t $(<$r>)?
                    )),*],)*
                    $(&[$crate::model::Entry::Choice($crate::model::Words::declared(
                        stringify!($preset), <$choice as $crate::model::Choice>::WORDS, None, $psays,
                    ))]),*
                ],
            }];

            #[inline(always)]
            fn map<S: $crate::Real>(
                &self,
                f: &mut impl FnMut(&'static $crate::model::Parameter, usize, R) -> S,
            ) -> $name<S> {
                match *self { $(Self::$variant { $($field),* } => $name::$variant { $($field: $crate::__field!(
                    map $field, f, $crate::__key!($field $($key)?), concat!($($says),*), [] [$q] $t $(<$r>)?
                )),* }),* }
            }
            $crate::__if_wide! {
                #[inline(always)]
                fn gather(lanes: [&$name<f32>; 8]) -> $name<$crate::F32x8> {
                    match *lanes[0] { $($name::$variant { $($field),* } => {
                        // A lane of another way gets what the first has.
                        $(let first = $field;
                        let $field = lanes.map(|lane| match *lane {
                            $name::$variant { $field, .. } => $field,
                            #[allow(unreachable_patterns)]
                            _ => first,
                        });)*
                        $name::$variant { $($field: $crate::__field!(gather $field, [], $t $(<$r>)?)),* }
                    }),* }
                }
            }
            #[inline(always)]
            fn same_code(&self, other: &Self) -> bool {
                core::mem::discriminant(self) == core::mem::discriminant(other)
            }
            fn each_choice(&self, visit: &mut dyn FnMut(&'static str)) {
                visit(match self { $(Self::$variant { .. } => stringify!($variant)),* });
            }
            #[inline(always)]
            fn in_domain(&self) -> R::Mask {
                match *self { $(Self::$variant { $($field),* } => <R::Mask as $crate::Mask>::splat(true)
                    $(& $crate::__field!(domain $field, [$q] $t $(<$r>)?))*),* }
            }
            fn read<S: $crate::model::Source<R>>(source: &mut S) -> Result<Self, S::Error> {
                let ways = $crate::model::__ways::<Self>();
                let (way, mut at) = (source.way(ways)?, 0..);
                $(if at.next() == Some(way) {
                    return Ok(Self::$variant { $($field: $crate::__field!(
                        read source, $crate::__key!($field $($key)?), "", [] [$q] $t $(<$r>)?
                    )),* });
                })*
                $(if at.next() == Some(way) {
                    let $preset: $choice = $crate::__field!(read source, stringify!($preset), "", [] [] $choice);
                    return Ok($made);
                })*
                Err(source.refuse($crate::model::Problem::OneOf(ways)))
            }
        }
    };
}

/// The ways of a declaration that is one of several.
#[doc(hidden)]
pub fn __ways<P: super::Parameters>() -> &'static [&'static [super::Entry]] {
    match P::ENTRIES {
        [super::Entry::OneOf { ways, .. }] => ways,
        _ => &[],
    }
}
