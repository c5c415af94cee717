//! `rasterscope bench --verify`: checks that tiled and classic execution draw bit-identical frames.

use crate::measure::equality::{ComparedQuantity, Equality, ExecutionVariant, FrameDifference, verify as compare};
use crate::pipeline::viewport::Viewport;

use super::failure::Failure;
use super::scene_args::RequestedView;

/// Compares tiled with classic execution, on one, two and all hardware threads, or only on `threads` threads.
pub(crate) fn verify(view: &RequestedView, size: Viewport, threads: Option<usize>) -> Result<Equality, Failure> {
    let machine = std::thread::available_parallelism().map_or(1, usize::from);
    let mut counts = threads.map_or_else(|| vec![1, 2, machine], |count| vec![count]);
    counts.sort_unstable();
    counts.dedup();
    compare(&view.scene, &view.camera, &view.recipe, size, &counts).map_err(|e| Failure::Threads(e.to_string()))
}

/// Formats the comparison, one line for each instruction set and number of threads.
pub(crate) fn table(scene: &str, Viewport { width, height }: Viewport, found: &Equality) -> String {
    let mut text =
        format!("{scene}, {width} × {height} px: tiled execution compared with classic execution, bit for bit\n");
    if let Some(obstacle) = found.obstacle {
        return text + &format!("nothing to compare: this frame is always drawn by classic execution ({obstacle})\n");
    }
    for ExecutionVariant { lanes, threads, difference } in &found.ways {
        let unit = if *threads == 1 { "thread" } else { "threads" };
        let result = difference.as_ref().map_or_else(|| "equal".to_owned(), in_words);
        text += &format!("{lanes:10} {threads:3} {unit:8} {result}\n");
    }
    text
}

fn in_words(difference: &FrameDifference) -> String {
    let FrameDifference { quantity, samples, first: (x, y), expected, found } = difference;
    let of = match quantity {
        ComparedQuantity::Color => "samples differ in colour",
        ComparedQuantity::Depth => "samples differ in depth",
        ComparedQuantity::Picture => "pixels of the final picture differ",
    };
    format!("DIFFERENT: {samples} {of}; first at {x},{y}: found {found}, expected {expected}")
}

/// Returns a failure if any variant of tiled execution differs from classic execution.
pub(crate) fn check_equality(found: &Equality) -> Result<(), Failure> {
    let differing = found.ways.iter().filter(|way| way.difference.is_some()).count();
    if differing > 0 { Err(Failure::Unequal { differing, of: found.ways.len() }) } else { Ok(()) }
}
