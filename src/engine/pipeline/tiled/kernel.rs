//! SIMD shading of sixteen samples at a time, eight in each of two rows. Each visible sample is shaded once.
//!
//! The arithmetic is the same as in [`crate::pipeline::interpolate`] and [`crate::pipeline::shade`], operation by
//! operation. Shading modes without a SIMD kernel call those functions themselves.

use super::TiledFrame;
use super::gather::Taps;
use super::lattice::{BLOCK, TILE, TileLattice};
use super::mipmap::CoarseTaps;
use super::queue::{Queue, QueuedPair, QueuedRow, make_room};
use super::record::{One, Record, ShadedTriangle, TriangleSource};
use super::setup::EdgeFunctions;
use super::shader::{DrawShader, LightSource, ShadingPlan};
use super::target::ColorRows;
use crate::image::Rgba8;
use crate::math::lanes::*;
use crate::pipeline::interpolate::interpolate;
use crate::pipeline::raster::RasterSample;
use crate::pipeline::shading::LightInputs;
use crate::pipeline::viewport::ScreenTriangle;

/// Rectangle of samples in a tile: rows of a block, or of several adjacent blocks.
#[derive(Clone, Copy, Debug)]
pub(super) struct Patch {
    pub(super) tile: (usize, usize),
    /// Index of the first column, within the tile.
    pub(super) column: usize,
    /// Number of the patch's columns that lie within the picture.
    pub(super) count: usize,
    /// Index of the first row, within the tile.
    pub(super) first: usize,
    /// Index one past the last row, within the tile.
    pub(super) end: usize,
    /// Bit mask of the samples to shade, one bit per column of a block. The same mask applies to every row of every
    /// block.
    pub(super) mine: u32,
}

impl Patch {
    /// Splits the patch horizontally into blocks.
    pub(super) fn blocks(self) -> impl Iterator<Item = Self> {
        let columns = (self.column..self.column + self.count).step_by(BLOCK);
        columns.map(move |column| Self { column, count: (self.column + self.count - column).min(BLOCK), ..self })
    }
}

/// Bit mask of all eight samples in a row of a block.
pub(super) const ALL: u32 = (1 << LANES) - 1;

/// Shades samples that all belong to one triangle and lie exactly on the points of the tile's lattice.
#[inline(never)]
pub(super) fn shade_uniform<S: Simd>(
    simd: S,
    frame: &TiledFrame<'_>,
    subject: &ShadedTriangle<'_>,
    patch: &Patch,
    queue: &mut Queue,
    picture: &mut ColorRows<'_>,
) {
    simd.vectorize(
        #[inline(always)]
        || {
            let lattice = &frame.lattice;
            let Some(edges) = subject.edges else {
                let mut edges = IntegerRows::new(simd, lattice, subject.one.record, patch);
                return shade_rows(simd, frame, subject, patch, (queue, picture), &mut edges);
            };
            let mut exact = ExactRows::new(simd, lattice, edges, patch);
            if frame.shader(subject.draw).on_lanes {
                return shade_rows(simd, frame, subject, patch, (queue, picture), &mut exact);
            }
            let whole = frame.screen_triangle(subject.key, subject.draw);
            for block in patch.blocks() {
                exact.begin(simd, &block);
                for (i, row) in (block.first..block.end).enumerate() {
                    let e = each!(edge in [0, 1, 2] => (exact.along[edge] + exact.down[edge][i]).to_array());
                    one_by_one(frame, frame.shader(subject.draw), &whole, &block, row, &e, picture.row(&block, row));
                }
            }
        },
    );
}

/// Source of the edge values at the samples of a patch.
pub(super) trait EdgeRows<S: Simd> {
    /// Moves to one of the blocks of the patch.
    fn begin(&mut self, simd: S, block: &Patch);

    /// Returns the edge values of eight samples in each of two rows of the block. Rows are counted from the first row
    /// of the patch.
    fn at(&self, simd: S, rows: [usize; 2]) -> [f32x16<S>; 3];
}

