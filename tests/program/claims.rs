//! Sentences of the manual and of help texts that compare or give a figure, each with its proof: a check in this file,
//! a test, or a command whose output shows it.

use std::collections::BTreeSet;
use std::path::Path;
use std::process::Command;
use std::sync::Arc;

use rasterscope::antialias::pattern::Pattern;
use rasterscope::antialias::settings::{AntialiasMethod, Antialiasing, PostFilterKind, SampleCount};
use rasterscope::chain::{Recipe, RenderInputs, Renderer};
use rasterscope::image::color::decode_byte;
use rasterscope::image::{Image, Rgba8};
use rasterscope::measure::difference::Difference;
use rasterscope::measure::reference::Reference;
use rasterscope::pipeline::depth::DepthScale;
use rasterscope::pipeline::depth_format::DepthEncoding;
use rasterscope::pipeline::settings::{self, Choice, DepthFormat};
use rasterscope::pipeline::viewport::Viewport;
use rasterscope::scene::{DepthMapping, Scene, builtin};
use rasterscope::upscale::{Anchor, FilterSpace, UpscaleInputs, Upscaling};

/// Sentence, or part of a sentence, that makes a claim.
struct Claim {
    /// Path of the file that contains the claim, relative to the repository.
    source: &'static str,
    /// Text of the claim; line breaks may differ from the file.
    words: &'static str,
    proof: Proof,
}

