//! `AnyLobe`: one of the kernel's lobes, and the macro that makes such enums, a user's too.

use super::*;

/// An enum of lobes that is a lobe: the kernel's own, and a user's, which may hold the kernel's.
///
/// ```
/// use gonio_kernel::lobe::{AnyLobe, Eon};
/// use gonio_kernel::any_lobe;
///
/// any_lobe! {
///     /// What my scenes are made of: two fast kinds, and whatever else there is.
///     pub enum Mine<'t, R> {
///         /// Walls.
///         Wall(Eon<R>),
///         /// All else.
///         Other(AnyLobe<'t, R>),
///     }
/// }
/// # use gonio_kernel::{Closure, Rgb, Vec3};
/// let wall: Mine<f32> = Eon::new(Rgb::splat(0.7), 0.5).into();
/// assert!(Closure::new(wall, Vec3::unit_z()).sample([0.5; 3]).weight.g > 0.0);
/// ```
#[macro_export]
macro_rules! any_lobe {
    (
        $(#[$doc:meta])*
        $vis:vis enum $any:ident<$($life:lifetime,)? R> { $($(#[$each:meta])* $name:ident($lobe:ty)),* $(,)? }
    ) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq)]
        #[non_exhaustive]
        $vis enum $any<$($life,)? R> {
            $($(#[$each])* $name($lobe),)*
            $(
                #[doc(hidden)]
                __Borrows(core::convert::Infallible, core::marker::PhantomData<&$life ()>),
            )?
        }
        $crate::__any_lobe!($any [$($life)?] [$($life,)? R] [$($name($lobe)),*]);
    };
}

/// The implementations of [`any_lobe!`](crate::any_lobe).
#[doc(hidden)]
#[macro_export]
macro_rules! __any_lobe {
    ($any:ident [$($life:lifetime)?] $generics:tt [$($name:ident($lobe:ty)),*]) => {
        const _: () = {
            use $crate::energy::AlbedoCurve;
            use $crate::lobe::{Lobe, Properties, Sample, Transport, Value};
            use $crate::model::{Entry, Model, ModelInfo, Parameter, Parameters, Problem, Source};
            use $crate::{Real, Rgb, Vec3};

            /// What each of them prepares.
            #[derive(Clone, Copy, Debug)]
            pub enum Prepared<$($name),*> { $($name($name)),* }

            impl<$($life,)? R: Real> Lobe<R> for $any<$($life,)? R> {
                type Prepared = Prepared<$(<$lobe as Lobe<R>>::Prepared),*>;
                const LOBES: u32 = {
                    let mut most = 1;
                    $(if <$lobe as Lobe<R>>::LOBES > most {
                        most = <$lobe as Lobe<R>>::LOBES;
                    })*
                    most
                };
                #[inline(always)]
                fn prepare(&self, wo: Vec3<R>, transport: Transport) -> Self::Prepared {
                    match self {
                        $(Self::$name(lobe) => Prepared::$name(lobe.prepare(wo, transport)),)*
                        $(Self::__Borrows(never, _) => $crate::__never!($life never),)?
                    }
                }
                #[inline(always)]
                fn eval(&self, wo: Vec3<R>, prepared: &Self::Prepared, wi: Vec3<R>) -> Value<R> {
                    match (self, prepared) {
                        $((Self::$name(lobe), Prepared::$name(prepared)) => lobe.eval(wo, prepared, wi),)*
                        // What another lobe prepared.
                        #[allow(unreachable_patterns)]
                        _ => Value::zero(),
                    }
                }
                #[inline(always)]
                fn sample(&self, wo: Vec3<R>, prepared: &Self::Prepared, u: [R; 3]) -> Sample<R> {
                    match (self, prepared) {
                        $((Self::$name(lobe), Prepared::$name(prepared)) => lobe.sample(wo, prepared, u),)*
                        #[allow(unreachable_patterns)]
                        _ => Sample::nothing(),
                    }
                }
                #[inline(always)]
                fn delta(&self, wo: Vec3<R>, prepared: &Self::Prepared, sample: &Sample<R>) -> Value<R> {
                    match (self, prepared) {
                        $((Self::$name(lobe), Prepared::$name(prepared)) => lobe.delta(wo, prepared, sample),)*
                        #[allow(unreachable_patterns)]
                        _ => Value::zero(),
                    }
                }
                #[inline(always)]
                fn albedo_estimate(&self, wo: Vec3<R>) -> Rgb<R> {
                    match self {
                        $(Self::$name(lobe) => lobe.albedo_estimate(wo),)*
                        $(Self::__Borrows(never, _) => $crate::__never!($life never),)?
                    }
                }
                #[inline(always)]
                fn domain(&self) -> R::Mask {
                    match self {
                        $(Self::$name(lobe) => lobe.domain(),)*
                        $(Self::__Borrows(never, _) => $crate::__never!($life never),)?
                    }
                }
                #[inline(always)]
                fn properties(&self) -> Properties<R> {
                    match self {
                        $(Self::$name(lobe) => lobe.properties(),)*
                        $(Self::__Borrows(never, _) => $crate::__never!($life never),)?
                    }
                }
                #[inline(always)]
                fn largest_weight(&self, wo: Vec3<R>) -> R {
                    match self {
                        $(Self::$name(lobe) => lobe.largest_weight(wo),)*
                        $(Self::__Borrows(never, _) => $crate::__never!($life never),)?
                    }
                }
                #[inline(always)]
                fn radiance_scale(&self, wo: Vec3<R>) -> R {
                    match self {
                        $(Self::$name(lobe) => lobe.radiance_scale(wo),)*
                        $(Self::__Borrows(never, _) => $crate::__never!($life never),)?
                    }
                }
                #[inline(always)]
                fn is_lambertian(&self) -> bool {
                    match self {
                        $(Self::$name(lobe) => Lobe::<R>::is_lambertian(lobe),)*
                        $(Self::__Borrows(never, _) => $crate::__never!($life never),)?
                    }
                }
            }

            impl<$($life,)? R: Real> Parameters for $any<$($life,)? R> {
                type Real = R;
                type Of<Another: Real> = $any<$($life,)? Another>;
                const ENTRIES: &'static [Entry] = &[];

                #[inline(always)]
                fn map<Another: Real>(
                    &self,
                    f: &mut impl FnMut(&'static Parameter, usize, R) -> Another,
                ) -> $any<$($life,)? Another> {
                    match self {
                        $(Self::$name(lobe) => $any::$name(lobe.map(f)),)*
                        $(Self::__Borrows(never, _) => $crate::__never!($life never),)?
                    }
                }
                $crate::__if_wide! {
                    #[inline(always)]
                    fn gather(lanes: [&$any<$($life,)? f32>; 8]) -> $any<$($life,)? $crate::F32x8> {
                        match lanes[0] {
                            $($any::$name(first) => $any::$name(<$lobe as Parameters>::gather($crate::each_lane(|i| {
                                match lanes[i & 7] {
                                    $any::$name(lobe) => lobe,
                                    #[allow(unreachable_patterns)]
                                    _ => first,
                                }
                            }))),)*
                            $($any::__Borrows(never, _) => $crate::__never!($life never),)?
                        }
                    }
                }
                #[inline(always)]
                fn same_code(&self, other: &Self) -> bool {
                    match (self, other) {
                        $((Self::$name(a), Self::$name(b)) => a.same_code(b),)*
                        #[allow(unreachable_patterns)]
                        _ => false,
                    }
                }
                fn each_choice(&self, visit: &mut dyn FnMut(&'static str)) {
                    visit(self.model_name());
                    match self {
                        $(Self::$name(lobe) => lobe.each_choice(visit),)*
                        $(Self::__Borrows(never, _) => $crate::__never!($life never),)?
                    }
                }
                #[inline(always)]
                fn in_domain(&self) -> R::Mask {
                    match self {
                        $(Self::$name(lobe) => lobe.in_domain(),)*
                        $(Self::__Borrows(never, _) => $crate::__never!($life never),)?
                    }
                }
                #[inline(always)]
                fn albedo_curve(&self) -> Option<AlbedoCurve<R>> {
                    match self {
                        $(Self::$name(lobe) => lobe.albedo_curve(),)*
                        $(Self::__Borrows(never, _) => $crate::__never!($life never),)?
                    }
                }
                fn read<S: Source<R>>(source: &mut S) -> Result<Self, S::Error> {
                    $(if <$lobe as Model>::is_named(source.model(), &|key| source.has(key)) {
                        return Ok(Self::$name(<$lobe as Parameters>::read(source)?));
                    })*
                    Err(source.refuse(Problem::UnknownModel))
                }
            }

            impl<$($life,)? R: Real> Model for $any<$($life,)? R> {
                fn is_named(name: &str, has: &dyn Fn(&str) -> bool) -> bool {
                    $(<$lobe as Model>::is_named(name, has))||*
                }
                fn model_name(&self) -> &'static str {
                    match self {
                        $(Self::$name(lobe) => lobe.model_name(),)*
                        $(Self::__Borrows(never, _) => $crate::__never!($life never),)?
                    }
                }
                fn each_model(visit: &mut dyn FnMut(&'static ModelInfo)) {
                    $(<$lobe as Model>::each_model(visit);)*
                }
            }

            $($crate::__from_lobe!($any $generics $name($lobe));)*
        };
    };
}

/// One lobe of an enum, as the enum.
#[doc(hidden)]
#[macro_export]
macro_rules! __from_lobe {
    ($any:ident [$($generics:tt)*] $name:ident($lobe:ty)) => {
        impl<$($generics)*> From<$lobe> for $any<$($generics)*> {
            #[inline(always)]
            fn from(lobe: $lobe) -> Self {
                Self::$name(lobe)
            }
        }
    };
}

/// A value that cannot be.
#[doc(hidden)]
#[macro_export]
macro_rules! __never {
    ($life:lifetime $never:ident) => {
        match *$never {}
    };
}

macro_rules! kernel_lobes {
    ($($file:ident::$model:ident),* $(,)?) => {
        any_lobe! {
            /// Any of the kernel's lobes. The lifetime is that of tables that a lobe borrows.
            pub enum AnyLobe<'t, R> {$(
                #[doc = concat!("See [`", stringify!($model), "`].")]
                $model($model<R>),
            )*}
        }
    };
}
for_each_lobe!(kernel_lobes);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::closure::Closure;
    use crate::fresnel::Fresnel;
    use crate::metal::Metal;
    use crate::microfacet::{Beckmann, Ggx};
    use crate::model::Parameters;
    use crate::real::Real;
    use crate::rgb::Rgb;
    use crate::surface::{Surface, SurfaceError};
    use crate::testing::{MixedLanes, Random, same_bits, special_values};
    use crate::vec3::Vec3;
    use std::format;
    use std::vec::Vec;

    type Mixed = MixedLanes<f32>;

    /// wo, wi, u: ordinary, and one in four with a special value in it.
    fn inputs() -> Vec<[[f32; 3]; 3]> {
        let (values, mut random) = (special_values(), Random(71));
        let mut all = Vec::new();
        for i in 0..2000 {
            let [wo, wi] = [random.direction(), random.direction()].map(<[f32; 3]>::from);
            let mut input = [wo, wi, [random.unit(), random.unit(), random.unit()]];
            if i % 4 == 0 {
                let at = random.bits() as usize;
                input[at % 3][at / 3 % 3] = values[at / 9 % values.len()];
            }
            all.push(input);
        }
        all
    }

    /// Value and sample of a closure, as numbers. Out of line, so that its code is made once.
    #[inline(never)]
    fn numbers<R: Real, L: Lobe<R>>(lobe: &L, [wo, wi, u]: [[R; 3]; 3], of: impl Fn(R) -> f32) -> [f32; 16] {
        let closure = Closure::new(lobe, Vec3::from(wo));
        let (value, sample) = (closure.eval(wi.into()), closure.sample(u));
        let truth = |mask: R::Mask| R::select(mask, R::ONE, R::ZERO);
        let (f, s, w) = (value.f_cos, sample.f_cos, sample.weight);
        let event = [truth(sample.event.failed), truth(sample.event.is_delta), truth(sample.event.transmitted)];
        let [x, y, z] = sample.wi.into();
        [f.r, f.g, f.b, value.pdf, s.r, s.g, sample.pdf, x, y, z, w.r, w.g, w.b, event[0], event[1], event[2]].map(of)
    }

    fn assert_same<L: Lobe<f32> + Parameters<Real = f32>>(what: &str, lobe: L)
    where
        L::Of<Mixed>: Lobe<Mixed>,
    {
        let mixed = lobe.to::<Mixed>();
        for input in inputs() {
            let alone = numbers(&lobe, input, |x| x);
            let among = numbers(&mixed, input.map(|v| v.map(MixedLanes)), |x| x.0);
            let same = alone.iter().zip(&among).all(|(&a, &b)| same_bits(a, b));
            assert!(same, "{what} at {input:?}: {alone:?} alone, {among:?} among lanes that differ");
        }
    }

    /// Every model at usual values, and what they do not show.
    fn lobes() -> Vec<AnyLobe<'static, f32>> {
        let mut lobes = Vec::new();
        macro_rules! typical {
            ($($file:ident::$model:ident),* $(,)?) => { $(lobes.extend($model::<f32>::typical().map(AnyLobe::from));)* };
        }
        for_each_lobe!(typical);
        let gold = Fresnel::from(Metal::Gold);
        lobes.push(Conductor::new(Beckmann::isotropic(0.3), gold).into());
        lobes.push(Conductor::new(Ggx::isotropic(1e-8), Fresnel::Schlick { f0: Rgb::splat(0.5) }).into());
        lobes.push(Dielectric::new(1.0 / 1.5).into());
        lobes.push(RoughDielectric::new(Ggx::isotropic(0.2), 1.0002).into());
        lobes
    }

    #[test]
    fn no_branch_on_what_other_lanes_do_changes_a_lobe_or_a_closure() -> Result<(), SurfaceError> {
        let all = lobes();
        for lobe in &all {
            assert_same(&format!("{lobe:?}"), *lobe);
        }
        let mut many = Surface::<f32, AnyLobe<f32>, 12, 3>::empty();
        many = many.coat(0.9, Coating::new(1.5, 0.1).lobe(), Layering::Reciprocal)?;
        many = many.coat(0.5, Mirror::new(Rgb::splat(0.2)), Layering::FurnacePreserving)?;
        for lobe in all.iter().take(10) {
            many = many.with(0.1, *lobe)?;
        }
        assert_same("twelve lobes", many);
        let coat = Conductor::new(Ggx::isotropic(0.2), Fresnel::Dielectric { eta: 1.5 });
        let layer =
            Layer::new(coat, Lambert::new(Rgb::splat(0.7)), Layering::Reciprocal).map_err(|_| SurfaceError::NoCoat)?;
        assert_same("a layer", layer);
        assert_same("a mix", layer.plus(Mirror::new(Rgb::splat(0.1))));
        Ok(())
    }
}
