//! Shading of samples that belong to several triangles, sixteen at a time.
//!
//! Shading sixteen samples is a long dependency chain: it loads triangle data, divides, and computes texel indices.
//! Samples are therefore collected until there are four groups of sixteen. Each step is done for all groups before the
//! next one, so that their latencies overlap.

use super::canvas::Canvas;
use super::edge_rows::exact_at;
use super::few::Few;
use super::kernel::interpolate_pair;
use super::mipmap::LevelTapsMut;
use super::patch::{ALL, Patch};
use super::queue::{QueuedRow, Reserved, ReservedPair};
use super::record::{TileBin, TriangleSource};
use super::sample_positions::SamplePositions;
use super::setup::EdgeFunctions;
use super::shader::{PlannedShader, ShadingPlan, with_known_plan};
use super::target::ColorRows;
use super::weights::{AttributeWeights, StoredWeights, corner_weights};
use crate::math::lanes::*;

/// Positions of sixteen samples, and destinations of their colours.
pub(super) trait SampleTargets: Copy {
    /// Returns the sample positions relative to the centre of the tile's first pixel, to the right and down, in steps
    /// of 1/256 px.
    fn positions<S: Simd>(self, simd: S) -> [i32x16<S>; 2];

    /// Returns the destinations of the samples selected by `mine`, as two rows of eight.
    fn rows(self, mine: u32, picture: &ColorRows<'_>) -> [QueuedRow; 2];
}

/// Eight samples in the first row of a patch, and eight in the row below it.
#[derive(Clone, Copy, Debug)]
pub(super) struct RowPair<'a, L> {
    pub(super) patch: &'a Patch,
    pub(super) locations: L,
}

impl<L: SamplePositions> SampleTargets for RowPair<'_, L> {
    #[inline(always)]
    fn positions<S: Simd>(self, simd: S) -> [i32x16<S>; 2] {
        let Patch { column, first, .. } = *self.patch;
        self.locations.positions(simd, column, [first, first + 1])
    }

    #[inline(always)]
    fn rows(self, mine: u32, picture: &ColorRows<'_>) -> [QueuedRow; 2] {
        let Self { patch, .. } = self;
        let [mine, below] = [mine & ALL, mine >> LANES];
        let start = picture.start(patch, patch.first);
        [(start, mine), (start + picture.stride, below)].map(|(start, mine)| QueuedRow::new(start, patch.count, mine))
    }
}

/// Samples at arbitrary positions, whose colours are stored one after the other.
#[derive(Clone, Copy, Debug)]
pub(super) struct Scattered<'a> {
    /// Sample positions relative to the centre of the tile's first pixel, to the right and down, in steps of 1/256 px.
    pub(super) places: [&'a [i32; WIDE]; 2],
    /// Index at which the first colour is stored.
    pub(super) start: usize,
}

impl SampleTargets for Scattered<'_> {
    #[inline(always)]
    fn positions<S: Simd>(self, simd: S) -> [i32x16<S>; 2] {
        each!(axis in [0, 1] => i32x16::load_array_ref(simd, self.places[axis]))
    }

    #[inline(always)]
    fn rows(self, mine: u32, _: &ColorRows<'_>) -> [QueuedRow; 2] {
        [(self.start, mine & ALL), (self.start + LANES, mine >> LANES)]
            .map(|(start, mine)| QueuedRow::new(start, LANES, mine))
    }
}

/// Sixteen samples that may belong to different triangles.
#[derive(Clone, Copy, Debug)]
pub(super) struct MixedSamples<'a, T> {
    /// Index of the samples' shader in the frame's list of shaders.
    pub(super) shader: usize,
    /// Slot of each sample's triangle.
    pub(super) slots: &'a [u32; WIDE],
    /// Bit mask of the samples to shade.
    pub(super) mine: u32,
    pub(super) targets: T,
}

/// Edge functions of a triangle whose edge values exceed 32 bits.
#[derive(Clone, Copy, Debug)]
pub(super) struct LargeTriangle {
    /// Bit mask of the triangle's samples, among sixteen.
    pub(super) lanes: u32,
    pub(super) edges: EdgeFunctions,
}

/// Number of groups of sixteen samples that are shaded together.
const CAPACITY: usize = 4;

/// Samples that wait to be shaded, all with the same shader. The memory is reused from tile to tile.
#[derive(Clone, Debug, Default)]
pub(super) struct Pending {
    sixteens: [SixteenSamples; CAPACITY],
    len: usize,
    /// Index of the samples' shader in the frame's list of shaders.
    shader: usize,
    /// Triangles whose edge values exceed 32 bits. Each comes with the index of a group.
    large: Vec<(usize, LargeTriangle)>,
}

