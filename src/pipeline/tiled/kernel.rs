//! Shading sixteen samples at a time, eight of each of two rows: once per visible sample.
//!
//! The arithmetic is that of [`crate::pipeline::interpolate`] and [`crate::pipeline::shade`], operation by operation. Shadings
//! that show a single quantity are left to those functions themselves.

use glam::Vec3;

use super::Frame;
use super::geometry::lambert_lanes;
use super::lattice::{BLOCK, Lattice, TILE};
use super::locations::Locations;
use super::record::{Entrants, Record, Source, Subject};
use super::setup::Edges;
use super::shader::{DrawShader, Light, Plan};
use super::texture::Taps;
use crate::image::Rgba8;
use crate::image::color::Tables;
use crate::math::lanes::*;
use crate::pipeline::interpolate::interpolate;
use crate::pipeline::raster::Sample;
use crate::pipeline::settings::ColorSpace;
use crate::pipeline::viewport::ScreenTriangle;

/// Rows of samples that wait for their texels, two by two. Where texels lie is found out for all of them before the first
/// texel is read, so that what one read waits for, another one does not.
#[derive(Clone, Debug, Default)]
pub(super) struct Queue {
    pairs: [QueuedPair; QUEUED],
    /// Which texels those of the pairs are.
    taps: [Taps; QUEUED],
    len: usize,
    /// Position of the shader of all rows.
    shader: usize,
}

/// Pairs of rows that wait together: those of four blocks, so that texels are there when the first of them is read.
const QUEUED: usize = 4 * BLOCK / 2;

/// Eight samples of each of two rows.
#[derive(Clone, Debug, Default)]
#[repr(align(64))]
struct QueuedPair {
    light: [f32; WIDE],
    /// The surface's colour without the texture, where it varies.
    color: [[f32; WIDE]; 3],
    rows: [QueuedRow; 2],
}

/// Where eight colours go.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct QueuedRow {
    /// Position of the first sample in the tile's rows of the picture.
    start: usize,
    /// Samples that lie within the picture.
    count: usize,
    /// A bit for each sample that is written.
    mine: u32,
}

/// Some rows of samples of a block, at most eight wide.
#[derive(Clone, Copy, Debug)]
pub(super) struct Patch {
    pub(super) tile: (usize, usize),
    /// First column, within the tile.
    pub(super) column: usize,
    /// Columns that lie within the picture.
    pub(super) count: usize,
    /// First row, within the tile.
    pub(super) first: usize,
    /// One past the last row.
    pub(super) end: usize,
    /// A bit for each sample of a row that is shaded.
    pub(super) mine: u32,
}

/// Rows of the packed picture that start with the first one of a tile.
pub(super) struct Band<'a> {
    pub(super) pixels: &'a mut [Rgba8],
    pub(super) width: usize,
}

impl Band<'_> {
    /// Columns and rows of a tile that lie within the picture.
    pub(super) fn size(&self, tile: (usize, usize)) -> (usize, usize) {
        ((self.width - tile.0 * TILE).min(TILE), self.pixels.len() / self.width)
    }

    /// The part of each row that lies in a tile.
    pub(super) fn rows(&mut self, tile: (usize, usize)) -> impl Iterator<Item = &mut [Rgba8]> {
        let columns = tile.0 * TILE..((tile.0 + 1) * TILE).min(self.width);
        self.pixels.chunks_mut(self.width).map(move |row| &mut row[columns.clone()])
    }

    #[inline(always)]
    fn start(&self, patch: &Patch, row: usize) -> usize {
        row * self.width + patch.tile.0 * TILE + patch.column
    }

    #[inline(always)]
    pub(super) fn row(&mut self, patch: &Patch, row: usize) -> &mut [Rgba8] {
        let start = self.start(patch, row);
        &mut self.pixels[start..start + patch.count]
    }
}

/// All samples of a row.
pub(super) const ALL: u32 = (1 << LANES) - 1;

