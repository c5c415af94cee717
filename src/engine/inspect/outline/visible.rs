//! Visible surfaces at each sample of a picture, found by the rasterizer itself.

use std::collections::HashMap;
use std::ops::Range;

use rayon::prelude::*;

use super::parallel_step::ParallelStep;
use crate::drawing::Rgb;
use crate::image::Rgba8;
use crate::inspect::control::TaskControl;
use crate::pipeline::area::DrawnArea;
use crate::pipeline::framebuffer::Framebuffer;
use crate::pipeline::interpolate::Fragment;
use crate::pipeline::observe::Observer;
use crate::pipeline::raster::Scissor;
use crate::pipeline::screen_triangle::ScreenTriangle;
use crate::pipeline::settings::Settings;
use crate::pipeline::viewport::Viewport;
use crate::pipeline::{DrawCall, Extent, Geometry};
use crate::scene::{Scene, TriangleId};

/// Number of sample rows in a band, which one thread draws. Large enough that most triangles are set up only once, and
/// small enough that every thread gets several bands.
const ROWS: u32 = 64;

/// Progress of the drawing before and after the visible surfaces are determined, in percent.
const VISIBILITY_PERCENT: Range<usize> = 0..50;

/// Index of a stack of surfaces in [`Stacks`].
pub(super) type StackId = u32;

/// Index of a region, which consists of all samples that show the same triangles.
pub(super) type RegionId = u32;

/// Index that stands for both the stack and the region of samples that no triangle covers.
pub(super) const BACKGROUND: u32 = 0;

/// A surface and the stack below it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
struct SurfaceLayer<T> {
    /// Index of the stack below; [`BACKGROUND`] for opaque surfaces, which hide everything below.
    below: u32,
    surface: T,
}

/// Deduplicated stacks of surfaces. A stack consists of an opaque surface and the blended surfaces drawn over it.
#[derive(Clone, Debug)]
struct Stacks<T> {
    /// Top layer of each stack except the background, which has none.
    layers: Vec<SurfaceLayer<T>>,
    numbers: HashMap<SurfaceLayer<T>, u32>,
}

impl<T: Copy + Eq + std::hash::Hash> Stacks<T> {
    fn new() -> Self {
        Self { layers: Vec::new(), numbers: HashMap::new() }
    }

    /// Returns the index of the stack with this top layer, and adds the stack if it is new.
    fn number(&mut self, layer: SurfaceLayer<T>) -> u32 {
        *self.numbers.entry(layer).or_insert_with(|| {
            self.layers.push(layer);
            self.layers.len() as u32
        })
    }

    /// Returns the surfaces of a stack, top to bottom.
    fn surfaces(&self, stack: u32) -> impl Iterator<Item = T> {
        let layer = |stack: u32| (stack != BACKGROUND).then(|| self.layers[stack as usize - 1]);
        std::iter::successors(layer(stack), move |above| layer(above.below)).map(|layer| layer.surface)
    }
}

/// Visible surfaces of all samples of a picture.
#[derive(Clone, Debug)]
pub(super) struct Visibility {
    /// Number of samples in a row.
    pub(super) width: u32,
    /// Number of rows of samples.
    pub(super) height: u32,
    /// Stack of each sample, row by row.
    labels: Vec<StackId>,
    /// Stacks of visible surfaces, given as indices into [`Geometry::triangles`].
    stacks: Stacks<u32>,
    /// Region of each stack; pieces of one clipped triangle belong to the same region.
    regions: Vec<RegionId>,
    /// Mean colour of each region, in sRGB codes.
    colors: Vec<Rgb>,
}

impl Visibility {
    /// Draws `geometry` and records the visible surfaces; returns `None` if cancelled. The geometry must be prepared
    /// for a picture of `size`.
    pub(super) fn of(
        scene: &Scene,
        geometry: &Geometry,
        settings: &Settings,
        size: Viewport,
        control: TaskControl<'_>,
    ) -> Option<Self> {
        let firsts: Vec<u32> = (0..size.height).step_by(ROWS as usize).collect();
        let step = ParallelStep::new(control, VISIBILITY_PERCENT, firsts.len());
        let bands: Vec<RowBand> = firsts
            .into_par_iter()
            .map(|first| {
                let rows = first..size.height.min(first + ROWS);
                let band = RowBand::draw(scene, geometry, settings, size, rows);
                step.advance().map(|()| band)
            })
            .collect::<Option<_>>()?;
        let mut labels = Vec::with_capacity(size.width as usize * size.height as usize);
        let (mut stacks, mut triangles) = (Stacks::<u32>::new(), Stacks::<TriangleId>::new());
        let (mut regions, mut sums) = (vec![BACKGROUND], vec![Sum::default()]);
        for band in bands {
            let mut numbers = vec![BACKGROUND];
            for SurfaceLayer { below, surface } in &band.stacks.layers {
                let number = stacks.number(SurfaceLayer { below: numbers[*below as usize], surface: *surface });
                if number as usize == regions.len() {
                    let id = geometry.triangles[*surface as usize].id;
                    let below = regions[stacks.layers[number as usize - 1].below as usize];
                    regions.push(triangles.number(SurfaceLayer { below, surface: id }));
                    sums.resize(triangles.layers.len() + 1, Sum::default());
                }
                numbers.push(number);
            }
            for (sum, number) in band.sums.iter().zip(&numbers) {
                sums[regions[*number as usize] as usize].add(sum);
            }
            labels.extend(band.labels.iter().map(|label| numbers[*label as usize]));
        }
        let colors = sums.iter().map(|sum| sum.mean().unwrap_or(scene.background)).collect();
        Some(Self { width: size.width, height: size.height, labels, stacks, regions, colors })
    }