/// Evidence for a claim.
enum Proof {
    /// A check in this file, which panics if the claim is wrong.
    Here(fn()),
    /// A test: the path of its file, and its name.
    Test(&'static str, &'static str),
    /// Arguments with which the program prints figures that prove the claim.
    Command(&'static str),
}

const CLAIMS: &[Claim] = &[
    Claim {
        source: "src/engine/antialias/settings.rs",
        words: "Every square is subdivided, so the picture is that of the regular grid.",
        proof: Proof::Test("src/engine/antialias/pattern.rs", "a_quartered_pixel_has_the_places_of_a_regular_grid"),
    },
    Claim {
        source: "src/engine/antialias/settings.rs",
        words: "four steps along edges where the regular grid of four has two",
        proof: Proof::Here(rotated_grid_has_twice_the_steps),
    },
    Claim {
        source: "src/engine/antialias/settings.rs",
        words: "as many steps as samples along vertical and horizontal edges",
        proof: Proof::Here(low_discrepancy_has_a_step_for_each_sample),
    },
    Claim {
        source: "src/engine/antialias/settings.rs",
        words: "With 16, 64 or 256 samples it is closer to the truth than the regular grid on the scene chess",
        proof: Proof::Test("tests/program/claims.rs", "low_discrepancy_is_closer_on_chess"),
    },
    Claim {
        source: "src/engine/antialias/settings.rs",
        words: "the regular grid is closer on edges in random directions",
        proof: Proof::Here(regular_grid_is_closer_on_edges_in_random_directions),
    },
    Claim {
        source: "src/engine/antialias/settings.rs",
        words: "and with 16 samples on the scenes cubes and cel",
        proof: Proof::Test("tests/program/claims.rs", "regular_grid_is_closer_on_cubes_and_cel"),
    },
    Claim {
        source: "src/engine/antialias/settings.rs",
        words: "nearly vertical or horizontal edges show only n steps",
        proof: Proof::Here(a_regular_grid_has_a_step_for_each_square_of_an_axis),
    },
    Claim {
        source: "src/engine/antialias/settings.rs",
        words: "Inside surfaces, in textures and at alpha-tested edges, nothing improves.",
        proof: Proof::Test("src/engine/chain/samples.rs", "multisampling_leaves_the_inside_of_triangles_alone"),
    },
    Claim {
        source: "src/engine/antialias/settings.rs",
        words: "as many samples as the converged reference",
        proof: Proof::Here(the_converged_reference_has_all_samples),
    },
    Claim {
        source: "src/engine/antialias/settings.rs",
        words: "smooth edges at less cost than supersampling",
        proof: Proof::Command("bench chess --set antialias.method=multisample --set antialias.samples=16"),
    },
    Claim {
        source: "src/engine/antialias/settings.rs",
        words: "The cost grows with the number of pixels and of edges, not with that of triangles: 1.4 to 3.8 ms at \
                1920 × 1080 px with two threads (Zen 4), 23 to 84 % of the frame without it",
        proof: Proof::Command("bench chess --size 1920x1080 --threads 2 --set post.filter=fxaa"),
    },
    Claim {
        source: "src/engine/measure/reference.rs",
        words: "The mean of 256 low-discrepancy samples of every pixel in linear light",
        proof: Proof::Here(the_converged_reference_has_all_samples),
    },
    Claim {
        source: "src/engine/upscale/nearest.rs",
        words: "the picture moves right and down: by ½ px at ×1.5 and ×2, 1 px at ×3, 1½ px at ×4",
        proof: Proof::Here(nearest_from_the_corner_moves_the_picture),
    },
    Claim {
        source: "src/engine/upscale/bicubic.rs",
        words: "Overshoots at hard edges by up to 6.5 % of their height",
        proof: Proof::Here(|| overshoots("bicubic", 6.5)),
    },
    Claim {
        source: "src/engine/upscale/cubic.rs",
        words: "Overshoots at hard edges by up to 7.5 % of their height",
        proof: Proof::Here(|| overshoots("catmull-rom", 7.5)),
    },
    Claim {
        source: "src/engine/upscale/cubic.rs",
        words: "overshoots by up to 4 % of an edge's height",
        proof: Proof::Here(|| overshoots("mitchell", 4.0)),
    },
    Claim {
        source: "src/engine/upscale/lanczos.rs",
        words: "Overshoots at hard edges by up to 9 % of their height",
        proof: Proof::Here(|| overshoots("lanczos2", 9.0)),
    },
    Claim {
        source: "src/engine/upscale/lanczos.rs",
        words: "Rings: up to 12 % of an edge's height beside it",
        proof: Proof::Here(|| overshoots("lanczos3", 12.0)),
    },
    Claim {
        source: "src/engine/upscale/bilinear.rs",
        words: "never leaves the range of its neighbours",
        proof: Proof::Here(|| overshoots("bilinear", 0.0)),
    },
    Claim {
        source: "src/engine/upscale/ewa/mod.rs",
        words: "treats all directions alike, where Lanczos favours rows and columns",
        proof: Proof::Here(ewa_treats_directions_alike),
    },
    Claim {
        source: "src/engine/upscale/ewa/mod.rs",
        words: "Rings beside hard edges unless de-ringed",
        proof: Proof::Test("src/engine/upscale/ewa/tests.rs", "deringing_keeps_an_edge_within_its_two_sides"),
    },
    Claim {
        source: "src/engine/upscale/nis/mod.rs",
        words: "Good on straight edges at multiples of 45°.",
        proof: Proof::Test("src/engine/upscale/nis/tests.rs", "an_edge_in_each_direction_has_its_filter"),
    },
    Claim {
        source: "src/engine/upscale/nis/mod.rs",
        words: "colours are only bilinear, so edges between colours of equal luma blur",
        proof: Proof::Here(nis_is_bilinear_between_colors_of_equal_luma),
    },
    Claim {
        source: "src/engine/upscale/sgsr2/mod.rs",
        words: "Still views regain fine detail",
        proof: Proof::Test("src/engine/upscale/sgsr2/tests.rs", "a_still_view_settles_near_the_mean_of_all_samples"),
    },
    Claim {
        source: "src/engine/antialias/settings.rs",
        words: "blends by the exact areas that a line between them cuts off",
        proof: Proof::Test("src/engine/antialias/smaa/area.rs", "areas_are_integrals_of_the_smoothed_edge"),
    },
    Claim {
        source: "src/engine/antialias/settings.rs",
        words: "stairs of slanted edges become ramps",
        proof: Proof::Test("src/engine/antialias/smaa/tests.rs", "stairs_of_a_slanted_edge_become_the_covered_area"),
    },
    Claim {
        source: "src/engine/antialias/settings.rs",
        words: "single pixels stay sharper than with FXAA",
        proof: Proof::Test("src/engine/antialias/smaa/tests.rs", "single_pixels_stay_sharper_than_with_fxaa"),
    },
    Claim {
        source: "src/engine/antialias/settings.rs",
        words: "Edges near 45° are smoothed along their diagonal",
        proof: Proof::Test("src/engine/antialias/smaa/tests.rs", "diagonals_halve_the_error_of_edges_near_45_degrees"),
    },
    Claim {
        source: "src/engine/antialias/settings.rs",
        words: "right-angled corners are rounded only a quarter as much as steps",
        proof: Proof::Test("src/engine/antialias/smaa/tests.rs", "corners_are_rounded_a_quarter_as_much_as_steps"),
    },
    Claim {
        source: "src/engine/upscale/choice.rs",
        words: "Slower: each sample is decoded and each pixel encoded.",
        proof: Proof::Command(
            "diff chess --size 1920x1080 --set upscaler.method=bilinear --set upscaler.scale=2 \
             --set upscaler.light=linear --against upscaler.light=bytes",
        ),
    },
    Claim {
        source: "src/engine/upscale/checkerboard/mean.rs",
        words: "half of the picture",
        proof: Proof::Test("src/engine/chain/whole.rs", "only_what_the_upscaler_reads_is_rasterized"),
    },
    Claim {
        source: "src/engine/upscale/checkerboard/edges.rs",
        words: "Good on vertical and horizontal edges, which the plain checkerboard frays.",
        proof: Proof::Test(
            "src/engine/upscale/checkerboard/edges.rs",
            "upright_and_level_edges_come_back_as_they_were",
        ),
    },
    Claim {
        source: "src/engine/upscale/checkerboard/edges.rs",
        words: "because half of them was never drawn",
        proof: Proof::Test("src/engine/chain/whole.rs", "only_what_the_upscaler_reads_is_rasterized"),
    },
    Claim {
        source: "src/engine/upscale/checkerboard/surfaces.rs",
        words: "Half of the pixels are shaded",
        proof: Proof::Test("src/engine/chain/whole.rs", "only_what_the_upscaler_reads_is_rasterized"),
    },
    Claim {
        source: "src/engine/upscale/checkerboard/surfaces.rs",
        words: "it saves time where shading costs more than that, as with supersampling",
        proof: Proof::Command(
            "diff chess --set antialias.method=regular --set antialias.samples=16 \
             --set upscaler.method=checkerboard-surfaces --against upscaler.method=native",
        ),
    },
    Claim {
        source: "src/engine/upscale/accumulation.rs",
        words: "upscaled ones regain detail that a single frame lacks",
        proof: Proof::Test("src/engine/chain/tests.rs", "enlarged_accumulation_regains_what_one_frame_has_not"),
    },
    Claim {
        source: "src/engine/upscale/checkerboard/temporal.rs",
        words: "In a still view the picture equals native rendering from the second frame on, bit for bit.",
        proof: Proof::Test("src/engine/chain/tests.rs", "a_settled_picture_changes_no_more"),
    },
    Claim {
        source: "src/engine/upscale/accumulation.rs",
        words: "Still pictures become the mean of 16 samples of each pixel, one per frame, and then stay unchanged",
        proof: Proof::Test("src/engine/chain/tests.rs", "accumulation_comes_to_the_mean_of_its_samples"),
    },
    Claim {
        source: "src/engine/pipeline/raster/arithmetic.rs",
        words: "the ground truth, but slower",
        proof: Proof::Command("diff chess --set execution=classic --set arithmetic=exact --against arithmetic=fixed"),
    },
    Claim {
        source: "src/engine/pipeline/settings.rs",
        words: "always correct, but slower",
        proof: Proof::Command("diff stained-glass --set blending.order=exact --against blending.order=triangles"),
    },
    Claim {
        source: "src/engine/pipeline/settings.rs",
        words: "always correct",
        proof: Proof::Test(
            "tests/internal/properties/transparency.rs",
            "exact_order_is_that_of_fragments_sorted_by_depth",
        ),
    },
    Claim {
        source: "src/engine/pipeline/depth_format/mod.rs",
        words: "at most 2⁻²³ of the distance from it",
        proof: Proof::Test(
            "tests/internal/properties/depth.rs",
            "the_resolution_is_the_distance_between_two_neighbouring_depths",
        ),
    },
    Claim {
        source: "src/engine/pipeline/depth_format/mod.rs",
        words: "floats are finest where perspective is coarsest, so distant surfaces z-fight less",
        proof: Proof::Test("tests/internal/depth_cases.rs", "close_surfaces_tie_as_often_as_theory_says"),
    },
    Claim {
        source: "src/engine/pipeline/depth_format/mod.rs",
        words: "in perspective nearly all steps lie close to the near plane",
        proof: Proof::Here(nearly_all_steps_lie_near),
    },
    Claim {
        source: "src/engine/pipeline/raster/fill_rule.rs",
        words: "Shared edges are drawn exactly once.",
        proof: Proof::Test(
            "tests/internal/properties/coverage.rs",
            "a_closed_mesh_over_the_picture_covers_every_pixel_exactly_once_under_sound_rules",
        ),
    },
    Claim {
        source: "src/engine/pipeline/raster/fill_rule.rs",
        words: "shared edges are drawn twice",
        proof: Proof::Test("src/engine/lab/tests.rs", "a_shared_side_is_drawn_once_by_sound_rules_and_not_by_others"),
    },
    Claim {
        source: "src/engine/pipeline/settings.rs",
        words: "Opaque textures look the same either way.",
        proof: Proof::Test("tests/internal/shading.rs", "opaque_textures_are_the_same_under_both_alpha_modes"),
    },
    Claim {
        source: "src/engine/pipeline/settings.rs",
        words: "the time shows what skipping the parts saves",
        proof: Proof::Test("tests/internal/tiled/mod.rs", "every_switch_gives_the_same_picture"),
    },
    Claim {
        source: "src/engine/scene/builtin/cubes.rs",
        words: "shows what sharing a mesh saves",
        proof: Proof::Test("src/engine/scene/builtin/cubes.rs", "cubes_share_one_mesh_and_so_a_fraction_of_the_memory"),
    },
    Claim {
        source: "assets/manual/03-stages.md",
        words: "ends in exactly one bin, and the sums are checked",
        proof: Proof::Test("tests/internal/fate_sums.rs", "sums_match_in_every_builtin_scene"),
    },
    Claim {
        source: "assets/manual/05-error-against-time.md",
        words: "the floor is the 90th percentile of the relative differences of all pairs",
        proof: Proof::Test("src/engine/measure/noise.rs", "the_floor_is_the_90th_percentile_of_the_medians_of_blocks"),
    },
    Claim {
        source: "assets/manual/11-case-files.md",
        words: "areas are right to the last bit or the one before",
        proof: Proof::Test("tests/internal/exact_cases.rs", "areas_are_right_to_the_last_bit"),
    },
    Claim {
        source: "assets/manual/11-case-files.md",
        words: "answers whose lists take more than 192 MiB are refused before they are computed",
        proof: Proof::Test(
            "src/engine/case/control/tests.rs",
            "answers_beyond_the_limit_are_refused_quickly_and_name_the_limit",
        ),
    },
    Claim {
        source: "assets/manual/13-conventions.md",
        words: "onto a grid of 1/256 px before any edge is built",
        proof: Proof::Test("src/engine/math/fixed.rs", "snapping_rounds_to_nearest_with_ties_to_even"),
    },
    Claim {
        source: "assets/manual/02-inspecting-a-pixel.md",
        words: "tests verify that the replay gives the same colour at every pixel of every built-in scene, under every upscaler",
        proof: Proof::Test(
            "tests/internal/replay.rs",
            "every_pixel_of_every_builtin_scene_replays_to_the_frame_under_every_upscaler",
        ),
    },
    Claim {
        source: "assets/manual/04-comparing-upscalers.md",
        words: "after 2 and 16 frames, and so do the commands: further frames of that view are equal, bit for bit",
        proof: Proof::Test("src/engine/chain/tests.rs", "a_settled_picture_changes_no_more"),
    },
    Claim {
        source: "assets/manual/13-conventions.md",
        words: "how many of 200 000 pairs of surfaces, between the planes 0.1 and 10 000 and 0.01 % of their distance apart, \
                get the very same depth",
        proof: Proof::Here(depths_tie_as_often_as_the_table_says),
    },
    Claim {
        source: "assets/manual/05-error-against-time.md",
        words: "compares colours, depths and picture with those of classic execution, bit for bit",
        proof: Proof::Command("bench chess --verify"),
    },
];

/// Returns the text with string continuations and line breaks replaced by spaces.
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
            Proof::Command(arguments) => assert_runs(arguments),
        }
    }
}