/// Shades rows of samples that all belong to one triangle.
#[inline(always)]
pub(super) fn shade_rows<S: Simd>(
    simd: S,
    frame: &TiledFrame<'_>,
    subject: &ShadedTriangle<'_>,
    patch: &Patch,
    queue_and_picture: (&mut Queue, &mut ColorRows<'_>),
    edges: &mut impl EdgeRows<S>,
) {
    match frame.shader(subject.draw).plan {
        ShadingPlan::COMMON => {
            shade_blocks(simd, frame, (subject, ShadingPlan::COMMON), patch, queue_and_picture, edges);
        }
        plan => shade_blocks(simd, frame, (subject, plan), patch, queue_and_picture, edges),
    }
}

/// Shades rows like [`shade_rows`], with a shading plan that may be a compile-time constant.
#[inline(always)]
fn shade_blocks<S: Simd>(
    simd: S,
    frame: &TiledFrame<'_>,
    (subject, plan): (&ShadedTriangle<'_>, ShadingPlan),
    patch: &Patch,
    (queue, picture): (&mut Queue, &mut ColorRows<'_>),
    edges: &mut impl EdgeRows<S>,
) {
    let ShadedTriangle { one, draw, .. } = *subject;
    let (shader, number) = (frame.shader(draw), frame.shader_of_draw[draw]);
    let pairs = (patch.end - patch.first).div_ceil(2);
    let mut ahead = [StoredWeights::default(); BLOCK / 2];
    for block in patch.blocks() {
        edges.begin(simd, &block);
        let room = make_room(simd, frame, number, pairs, queue, picture.values);
        let starts = (picture.start(&block, block.first), picture.stride);
        interpolate_rows(simd, (shader, plan), one, (&block, starts), room, (&*edges, &mut ahead));
    }
}

/// Interpolates all attributes in the rows of a block. The colours of the first row will be written to the picture from
/// index `start` on. Each following row starts `stride` pixels after the previous one.
///
/// The weights of all rows are computed first. Each computation is a dependency chain with a division, and the chains
/// of several rows overlap.
#[inline(always)]
fn interpolate_rows<S: Simd>(
    simd: S,
    (shader, plan): (&DrawShader<'_>, ShadingPlan),
    one: One<'_>,
    (patch, (start, stride)): (&Patch, (usize, usize)),
    (pairs, taps, coarse): (&mut [QueuedPair], &mut [Taps], &mut [CoarseTaps]),
    (edges, ahead): (&impl EdgeRows<S>, &mut [StoredWeights; BLOCK / 2]),
) {
    let (rows, relative_inv_w) = (patch.end - patch.first, one.relative_inv_w(simd));
    let mut row = QueuedRow::new(start, patch.count, patch.mine);
    for (i, (pair, weights)) in pairs.iter_mut().zip(ahead.iter_mut()).enumerate() {
        // If the number of rows is odd, the last one is computed twice and written once.
        let (upper, lower) = (2 * i, (2 * i + 1).min(rows - 1));
        weights.store(plan, corner_weights(simd, edges.at(simd, [upper, lower]), relative_inv_w));
        pair.rows = [row, if lower > upper { row.after(stride) } else { row.none() }];
        row = row.after(2 * stride);
    }
    let mut coarse = coarse.iter_mut();
    for ((pair, taps), weights) in pairs.iter_mut().zip(taps).zip(ahead.iter()) {
        let coarse = if plan.mipmapped { coarse.next() } else { None };
        interpolate_pair(simd, shader, plan, one, weights.load(simd), (pair, (taps, coarse)));
    }
}

/// Edge values of up to eight rows in 32-bit integers, for triangles whose edge values fit. Sums may wrap around, but
/// are correct at samples that the triangle covers.
struct IntegerRows<'a, S: Simd> {
    lattice: &'a TileLattice,
    /// Change of the first two edge values per 1/256 px to the right.
    a: [i32; 2],
    /// Differences between the edge values of the eight samples in a row of the block and the edge values at the start
    /// of the row. They are repeated for the second row.
    along: [i32x16<S>; 2],
    /// Edge values at the start of each row.
    down: [[i32; LANES]; 2],
    doubled_area: i32,
}

impl<'a, S: Simd> IntegerRows<'a, S> {
    #[inline(always)]
    fn new(simd: S, lattice: &'a TileLattice, record: &Record, patch: &Patch) -> Self {
        let [y, shift] = lattice.rows_i32(simd, patch.first);
        let ([a0, b0, c0], [a1, b1, c1], doubled_area) = record.integer_edges();
        let down = each!((a, b, c) in [(a0, b0, c0), (a1, b1, c1)] => (y * b + shift * a + c).to_array());
        Self { lattice, a: [a0, a1], along: [i32x16::splat(simd, 0); 2], down, doubled_area }
    }
}

impl<S: Simd> EdgeRows<S> for IntegerRows<'_, S> {
    #[inline(always)]
    fn begin(&mut self, simd: S, block: &Patch) {
        let columns = self.lattice.columns_i32(simd, block.column);
        self.along = each!(edge in [0, 1] => {
            let along = columns * self.a[edge];
            along.combine(along)
        });
    }

    #[inline(always)]
    fn at(&self, simd: S, [upper, lower]: [usize; 2]) -> [f32x16<S>; 3] {
        let [first, second] = each!(edge in [0, 1] => {
            let down = i32x8::splat(simd, self.down[edge][upper]).combine(i32x8::splat(simd, self.down[edge][lower]));
            self.along[edge] + down
        });
        let third = i32x16::splat(simd, self.doubled_area) - first - second;
        each!(e in [first, second, third] => e.to_float::<f32x16<S>>())
    }
}

/// Edge values of up to eight rows in doubles, for any triangle.
struct ExactRows<'a, S: Simd> {
    lattice: &'a TileLattice,
    /// Change of the edge values per 1/256 px to the right.
    a: [f64; 3],
    /// Differences between the edge values of the eight samples in a row of the block and the edge values at the start
    /// of the row.
    along: [F64<S>; 3],
    /// Edge values at the start of each row.
    down: [[f64; LANES]; 3],
}

impl<'a, S: Simd> ExactRows<'a, S> {
    #[inline(always)]
    fn new(simd: S, lattice: &'a TileLattice, edges: &EdgeFunctions, patch: &Patch) -> Self {
        let EdgeFunctions { a, b, c } = *edges;
        let steps = &lattice.doubles;
        let y = F64::load_array_ref(simd, &steps.rows) + steps.row(patch.first);
        let shift = F64::load_array_ref(simd, steps.shifts(patch.first));
        let down = each!(i in [0, 1, 2] => (y * b[i] + shift * a[i] + c[i]).to_array());
        Self { lattice, a, along: [F64::splat(simd, 0.0); 3], down }
    }
}

impl<S: Simd> EdgeRows<S> for ExactRows<'_, S> {
    #[inline(always)]
    fn begin(&mut self, simd: S, block: &Patch) {
        let steps = &self.lattice.doubles;
        let columns = F64::load_array_ref(simd, &steps.lanes) + steps.column(block.column);
        self.along = each!(edge in [0, 1, 2] => columns * self.a[edge]);
    }

    #[inline(always)]
    fn at(&self, simd: S, [upper, lower]: [usize; 2]) -> [f32x16<S>; 3] {
        each!(edge in [0, 1, 2] => {
            let [upper, lower] = each!(row in [upper, lower] => narrow(simd, self.along[edge] + self.down[edge][row]));
            upper.combine(lower)
        })
    }
}

