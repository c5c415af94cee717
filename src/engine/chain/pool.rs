//! Buffers that successive frames reuse.

use std::sync::Arc;

use crate::image::{Image, Rgba8};
use crate::pipeline::gbuffer::GBuffer;
use crate::pipeline::motion::MotionVectors;
use crate::upscale::{Accumulated, History};

/// Buffers of frames that are no longer needed.
#[derive(Debug, Default)]
pub(super) struct BufferPool {
    codes: Vec<Image<Rgba8>>,
    numbers: Vec<Image<f32>>,
    histories: Vec<Accumulated>,
    vectors: Vec<MotionVectors>,
}

/// Most buffers of one kind that are kept: a frame has no more of them, and neither has the history that it reads.
const MOST: usize = 6;

impl BufferPool {
    /// Removes a buffer with four bytes per pixel, preferably of `size` px.
    pub(super) fn codes(&mut self, size: (u32, u32)) -> Option<Image<Rgba8>> {
        take(&mut self.codes, |image| image.size() == size)
    }

    /// Removes a buffer with one number per pixel, preferably of `size` px.
    pub(super) fn numbers(&mut self, size: (u32, u32)) -> Option<Image<f32>> {
        take(&mut self.numbers, |image| image.size() == size)
    }

    /// Removes the buffers of an upscaler's history.
    pub(super) fn history(&mut self) -> Option<Accumulated> {
        self.histories.pop()
    }

    /// Removes the buffers of motion vectors.
    pub(super) fn vectors(&mut self) -> Option<MotionVectors> {
        self.vectors.pop()
    }

    /// Adds a buffer with four bytes per pixel, unless it is empty.
    pub(super) fn give_codes(&mut self, image: Image<Rgba8>) {
        if image.bytes() > 0 {
            give(&mut self.codes, image);
        }
    }

    /// Adds a buffer with one number per pixel.
    pub(super) fn give_numbers(&mut self, image: Image<f32>) {
        give(&mut self.numbers, image);
    }

    /// Adds the buffers of motion vectors.
    pub(super) fn give_vectors(&mut self, vectors: MotionVectors) {
        give(&mut self.vectors, vectors);
    }

    /// Adds the buffers of a G-buffer.
    pub(super) fn give_surfaces(&mut self, GBuffer { object, distance }: GBuffer) {
        self.give_codes(object);
        self.give_numbers(distance);
    }

    /// Adds the buffers of a history, except those that something else still shares.
    pub(super) fn give_history(&mut self, History { picture, accumulated, surfaces, .. }: History) {
        picture.into_iter().for_each(|picture| self.give_codes(picture));
        accumulated.into_iter().for_each(|accumulated| give(&mut self.histories, accumulated));
        Arc::into_inner(surfaces).into_iter().for_each(|surfaces| self.give_surfaces(surfaces));
    }

    /// Returns the memory use in bytes.
    pub(super) fn bytes(&self) -> usize {
        self.codes.iter().map(Image::bytes).sum::<usize>()
            + self.numbers.iter().map(Image::bytes).sum::<usize>()
            + self.histories.iter().map(Accumulated::bytes).sum::<usize>()
            + self.vectors.iter().map(MotionVectors::bytes).sum::<usize>()
    }
}

/// Removes a buffer that is `preferred`, or the one that was added last.
fn take<T>(buffers: &mut Vec<T>, preferred: impl Fn(&T) -> bool) -> Option<T> {
    match buffers.iter().rposition(preferred) {
        Some(place) => Some(buffers.remove(place)),
        None => buffers.pop(),
    }
}

/// Adds a buffer, in place of the oldest one if there are many.
fn give<T>(buffers: &mut Vec<T>, buffer: T) {
    if buffers.len() == MOST {
        buffers.remove(0);
    }
    buffers.push(buffer);
}
