//! Quantitative and comparative sentences of README and help, each with its proof: a check that runs here, a test elsewhere, or
//! a command whose output shows it, for what only a clock can show.

use std::collections::BTreeSet;
use std::path::Path;

use rasterscope::antialias::pattern::Pattern;
use rasterscope::antialias::settings::{Method, Samples};
use rasterscope::chain::{Recipe, run};
use rasterscope::image::color::decode_byte;
use rasterscope::image::{Image, Rgba8};
use rasterscope::pipeline::depth::{DepthEncoding, DepthScale};
use rasterscope::pipeline::settings::Choice as _;
use rasterscope::pipeline::viewport::Viewport;
use rasterscope::scene::{DepthMapping, builtin};
use rasterscope::upscale::{Anchor, Drawn, Upscaling};

/// A sentence, or the part of one that claims something.
struct Claim {
    /// File that holds it.
    source: &'static str,
    /// Its words.
    words: &'static str,
    proof: Proof,
}

/// Evidence for a claim.
enum Proof {
    /// A check in this file.
    Here(fn()),
    /// A test in another file.
    Test(&'static str, &'static str),
    /// Arguments of the program whose output shows it.
    Command(&'static str),
}

const CLAIMS: &[Claim] = &[
    Claim {
        source: "src/antialias/settings.rs",
        words: "It splits everywhere, so the picture is that of the regular grid.",
        proof: Proof::Test("src/antialias/pattern.rs", "a_quartered_pixel_has_the_places_of_a_regular_grid"),
    },
    Claim {
        source: "src/antialias/settings.rs",
        words: "four steps along edges where the regular grid of four has two",
        proof: Proof::Here(rotated_grid_has_twice_the_steps),
    },
    Claim {
        source: "src/antialias/settings.rs",
        words: "as many steps as samples along upright and level edges",
        proof: Proof::Here(low_discrepancy_has_a_step_for_each_sample),
    },
    Claim {
        source: "src/antialias/settings.rs",
        words: "Closer to the truth than the regular grid where patterns run along rows, as on the chess floor",
        proof: Proof::Here(low_discrepancy_is_closer_on_the_chess_floor),
    },
    Claim {
        source: "src/antialias/settings.rs",
        words: "the regular grid is closer on edges in random directions",
        proof: Proof::Here(regular_grid_is_closer_on_edges_in_random_directions),
    },
    Claim {
        source: "src/antialias/settings.rs",
        words: "smooth edges at less cost than supersampling",
        proof: Proof::Command("bench chess --set antialias.method=multisample --set antialias.samples=16"),
    },
    Claim {
        source: "src/antialias/settings.rs",
        words: "The cost grows with the number of pixels and of edges, not with that of triangles.",
        proof: Proof::Command("bench chess --size 1920x1080 --set post.filter=fxaa"),
    },
    Claim {
        source: "src/measure/reference.rs",
        words: "The mean of 256 low-discrepancy samples of every pixel in linear light",
        proof: Proof::Here(the_converged_reference_has_all_samples),
    },
    Claim {
        source: "src/upscale/nearest.rs",
        words: "the picture moves right and down: by ½ px at ×1.5 and ×2, 1 px at ×3, 1½ px at ×4",
        proof: Proof::Here(nearest_from_the_corner_moves_the_picture),
    },
    Claim {
        source: "src/upscale/bicubic.rs",
        words: "Overshoots at hard edges by up to 6.5 % of their height",
        proof: Proof::Here(|| overshoots("bicubic", 6.5)),
    },
    Claim {
        source: "src/upscale/cubic.rs",
        words: "Overshoots at hard edges by up to 7.5 % of their height",
        proof: Proof::Here(|| overshoots("catmull-rom", 7.5)),
    },
    Claim {
        source: "src/upscale/cubic.rs",
        words: "overshoots by up to 4 % of an edge's height",
        proof: Proof::Here(|| overshoots("mitchell", 4.0)),
    },
    Claim {
        source: "src/upscale/lanczos.rs",
        words: "Overshoots at hard edges by up to 9 % of their height",
        proof: Proof::Here(|| overshoots("lanczos2", 9.0)),
    },
    Claim {
        source: "src/upscale/lanczos.rs",
        words: "Rings: up to 12 % of an edge's height beside it",
        proof: Proof::Here(|| overshoots("lanczos3", 12.0)),
    },
    Claim {
        source: "src/upscale/checkerboard/temporal.rs",
        words: "While the view stands still the picture is native from the second frame on, bit for bit.",
        proof: Proof::Test("src/chain/tests.rs", "a_settled_picture_changes_no_more"),
    },
    Claim {
        source: "src/upscale/accumulation.rs",
        words: "Still pictures become the mean of 16 samples of each pixel, one a frame, and then change no more",
        proof: Proof::Test("src/chain/tests.rs", "accumulation_comes_to_the_mean_of_its_samples"),
    },
    Claim {
        source: "README.md",
        words: "after 2 and 16 frames, and so do the commands: further frames of that view are equal, bit for bit",
        proof: Proof::Test("src/chain/tests.rs", "a_settled_picture_changes_no_more"),
    },
    Claim {
        source: "README.md",
        words: "how many of 200 000 pairs of surfaces, between the planes 0.1 and 10 000 and 0.01 % of their distance apart, \
                get the very same depth",
        proof: Proof::Here(depths_tie_as_often_as_the_table_says),
    },
    Claim {
        source: "README.md",
        words: "compares colours, depths and picture with those drawn triangle after triangle, bit for bit",
        proof: Proof::Command("bench chess --verify"),
    },
];

/// Text as it is read: string continuations and line breaks are spaces.
fn flowing(text: &str) -> String {
    text.replace("\\\n", " ").split_whitespace().collect::<Vec<_>>().join(" ")
}

fn read(file: &str) -> String {
    std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(file)).unwrap_or_else(|e| panic!("{file}: {e}"))
}