/// Samples that belong to one triangle and lie on the lattice.
#[inline(never)]
pub(super) fn shade_uniform<S: Simd>(
    simd: S,
    frame: &Frame<'_>,
    subject: &Subject<'_>,
    patch: &Patch,
    queue: &mut Queue,
    band: &mut Band<'_>,
) {
    simd.vectorize(
        #[inline(always)]
        || {
            let Subject { one, edges, .. } = *subject;
            let lattice = &frame.lattice;
            let Some(edges) = edges else {
                let edges = IntegerRows::new(simd, lattice, one.record, patch);
                return shade_rows(
                    simd,
                    frame,
                    subject,
                    patch,
                    (queue, band),
                    #[inline(always)]
                    |rows| edges.at(rows),
                );
            };
            let exact = ExactRows::new(simd, lattice, edges, patch);
            if !frame.shader(subject.draw).on_lanes {
                let whole = frame.screen_triangle(subject.key, subject.draw);
                for (i, row) in (patch.first..patch.end).enumerate() {
                    let e = each!(edge in [0, 1, 2] => (exact.along[edge] + exact.down[edge][i]).to_array());
                    one_by_one(frame, frame.shader(subject.draw), &whole, patch, row, &e, band.row(patch, row));
                }
                return;
            }
            shade_rows(
                simd,
                frame,
                subject,
                patch,
                (queue, band),
                #[inline(always)]
                |rows| exact.at(rows),
            );
        },
    );
}

/// Rows of samples that belong to one triangle, by its edge values in each pair of rows.
#[inline(always)]
pub(super) fn shade_rows<S: Simd>(
    simd: S,
    frame: &Frame<'_>,
    subject: &Subject<'_>,
    patch: &Patch,
    (queue, band): (&mut Queue, &mut Band<'_>),
    edges: impl Fn([usize; 2]) -> [f32x16<S>; 3],
) {
    let Subject { one, draw, .. } = *subject;
    let shader = frame.shader(draw);
    let rows = patch.end - patch.first;
    let (pairs, taps) = make_room(simd, frame, frame.shader_of_draw[draw], rows.div_ceil(2), queue, band);
    let relative_inv_w = one.relative_inv_w(simd);
    let plan = shader.plan;
    let mut start = band.start(patch, patch.first);
    for (i, (pair, taps)) in pairs.iter_mut().zip(taps).enumerate() {
        // A last row that has no other beside it is computed twice, and written once.
        let (upper, lower) = (2 * i, (2 * i + 1).min(rows - 1));
        let weights = corner_weights(simd, edges([upper, lower]), relative_inv_w);
        let row = QueuedRow { start, count: patch.count, mine: patch.mine };
        let below = QueuedRow { start: start + band.width, ..row };
        pair.rows = [row, if lower > upper { below } else { QueuedRow::default() }];
        start += 2 * band.width;
        match plan {
            Plan::COMMON => interpolate_pair(simd, shader, Plan::COMMON, one, weights, (pair, taps)),
            plan => interpolate_pair(simd, shader, plan, one, weights, (pair, taps)),
        }
    }
}

/// Edge values of up to eight rows of a triangle for which 32 bits are enough: sums that wrap around, and are right where
/// the triangle covers the sample.
struct IntegerRows<S: Simd> {
    /// Of the eight samples of a row, from its start, twice.
    along: [i32x16<S>; 2],
    /// Of the starts of the rows.
    down: [[i32; LANES]; 2],
    doubled_area: i32,
}

impl<S: Simd> IntegerRows<S> {
    #[inline(always)]
    fn new(simd: S, lattice: &Lattice, record: &Record, patch: &Patch) -> Self {
        let columns = lattice.columns_i32(simd, patch.column);
        let [y, shift] = lattice.rows_i32(simd, patch.first);
        let ([a0, b0, c0], [a1, b1, c1], doubled_area) = record.integer_edges();
        let down = each!((a, b, c) in [(a0, b0, c0), (a1, b1, c1)] => (y * b + shift * a + c).to_array());
        let along = each!(a in [a0, a1] => {
            let along = columns * a;
            along.combine(along)
        });
        Self { along, down, doubled_area }
    }

    #[inline(always)]
    fn at(&self, [upper, lower]: [usize; 2]) -> [f32x16<S>; 3] {
        let [first, second] = each!(edge in [0, 1] => {
            let simd = self.along[edge].simd;
            let down = i32x8::splat(simd, self.down[edge][upper]).combine(i32x8::splat(simd, self.down[edge][lower]));
            self.along[edge] + down
        });
        let third = i32x16::splat(first.simd, self.doubled_area) - first - second;
        each!(e in [first, second, third] => e.to_float::<f32x16<S>>())
    }
}

/// Edge values of up to eight rows of any triangle.
struct ExactRows<S: Simd> {
    /// Of the eight samples of a row, from its start.
    along: [F64<S>; 3],
    /// Of the starts of the rows.
    down: [[f64; LANES]; 3],
}

impl<S: Simd> ExactRows<S> {
    #[inline(always)]
    fn new(simd: S, lattice: &Lattice, edges: &Edges, patch: &Patch) -> Self {
        let Edges { a, b, c, .. } = *edges;
        let columns = F64::load_array(simd, lattice.lanes) + lattice.column(patch.column);
        let y = F64::load_array(simd, lattice.rows) + patch.first as f64 * lattice.row_step;
        let shift = F64::load_array(simd, lattice.shifts(patch.first));
        Self {
            along: each!(i in [0, 1, 2] => columns * a[i]),
            down: each!(i in [0, 1, 2] => (y * b[i] + shift * a[i] + c[i]).to_array()),
        }
    }

    #[inline(always)]
    fn at(&self, [upper, lower]: [usize; 2]) -> [f32x16<S>; 3] {
        let simd = self.along[0].simd;
        each!(edge in [0, 1, 2] => {
            let [upper, lower] = each!(row in [upper, lower] => narrow(simd, self.along[edge] + self.down[edge][row]));
            upper.combine(lower)
        })
    }
}

/// Places in the queue for some pairs of rows that a shader is for.
#[inline(always)]
fn make_room<'q, S: Simd>(
    simd: S,
    frame: &Frame<'_>,
    shader: usize,
    pairs: usize,
    queue: &'q mut Queue,
    band: &mut Band<'_>,
) -> (&'q mut [QueuedPair], &'q mut [Taps]) {
    if queue.shader != shader || queue.len + pairs > QUEUED {
        flush(simd, frame, queue, band.pixels);
        queue.shader = shader;
    }
    let from = queue.len;
    queue.len += pairs;
    (&mut queue.pairs[from..queue.len], &mut queue.taps[from..queue.len])
}