/// Shades a row sample by sample with the code of the classic (scalar) path. Not inlined into SIMD code, where it would
/// spill registers.
#[inline(never)]
pub(super) fn one_by_one(
    frame: &TiledFrame<'_>,
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
        let sample = RasterSample { column, row, x, y, edges: edges.map(|e| e[lane]) };
        let fragment = interpolate(triangle, sample, shader.shader.attributes());
        *pixel = shader.shader.shade(&fragment, triangle);
    }
}

/// Returns edge values that are computed in f64, and so are valid for any triangle. Positions are relative to the
/// centre of the tile's first pixel, to the right and down, in steps of 1/256 px.
#[inline(always)]
pub(super) fn exact_at<S: Simd>(simd: S, edges: &EdgeFunctions, places: [i32x16<S>; 2]) -> [f32x16<S>; 3] {
    // Offsets are small enough for floats to hold them exactly.
    let [(x0, x1), (y0, y1)] = each!(axis in [0, 1] => places[axis].to_float::<f32x16<S>>().split());
    let [first, last] = each!((x, y) in [(x0, y0), (x1, y1)] => {
        let (x, y) = (widen(simd, x), widen(simd, y));
        each!(i in [0, 1, 2] => narrow(simd, x * edges.a[i] + y * edges.b[i] + edges.c[i]))
    });
    each!(i in [0, 1, 2] => first[i].combine(last[i]))
}

