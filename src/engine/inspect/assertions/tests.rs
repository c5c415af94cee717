use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};

use super::*;
use glam::{Mat4, Vec3};

use crate::chain::run;
use crate::inspect::hits::Hits;
use crate::pipeline::viewport::Viewport;
use crate::scene::seams::{Seams, tests as seams};
use crate::scene::{Camera, Projection, builtin};

const VIEW: Viewport = Viewport { width: 64, height: 40 };

fn report(id: &str, settings: &[&str]) -> AssertionReport {
    let scene = builtin::by_id(id).unwrap().build();
    let mut recipe = Recipe::default();
    recipe.set_all(settings).unwrap();
    let frame = run(&scene, &scene.home, &recipe, VIEW, &mut ());
    check(&scene, &recipe, &frame, Assertion::ALL, TaskControl::quiet()).unwrap()
}

#[test]
fn all_hold_on_the_built_in_scenes_except_the_one_without_normals() {
    for builtin in builtin::ALL {
        let report = report(builtin.id, &[]);
        let violated = || report.findings.iter().filter(|finding| finding.violated > 0);
        if builtin.id == "nan-normal" {
            assert!(violated().all(|finding| finding.assertion == Assertion::Normal), "{report:#?}");
        } else {
            assert!(report.holds(), "{}: {:#?}", builtin.id, violated().collect::<Vec<_>>());
        }
        let may_be_idle = [Assertion::DepthPass, Assertion::BlendOrder, Assertion::Junctions];
        assert!(report.findings.iter().all(|f| f.checked > 0 || may_be_idle.contains(&f.assertion)), "{}", builtin.id);
    }
}

#[test]
fn all_hold_under_every_depth_bias() {
    for id in ["chess", "interpenetrating", "near-plane"] {
        for format in ["f32", "reversed-f32", "unorm16", "w-buffer"] {
            for (constant, slope) in [("-3", "0"), ("0", "1.5"), ("4e6", "-30"), ("-5e6", "2")] {
                let settings = [
                    format!("depth_format={format}"),
                    format!("depth_bias.constant={constant}"),
                    format!("depth_bias.slope={slope}"),
                ];
                let report = report(id, &settings.each_ref().map(String::as_str));
                let violated: Vec<_> = report.findings.iter().filter(|finding| finding.violated > 0).collect();
                assert!(report.holds(), "{id} {settings:?}: {violated:#?}");
            }
        }
    }
}

#[test]
fn each_assertion_is_violated_by_a_deliberately_wrong_setting_or_scene() {
    let wrong: [(Assertion, &str, &[&str]); 12] = [
        (Assertion::Owner, "cubes", &["rasterizer=scanline-published"]),
        (Assertion::Owner, "shared-edges", &["fill-rule=inclusive"]),
        (Assertion::EdgeSum, "slivers", &["arithmetic=f32"]),
        (Assertion::Weights, "cubes", &["rasterizer=scanline-published"]),
        (Assertion::Weights, "cubes", &["rasterizer=bounding-box-published"]),
        (Assertion::WeightsSum, "shared-edges", &["interpolation=published"]),
        (Assertion::Finite, "shared-edges", &["interpolation=published"]),
        (Assertion::DepthRange, "cubes", &["rasterizer=scanline-published"]),
        (Assertion::DepthPass, "interpenetrating", &["depth-test=always"]),
        (Assertion::Attributes, "shared-edges", &["interpolation=published"]),
        (Assertion::Normal, "nan-normal", &[]),
        (Assertion::BlendOrder, "stained-glass", &["blending.order=objects"]),
    ];
    for (assertion, id, settings) in wrong {
        let report = report(id, settings);
        let finding = report.findings.iter().find(|finding| finding.assertion == assertion).unwrap();
        assert!(finding.violated > 0 && finding.violated <= finding.checked, "{assertion:?} {settings:?}");
        let first = finding.first.as_ref().unwrap();
        assert!(first.x < VIEW.width && first.y < VIEW.height && !first.text.is_empty(), "{first:?}");
    }
    let tried: Vec<_> = wrong.iter().map(|(assertion, ..)| *assertion).collect();
    // No built-in scene has T-junctions.
    assert!(Assertion::ALL.iter().all(|a| tried.contains(a) || *a == Assertion::Junctions));
}