/// Shades a row by the classic way's own functions.
pub(super) fn one_by_one(
    frame: &Frame<'_>,
    shader: &DrawShader<'_>,
    triangle: &ScreenTriangle,
    patch: &Patch,
    row: usize,
    edges: &[[f64; LANES]; 3],
    out: &mut [Rgba8],
) {
    let row = (patch.tile.1 * TILE + row) as u32;
    for (lane, pixel) in out.iter_mut().enumerate().filter(|(lane, _)| patch.mine >> lane & 1 != 0) {
        let column = (patch.tile.0 * TILE + patch.column + lane) as u32;
        let (x, y) = frame.grid.pixel(column, row);
        let sample = Sample { column, row, x, y, edges: edges.map(|e| e[lane]) };
        let fragment = interpolate(triangle, sample, shader.shader.attributes());
        *pixel = shader.shader.shade(&fragment, triangle);
    }
}

/// Where sixteen samples lie, and where their colours go.
pub(super) trait Spots: Copy {
    /// Right of and below the centre of the tile's first pixel, in grid steps.
    fn places<S: Simd>(self, simd: S) -> [i32x16<S>; 2];

    /// Of the samples that have a bit, eight by eight.
    fn rows(self, mine: u32, band: &Band<'_>) -> [QueuedRow; 2];
}

/// Eight samples of the first row of a patch, and eight of the row below it.
#[derive(Clone, Copy, Debug)]
pub(super) struct RowPair<'a, L> {
    pub(super) patch: &'a Patch,
    pub(super) locations: L,
}

