//! Triangles that are seen through, where pixels have several samples.
//!
//! In a pixel a triangle has one fragment, as everywhere. What that cuts out is cut out of all samples; what it blends goes over
//! the colour of each sample by itself, so that tiles with blended triangles keep the colours of all samples until the last of
//! them. What is computed of a fragment is remembered for the next sample.

use super::Frame;
use super::kernel::Band;
use super::lattice::{Lattice, TILE, TILE_SAMPLES};
use super::mixed::MixedPixels;
use super::multisample::{MeanOfSamples, Picks, Planes};
use super::record::{Entrant, Entrants, Slot};
use super::setup::{Edges, Setup};
use super::tested::TestedSample;
use super::tile::Tile;
use crate::image::Rgba8;
use crate::math::lanes::*;
use crate::pipeline::interpolate::Fragment;
use crate::pipeline::viewport::ScreenTriangle;

/// What is known of each pixel of a tile about the triangle that it was last asked about.
#[derive(Clone, Debug)]
pub(super) struct Remembered<T> {
    /// The tile and the triangle that it is known of.
    pixels: Vec<(u64, Slot, T)>,
    /// Number of the tile.
    tile: u64,
}

impl<T> Default for Remembered<T> {
    fn default() -> Self {
        Self { pixels: Vec::new(), tile: 0 }
    }
}

impl<T: Copy + Default> Remembered<T> {
    /// Forgets all.
    fn clear(&mut self) {
        self.tile += 1;
        self.pixels.resize(TILE_SAMPLES, (0, Slot::NONE, T::default()));
    }

    /// What is known of a pixel about a triangle if `holds` says so, else what `find` finds.
    fn get(
        &mut self,
        slot: Slot,
        (column, row): (usize, usize),
        holds: impl Fn(T) -> bool,
        find: impl FnOnce() -> T,
    ) -> T {
        let known = &mut self.pixels[row * TILE + column];
        if (known.0, known.1) != (self.tile, slot) || !holds(known.2) {
            *known = (self.tile, slot, find());
        }
        known.2
    }
}

/// Memory for triangles that are seen through, kept from tile to tile.
#[derive(Clone, Debug, Default)]
pub(super) struct SeenThrough {
    /// Whether a cut-out triangle is there.
    is_there: Remembered<bool>,
    /// What a blended triangle went over last, and what became of that.
    over: Remembered<(Rgba8, Rgba8)>,
    /// The blended triangles of the tile.
    pub(super) blended: Vec<Slot>,
    /// The colours of all samples of the tile, sample by sample.
    colors: Vec<Rgba8>,
    /// Where among them those of sixteen pixels are.
    picks: Vec<Picks>,
}

impl SeenThrough {
    /// Bytes held.
    pub(super) fn bytes(&self) -> usize {
        self.is_there.pixels.capacity() * size_of::<(u64, Slot, bool)>()
            + self.over.pixels.capacity() * size_of::<(u64, Slot, (Rgba8, Rgba8))>()
            + self.blended.capacity() * size_of::<Slot>()
            + self.colors.capacity() * size_of::<Rgba8>()
            + self.picks.capacity() * size_of::<Picks>()
    }

    /// Begins a tile.
    pub(super) fn clear(&mut self) {
        self.is_there.clear();
        self.over.clear();
        self.blended.clear();
    }

    /// Writes the colours of all pixels of a tile.
    fn resolve(&mut self, mean: MeanOfSamples<'_>, picture: &mut Band<'_>, tile: (usize, usize)) {
        let Self { colors, picks, .. } = self;
        for (row, pixels) in picture.rows(tile).enumerate() {
            for (sixteen, out) in pixels.chunks_mut(WIDE).enumerate() {
                let first = row * TILE + sixteen * WIDE;
                let of_sample = |sample| std::array::from_fn(|lane| (sample * TILE_SAMPLES + first + lane) as u32);
                picks.clear();
                picks.extend((0..colors.len() / TILE_SAMPLES).map(of_sample));
                mean(colors, picks, out);
            }
        }
    }
}

/// The fragments of one triangle in the pixels of a tile.
struct PixelFragments<'a> {
    frame: &'a Frame<'a>,
    triangle: &'a ScreenTriangle,
    draw: usize,
    edges: Edges,
    tile: (usize, usize),
    /// [`Planes::shading_places`].
    places: &'a [[i32; 2]],
}