/// Checks that the program executes a command successfully, on a small picture and without repetitions.
fn assert_runs(arguments: &str) {
    const REPEATED: [&str; 3] = ["--size", "--frames", "--rounds"];
    let mut words = arguments.split_whitespace();
    let mut short = vec!["--size", "32x18"];
    while let Some(word) = words.next() {
        if REPEATED.contains(&word) {
            words.next();
        } else {
            short.push(word);
        }
    }
    let command = short.remove(2);
    short.insert(0, command);
    match command {
        "bench" if !short.contains(&"--verify") => short.extend(["--turn", "0", "--frames", "1"]),
        "diff" => short.extend(["--turn", "0", "--rounds", "1"]),
        _ => {}
    }
    let output = Command::new(env!("CARGO_BIN_EXE_rasterscope")).args(&short).output().expect("the program starts");
    assert!(output.status.success(), "{arguments}: {}", String::from_utf8_lossy(&output.stderr));
}

/// Returns the help texts of all values of a setting.
fn help_of<T: Choice>() -> Vec<&'static str> {
    T::ALL.iter().map(|choice| choice.help()).collect()
}

/// Words that indicate a comparison or a figure in a help text.
const COMPARISONS: [&str; 18] = [
    "faster", "slower", "cheap", "cheaper", "closer", "dear", "cost", "costs", "pays", "saves", "less", "fewer",
    "half", "halved", "twice", "better", "best", "worse",
];

