//! Environment maps: radiance from infinitely far away by latitude and longitude, sampled by luminance.
//!
//! **Directions.** As in Mitsuba 3's `envmap`: y is up, the top row looks along +y. A direction (x, y, z) has the column
//! coordinate u = (atan2(x, −z) + rotation)/2π and the row coordinate v = acos(y)/π, each from 0 to 1. So at rotation 0 the
//! centre column faces +z and the left edge −z, and columns run from −z by +x to +z. Rotation turns the picture about +y by
//! the right hand: at 90° the centre column faces +x.
//!
//! **Radiance** is bilinear in (u, v) between texel centres, which lie at +0.5 as the texels of a panorama cover equal
//! angles. Columns wrap. Between the first row's centres and the pole the first row holds, likewise at the other pole.
//! (Mitsuba places the centres of the first and last row on the poles, which stretches a picture of h rows by 1/(h − 1).)
//!
//! **Sampling.** The cells between texel centres, w columns and h + 1 rows, are chosen by alias tables: first a row, then a
//! cell of that row. Within a cell the density per solid angle is bilinear in (u, cosθ) between the luminances of its four
//! corners, so that
//!
//! ```text
//! pdf(ω) = luminance, bilinear in (u, cosθ) / Σ over cells of Ω · mean of four corners,   Ω = (cosθ₀ − cosθ₁) · 2π/w
//! ```
//!
//! is exact: (u, cosθ) is the solid angle up to a factor, and the mean of a bilinear function over its cell is that of its
//! corners. It is continuous over the whole sphere, so a direction that rounding moves into the next cell keeps its density,
//! and it is zero exactly where the radiance is. Inside a cell radiance and density differ only by colour and by bending
//! between θ and cosθ, at most twofold, and that beside the poles.
//!
//! Near a pole cosθ says nothing in `f32`. Heights are kept as sin²(θ/2), measured from the nearer pole.

use crate::alias::{alias_table, pick};
use crate::fingerprint::Fingerprint;
use crate::picture::Picture;
use crate::sampler::Random4;
use gonio_kernel::math::{atan2_turns, sin_cos_turns};
use gonio_kernel::{F32x8, Real, Rgb, U32x8, Vec3, each_lane};
use rayon::prelude::*;
use std::f64::consts::{PI, TAU};
use std::sync::Arc;

/// A mean luminance below this is black: its reciprocal, and that of the densities, would leave the range of `f32`.
const FAINTEST: f64 = 1e-30;

/// A map, ready to be looked at and sampled.
#[derive(Clone, Debug)]
pub(crate) struct EnvironmentMap {
    picture: Arc<Picture>,
    intensity: f32,
    /// Rotation in turns, in [0, 1).
    rotation: f32,
    /// The h + 1 rows of cells, from the top.
    rows: Vec<Row>,
    row_alias: Vec<(f32, u32)>,
    /// The tables of the rows of cells, one after the other.
    column_alias: Vec<(f32, u32)>,
    /// Density per luminance of the picture \[1/sr\].
    pdf_per_luminance: f32,
}

/// Where a row of cells lies. Height is sin²(θ/2), from the pole that is nearer to the row.
#[derive(Clone, Copy, Debug)]
struct Row {
    /// Height at the upper edge.
    upper: f32,
    /// Height at the lower edge minus that at the upper one; negative if the nearer pole is the lower one.
    span: f32,
    /// 1 if the nearer pole is the upper one, else −1.
    pole: f32,
}

/// What a map says about eight directions.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Seen {
    pub(crate) radiance: Rgb<F32x8>,
    /// Density of [`EnvironmentMap::sample`] \[1/sr\]; 0 exactly where the radiance is black.
    pub(crate) pdf: F32x8,
}

/// Eight cells: indices from 0 to their number, one past the end meaning the first again (columns) or not occurring (rows).
struct Cells {
    column: [usize; F32x8::LANES],
    row: [usize; F32x8::LANES],
}