/// Group of sixteen samples that are shaded together.
#[derive(Clone, Copy, Debug, Default)]
#[repr(align(64))]
struct SixteenSamples {
    /// Slot of each sample's triangle in the tile's bin.
    slots: [u32; WIDE],
    /// Sample positions relative to the centre of the tile's first pixel, to the right and down, in steps of 1/256 px.
    places: [[i32; WIDE]; 2],
    /// Bit mask of the samples to shade.
    mine: u32,
    rows: [QueuedRow; 2],
}

impl Pending {
    /// Returns the memory use in bytes.
    pub(super) fn bytes(&self) -> usize {
        size_of::<Self>() + self.large.capacity() * size_of::<(usize, LargeTriangle)>()
    }

    /// Returns `true` if sixteen more samples that use the shader with index `shader` do not fit: the list is full, or
    /// holds samples of another shader.
    #[inline(always)]
    pub(super) fn is_full(&self, shader: usize) -> bool {
        self.len == CAPACITY || self.len > 0 && self.shader != shader
    }

    /// Adds sixteen samples. `large` has the triangles of these samples whose edge values exceed 32 bits.
    #[inline(always)]
    pub(super) fn push<S: Simd>(
        &mut self,
        simd: S,
        samples: MixedSamples<'_, impl SampleTargets>,
        large: &[LargeTriangle],
        picture: &ColorRows<'_>,
    ) {
        let MixedSamples { shader, slots, mine, targets } = samples;
        let places = targets.positions(simd);
        let sixteen = &mut self.sixteens[self.len];
        (sixteen.slots, sixteen.mine, sixteen.rows) = (*slots, mine, targets.rows(mine, picture));
        for (place, stored) in places.into_iter().zip(&mut sixteen.places) {
            place.store_array(stored);
        }
        self.large.extend(large.iter().map(|triangle| (self.len, *triangle)));
        self.shader = shader;
        self.len += 1;
    }

    /// Interpolates the attributes of all pending samples, moves the samples to the queue and clears the list.
    #[inline(never)]
    pub(super) fn shade<S: Simd>(&mut self, simd: S, entrants: &TileBin, canvas: &mut Canvas<'_>) {
        simd.vectorize(
            #[inline(always)]
            || {
                if self.len == 0 {
                    return;
                }
                let shader = &canvas.frame.shaders[self.shader];
                let room = canvas.reserve(simd, self.shader, self.len);
                with_known_plan!([GOURAUD], shader.plan, plan => {
                    self.interpolate(simd, PlannedShader { shader, plan }, entrants, room);
                });
                self.len = 0;
                self.large.clear();
            },
        );
    }

    /// Interpolates all attributes of the pending samples.
    #[inline(always)]
    fn interpolate<S: Simd>(
        &self,
        simd: S,
        shader: PlannedShader<'_>,
        entrants: &TileBin,
        Reserved { pairs, taps, coarse }: Reserved<'_>,
    ) {
        let plan = shader.plan;
        let (mut few, mut weights) = ([None; CAPACITY], [StoredWeights::default(); CAPACITY]);
        for (i, (pair, sixteen)) in pairs.iter_mut().zip(&self.sixteens).enumerate() {
            pair.rows = sixteen.rows;
            few[i] = Few::find(simd, entrants, &sixteen.slots, sixteen.mine);
            let of_corners = match few[i] {
                Some(few) => self.weights(simd, i, few),
                None => self.weights(simd, i, entrants.many(&sixteen.slots)),
            };
            weights[i].store(plan, of_corners);
        }
        let mut coarse = coarse.iter_mut();
        for (i, (pair, fine)) in pairs.iter_mut().zip(taps).enumerate().take(CAPACITY) {
            let weights = weights[i].load(simd);
            let taps = LevelTapsMut { fine, coarse: if plan.mipmapped { coarse.next() } else { None } };
            let out = ReservedPair { pair, taps };
            match few[i] {
                Some(few) => interpolate_pair(simd, shader, few, weights, out),
                None => interpolate_pair(simd, shader, entrants.many(&self.sixteens[i].slots), weights, out),
            }
        }
    }

    /// Returns the interpolation weights of one group of samples.
    #[inline(always)]
    fn weights<S: Simd>(&self, simd: S, number: usize, source: impl TriangleSource) -> AttributeWeights<S> {
        let SixteenSamples { places, mine, .. } = &self.sixteens[number];
        let places = each!(axis in [0, 1] => i32x16::load_array_ref(simd, &places[axis]));
        let e = source.edge_values(simd, places);
        let mut e = each!(i in [0, 1, 2] => e[i].to_float::<f32x16<S>>());
        for (_, LargeTriangle { lanes, edges }) in self.large.iter().filter(|(of, _)| *of == number) {
            let (theirs, exact) = (mask32x16::from_bitmask(simd, (*lanes).into()), exact_at(simd, edges, places));
            e = each!(i in [0, 1, 2] => theirs.select(exact[i], e[i]));
        }
        corner_weights(simd, e, source.relative_inv_w(simd)).of_some(simd, *mine)
    }
}