    /// Returns the stack of each sample of a row.
    pub(super) fn row(&self, row: u32) -> &[StackId] {
        let width = self.width as usize;
        &self.labels[row as usize * width..][..width]
    }

    /// Returns the stack of a sample.
    pub(super) fn stack(&self, x: u32, y: u32) -> StackId {
        self.labels[y as usize * self.width as usize + x as usize]
    }

    /// Returns the region of the samples that show a stack.
    pub(super) fn region(&self, stack: StackId) -> RegionId {
        self.regions[stack as usize]
    }

    /// Returns the mean colour of each region, in sRGB codes.
    pub(super) fn colors(&self) -> &[Rgb] {
        &self.colors
    }

    /// Returns the surfaces of a stack, top to bottom, as indices into [`Geometry::triangles`].
    pub(super) fn surfaces(&self, stack: StackId) -> impl Iterator<Item = u32> {
        self.stacks.surfaces(stack)
    }
}

/// Sums of the red, green and blue sRGB codes of a set of samples, and the number of samples.
#[derive(Clone, Copy, Debug, Default)]
struct Sum {
    codes: [u64; 3],
    count: u64,
}

impl Sum {
    fn add(&mut self, other: &Self) {
        self.codes.iter_mut().zip(other.codes).for_each(|(sum, code)| *sum += code);
        self.count += other.count;
    }

    /// Returns the mean colour of the samples, rounded to nearest; `None` if there are no samples.
    fn mean(&self) -> Option<Rgb> {
        let Self { codes, count } = *self;
        (count > 0).then(|| codes.map(|code| ((code + count / 2) / count) as u8))
    }
}

/// A band of sample rows, with its own stack indices.
struct RowBand {
    labels: Vec<u32>,
    stacks: Stacks<u32>,
    /// Sum of the colours of each stack's samples.
    sums: Vec<Sum>,
}

impl RowBand {
    fn draw(scene: &Scene, geometry: &Geometry, settings: &Settings, size: Viewport, rows: Range<u32>) -> Self {
        let Viewport { width, height } = size;
        let scissor = Scissor { top: rows.start, bottom: rows.end, ..Scissor::full(width, height) };
        let extent = Extent { triangles: 0..geometry.triangles.len(), scissor };
        let mut frame = Framebuffer::of_rows(DrawnArea::full(size), rows.clone(), scene.background, settings);
        let labels = vec![BACKGROUND; width as usize * rows.len()];
        let mut recorder =
            StackRecorder { geometry, first_row: rows.start, width, labels, stacks: Stacks::new(), last_drawn: 0 };
        DrawCall::new(scene, geometry, settings, &extent).draw(&mut frame, &mut recorder);
        let StackRecorder { labels, stacks, .. } = recorder;
        let mut sums = vec![Sum::default(); stacks.layers.len() + 1];
        for (label, [red, green, blue, _]) in labels.iter().zip(frame.color.pixels()) {
            let codes = [red, green, blue].map(|code| u64::from(*code));
            sums[*label as usize].add(&Sum { codes, count: 1 });
        }
        Self { labels, stacks, sums }
    }
}

/// An observer that records the stack of each sample.
struct StackRecorder<'a> {
    geometry: &'a Geometry,
    first_row: u32,
    width: u32,
    labels: Vec<u32>,
    stacks: Stacks<u32>,
    /// Index of the triangle of the previous fragment, cached because most fragments have the same triangle.
    last_drawn: usize,
}

impl StackRecorder<'_> {
    /// Returns the index of a triangle in [`Geometry::triangles`].
    fn index_of(&mut self, triangle: &ScreenTriangle) -> u32 {
        let triangles = &self.geometry.triangles;
        if !triangles.get(self.last_drawn).is_some_and(|last| std::ptr::eq(last, triangle)) {
            self.last_drawn = self.geometry.index_of(triangle);
        }
        self.last_drawn as u32
    }
}

impl Observer for StackRecorder<'_> {
    fn shaded(&mut self, triangle: &ScreenTriangle, fragment: &Fragment, _color: Rgba8) {
        let surface = self.index_of(triangle);
        let (column, row) = (fragment.sample.column, fragment.sample.row - self.first_row);
        let label = &mut self.labels[row as usize * self.width as usize + column as usize];
        let below = if self.geometry.is_blended(triangle) { *label } else { BACKGROUND };
        *label = self.stacks.number(SurfaceLayer { below, surface });
    }
}
