//! Mixed pixels: pixels whose samples show several triangles, or a triangle and the background, as at triangle edges.
//!
//! Each triangle in a mixed pixel is a *fragment*, which is shaded once: at the centre of the pixel if the triangle
//! covers it, otherwise at the first sample that it covers, even if the triangle is hidden there. Fragments are shaded
//! sixteen at a time, regardless of which pixels they belong to.

use super::canvas::Canvas;
use super::lattice::TileLattice;
use super::layout::{BLOCK, Block, SamplePlace, TILE_SAMPLES, TileSize};
use super::multisample::{Picks, SamplePlanes};
use super::pass::TilePass;
use super::patch::ALL;
use super::pending::{LargeTriangle, MixedSamples, Scattered};
use super::record::{BinEntry, Many, TriangleSource as _};
use super::setup::{ShadingCandidates, inside_thresholds};
use super::shade::{ShadingJob, ShadingWork};
use super::slot::Slot;
use super::target::{ColorRows, TileRows};
use super::tile::Tile;
use crate::image::Rgba8;
use crate::math::lanes::*;

/// Mixed pixels of a tile. The memory is reused from tile to tile.
#[derive(Clone, Debug, Default)]
pub(super) struct MixedPixels {
    places: Vec<SamplePlace>,
    /// For every sixteen mixed pixels, one entry per sample: first the indices in `colors` of the colours of their first
    /// samples, then those of their second samples, and so on.
    picks: Vec<Picks>,
    fragments: Fragments,
    /// Colours that samples refer to: the background, and from index [`FIRST`] on the fragments.
    colors: Vec<Rgba8>,
    /// Combined colour of the samples of each pixel.
    means: Vec<Rgba8>,
    /// Slots of the triangles that are visible in eight adjacent pixels, one entry per sample of a pixel.
    slots: Vec<[u32; LANES]>,
}

/// Index of the background in the list of colours.
const BACKGROUND: u32 = 0;

/// Index of the first fragment in the list of colours.
const FIRST: usize = WIDE;

impl MixedPixels {
    /// Returns the memory use in bytes.
    pub(super) fn bytes(&self) -> usize {
        self.places.capacity() * size_of::<SamplePlace>()
            + self.picks.capacity() * size_of::<Picks>()
            + self.fragments.list.capacity() * size_of::<SixteenFragments>()
            + (self.colors.capacity() + self.means.capacity()) * size_of::<Rgba8>()
            + self.slots.capacity() * size_of::<[u32; LANES]>()
    }

    /// Finds the mixed pixels of a tile. If all samples of a pixel show the same triangle, stores it in `agreed`.
    /// Otherwise stores no triangle there and adds the pixel to the list of mixed pixels.
    #[inline(always)]
    pub(super) fn find<S: Simd>(&mut self, simd: S, samples: &[Tile], agreed: &mut Tile, canvas: &Canvas<'_>) {
        let (lattice, TileSize { columns, rows }) = (&canvas.frame.lattice, canvas.picture.size);
        self.places.clear();
        self.picks.clear();
        self.fragments.clear();
        let Some((first, others)) = samples.split_first() else { return };
        for (bx, by) in (0..rows.div_ceil(BLOCK)).flat_map(|by| (0..columns.div_ceil(BLOCK)).map(move |bx| (bx, by))) {
            let block = Block { column: bx, row: by };
            let owner = first.owner(block);
            let owner = owner.filter(|_| others.iter().all(|sample| sample.owner(block) == owner));
            agreed.set_owner(block, owner);
            if owner.is_some() {
                continue;
            }
            let column = bx * BLOCK;
            let within = ALL >> (LANES - (columns - column).min(LANES));
            for row in by * BLOCK..((by + 1) * BLOCK).min(rows) {
                let slots = first.visible_slots(simd, column, row);
                let mut same = u64::MAX;
                for sample in others {
                    same &= sample.visible_slots(simd, column, row).simd_eq(slots).to_bitmask();
                }
                let nothing = u32x8::splat(simd, Slot::NONE.0);
                agreed.set_seen(column, row, mask32x8::from_bitmask(simd, same).select(slots, nothing));
                let mixed = !same as u32 & within;
                if mixed != 0 {
                    self.slots.clear();
                    self.slots.extend(samples.iter().map(|sample| sample.visible_slots(simd, column, row).to_array()));
                    self.list(lattice, SamplePlace { column, row }, mixed);
                }
            }
        }
    }

    /// Adds the pixels selected by `mixed` to the list, among the eight adjacent pixels of a row that `slots`
    /// describes. The first of them is at `first`.
    fn list(&mut self, lattice: &TileLattice, first: SamplePlace, mut mixed: u32) {
        while mixed != 0 {
            let lane = mixed.trailing_zeros() as usize;
            mixed &= mixed - 1;
            let place = SamplePlace { column: first.column + lane, ..first };
            self.push(place, lattice.place(place), lane);
        }
    }