/// Parts of help texts that contain a word of [`COMPARISONS`] but define a term instead of making a claim.
const DEFINITIONS: &[&str] = &[
    "samples at pixel corners, shared edges drawn twice",
    "snapped to 1/256 px",
    "filled in up to the border",
    "with more weight for the one that changes less",
];

/// Returns whether a sentence contains a word of [`COMPARISONS`] or a number with a unit.
fn claims_something(sentence: &str) -> bool {
    let words = || sentence.split(|c: char| !c.is_alphanumeric() && c != '½').filter(|word| !word.is_empty());
    let after_number = sentence.split_whitespace().zip(sentence.split_whitespace().skip(1)).any(|(number, unit)| {
        number.ends_with(|c: char| c.is_ascii_digit() || c == '½')
            && ["%", "ms", "px"].iter().any(|u| unit.starts_with(u))
    });
    after_number
        || sentence.contains("at most")
        || sentence.contains("up to")
        || words().any(|word| COMPARISONS.contains(&word.to_lowercase().as_str()))
}

#[test]
fn every_help_text_that_compares_has_its_claims_in_the_table() {
    let helps = [
        rasterscope::upscale::BUILT_IN.iter().map(|upscaler| upscaler.help()).collect(),
        help_of::<AntialiasMethod>(),
        help_of::<SampleCount>(),
        help_of::<PostFilterKind>(),
        help_of::<FilterSpace>(),
        help_of::<Anchor>(),
        help_of::<Reference>(),
        help_of::<Difference>(),
        help_of::<settings::Execution>(),
        help_of::<settings::Culling>(),
        help_of::<settings::Rasterizer>(),
        help_of::<settings::Arithmetic>(),
        help_of::<settings::FillRule>(),
        help_of::<settings::DepthTest>(),
        help_of::<settings::DepthFormat>(),
        help_of::<settings::Interpolation>(),
        help_of::<settings::Shading>(),
        help_of::<settings::TexelFilter>(),
        help_of::<settings::AlphaMode>(),
        help_of::<settings::AddressMode>(),
        help_of::<settings::ColorSpace>(),
        help_of::<settings::BlendingOrder>(),
    ]
    .concat();
    let known = |sentence: &str| {
        let row = |words: &str| sentence.contains(words.trim_end_matches('.')) || words.contains(sentence);
        CLAIMS.iter().any(|claim| row(&flowing(claim.words)))
            || DEFINITIONS.iter().any(|words| sentence.contains(words))
    };
    let sentences = helps.iter().flat_map(|help| help.split(". "));
    let unproven: Vec<&str> = sentences.filter(|sentence| claims_something(sentence) && !known(sentence)).collect();
    assert!(unproven.is_empty(), "neither a row of the table nor a definition:\n{}", unproven.join("\n"));
}