impl<L: Locations> Spots for RowPair<'_, L> {
    #[inline(always)]
    fn places<S: Simd>(self, simd: S) -> [i32x16<S>; 2] {
        let Patch { column, first, .. } = *self.patch;
        self.locations.places(simd, column, [first, first + 1])
    }

    #[inline(always)]
    fn rows(self, mine: u32, band: &Band<'_>) -> [QueuedRow; 2] {
        let Self { patch, .. } = self;
        let [mine, below] = [mine & ALL, mine >> LANES];
        let upper = QueuedRow { start: band.start(patch, patch.first), count: patch.count, mine };
        let lower = QueuedRow { start: upper.start + band.width, count: patch.count, mine: below };
        [upper, if below == 0 { QueuedRow::default() } else { lower }]
    }
}

/// Samples anywhere, whose colours go side by side.
#[derive(Clone, Copy, Debug)]
pub(super) struct Scattered<'a> {
    /// Right of and below the centre of the tile's first pixel, in grid steps.
    pub(super) places: [&'a [i32; WIDE]; 2],
    /// Where the first colour goes.
    pub(super) start: usize,
}

impl Spots for Scattered<'_> {
    #[inline(always)]
    fn places<S: Simd>(self, simd: S) -> [i32x16<S>; 2] {
        each!(axis in [0, 1] => i32x16::load_array_ref(simd, self.places[axis]))
    }

    #[inline(always)]
    fn rows(self, mine: u32, _: &Band<'_>) -> [QueuedRow; 2] {
        let first = QueuedRow { start: self.start, count: LANES, mine: mine & ALL };
        [first, QueuedRow { start: self.start + LANES, count: LANES, mine: mine >> LANES }]
    }
}

/// Samples of sixteen triangles that one shader is for, with a bit for each that is shaded. Edges are given of triangles that
/// 32 bits are not enough for, each with its samples.
#[inline(never)]
pub(super) fn shade_gathered<S: Simd>(
    simd: S,
    frame: &Frame<'_>,
    shader: usize,
    (entrants, slots, large): (&Entrants, &[u32; WIDE], &[(u32, Edges)]),
    (spots, mine): (impl Spots, u32),
    queue: &mut Queue,
    band: &mut Band<'_>,
) {
    simd.vectorize(
        #[inline(always)]
        || {
            let ([pair], [taps]) = make_room(simd, frame, shader, 1, queue, band) else { return };
            let places = spots.places(simd);
            let many = entrants.many(slots);
            let e = many.edge_values(simd, places);
            let mut e = each!(i in [0, 1, 2] => e[i].to_float::<f32x16<S>>());
            for (lanes, edges) in large {
                let (theirs, exact) = (mask32x16::from_bitmask(simd, (*lanes).into()), exact_at(simd, edges, places));
                e = each!(i in [0, 1, 2] => theirs.select(exact[i], e[i]));
            }
            let weights = corner_weights(simd, e, many.relative_inv_w(simd));
            let wanted = mask32x16::from_bitmask(simd, mine.into());
            // The first corner stands for samples that are not wanted: what is computed there must not lead astray.
            let weights = each!(i in [0, 1] => wanted.select(weights[i], f32x16::splat(simd, 0.0)));
            pair.rows = spots.rows(mine, band);
            let shader = &frame.shaders[shader];
            match shader.plan {
                Plan::COMMON => interpolate_pair(simd, shader, Plan::COMMON, many, weights, (pair, taps)),
                plan => interpolate_pair(simd, shader, plan, many, weights, (pair, taps)),
            }
        },
    );
}

/// Edge values of any triangle at places right of and below the centre of the tile's first pixel.
#[inline(always)]
pub(super) fn exact_at<S: Simd>(simd: S, edges: &Edges, places: [i32x16<S>; 2]) -> [f32x16<S>; 3] {
    // Offsets are small enough for floats.
    let [(x0, x1), (y0, y1)] = each!(axis in [0, 1] => places[axis].to_float::<f32x16<S>>().split());
    let [first, last] = each!((x, y) in [(x0, y0), (x1, y1)] => {
        let (x, y) = (widen(simd, x), widen(simd, y));
        each!(i in [0, 1, 2] => narrow(simd, x * edges.a[i] + y * edges.b[i] + edges.c[i]))
    });
    each!(i in [0, 1, 2] => first[i].combine(last[i]))
}