/// Interpolation weights of attributes at sixteen samples.
#[derive(Clone, Copy)]
pub(super) struct AttributeWeights<S: Simd> {
    /// Weights of the second and third vertex.
    pub(super) of_corners: [f32x16<S>; 2],
    /// Reciprocal of Σ edge value × relative 1/w, with one term per vertex.
    inverse_sum: f32x16<S>,
}

/// Interpolation weights of sixteen samples, stored in memory: see [`AttributeWeights`].
#[derive(Clone, Copy, Debug, Default)]
#[repr(align(64))]
pub(super) struct StoredWeights {
    of_corners: [[f32; WIDE]; 2],
    /// Reciprocal of Σ edge value × relative 1/w, with one term per vertex. Only valid if the texture is mip-mapped.
    inverse_sum: [f32; WIDE],
}

impl StoredWeights {
    #[inline(always)]
    pub(super) fn store<S: Simd>(
        &mut self,
        plan: ShadingPlan,
        AttributeWeights { of_corners: [second, third], inverse_sum }: AttributeWeights<S>,
    ) {
        second.store_array(&mut self.of_corners[0]);
        third.store_array(&mut self.of_corners[1]);
        if plan.mipmapped {
            inverse_sum.store_array(&mut self.inverse_sum);
        }
    }

    #[inline(always)]
    pub(super) fn load<S: Simd>(&self, simd: S) -> AttributeWeights<S> {
        let [second, third, inverse_sum] = each!(of in [&self.of_corners[0], &self.of_corners[1], &self.inverse_sum] => f32x16::load_array_ref(simd, of));
        AttributeWeights { of_corners: [second, third], inverse_sum }
    }
}

impl<S: Simd> AttributeWeights<S> {
    /// Replaces the weights of the samples that `mine` does not select, which may be infinite or NaN, by the weights at
    /// the first vertex.
    #[inline(always)]
    pub(super) fn of_some(self, simd: S, mine: u32) -> Self {
        let (wanted, nothing) = (mask32x16::from_bitmask(simd, mine.into()), f32x16::splat(simd, 0.0));
        Self { of_corners: each!(i in [0, 1] => wanted.select(self.of_corners[i], nothing)), ..self }
    }

    /// Returns the gradients of the second and the third vertex's weights: the changes per pixel in x and in y.
    #[inline(always)]
    pub(super) fn gradient(&self, simd: S, source: impl TriangleSource) -> [[f32x16<S>; 2]; 2] {
        let (slopes, relative_inv_w) = (source.edge_slopes(simd), source.relative_inv_w(simd));
        each!(slopes in [slopes[0], slopes[1]] => {
            let q = each!(i in [0, 1, 2] => slopes[i] * relative_inv_w[i]);
            let sum = q[0] + q[1] + q[2];
            each!(i in [0, 1] => (q[i + 1] - self.of_corners[i] * sum) * self.inverse_sum)
        })
    }
}

/// Computes interpolation weights from edge values and the relative 1/w of the vertices.
#[inline(always)]
pub(super) fn corner_weights<S: Simd>(
    simd: S,
    e: [f32x16<S>; 3],
    relative_inv_w: [f32x16<S>; 3],
) -> AttributeWeights<S> {
    let q = each!(i in [0, 1, 2] => e[i] * relative_inv_w[i]);
    let inverse_sum = f32x16::splat(simd, 1.0) / (q[0] + q[1] + q[2]);
    AttributeWeights { of_corners: [q[1] * inverse_sum, q[2] * inverse_sum], inverse_sum }
}