impl EnvironmentMap {
    /// Prepares a picture of radiances (finite, not negative) that is turned by degrees and multiplied by a factor. `None`
    /// if there is no light in it. O(texels), in parallel.
    pub(crate) fn new(picture: &Arc<Picture>, degrees: f64, intensity: f32) -> Option<Self> {
        let (width, height) = (picture.width as usize, picture.height as usize);
        if width == 0 || height == 0 || picture.rgb.len() != width * height || intensity <= 0.0 {
            return None;
        }
        // Edges of the rows of cells: the poles and the texel centres between them.
        let edge = |row: usize| match row {
            0 => 0.0,
            row if row > height => PI,
            row => (row as f64 - 0.5) * PI / height as f64,
        };
        let mut rows = Vec::with_capacity(height + 1);
        let mut solid_angles = Vec::with_capacity(height + 1);
        for row in 0..=height {
            let pole = if 2 * row <= height { 1.0 } else { -1.0 };
            let near = |theta: f64| (0.5 * if pole > 0.0 { theta } else { PI - theta }).sin().powi(2);
            let (upper, lower) = (near(edge(row)), near(edge(row + 1)));
            rows.push(Row { upper: upper as f32, span: (lower - upper) as f32, pole });
            // cosθ₀ − cosθ₁ = 2(sin²(θ₁/2) − sin²(θ₀/2))
            solid_angles.push(2.0 * (lower - upper).abs() * TAU / width as f64);
        }

        let luminance = |row: usize, column: usize| f64::from(Rgb::from(picture.rgb[row * width + column]).luminance());
        let mut column_alias = vec![(1.0, 0); (height + 1) * width];
        let powers: Vec<f64> = column_alias
            .par_chunks_mut(width)
            .enumerate()
            .map(|(row, table)| {
                let [above, below] = neighbours(row, height);
                let at_edge: Vec<f64> = (0..width).map(|c| luminance(above, c) + luminance(below, c)).collect();
                let means: Vec<f64> =
                    (0..width).map(|c| 0.25 * (at_edge[(c + width - 1) % width] + at_edge[c])).collect();
                table.copy_from_slice(&alias_table(&means));
                means.iter().sum::<f64>() * solid_angles[row]
            })
            .collect();
        let power: f64 = powers.iter().sum();
        (power > FAINTEST).then(|| Self {
            picture: Arc::clone(picture),
            intensity,
            rotation: (degrees / 360.0).rem_euclid(1.0) as f32,
            rows,
            row_alias: alias_table(&powers),
            column_alias,
            pdf_per_luminance: (1.0 / power) as f32,
        })
    }

    /// Takes the map into a fingerprint.
    pub(crate) fn describe(&self, print: &mut Fingerprint) {
        print.numbers(self.picture.rgb.as_flattened().iter().copied());
        print.numbers([self.intensity, self.rotation]);
    }

    /// Radiance and density of eight unit directions.
    #[inline(always)]
    pub(crate) fn at(&self, w: Vec3<F32x8>) -> Seen {
        let half = F32x8::splat(0.5);
        let sin2 = w.x.mul_add(w.x, w.z * w.z);
        let turn = atan2_turns(w.x, -w.z) + F32x8::splat(self.rotation);
        let turn = F32x8::select(turn.lt(F32x8::ZERO), turn + F32x8::ONE, turn);
        let turn = F32x8::select(turn.ge(F32x8::ONE), turn - F32x8::ONE, turn);
        let x = turn.mul_add(F32x8::splat(self.picture.width as f32), half);
        let half_turn = atan2_turns(sin2.sqrt(), w.y);
        let y = half_turn.mul_add(F32x8::splat(2.0 * self.picture.height as f32), half);
        // The floor, or one less and a fraction of 1 instead of 0, which is the same place.
        let ((column, column_int), (row, row_int)) = ((x - half).round_to_int(), (y - half).round_to_int());
        let cells = Cells {
            column: each_lane(|l| (column_int.lane(l)).min(self.picture.width) as usize),
            row: each_lane(|l| row_int.lane(l).min(self.picture.height) as usize),
        };
        let (across, down) = ((x - column).clamp(0.0, 1.0), (y - row).clamp(0.0, 1.0));

        // sin²(θ/2) from either pole, without cancellation: sin²θ = 4 sin²(θ/2) cos²(θ/2).
        let (upper, span, pole) = self.rows_of(&cells);
        let far = w.y.abs().mul_add(half, half);
        let near = sin2 / (far * F32x8::splat(4.0));
        let height = F32x8::select((pole * w.y).ge(F32x8::ZERO), near, far);
        let fallen = ((height - upper) / span).clamp(0.0, 1.0);

        let corners = self.corners(&cells);
        let [a, b, c, d] = corners.map(|corner| corner.luminance());
        let density = mix(mix(a, b, across), mix(c, d, across), fallen);
        let blend = |channel: fn(&Rgb<F32x8>) -> F32x8| {
            let [a, b, c, d] = corners.each_ref().map(channel);
            mix(mix(a, b, across), mix(c, d, across), down)
        };
        Seen {
            radiance: Rgb::new(blend(|c| c.r), blend(|c| c.g), blend(|c| c.b)) * F32x8::splat(self.intensity),
            pdf: density * F32x8::splat(self.pdf_per_luminance),
        }
    }