/// Weights of the second and third corner.
#[inline(always)]
fn corner_weights<S: Simd>(simd: S, e: [f32x16<S>; 3], relative_inv_w: [f32x16<S>; 3]) -> [f32x16<S>; 2] {
    let q = each!(i in [0, 1, 2] => e[i] * relative_inv_w[i]);
    let inverse_sum = f32x16::splat(simd, 1.0) / (q[0] + q[1] + q[2]);
    [q[1] * inverse_sum, q[2] * inverse_sum]
}

/// From weights to everything that is interpolated.
#[inline(always)]
fn interpolate_pair<S: Simd>(
    simd: S,
    shader: &DrawShader<'_>,
    plan: Plan,
    source: impl Source,
    weights: [f32x16<S>; 2],
    (pair, taps): (&mut QueuedPair, &mut Taps),
) {
    if let (Some(texture), Some(layout)) = (&shader.texture, plan.texture) {
        let [u, v] = source.uv(simd);
        texture.locate(simd, layout, [u.at(weights), v.at(weights)], taps);
    }
    match plan.light {
        Light::None => {}
        Light::Vertices => source.light(simd).at(weights).store_array(&mut pair.light),
        Light::Normals => {
            let normal = source.normal(simd);
            let normal = each!(axis in [0, 1, 2] => normal[axis].at(weights));
            let ambient = shader.shader.settings.light.ambient;
            lambert(simd, normal, shader.shader.light_direction, ambient).store_array(&mut pair.light);
        }
    }
    if plan.colored {
        let (diffuse, color) = (shader.shader.diffuse.to_array(), source.color(simd));
        for channel in 0..3 {
            let color = f32x16::splat(simd, diffuse[channel]) * color[channel].at(weights);
            color.store_array(&mut pair.color[channel]);
        }
    }
}

/// Reads the texels of all rows of the queue, finishes their colours, and writes those.
#[inline(never)]
pub(super) fn flush<S: Simd>(simd: S, frame: &Frame<'_>, queue: &mut Queue, pixels: &mut [Rgba8]) {
    simd.vectorize(
        #[inline(always)]
        || {
            let pairs = std::mem::take(&mut queue.len);
            if pairs == 0 {
                return;
            }
            let shader = &frame.shaders[queue.shader];
            let (pairs, taps) = (&queue.pairs[..pairs], &mut queue.taps[..pairs]);
            if let (Some(texture), Some(layout)) = (&shader.texture, shader.plan.texture) {
                texture.read_ahead(simd, layout, taps);
            }
            // Loops, as the closure of `for_each` may fail to be compiled for the chosen instructions.
            match shader.plan {
                Plan::COMMON => {
                    for (pair, taps) in pairs.iter().zip(taps) {
                        finish_pair(simd, shader, Plan::COMMON, (pair, taps), pixels);
                    }
                }
                plan => {
                    for (pair, taps) in pairs.iter().zip(taps) {
                        finish_pair(simd, shader, plan, (pair, taps), pixels);
                    }
                }
            }
        },
    );
}

/// Multiplies colour, texture and light, and writes the codes.
#[inline(always)]
fn finish_pair<S: Simd>(
    simd: S,
    shader: &DrawShader<'_>,
    plan: Plan,
    (pair, taps): (&QueuedPair, &Taps),
    pixels: &mut [Rgba8],
) {
    let mut codes = [0; WIDE];
    match plan.space {
        ColorSpace::Bytes => {
            // Register by register: what all sixteen read would not fit where registers are narrower.
            for first in (0..WIDE).step_by(S::f32s::LEN) {
                let mut color = surface_color::<S, S::f32s>(simd, shader, plan, pair, first);
                if let (Some(texture), Some(layout)) = (&shader.texture, plan.texture) {
                    color = textured(plan, color, texture.read_bytes(simd, layout, taps, first));
                }
                let color = lit(simd, plan, color, pair, first);
                pack::<S>(color).store_slice(&mut codes[first..first + S::u32s::LEN]);
            }
        }
        ColorSpace::Linear => {
            let mut color = surface_color::<S, f32x16<S>>(simd, shader, plan, pair, 0);
            if let (Some(texture), Some(layout)) = (&shader.texture, plan.texture) {
                color = textured(plan, color, texture.read_linear(simd, layout, taps));
            }
            encode(simd, lit(simd, plan, color, pair, 0)).store_array(&mut codes);
        }
    }
    let (upper, lower) = u32x16::load_array(simd, codes).split();
    write_row(simd, upper, &pair.rows[0], pixels);
    write_row(simd, lower, &pair.rows[1], pixels);
}