/// Checks that claims that were refuted or cannot be measured do not return to the sources.
#[test]
fn claims_that_were_refuted_stay_out() {
    let refuted = [
        ("src/engine/antialias/settings.rs", "a few percent"),
        ("src/engine/antialias/settings.rs", "Converges fastest"),
        ("src/engine/antialias/settings.rs", "as good as the truth"),
        ("src/engine/antialias/settings.rs", "corners stay sharper"),
        ("src/engine/upscale/nearest.rs", "(scale − 1)/2"),
        ("assets/manual/13-conventions.md", "| pairs that tie |"),
    ];
    for (file, words) in refuted {
        assert!(!flowing(&read(file)).contains(words), "{file}: {words}");
    }
}

/// Returns the number of distinct sample positions along an axis.
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
    for samples in SampleCount::ALL {
        let count = samples.count();
        assert_eq!([0, 1].map(|axis| steps(Pattern::LowDiscrepancy { count }, axis)), [count as usize; 2]);
    }
}

fn a_regular_grid_has_a_step_for_each_square_of_an_axis() {
    for samples in SampleCount::ALL {
        let side = samples.side();
        assert_eq!([0, 1].map(|axis| steps(Pattern::Regular { side }, axis)), [side as usize; 2]);
    }
}

fn the_converged_reference_has_all_samples() {
    assert_eq!([SampleCount::All.count(), Reference::Converged.samples()], [256; 2]);
}