impl PixelFragments<'_> {
    /// That of a pixel, given by column and row, which the triangle must cover a sample of.
    fn at(&self, pixel: (usize, usize)) -> Fragment {
        let Self { frame, triangle, draw, edges, tile, places } = self;
        let place = edges.first_covered(frame.lattice.place(pixel), places, frame.settings.fill_rule);
        frame.fragment(triangle, *draw, *tile, pixel, edges.at(place))
    }
}

impl Frame<'_> {
    fn fragments<'a>(
        &'a self,
        (entrant, triangle): (Entrant, &'a ScreenTriangle),
        tile: (usize, usize),
        planes: &'a Planes<'_>,
    ) -> PixelFragments<'a> {
        let draw = entrant.draw as usize;
        // One without area is never drawn.
        let edges = Edges::new(&self.corners(entrant.key, draw), self.lattice.origin(tile)).unwrap_or_default();
        PixelFragments { frame: self, triangle, draw, edges, tile, places: &planes.shading_places }
    }

    /// Draws a cut-out triangle into the tile of one of the samples, whose lattice is given.
    #[inline(always)]
    pub(super) fn draw_cut_out<S: Simd>(
        &self,
        simd: S,
        planes: &Planes<'_>,
        (tile, triangle, lattice): (&mut Tile, &Setup, &Lattice),
        (entrants, place): (&Entrants, (usize, usize)),
        memory: &mut SeenThrough,
    ) {
        let (slot, entrant) = (triangle.slot, entrants.get(triangle.slot));
        let whole = self.screen_triangle(entrant.key, entrant.draw as usize);
        let shader = &self.shader(entrant.draw as usize).shader;
        let fragments = self.fragments((entrant, &whole), place, planes);
        let owner = self.owner(entrants, lattice, place);
        tile.draw_kept(simd, triangle, lattice, &self.rules, &owner, |tested| {
            let mut kept = 0;
            for TestedSample { bit, place: pixel, .. } in tested.samples() {
                let find = || !shader.cuts_out(&fragments.at(pixel));
                kept |= if memory.is_there.get(slot, pixel, |_| true, find) { bit } else { 0 };
            }
            kept
        });
    }

    /// Blends the blended triangles of a tile over its picture, whose mixed pixels are known. Gives the number of fragments.
    #[inline(always)]
    pub(super) fn blend_samples<S: Simd>(
        &self,
        simd: S,
        (planes, tiles): (&Planes<'_>, &mut [Tile]),
        (entrants, place): (&Entrants, (usize, usize)),
        mixed: &MixedPixels,
        memory: &mut SeenThrough,
        picture: &mut Band<'_>,
    ) -> u64 {
        let SeenThrough { over, blended, colors, .. } = memory;
        let (columns, rows) = picture.size(place);
        colors.resize(planes.samples.offsets.len() * TILE_SAMPLES, self.background);
        for sample in colors.chunks_exact_mut(TILE_SAMPLES) {
            for (row, below) in sample.chunks_exact_mut(TILE).zip(picture.rows(place)) {
                row[..below.len()].copy_from_slice(below);
            }
        }
        mixed.spread(colors);
        let mut shaded = 0;
        for (slot, triangle) in self.by_distance(entrants, blended) {
            let entrant = entrants.get(slot);
            let shader = &self.shader(entrant.draw as usize).shader;
            let fragments = self.fragments((entrant, &triangle), place, planes);
            let samples = colors.chunks_exact_mut(TILE_SAMPLES).zip(&planes.lattices);
            for ((colors, lattice), tile) in samples.zip(tiles.iter_mut()) {
                let owner = self.owner(entrants, lattice, place);
                let Some(setup) = owner(slot) else { continue };
                tile.draw_kept(simd, &setup, lattice, &self.rules, &owner, |tested| {
                    for TestedSample { place: pixel @ (column, row), .. } in tested.samples() {
                        if column >= columns || row >= rows {
                            continue;
                        }
                        let color = &mut colors[row * TILE + column];
                        let blend = || {
                            shaded += 1;
                            (*color, shader.blend(&fragments.at(pixel), &triangle, *color))
                        };
                        *color = over.get(slot, pixel, |(below, _)| below == *color, blend).1;
                    }
                    // What is blended hides nothing.
                    0
                });
            }
        }
        memory.resolve(planes.samples.mean, picture, place);
        shaded
    }
}