/// The surface's own colour at some samples, from `first` on.
#[inline(always)]
fn surface_color<S: Simd, F: SimdFloat<S, Element = f32>>(
    simd: S,
    shader: &DrawShader<'_>,
    plan: Plan,
    pair: &QueuedPair,
    first: usize,
) -> [F; 3] {
    if plan.colored {
        each!(channel in [0, 1, 2] => F::from_slice(simd, &pair.color[channel][first..first + F::LEN]))
    } else {
        let diffuse = shader.shader.diffuse.to_array();
        each!(channel in [0, 1, 2] => F::splat(simd, diffuse[channel]))
    }
}

/// Times the texture. What is multiplied by one stays as it is.
#[inline(always)]
fn textured<S: Simd, F: SimdFloat<S>>(plan: Plan, color: [F; 3], texel: [F; 3]) -> [F; 3] {
    let white = !plan.tinted && !plan.colored;
    if white { texel } else { each!(channel in [0, 1, 2] => color[channel] * texel[channel]) }
}

/// Times the light, of some samples from `first` on.
#[inline(always)]
fn lit<S: Simd, F: SimdFloat<S, Element = f32>>(
    simd: S,
    plan: Plan,
    color: [F; 3],
    pair: &QueuedPair,
    first: usize,
) -> [F; 3] {
    if plan.light == Light::None {
        return color;
    }
    let light = F::from_slice(simd, &pair.light[first..first + F::LEN]);
    each!(channel in [0, 1, 2] => color[channel] * light)
}

#[inline(always)]
fn write_row<S: Simd>(simd: S, codes: u32x8<S>, row: &QueuedRow, pixels: &mut [Rgba8]) {
    let out = &mut pixels[row.start..row.start + row.count];
    let Ok(out) = <&mut [Rgba8; LANES]>::try_from(&mut *out) else {
        let codes = codes.to_array();
        for (lane, pixel) in out.iter_mut().enumerate().filter(|(lane, _)| row.mine >> lane & 1 != 0) {
            *pixel = codes[lane].to_le_bytes();
        }
        return;
    };
    let bytes = out.as_flattened_mut();
    let codes = if row.mine == ALL {
        codes
    } else {
        let there = u8x32::from_slice(simd, bytes).bitcast::<u32x8<S>>();
        mask32x8::from_bitmask(simd, row.mine.into()).select(codes, there)
    };
    codes.bitcast::<u8x32<S>>().store_slice(bytes);
}

/// Colours in bytes, packed.
#[inline(always)]
fn pack<S: Simd>(color: [S::f32s; 3]) -> S::u32s {
    let [r, g, b] = each!(c in [0, 1, 2] => {
        (color[c] * 255.0 + 0.5).max(0.0).min(255.0).to_int::<S::i32s>().bitcast::<S::u32s>()
    });
    r | g << 8 | b << 16 | 0xFF00_0000
}

/// Colours in linear light, encoded and packed.
#[inline(always)]
fn encode<S: Simd>(simd: S, color: [f32x16<S>; 3]) -> u32x16<S> {
    let tables = Tables::get();
    let [r, g, b] = each!(c in [0, 1, 2] => {
        let (low, high) = color[c].split();
        tables.encode_lanes(simd, low).combine(tables.encode_lanes(simd, high))
    });
    r | g << 8 | b << 16 | 0xFF00_0000
}

/// Light on normals that are not of unit length; no direct light on those of none.
#[inline(always)]
fn lambert<S: Simd>(simd: S, normal: [f32x16<S>; 3], direction: Vec3, ambient: f32) -> f32x16<S> {
    let [x, y, z] = normal;
    let reciprocal = f32x16::splat(simd, 1.0) / (x * x + y * y + z * z).sqrt();
    let has_length = reciprocal.is_finite() & reciprocal.simd_gt(0.0);
    let unit = each!(component in [x, y, z] => has_length.select(component * reciprocal, f32x16::splat(simd, 0.0)));
    lambert_lanes(unit, direction, ambient)
}
