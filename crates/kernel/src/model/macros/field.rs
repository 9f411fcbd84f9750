//! What the macros of declarations do with one field, by what it is: a colour, a number, a group or a choice.

/// What a field's type says.
#[doc(hidden)]
#[macro_export]
macro_rules! __field {
    (parameter $key:expr, $doc:expr, $color:expr, [$($d:expr)?], $q:expr) => {
        $crate::model::Parameter::declared($key, $color, $q, $crate::__default!($($d)?), $doc)
    };
    (words $key:expr, $doc:expr, [$($d:tt)?] $choice:ident) => {
        $crate::model::Words::declared(
            $key, <$choice as $crate::model::Choice>::WORDS, $crate::__default_choice!($choice $($d)?), $doc,
        )
    };

    (entry $key:expr, $doc:expr, [$($d:tt)?] [$q:expr] Rgb<R>) => {
        $crate::model::Entry::Parameter($crate::__field!(parameter $key, $doc, true, [$($d)?], $q))
    };
    (entry $key:expr, $doc:expr, [$($d:tt)?] [$q:expr] R) => {
        $crate::model::Entry::Parameter($crate::__field!(parameter $key, $doc, false, [$($d)?], $q))
    };
    (entry $key:expr, $doc:expr, [] [] $group:ident<R>) => {
        $crate::model::Entry::Group(<$group<f32> as $crate::model::Parameters>::ENTRIES)
    };
    (entry $key:expr, $doc:expr, [$($d:tt)?] [] $choice:ident) => {
        $crate::model::Entry::Choice($crate::__field!(words $key, $doc, [$($d)?] $choice))
    };

    (map $x:expr, $f:ident, $key:expr, $doc:expr, [$($d:tt)?] [$q:expr] Rgb<R>) => {{
        let parameter = const { &$crate::__field!(parameter $key, $doc, true, [$($d)?], $q) };
        $crate::Rgb::new($f(parameter, 0, $x.r), $f(parameter, 1, $x.g), $f(parameter, 2, $x.b))
    }};
    (map $x:expr, $f:ident, $key:expr, $doc:expr, [$($d:tt)?] [$q:expr] R) => {
        $f(const { &$crate::__field!(parameter $key, $doc, false, [$($d)?], $q) }, 0, $x)
    };
    (map $x:expr, $f:ident, $key:expr, $doc:expr, [] [] $group:ident<R>) => {
        $crate::model::Parameters::map(&$x, $f)
    };
    (map $x:expr, $f:ident, $key:expr, $doc:expr, [$($d:tt)?] [] $choice:ident) => { $x };

    (gather $lanes:expr, [$($path:tt)*], Rgb<R>) => {{
        let lanes = $lanes;
        $crate::Rgb::from_lanes(|i| lanes[i & 7]$($path)*)
    }};
    (gather $lanes:expr, [$($path:tt)*], R) => {{
        let lanes = $lanes;
        $crate::F32x8::from_fn(|i| lanes[i & 7]$($path)*)
    }};
    (gather $lanes:expr, [$($path:tt)*], $group:ident<R>) => {{
        let lanes = $lanes;
        <$group<f32> as $crate::model::Parameters>::gather($crate::each_lane(|i| &lanes[i & 7]$($path)*))
    }};
    (gather $lanes:expr, [$($path:tt)*], $choice:ident) => { $lanes[0]$($path)* };

    (same $a:expr, $b:expr, Rgb<R>) => { true };
    (same $a:expr, $b:expr, R) => { true };
    (same $a:expr, $b:expr, $group:ident<R>) => { $crate::model::Parameters::same_code(&$a, &$b) };
    (same $a:expr, $b:expr, $choice:ident) => { $a == $b };

    (choices $x:expr, $visit:ident, Rgb<R>) => {};
    (choices $x:expr, $visit:ident, R) => {};
    (choices $x:expr, $visit:ident, $group:ident<R>) => { $crate::model::Parameters::each_choice(&$x, $visit) };
    (choices $x:expr, $visit:ident, $choice:ident) => { $visit($crate::model::Choice::word($x)) };

    (domain $x:expr, [$q:expr] Rgb<R>) => { { let q = $q; q.contains($x.r) & q.contains($x.g) & q.contains($x.b) } };
    (domain $x:expr, [$q:expr] R) => { ($q).contains($x) };
    (domain $x:expr, [] $group:ident<R>) => { $crate::model::Parameters::in_domain(&$x) };
    (domain $x:expr, [] $choice:ident) => { <R::Mask as $crate::Mask>::splat(true) };

    (read $source:ident, $key:expr, $doc:expr, [$($d:tt)?] [$q:expr] Rgb<R>) => {
        $crate::model::read_color($source, const { &$crate::__field!(parameter $key, $doc, true, [$($d)?], $q) })?
    };
    (read $source:ident, $key:expr, $doc:expr, [$($d:tt)?] [$q:expr] R) => {
        $crate::model::read_number($source, const { &$crate::__field!(parameter $key, $doc, false, [$($d)?], $q) })?
    };
    (read $source:ident, $key:expr, $doc:expr, [] [] $group:ident<R>) => { $crate::model::Parameters::read($source)? };
    (read $source:ident, $key:expr, $doc:expr, [$($d:tt)?] [] $choice:ident) => {
        $crate::model::read_word::<$choice, R, S>($source, const { &$crate::__field!(words $key, $doc, [$($d)?] $choice) })?
    };
}

/// The field's name, unless another key is given.
#[doc(hidden)]
#[macro_export]
macro_rules! __key {
    ($field:ident) => {
        stringify!($field)
    };
    ($field:ident $key:literal) => {
        $key
    };
}

/// A number, or none.
#[doc(hidden)]
#[macro_export]
macro_rules! __default {
    () => {
        None
    };
    ($x:expr) => {
        Some($x)
    };
}

/// The place of a choice among its likes, or none.
#[doc(hidden)]
#[macro_export]
macro_rules! __default_choice {
    ($choice:ident) => {
        None
    };
    ($choice:ident $default:ident) => {
        Some($choice::$default as usize)
    };
}

/// What follows, where there are lanes.
#[cfg(feature = "wide")]
#[doc(hidden)]
#[macro_export]
macro_rules! __if_wide {
    ($($tokens:tt)*) => { $($tokens)* };
}

/// Nothing, for want of lanes.
#[cfg(not(feature = "wide"))]
#[doc(hidden)]
#[macro_export]
macro_rules! __if_wide {
    ($($tokens:tt)*) => {};
}