    /// Eight directions with the density that [`EnvironmentMap::at`] states, to the rounding of `f32`. A cell's probability
    /// is off by 2⁻²⁴ of itself and 2⁻³² of the mean of its row.
    ///
    /// `u` chooses the row (a word), the cell of the row (a word) and the place in the cell (two numbers); `toss` are the
    /// alias method's second numbers for row and cell, as words.
    #[inline(always)]
    pub(crate) fn sample(&self, u: &Random4, toss: [U32x8; 2]) -> Vec3<F32x8> {
        let width = self.picture.width as usize;
        let row = each_lane(|l| pick(&self.row_alias, u.0[0].lane(l), fraction(toss[0].lane(l))));
        let column = each_lane(|l| {
            let table = &self.column_alias[row[l] * width..(row[l] + 1) * width];
            pick(table, u.0[1].lane(l), fraction(toss[1].lane(l)))
        });
        let cells = Cells { column, row };
        let [a, b, c, d] = self.corners(&cells).map(|corner| corner.luminance());
        let fallen = sample_linear(a + b, c + d, u.unit(2));
        let across = sample_linear(mix(a, c, fallen), mix(b, d, fallen), u.unit(3));

        let (upper, span, pole) = self.rows_of(&cells);
        let height = fallen.mul_add(span, upper).clamp(0.0, 1.0);
        let two = F32x8::splat(2.0);
        let sin_theta = two * (height * (F32x8::ONE - height)).sqrt();
        let cos_theta = pole * height.mul_add(-two, F32x8::ONE);
        let column = F32x8::from_fn(|l| cells.column[l] as f32) + (across - F32x8::splat(0.5));
        let turn = column / F32x8::splat(self.picture.width as f32) - F32x8::splat(self.rotation);
        let (sin_phi, cos_phi) = sin_cos_turns(turn);
        Vec3::new(sin_theta * sin_phi, cos_theta, -(sin_theta * cos_phi))
    }

    /// The radiances of the picture at the corners of eight cells: upper left, upper right, lower left, lower right.
    #[inline(always)]
    fn corners(&self, cells: &Cells) -> [Rgb<F32x8>; 4] {
        let (width, height) = (self.picture.width as usize, self.picture.height as usize);
        let texels = each_lane(|l| {
            let right = if cells.column[l] < width { cells.column[l] } else { 0 };
            let left = if right > 0 { right - 1 } else { width - 1 };
            let [above, below] = neighbours(cells.row[l], height).map(|row| &self.picture.rgb[row * width..][..width]);
            [&above[left], &above[right], &below[left], &below[right]]
        });
        let corner = |c: usize| {
            let channel = |k: usize| F32x8::from_fn(|l| texels[l][c][k]);
            Rgb::new(channel(0), channel(1), channel(2))
        };
        [corner(0), corner(1), corner(2), corner(3)]
    }

    /// Upper edge, span and pole of eight cells' rows.
    #[inline(always)]
    fn rows_of(&self, cells: &Cells) -> (F32x8, F32x8, F32x8) {
        let rows = each_lane(|l| &self.rows[cells.row[l]]);
        let field = |f: fn(&Row) -> f32| F32x8::from_fn(|l| f(rows[l]));
        (field(|r| r.upper), field(|r| r.span), field(|r| r.pole))
    }
}

/// The rows of texels above and below a row of cells; at the poles they are the same.
#[inline(always)]
fn neighbours(row: usize, height: usize) -> [usize; 2] {
    [row.saturating_sub(1), row.min(height - 1)]
}

/// A random word as a number in [0, 1]. Small ones keep all their bits, so that what is improbable is so by the right amount.
#[inline(always)]
fn fraction(word: u32) -> f32 {
    word as f32 * (1.0 / 4_294_967_296.0)
}

/// a + t·(b − a) as a sum of what is not negative.
#[inline(always)]
fn mix(a: F32x8, b: F32x8, t: F32x8) -> F32x8 {
    t.mul_add(b, (F32x8::ONE - t) * a)
}

/// A number in [0, 1] with density proportional to a + x·(b − a), for a and b at least 0 and not both 0.
/// pbrt-v4 (Pharr, Jakob & Humphreys 2023), section 2.3.2: the root without cancellation.
#[inline(always)]
fn sample_linear(a: F32x8, b: F32x8, u: F32x8) -> F32x8 {
    let (a, b) = (a / (a + b), b / (a + b)); // squares of radiances need not be in range
    let root = mix(a * a, b * b, u).sqrt();
    (u / (a + root).max(F32x8::splat(f32::MIN_POSITIVE))).clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests;