/// Computes the texture taps of sixteen samples and prefetches their texels. Does nothing without a texture.
#[inline(always)]
pub(super) fn locate_texels<S: Simd, O: TriangleSource>(
    simd: S,
    shader: &DrawShader<'_>,
    plan: ShadingPlan,
    source: O,
    weights: AttributeWeights<S>,
    (taps, coarse): (&mut Taps, Option<&mut CoarseTaps>),
) {
    let (Some(texture), Some(layout)) = (&shader.texture, plan.texture) else { return };
    match coarse {
        Some(coarse) if plan.mipmapped => {
            texture.locate_in_levels(simd, layout, source, weights, (taps, coarse));
            if let Some(step) = O::PREFETCH_STEP {
                coarse.prefetch(texture, step);
            }
        }
        _ => {
            let [u, v] = source.uv(simd);
            texture.locate(simd, layout, [u.at(weights.of_corners), v.at(weights.of_corners)], taps);
        }
    }
    if let Some(step) = O::PREFETCH_STEP {
        texture.prefetch(taps, step);
    }
}

/// Interpolates all attributes of sixteen samples from their weights.
#[inline(always)]
pub(super) fn interpolate_pair<S: Simd>(
    simd: S,
    shader: &DrawShader<'_>,
    plan: ShadingPlan,
    source: impl TriangleSource,
    weights: AttributeWeights<S>,
    (pair, taps): (&mut QueuedPair, (&mut Taps, Option<&mut CoarseTaps>)),
) {
    let of_corners = weights.of_corners;
    let zero = f32x16::splat(simd, 0.0);
    let inputs = LaneInputs { simd, shader, normal: [zero; 3], vertex_light: zero };
    match plan.light {
        LightSource::None => {}
        LightSource::Vertices => {
            let inputs = LaneInputs { vertex_light: source.light(simd).at(of_corners), ..inputs };
            plan.shading.light(&inputs).store_array(&mut pair.light);
        }
        LightSource::Normals => {
            let normal = source.normal(simd);
            let normal = each!(axis in [0, 1, 2] => normal[axis].at(of_corners));
            let inputs = LaneInputs { normal: unit(simd, normal), ..inputs };
            plan.shading.light(&inputs).store_array(&mut pair.light);
        }
    }
    if plan.colored {
        let (diffuse, color) = (shader.shader.diffuse.to_array(), source.color(simd));
        for channel in 0..3 {
            let color = f32x16::splat(simd, diffuse[channel]) * color[channel].at(of_corners);
            color.store_array(&mut pair.color[channel]);
        }
    }
    // Done last, because it needs the most registers.
    locate_texels(simd, shader, plan, source, weights, taps);
}

/// Normalises vectors; those of length zero remain zero.
#[inline(always)]
fn unit<S: Simd>(simd: S, [x, y, z]: [f32x16<S>; 3]) -> [f32x16<S>; 3] {
    let reciprocal = f32x16::splat(simd, 1.0) / (x * x + y * y + z * z).sqrt();
    let has_length = reciprocal.is_finite() & reciprocal.simd_gt(0.0);
    each!(component in [x, y, z] => has_length.select(component * reciprocal, f32x16::splat(simd, 0.0)))
}

/// Inputs of the light at sixteen samples.
#[derive(Clone, Copy)]
struct LaneInputs<'a, S: Simd> {
    simd: S,
    shader: &'a DrawShader<'a>,
    normal: [f32x16<S>; 3],
    vertex_light: f32x16<S>,
}

impl<S: Simd> LightInputs for LaneInputs<'_, S> {
    type Number = f32x16<S>;

    #[inline(always)]
    fn constant(&self, value: f32) -> f32x16<S> {
        f32x16::splat(self.simd, value)
    }

    #[inline(always)]
    fn normal(&self) -> [f32x16<S>; 3] {
        self.normal
    }

    #[inline(always)]
    fn vertex_light(&self) -> f32x16<S> {
        self.vertex_light
    }

    #[inline(always)]
    fn light_direction(&self) -> [f32x16<S>; 3] {
        let direction = self.shader.shader.light_direction.to_array();
        each!(axis in [0, 1, 2] => f32x16::splat(self.simd, direction[axis]))
    }

    #[inline(always)]
    fn ambient(&self) -> f32x16<S> {
        f32x16::splat(self.simd, self.shader.shader.settings.light.ambient)
    }

    #[inline(always)]
    fn dark_factor(&self) -> f32x16<S> {
        f32x16::splat(self.simd, self.shader.shader.dark_factor())
    }
}