fn nearly_all_steps_lie_near() {
    let scale = DepthScale::perspective(DepthMapping::STANDARD, DepthEncoding::Unorm24, 0.1, 1e4);
    // At ten times the near plane 90 % of the steps are used, at a hundred times 99 %.
    for (distance, share) in [(1.0, 0.9), (10.0, 0.99)] {
        assert!((f64::from(scale.stored(distance)) - share).abs() < 1e-3, "{distance}");
    }
}

/// Returns the root mean square error of the coverage that a pattern estimates, over random half-planes whose borders
/// cross the pixel.
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
        // The exact area is the distribution function of the sum of two uniform random variables.
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
    for samples in [SampleCount::Sixteen, SampleCount::SixtyFour, SampleCount::All] {
        let regular = half_plane_error(Pattern::Regular { side: samples.side() });
        let low = half_plane_error(Pattern::LowDiscrepancy { count: samples.count() });
        assert!(regular < low, "{samples:?}: {regular} and {low}");
    }
}

fn drawn(scene: &Arc<Scene>, size: (u32, u32), antialias: Antialiasing) -> Image<Rgba8> {
    let recipe = Recipe { antialias, ..Recipe::default() };
    let viewport = Viewport { width: size.0, height: size.1 };
    Renderer::default()
        .render_converged(RenderInputs { scene, camera: &scene.home, recipe: &recipe, viewport })
        .image()
        .clone()
}

/// Asserts that `closer` has a smaller squared error than `farther` on a scene, in linear light, for each number of
/// samples. The reference is a large picture, averaged over blocks of pixels.
fn assert_closer(scene: &str, samples: &[SampleCount], [closer, farther]: [AntialiasMethod; 2]) {
    /// Pixels of the large picture per pixel of the small one, along each axis.
    const FINE: u32 = 32;
    const SIZE: (u32, u32) = (48, 27);
    let scene = Arc::new(builtin::by_id(scene).expect("a built-in scene").build());
    let fine = drawn(&scene, (SIZE.0 * FINE, SIZE.1 * FINE), Antialiasing::default());
    let truth = |x: u32, y: u32, channel: usize| {
        let block = (0..FINE).flat_map(|dy| (0..FINE).map(move |dx| (x * FINE + dx, y * FINE + dy)));
        block.map(|(x, y)| f64::from(decode_byte(fine.at(x, y)[channel]))).sum::<f64>() / f64::from(FINE * FINE)
    };
    let truth = Image::from_fn(SIZE.0, SIZE.1, |x, y| [0, 1, 2].map(|channel| truth(x, y, channel)));
    for samples in samples {
        let [closer, farther] = [closer, farther].map(|method| {
            let picture = drawn(&scene, SIZE, Antialiasing { method, samples: *samples, ..Antialiasing::default() });
            let pairs = picture.pixels().iter().zip(truth.pixels());
            let off = |(color, exact): (&Rgba8, &[f64; 3])| -> f64 {
                color.iter().zip(exact).map(|(code, exact)| (f64::from(decode_byte(*code)) - exact).powi(2)).sum()
            };
            pairs.map(off).sum::<f64>()
        });
        assert!(closer < farther, "{} {samples:?}: squared errors in linear light: {closer} and {farther}", scene.name);
    }
}