#[test]
fn t_junctions_in_the_picture_are_counted_and_the_first_open_pixel_is_reported() {
    let (mut positions, triangles) = seams::fan(&[-0.7, -0.61, -0.3, 0.11, 0.27, 0.5]);
    positions[4..].iter_mut().for_each(|at| at.y = -2e-4);
    let mut scene = seams::scene(&[(positions, triangles)], Mat4::from_rotation_z(0.3));
    let recipe = Recipe::default();
    let found = |scene: &Scene, width: u32| {
        let frame = run(scene, &scene.home, &recipe, Viewport { width, height: 100 }, &mut ());
        let found = check(scene, &recipe, &frame, &[Assertion::Junctions], TaskControl::quiet());
        let hits = Hits::of(&frame, &recipe.pipeline).with_seams(scene, &recipe, &frame, &Seams::of(scene));
        (found.unwrap().findings.remove(0), hits.faults)
    };
    scene.home = Camera::look_at(Vec3::new(0.2, 0.1, 3.0), Vec3::ZERO);
    let (finding, _) = found(&scene, 120);
    // Six junctions and the four corners of the outline.
    assert_eq!((finding.checked, finding.violated), (10, 6));
    let first = finding.first.unwrap();
    assert!(first.text.starts_with("T-junction: v") && first.triangle == TriangleId(0), "{first:?}");
    // The camera is so close that the gap is a tenth of a pixel wide; the first pixel in the gap is reported.
    let far = scene.home;
    scene.home.target = Vec3::new(0.02, 0.005, 0.0);
    scene.home.projection = Projection::Orthographic { height: 0.2 };
    let (finding, faults) = found(&scene, 160);
    let (first, fault) = (finding.first.unwrap(), &faults[0]);
    assert_eq!((first.x, first.y), (fault.x, fault.y));
    assert!(faults.len() > 3 && first.text.starts_with("T-junction: v"), "{first:?}");
    scene.home = far;
    // Junctions outside the picture or on culled triangles are not violations of the frame.
    scene.home.target = Vec3::new(9.0, 0.0, 3.0);
    let finding = found(&scene, 100).0;
    assert_eq!((finding.checked, finding.violated, finding.first), (0, 0, None));
    scene.home = Camera::look_at(Vec3::new(0.2, 0.1, -3.0), Vec3::ZERO);
    assert_eq!(found(&scene, 100).0.violated, 0);
}

#[test]
fn only_requested_assertions_are_checked_and_the_check_can_be_stopped() {
    let scene = builtin::by_id("triangle").unwrap().build();
    let recipe = Recipe::default();
    let frame = run(&scene, &scene.home, &recipe, VIEW, &mut ());
    let check = |wanted: &[Assertion], stop: bool| {
        check(&scene, &recipe, &frame, wanted, TaskControl { cancel: &AtomicBool::new(stop), ..TaskControl::quiet() })
    };
    let found = check(&[Assertion::Finite], false).unwrap();
    assert_eq!(found.findings.len(), 1);
    let covered = (0..VIEW.width * VIEW.height)
        .filter_map(|i| crate::inspect::inspect(&scene, &recipe, &frame, i % VIEW.width, i / VIEW.width))
        .filter(|report| !report.fragments.is_empty());
    assert_eq!(found.findings[0].checked, covered.count() as u64);
    assert_eq!(check(Assertion::ALL, true), None);
}

#[test]
fn batches_between_two_checks_of_the_stop_flag_stay_within_the_limits() {
    let large = Viewport { width: 4096, height: 4096 };
    let mut split = 0;
    for builtin in builtin::ALL {
        let scene = builtin.build();
        let settings = Recipe::default().pipeline;
        let geometry = crate::pipeline::prepare(&scene, &scene.home, &settings, large, &mut ());
        let mut rest = &geometry.triangles[..];
        while !rest.is_empty() {
            let count = drawn_at_once(rest, large);
            let pixels = rest[..count - 1].iter().map(|triangle| box_pixels(triangle, large)).sum::<u64>();
            assert!(count <= TRIANGLES_AT_ONCE && pixels <= PIXELS_AT_ONCE, "{}: {count}, {pixels} px", builtin.id);
            split += u32::from(count < TRIANGLES_AT_ONCE.min(rest.len()));
            rest = &rest[count..];
        }
    }
    assert!(split > 10, "large triangles ended only {split} batches early");
}

#[test]
fn blended_triangles_are_checked_in_rows_and_stopped_between_them() {
    let scene = builtin::by_id("stained-glass").unwrap().build();
    let mut recipe = Recipe::default();
    recipe.set_all(&["blending.order=exact".to_owned()]).unwrap();
    let frame = run(&scene, &scene.home, &recipe, VIEW, &mut ());
    let (shares, stop) = (Mutex::new(Vec::new()), AtomicBool::new(false));
    let record = |share| shares.lock().unwrap().push(share);
    check(&scene, &recipe, &frame, Assertion::ALL, TaskControl { progress: &record, cancel: &stop }).unwrap();
    let shares = shares.into_inner().unwrap();
    assert!(shares.is_sorted(), "{shares:?}");
    let last = shares[shares.len() - 1];
    // Stopping before the last rows gives no report.
    let stop_at_last = |share: f32| stop.fetch_or(share >= last, Ordering::Relaxed);
    let report_progress = |share| {
        stop_at_last(share);
    };
    let rows = VIEW.height.div_ceil(ROWS_AT_ONCE as u32) as usize;
    assert!(rows > 1 && shares.len() > rows, "{shares:?}");
    let control = TaskControl { progress: &report_progress, cancel: &stop };
    assert_eq!(check(&scene, &recipe, &frame, Assertion::ALL, control), None);
}
