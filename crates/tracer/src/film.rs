//! The film: tiles of pixels, whose sums do not depend on the order in which samples arrive.

pub(crate) mod pixel;

use crate::layers::{DepthUnit, LayerSums, Layers};
use crate::picture::Picture;
use crate::stats::{RenderStats, TileStats};
use crate::world::World;
use pixel::Pixel;
use rayon::prelude::*;

/// Pixels along a tile's edge.
pub(crate) const TILE: u32 = 16;

/// A rectangle of pixels, half open. Each pixel keeps the random numbers it has in the whole picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Crop {
    /// First column.
    pub x0: u32,
    /// One past the last column.
    pub x1: u32,
    /// First row.
    pub y0: u32,
    /// One past the last row.
    pub y1: u32,
}

/// A picture and how it was made.
#[derive(Clone, Debug)]
pub struct Rendering {
    /// The mean radiance of each pixel.
    pub picture: Picture,
    /// What lies beside it, if asked for.
    pub layers: Option<Layers>,
    /// Counts and times.
    pub stats: RenderStats,
}

/// All sums of a render.
pub(crate) struct Film {
    pub(crate) crop: Crop,
    tiles: Vec<FilmTile>,
    /// If layers are gathered.
    depth_unit: Option<DepthUnit>,
    threads: usize,
    /// Samples that every pixel has.
    pub(crate) spp_done: u32,
}

/// A square of the film and its sums.
pub(crate) struct FilmTile {
    pub(crate) x0: u32,
    pub(crate) y0: u32,
    pub(crate) width: u32,
    pub(crate) pixels: Vec<Pixel>,
    /// One per pixel, or none at all.
    pub(crate) layers: Vec<LayerSums>,
    pub(crate) stats: TileStats,
}

impl Crop {
    pub(crate) fn pixels(&self) -> u64 {
        u64::from(self.x1 - self.x0) * u64::from(self.y1 - self.y0)
    }
}

impl Film {
    pub(crate) fn new(world: &World, crop: Option<Crop>, layers: bool, threads: usize) -> Self {
        let film = world.film;
        let whole = Crop { x0: 0, x1: film.width, y0: 0, y1: film.height };
        let crop = crop.map_or(whole, |c| Crop {
            x0: c.x0.min(c.x1).min(film.width),
            x1: c.x1.min(film.width),
            y0: c.y0.min(c.y1).min(film.height),
            y1: c.y1.min(film.height),
        });
        let depth_unit = layers.then(|| DepthUnit::for_depths_up_to(world.farthest_depth()));
        Self { crop, tiles: tiles_of(crop, layers), depth_unit, threads, spp_done: 0 }
    }

    /// Has every tile rendered, each by some worker, one per thread.
    pub(crate) fn expose<W: Default>(&mut self, render: impl Fn(&mut W, &mut FilmTile, Option<DepthUnit>) + Sync) {
        let depth_unit = self.depth_unit;
        self.tiles.par_iter_mut().for_each_init(W::default, |worker, tile| render(worker, tile, depth_unit));
    }

    /// The tiles put together.
    pub(crate) fn develop(&self, seconds: f64) -> Rendering {
        let mut stats = TileStats::default();
        self.tiles.iter().for_each(|tile| stats.add(&tile.stats));
        let pixels = self.gather(|tile| &tile.pixels);
        let layers = self.depth_unit.map(|unit| Layers::develop(&pixels, &self.gather(|tile| &tile.layers), unit));
        let dropped = pixels.iter().map(|p| u64::from(p.dropped())).sum();
        let (width, height) = (self.crop.x1 - self.crop.x0, self.crop.y1 - self.crop.y0);
        Rendering {
            picture: Picture {
                width,
                height,
                rgb: pixels.iter().map(Pixel::mean).collect(),
                alpha: Some(pixels.iter().map(Pixel::alpha).collect()),
            },
            layers,
            stats: stats.finish(seconds, self.spp_done, dropped, pixel::hash(pixels.iter()), self.threads),
        }
    }

    /// One value per pixel of the crop, rows from the top.
    fn gather<T: Copy + Default>(&self, of: impl Fn(&FilmTile) -> &[T]) -> Vec<T> {
        let width = (self.crop.x1 - self.crop.x0) as usize;
        let mut all = vec![T::default(); width * (self.crop.y1 - self.crop.y0) as usize];
        for tile in &self.tiles {
            for (row, line) in of(tile).chunks(tile.width as usize).enumerate() {
                let (x, y) = ((tile.x0 - self.crop.x0) as usize, (tile.y0 - self.crop.y0) as usize + row);
                all[y * width + x..][..line.len()].copy_from_slice(line);
            }
        }
        all
    }
}

/// The crop cut into tiles, row by row.
fn tiles_of(crop: Crop, layers: bool) -> Vec<FilmTile> {
    let mut tiles = Vec::new();
    for y0 in (crop.y0..crop.y1).step_by(TILE as usize) {
        for x0 in (crop.x0..crop.x1).step_by(TILE as usize) {
            let (width, height) = (TILE.min(crop.x1 - x0), TILE.min(crop.y1 - y0));
            let pixels = vec![Pixel::default(); (width * height) as usize];
            let layers = vec![LayerSums::default(); if layers { pixels.len() } else { 0 }];
            tiles.push(FilmTile { x0, y0, width, pixels, layers, stats: TileStats::default() });
        }
    }
    tiles
}