#[test]
fn low_discrepancy_is_closer_on_chess() {
    let samples = [SampleCount::Sixteen, SampleCount::SixtyFour, SampleCount::All];
    assert_closer("chess", &samples, [AntialiasMethod::LowDiscrepancy, AntialiasMethod::Regular]);
}

#[test]
fn regular_grid_is_closer_on_cubes_and_cel() {
    for scene in ["cubes", "cel"] {
        assert_closer(scene, &[SampleCount::Sixteen], [AntialiasMethod::Regular, AntialiasMethod::LowDiscrepancy]);
    }
}

fn nearest_from_the_corner_moves_the_picture() {
    for (scale, expected) in [(1.5, 0.5), (2.0, 0.5), (3.0, 1.0), (4.0, 1.5)] {
        let how = Upscaling::new("nearest", scale).expect("it has this scale").with_anchor(Anchor::Corner);
        // The samples are numbered by their codes; the last pixel starts a new block.
        let columns = Image::from_fn(49, 1, |x, _| [x as u8, 0, 0, 255]);
        let width = (48.0 * scale) as u32;
        let full = how.upscale(&UpscaleInputs::from(&columns), width, 1);
        let moved = |x: u32| f64::from(x) + 0.5 - how.sampling().position_px((full.at(x, 0)[0].into(), 0)).0;
        let mean = (0..width).map(moved).sum::<f64>() / f64::from(width);
        assert!((mean - expected).abs() < 1e-9, "×{scale}: {mean} px");
    }
}

/// Checks that a method overshoots a step by at most `most` percent at any scale and anchor, and by nearly as much at
/// one of them.
fn overshoots(method: &str, most: f64) {
    const STEP: [f64; 2] = [50.0, 200.0];
    let mut greatest = 0.0_f64;
    for scale in [1.5, 2.0, 3.0, 4.0] {
        for anchor in Anchor::ALL {
            let how = Upscaling::new(method, scale).expect("it has this scale").with_anchor(*anchor);
            let samples = Image::from_fn(24, 1, |x, _| [STEP[usize::from(x >= 12)] as u8; 4]);
            let width = (24.0 * scale) as u32;
            let full = how.upscale(&UpscaleInputs::from(&samples), width, 1);
            let beyond = full.pixels().iter().map(|pixel| f64::from(pixel[0]) - STEP[1]).fold(0.0, f64::max);
            greatest = greatest.max(100.0 * beyond / (STEP[1] - STEP[0]));
        }
    }
    // Values are rounded to codes: half a code of a step of 150.
    let rounding = 50.0 / (STEP[1] - STEP[0]);
    assert!(greatest <= most + rounding && greatest >= most - 1.0 - rounding, "{method}: {greatest} %, not {most} %");
}

/// Returns the percentage of pairs of surfaces with equal stored depths. `distance` maps numbers that are evenly spaced
/// in [0, 1] to the distance of the nearer surface.
fn ties(scale: &DepthScale, distance: impl Fn(f64) -> f64) -> f64 {
    let equal = |pair: &u32| {
        let near = distance((f64::from(*pair) + 0.5) / f64::from(PAIRS));
        scale.stored(near as f32) == scale.stored((near * (1.0 + GAP)) as f32)
    };
    100.0 * (0..PAIRS).filter(equal).count() as f64 / f64::from(PAIRS)
}

/// Number of pairs of surfaces over which the manual's table gives the share of ties.
const PAIRS: u32 = 200_000;

/// Distance between the surfaces of a pair, as a share of their distance from the eye.
const GAP: f64 = 1e-4;