#[test]
fn every_claim_stands_in_its_source_and_has_a_proof() {
    for Claim { source, words, proof } in CLAIMS {
        assert!(flowing(&read(source)).contains(&flowing(words)), "{source} no longer says: {words}");
        match proof {
            Proof::Here(check) => check(),
            Proof::Test(file, name) => {
                assert!(
                    read(file).contains(&format!("#[test]\nfn {name}()"))
                        || read(file).contains(&format!("#[test]\n    fn {name}()")),
                    "{file} has no test {name}"
                );
            }
            Proof::Command(arguments) => assert!(!arguments.is_empty()),
        }
    }
}

/// Sentences that were measured and found untrue, or that nothing can measure.
#[test]
fn claims_that_were_refuted_stay_out() {
    let refuted = [
        ("src/antialias/settings.rs", "a few percent"),
        ("src/antialias/settings.rs", "Converges fastest"),
        ("src/antialias/settings.rs", "as good as the truth"),
        ("src/upscale/nearest.rs", "(scale − 1)/2"),
        ("README.md", "| pairs that tie |"),
    ];
    for (file, words) in refuted {
        assert!(!flowing(&read(file)).contains(words), "{file}: {words}");
    }
}

/// Number of different positions of samples along an axis.
fn steps(pattern: Pattern, axis: usize) -> usize {
    let positions: BTreeSet<u64> = pattern.offsets(0, 0).iter().map(|place| place[axis].to_bits()).collect();
    positions.len()
}

fn rotated_grid_has_twice_the_steps() {
    for axis in [0, 1] {
        assert_eq!([steps(Pattern::RotatedGrid, axis), steps(Pattern::Regular { side: 2 }, axis)], [4, 2]);
    }
}

fn low_discrepancy_has_a_step_for_each_sample() {
    for samples in Samples::ALL {
        let count = samples.count();
        assert_eq!([0, 1].map(|axis| steps(Pattern::LowDiscrepancy { count }, axis)), [count as usize; 2]);
    }
}

fn the_converged_reference_has_all_samples() {
    assert_eq!(Samples::All.count(), 256);
}

