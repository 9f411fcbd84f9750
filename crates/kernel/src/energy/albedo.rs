//! Temporary.
use crate::real::Real;
use crate::rgb::Rgb;
/// E
#[derive(Clone, Copy, Debug)]
pub struct AlbedoCurve<R> {
    e: Rgb<R>,
    c: [R; 12],
}
impl<R: Real> AlbedoCurve<R> {
    /// E
    pub fn constant(e: Rgb<R>) -> Self {
        Self { e, c: [R::ZERO; 12] }
    }
    /// E
    pub fn scaled(self, w: Rgb<R>) -> Self {
        Self { e: self.e * w, ..self }
    }
    /// E
    pub fn dielectric(_alpha: R, eta: R) -> Self {
        Self::constant(Rgb::splat((eta - R::ONE) / (eta + R::ONE)))
    }
    /// E
    pub fn schlick(_alpha: R, f0: Rgb<R>) -> Self {
        Self::constant(f0)
    }
    /// E
    pub fn at(&self, _cos: R) -> Rgb<R> {
        self.e.map(|e| e + self.c[0])
    }
    /// E
    pub fn avg(&self) -> Rgb<R> {
        self.e
    }
    /// E
    pub fn most_transmitted(&self) -> Rgb<R> {
        self.e.map(|e| R::ONE - e)
    }
}