    /// Adds a pixel to the list. `lane` is its lane among eight pixels. `centre` is the pixel's centre relative to the
    /// centre of the tile's first pixel, in steps of 1/256 px.
    fn push(&mut self, place: SamplePlace, centre: [i32; 2], lane: usize) {
        let Self { places, picks, fragments, slots: seen, .. } = self;
        let (sixteen, pixel) = (places.len() / WIDE, places.len() % WIDE);
        places.push(place);
        if pixel == 0 {
            picks.resize((sixteen + 1) * seen.len(), [BACKGROUND; WIDE]);
        }
        let first = fragments.len;
        let mut last = (Slot::NONE.0, BACKGROUND);
        for (picks, slots) in picks[sixteen * seen.len()..].iter_mut().zip(seen.iter()) {
            let slot = slots[lane];
            if slot != last.0 {
                last =
                    (slot, if slot == Slot::NONE.0 { BACKGROUND } else { fragments.pick(first, slot, place, centre) });
            }
            picks[pixel] = last.1;
        }
    }

    /// Shades the fragments and combines them into the colours of the pixels. `job` shades the fragments; their colours
    /// are stored in a list instead of its picture. Returns the number of samples shaded and texels read.
    #[inline(always)]
    pub(super) fn shade<S: Simd>(
        &mut self,
        simd: S,
        planes: &SamplePlanes<'_>,
        job: ShadingJob<'_, &TileLattice>,
    ) -> ShadingWork {
        let Self { places, picks, fragments, colors, means, .. } = self;
        let background = job.pass.frame.background;
        colors.clear();
        colors.resize(FIRST + fragments.list.len() * WIDE, background);
        let size = TileSize { columns: 0, rows: 0 };
        // The new binding has the shorter lifetime of `colors`.
        let mut job = job;
        job.canvas.picture = TileRows { values: colors, stride: 0, left: 0, size };
        for number in 0..fragments.list.len() {
            job.fragments(simd, fragments, number, &planes.shading_places);
        }
        let shaded = job.finish(simd);
        means.clear();
        means.resize(places.len(), background);
        (planes.samples.mean)(colors, picks, means);
        shaded
    }

    /// Writes the colour of each sample of the mixed pixels to `samples`, which holds the first sample of all pixels of
    /// the tile, then the second, and so on.
    pub(super) fn spread(&self, samples: &mut [Rgba8]) {
        let count = samples.len() / TILE_SAMPLES;
        for (pixel, place) in self.places.iter().enumerate() {
            let picks = self.picks[pixel / WIDE * count..].iter().map(|picks| picks[pixel % WIDE]);
            for (sample, pick) in samples.chunks_exact_mut(TILE_SAMPLES).zip(picks) {
                sample[place.index()] = self.colors[pick as usize];
            }
        }
    }

    /// Writes the colours of the mixed pixels to the picture.
    pub(super) fn write(&self, picture: &mut ColorRows<'_>) {
        for (place, color) in self.places.iter().zip(&self.means) {
            *picture.at(*place) = *color;
        }
    }
}

/// List of fragments: pairs of a triangle and a pixel.
#[derive(Clone, Debug, Default)]
struct Fragments {
    list: Vec<SixteenFragments>,
    len: usize,
}

/// Sixteen fragments that are shaded together.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub(super) struct SixteenFragments {
    /// Slot of each fragment's triangle; unused lanes hold the slot of the tile's first triangle.
    slots: [u32; WIDE],
    /// Index of each fragment's pixel in the tile, counted row by row.
    pixels: [u16; WIDE],
    /// Pixel centres relative to the centre of the tile's first pixel, to the right and down, in steps of 1/256 px.
    centres: [[i32; WIDE]; 2],
}

impl Fragments {
    fn clear(&mut self) {
        self.list.clear();
        self.len = 0;
    }

    /// Returns the index in the list of colours for the fragment of a triangle in a pixel. Adds the fragment if it is
    /// new. `first` is the index of the pixel's first fragment.
    fn pick(&mut self, first: usize, slot: u32, place: SamplePlace, [x, y]: [i32; 2]) -> u32 {
        let known = (first..self.len).find(|index| self.list[index / WIDE].slots[index % WIDE] == slot);
        let index = known.unwrap_or_else(|| {
            let lane = self.len % WIDE;
            if lane == 0 {
                self.list.push(SixteenFragments { slots: [0; WIDE], pixels: [0; WIDE], centres: [[0; WIDE]; 2] });
            }
            if let Some(SixteenFragments { slots, pixels, centres }) = self.list.last_mut() {
                (slots[lane], pixels[lane]) = (slot, place.index() as u16);
                (centres[0][lane], centres[1][lane]) = (x, y);
            }
            self.len += 1;
            self.len - 1
        });
        (FIRST + index) as u32
    }
}