/// Root mean square error of the coverage of a pixel by half-planes whose borders cross it.
fn half_plane_error(pattern: Pattern) -> f64 {
    let places = pattern.offsets(0, 0);
    let mut random = fastrand::Rng::with_seed(31);
    let (mut sum, mut count) = (0.0, 0);
    while count < 4000 {
        let (sin, cos) = (random.f64() * std::f64::consts::TAU).sin_cos();
        let distance = random.f64() * 1.5 - 0.75;
        let [a, b] = [cos.abs(), sin.abs()];
        if distance.abs() >= (a + b) / 2.0 {
            continue;
        }
        // The exact area is the distribution function of the sum of two uniform numbers.
        let half_square = |t: f64| t.max(0.0).powi(2) / 2.0;
        let corners = [(a + b) / 2.0, (a - b) / 2.0, (b - a) / 2.0, -(a + b) / 2.0];
        let signs = [1.0, -1.0, -1.0, 1.0];
        let area: f64 =
            corners.iter().zip(signs).map(|(at, sign)| sign * half_square(distance + at)).sum::<f64>() / (a * b);
        let inside = places.iter().filter(|[x, y]| cos * (x - 0.5) + sin * (y - 0.5) < distance).count();
        sum += (inside as f64 / places.len() as f64 - area).powi(2);
        count += 1;
    }
    (sum / f64::from(count)).sqrt()
}

fn regular_grid_is_closer_on_edges_in_random_directions() {
    for samples in [Samples::Sixteen, Samples::SixtyFour, Samples::All] {
        let regular = half_plane_error(Pattern::Regular { side: samples.side() });
        let low = half_plane_error(Pattern::LowDiscrepancy { count: samples.count() });
        assert!(regular < low, "{samples:?}: {regular} and {low}");
    }
}

fn drawn(scene: &str, size: (u32, u32), antialias: Option<Method>) -> Image<Rgba8> {
    let scene = builtin::by_id(scene).expect("a built-in scene").build();
    let mut recipe = Recipe::default();
    if let Some(method) = antialias {
        (recipe.antialias.method, recipe.antialias.samples) = (method, Samples::Sixteen);
    }
    let viewport = Viewport { width: size.0, height: size.1 };
    run(&scene, &scene.home, &recipe, viewport, &mut ()).image().clone()
}

fn low_discrepancy_is_closer_on_the_chess_floor() {
    /// Pixels along a side of the large picture for each of the small one.
    const FINE: u32 = 20;
    const SIZE: (u32, u32) = (64, 36);
    let fine = drawn("chess", (SIZE.0 * FINE, SIZE.1 * FINE), None);
    let truth = |x: u32, y: u32, channel: usize| {
        let block = (0..FINE).flat_map(|dy| (0..FINE).map(move |dx| (x * FINE + dx, y * FINE + dy)));
        block.map(|(x, y)| f64::from(decode_byte(fine.at(x, y)[channel]))).sum::<f64>() / f64::from(FINE * FINE)
    };
    let truth = Image::from_fn(SIZE.0, SIZE.1, |x, y| [0, 1, 2].map(|channel| truth(x, y, channel)));
    let [regular, low] = [Method::Regular, Method::LowDiscrepancy].map(|method| {
        let picture = drawn("chess", SIZE, Some(method));
        let pairs = picture.pixels().iter().zip(truth.pixels());
        let off = |(color, exact): (&Rgba8, &[f64; 3])| -> f64 {
            color.iter().zip(exact).map(|(code, exact)| (f64::from(decode_byte(*code)) - exact).powi(2)).sum()
        };
        pairs.map(off).sum::<f64>()
    });
    assert!(low < regular, "squared errors in light: {low} and {regular}");
}

fn nearest_from_the_corner_moves_the_picture() {
    for (scale, expected) in [(1.5, 0.5), (2.0, 0.5), (3.0, 1.0), (4.0, 1.5)] {
        let how = Upscaling::new("nearest", scale).expect("it has this scale").with_anchor(Anchor::Corner);
        // Samples numbered by their codes; the last pixel starts a new block.
        let columns = Image::from_fn(49, 1, |x, _| [x as u8, 0, 0, 255]);
        let width = (48.0 * scale) as u32;
        let full = how.upscale(&Drawn::from(&columns), width, 1);
        let moved = |x: u32| f64::from(x) + 0.5 - how.sampling().position_px((full.at(x, 0)[0].into(), 0)).0;
        let mean = (0..width).map(moved).sum::<f64>() / f64::from(width);
        assert!((mean - expected).abs() < 1e-9, "×{scale}: {mean} px");
    }
}