fn depths_tie_as_often_as_the_table_says() {
    const PLANES: [f64; 2] = [0.1, 1e4];
    let [near, far] = [PLANES[0], PLANES[1] / (1.0 + GAP)];
    let chapter = read("assets/manual/13-conventions.md");
    for format in DepthFormat::ALL {
        let (mapping, encoding, format) = (format.mapping(), format.encoding(), format.id());
        let scale = DepthScale::perspective(mapping, encoding, PLANES[0] as f32, PLANES[1] as f32);
        let found = [ties(&scale, |t| near * (far / near).powf(t)), ties(&scale, |t| near + (far - near) * t)];
        let row = chapter.lines().find(|line| line.starts_with(&format!("| `{format}` | ")) && line.ends_with("% |"));
        let row = row.unwrap_or_else(|| panic!("no row of {format}"));
        let cells: Vec<&str> = row.trim_end_matches('|').rsplit('|').map(str::trim).take(2).collect();
        for (cell, found) in cells.iter().rev().zip(found) {
            let percent = cell.strip_suffix(" %").expect("a share in percent");
            let digits = percent.split_once('.').map_or(0, |(_, digits)| digits.len());
            assert_eq!(percent, format!("{found:.digits$}"), "{format}: {found} %");
        }
    }
}

/// Returns the factor by which a method at ×2 multiplies the amplitude of a grating of 0.35 periods per sample, whose waves
/// travel in a direction given in degrees.
fn gain_of_grating(method: &str, degrees: f64) -> f64 {
    const SAMPLES: u32 = 40;
    let how = Upscaling::new(method, 2).expect("it has this scale").with_anchor(Anchor::Centre);
    let wave = [degrees.to_radians().cos(), degrees.to_radians().sin()].map(|axis| std::f64::consts::TAU * 0.35 * axis);
    let samples = Image::from_fn(SAMPLES, SAMPLES, |x, y| {
        let phase = wave[0] * (f64::from(x) + 0.5) + wave[1] * (f64::from(y) + 0.5);
        [(128.0 + 100.0 * phase.cos()).round() as u8; 4]
    });
    let full = how.upscale(&UpscaleInputs::from(&samples), 2 * SAMPLES, 2 * SAMPLES);
    // Projection onto both phases of the grating, away from the border.
    let (mut projected, mut count) = ([0.0; 2], 0.0);
    for (x, y) in (16..64).flat_map(|y| (16..64).map(move |x| (x, y))) {
        let phase = (wave[0] * (f64::from(x) + 0.5) + wave[1] * (f64::from(y) + 0.5)) / 2.0;
        let code = f64::from(full.at(x, y)[0]) - 128.0;
        projected[0] += code * phase.cos();
        projected[1] += code * phase.sin();
        count += 1.0;
    }
    projected[0].hypot(projected[1]) * 2.0 / count / 100.0
}

fn ewa_treats_directions_alike() {
    let [ewa, lanczos] = ["ewa-lanczos", "lanczos3"].map(|method| {
        let gains = [0.0, 15.0, 30.0, 45.0].map(|degrees| gain_of_grating(method, degrees));
        gains.iter().copied().fold(0.0, f64::max) - gains.iter().copied().fold(f64::INFINITY, f64::min)
    });
    assert!(ewa < 0.5 * lanczos, "the gain varies by {ewa}, that of Lanczos by {lanczos}");
}

fn nis_is_bilinear_between_colors_of_equal_luma() {
    let differences = |left: Rgba8, right: Rgba8| {
        let samples = Image::from_fn(16, 16, |x, _| if x < 8 { left } else { right });
        let [nis, bilinear] = ["nis", "bilinear"].map(|method| {
            let how = Upscaling::new(method, 2).expect("it has this scale").with_anchor(Anchor::Centre);
            how.with_sharpening(0).upscale(&UpscaleInputs::from(&samples), 32, 32)
        });
        nis.pixels().iter().zip(bilinear.pixels()).flat_map(|(a, b)| [0, 1, 2].map(|i| a[i].abs_diff(b[i]))).max()
    };
    // 0.2126 · 185 = 39.33, and 0.7152 · 55 = 39.34.
    assert!(differences([185, 0, 0, 255], [0, 55, 0, 255]) <= Some(1));
    assert!(differences([40, 40, 40, 255], [200, 200, 200, 255]) > Some(4), "an edge in luma is sharper");
}
