//! Table of all planted faults and pairs in all scenes, with the causes that were named, pixels and time. Fails if too
//! few are named, or if a correct picture is accused.
//!
//! `cargo bench --bench explanations` takes some minutes.

#![expect(clippy::print_stdout, reason = "the table is its result")]
#![expect(
    dead_code,
    unused_imports,
    reason = "without a test harness, the tests of the textbook renderer are not compiled, but their helpers are"
)]

mod judge;
mod textbook;

use std::time::Instant;

use judge::{explained, names_exactly};
use textbook::scene::Scene;
use textbook::{Fault, Size, scenes};

/// Size of the pictures.
const SIZE: Size = Size { width: 640, height: 360 };

/// Smallest shares of planted single faults and pairs that must be named, and nothing else with them.
const LEAST_NAMED: [f64; 2] = [0.9, 0.75];

/// Result of one picture.
struct Row {
    /// Whether exactly the planted faults are named, except those that the program does not know.
    is_right: bool,
    seconds: f64,
}

/// Explains one picture, and prints its row.
fn row(scene: &Scene, planted: &[Fault]) -> Row {
    let start = Instant::now();
    let found = explained(scene, SIZE, planted);
    let seconds = start.elapsed().as_secs_f64();
    let is_right = names_exactly(&found, planted);
    let verdict = if is_right { "right" } else { "WRONG" };
    let planted: Vec<_> = planted.iter().map(|fault| fault.name()).collect();
    let named: Vec<_> = found.causes.iter().map(|cause| cause.fault.id).collect();
    let (before, after) = (found.differing_before, found.differing_after);
    let (planted, named) = (planted.join(" + "), named.join(", "));
    println!("{verdict}  {}  {planted}: {named}; {before} px, {after} px after; {seconds:.1} s", scene.name);
    Row { is_right, seconds }
}

fn main() {
    let (mut right, mut of) = ([0_u32; 3], [0_u32; 3]);
    let mut seconds = Vec::new();
    for scene in scenes::all() {
        let singles = scene.faults().map(|fault| vec![fault]);
        let pairs = scene.pairs.iter().map(|pair| pair.to_vec());
        for planted in [Vec::new()].into_iter().chain(singles).chain(pairs) {
            let row = row(&scene, &planted);
            right[planted.len()] += u32::from(row.is_right);
            of[planted.len()] += 1;
            seconds.push(row.seconds);
        }
    }
    seconds.sort_by(f64::total_cmp);
    for (kind, count) in ["correct pictures", "single faults", "pairs"].into_iter().zip(right.iter().zip(&of)) {
        println!("{kind}: {} of {} right", count.0, count.1);
    }
    println!("median {:.1} s, longest {:.1} s", seconds[seconds.len() / 2], seconds[seconds.len() - 1]);
    assert_eq!(right[0], of[0], "a correct picture is accused");
    for ((right, of), least) in right[1..].iter().zip(&of[1..]).zip(LEAST_NAMED) {
        assert!(f64::from(*right) >= least * f64::from(*of), "{right} of {of}");
    }
}