/// Checks that a method overshoots a step by at most so many percent at any scale and anchor, and by nearly as much at one.
fn overshoots(method: &str, most: f64) {
    const STEP: [f64; 2] = [50.0, 200.0];
    let mut greatest = 0.0_f64;
    for scale in [1.5, 2.0, 3.0, 4.0] {
        for anchor in Anchor::ALL {
            let how = Upscaling::new(method, scale).expect("it has this scale").with_anchor(*anchor);
            let samples = Image::from_fn(24, 1, |x, _| [STEP[usize::from(x >= 12)] as u8; 4]);
            let width = (24.0 * scale) as u32;
            let full = how.upscale(&Drawn::from(&samples), width, 1);
            let beyond = full.pixels().iter().map(|pixel| f64::from(pixel[0]) - STEP[1]).fold(0.0, f64::max);
            greatest = greatest.max(100.0 * beyond / (STEP[1] - STEP[0]));
        }
    }
    // Codes are rounded: half a code of a step of 150.
    let rounding = 50.0 / (STEP[1] - STEP[0]);
    assert!(greatest <= most + rounding && greatest >= most - 1.0 - rounding, "{method}: {greatest} %, not {most} %");
}

/// Shares of the table, in percent as they are printed, from random pairs of distances.
fn ties(scale: &DepthScale, distance: impl Fn(f64) -> f64) -> f64 {
    let mut random = fastrand::Rng::with_seed(26);
    let equal = |_: &u32| {
        let near = distance(random.f64());
        scale.stored(near as f32) == scale.stored((near * (1.0 + GAP)) as f32)
    };
    100.0 * (0..PAIRS).filter(equal).count() as f64 / f64::from(PAIRS)
}

/// Pairs of which the table gives shares.
const PAIRS: u32 = 200_000;

/// Distance between the two of a pair, as a share of their distance from the eye.
const GAP: f64 = 1e-4;

fn depths_tie_as_often_as_the_table_says() {
    const PLANES: [f64; 2] = [0.1, 1e4];
    let [near, far] = [PLANES[0], PLANES[1] / (1.0 + GAP)];
    let readme = read("README.md");
    for (format, mapping, encoding) in [
        ("f32", DepthMapping::Standard, DepthEncoding::F32),
        ("reversed-f32", DepthMapping::Reversed, DepthEncoding::F32),
        ("reversed-infinite", DepthMapping::ReversedInfinite, DepthEncoding::F32),
        ("unorm24", DepthMapping::Standard, DepthEncoding::Unorm24),
        ("unorm16", DepthMapping::Standard, DepthEncoding::Unorm16),
        ("w-buffer", DepthMapping::Linear, DepthEncoding::F32),
    ] {
        let scale = DepthScale::perspective(mapping, encoding, PLANES[0] as f32, PLANES[1] as f32);
        let found = [ties(&scale, |t| near * (far / near).powf(t)), ties(&scale, |t| near + (far - near) * t)];
        let row = readme.lines().find(|line| line.starts_with(&format!("| `{format}` | ")) && line.ends_with("% |"));
        let row = row.unwrap_or_else(|| panic!("no row of {format}"));
        let cells: Vec<&str> = row.trim_end_matches('|').rsplit('|').map(str::trim).take(2).collect();
        for (cell, found) in cells.iter().rev().zip(found) {
            let percent = cell.strip_suffix(" %").expect("a share in percent");
            let digits = percent.split_once('.').map_or(0, |(_, digits)| digits.len() as i32);
            let printed: f64 = percent.parse().expect("a number");
            // Half a printed step, and five standard deviations of the share of as many random pairs.
            let deviation = (found * (100.0 - found) / f64::from(PAIRS)).sqrt();
            let margin = 0.5 * 0.1_f64.powi(digits) + 5.0 * deviation;
            assert!((found - printed).abs() <= margin, "{format}: {found} %, not {printed} % ± {margin}");
        }
    }
}