impl SixteenFragments {
    /// Computes [`EdgeFunctions::first_covered`] for the fragments selected by `open`. `many` is the source of their
    /// triangles, whose edge values must fit into 32 bits.
    ///
    /// [`EdgeFunctions::first_covered`]: super::setup::EdgeFunctions::first_covered
    #[inline(always)]
    fn first_covered<S: Simd>(
        &self,
        simd: S,
        many: Many<'_>,
        mut open: u32,
        ShadingCandidates { offsets, rule }: ShadingCandidates<'_>,
    ) -> [[i32; WIDE]; 2] {
        let ([[a0, b0, c0], [a1, b1, c1]], area) = many.integer_edges(simd);
        let centres = each!(axis in [0, 1] => i32x16::load_array_ref(simd, &self.centres[axis]));
        let [x, y] = centres;
        let (e0, e1) = (a0 * x + b0 * y + c0, a1 * x + b1 * y + c1);
        let (zero, one) = (i32x16::splat(simd, 0), i32x16::splat(simd, 1));
        let edges = [(a0, b0, e0), (a1, b1, e1), (zero - a0 - a1, zero - b0 - b1, area - e0 - e1)];
        // After the thresholds are subtracted, an edge value is non-negative exactly if the position is inside the
        // edge.
        let edges = each!((a, b, e) in [edges[0], edges[1], edges[2]] => {
            (a, b, e - inside_thresholds([zero, one], a, b, rule))
        });
        let mut moved = [zero; 2];
        for [right, down] in offsets {
            let [e0, e1, e2] = each!((a, b, e) in [edges[0], edges[1], edges[2]] => e + a * *right + b * *down);
            let covers = (e0 | e1 | e2).simd_ge(zero).to_bitmask() as u32 & open;
            let here = mask32x16::from_bitmask(simd, covers.into());
            moved = each!((offset, moved) in [(*right, moved[0]), (*down, moved[1])] => {
                here.select(i32x16::splat(simd, offset), moved)
            });
            open &= !covers;
            if open == 0 {
                break;
            }
        }
        each!(axis in [0, 1] => (centres[axis] + moved[axis]).to_array())
    }
}

impl ShadingJob<'_, &TileLattice> {
    /// Shades the group of sixteen fragments with index `number`; the last group may be incomplete. Each fragment is
    /// shaded at the first candidate position in its pixel that its triangle covers. The candidates `offsets` are
    /// relative to the pixel centre, in steps of 1/256 px.
    #[inline(always)]
    fn fragments<S: Simd>(&mut self, simd: S, all: &Fragments, number: usize, offsets: &[[i32; 2]]) {
        let (fragments, first) = (&all.list[number], number * WIDE);
        let mut open = u32::MAX >> (u32::BITS as usize - (all.len - first).min(WIDE));
        let start = FIRST + first;
        let slots = &fragments.slots;
        let [x, y] = self.shading_places(simd, fragments, open, offsets);
        let targets = Scattered { places: [&x, &y], start };
        if self.alike {
            self.together(simd, MixedSamples { shader: 0, slots, mine: open, targets });
            return;
        }
        let TilePass { frame, bin, .. } = self.pass;
        while open != 0 {
            let lane = open.trailing_zeros() as usize;
            let draw = bin.get(Slot(slots[lane])).draw as usize;
            if frame.shader(draw).on_lanes {
                let shader = frame.shader_of_draw[draw];
                let mine = self.shaded_by(shader, open, slots);
                open &= !mine;
                self.together(simd, MixedSamples { shader, slots, mine, targets });
            } else {
                open &= open - 1;
                let pixel = SamplePlace::of(fragments.pixels[lane].into());
                let color = self.by_itself(Slot(slots[lane]), pixel, [x[lane], y[lane]]);
                self.canvas.picture.values[start + lane] = color;
            }
        }
    }

    /// Returns the shading positions of fragments relative to the centre of the tile's first pixel, to the right and
    /// down, in steps of 1/256 px.
    #[inline(always)]
    fn shading_places<S: Simd>(
        &mut self,
        simd: S,
        fragments: &SixteenFragments,
        open: u32,
        offsets: &[[i32; 2]],
    ) -> [[i32; WIDE]; 2] {
        let candidates = ShadingCandidates { offsets, rule: self.pass.frame.settings.fill_rule };
        self.find_large(simd, open, &fragments.slots);
        let of_large = self.large.iter().fold(0, |all, triangle| all | triangle.lanes);
        let many = self.pass.bin.many(&fragments.slots);
        let mut places = fragments.first_covered(simd, many, open & !of_large, candidates);
        for LargeTriangle { lanes, edges } in &self.large {
            for lane in (0..WIDE).filter(|lane| lanes >> lane & 1 != 0) {
                let place = edges.first_covered(fragments.centres.map(|along| along[lane]), candidates);
                (places[0][lane], places[1][lane]) = (place[0], place[1]);
            }
        }
        places
    }

    /// Shades one fragment with the code of the classic (scalar) path.
    fn by_itself(&mut self, slot: Slot, pixel: SamplePlace, place: [i32; 2]) -> Rgba8 {
        let TilePass { frame, bin, .. } = self.pass;
        let BinEntry { key, draw } = bin.get(slot);
        let (draw, shader) = (draw as usize, frame.shader(draw as usize));
        self.shaded.add(shader, 1);
        if let Some(color) = shader.shader.flat_color(frame.id_of(key), frame.draws[draw].instance) {
            return color;
        }
        let classic = frame.classic(key, draw, bin.place);
        let edges = self.exact_edges(slot).unwrap_or_default().at(place);
        classic.shade(&classic.fragment(pixel, edges))
    }
}
