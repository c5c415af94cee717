use std::sync::atomic::AtomicBool;

use super::*;
use crate::pipeline::settings::DepthTest;
use crate::scene::{TriangleId, builtin};

const SIZE: Viewport = Viewport { width: 160, height: 100 };

fn subject(id: &str) -> ProbedView {
    let scene = Arc::new(builtin::by_id(id).unwrap().build());
    ProbedView { camera: scene.home, scene, settings: Settings::default(), viewport: SIZE }
}

fn found(subject: &ProbedView, probe: Probe) -> ProbeFindings {
    run(subject, probe, TaskControl::quiet()).unwrap().findings
}

const FEW: Probe = Probe { what: JitterTarget::Camera, ulps: 32, runs: 8, seed: 7 };

#[test]
fn z_fighting_surfaces_are_fragile_and_a_single_triangle_is_not() {
    // Depth steps on the far panels are coarse relative to the vertex jitter, so vertex jitter changes fewer pixels.
    for (what, least) in [(JitterTarget::Camera, 50), (JitterTarget::Vertices, 5)] {
        let probe = Probe { what, ..FEW };
        let fighting = found(&subject("z-fighting"), probe);
        let owner = fighting.summary().owner;
        assert!(owner.pixels >= least && owner.most >= 2, "{what:?}: {owner:?}");
        assert!(fighting.ranking.len() >= 2);
        let alone = found(&subject("triangle"), probe);
        // A pixel may change only if an edge passes within rounding error of its centre.
        assert!(alone.summary().owner.pixels <= 1, "{what:?}: {:?}", alone.summary());
        let owners = draw::draw_still(&subject("triangle")).owner;
        assert!(owners.pixels().iter().filter(|id| **id == TriangleId(0)).count() > 500);
    }
}

#[test]
fn without_jitter_nothing_changes() {
    for what in JitterTarget::ALL {
        let result = found(&subject("z-fighting"), Probe { what: *what, ulps: 0, ..FEW });
        let none = Changed { pixels: 0, most: 0 };
        let summary = result.summary();
        assert_eq!((summary.owner, summary.depth, summary.color), (none, Some(none), none));
        assert!(result.ranking.is_empty());
    }
}

#[test]
fn equal_seeds_give_equal_results_on_any_number_of_threads() {
    let subject = subject("z-fighting");
    let on = |threads: usize, seed| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| found(&subject, Probe { seed, ..FEW }))
    };
    let (one, three, other) = (on(1, 7), on(3, 7), on(1, 8));
    assert_eq!((&one.owner_changes, &one.color_changes), (&three.owner_changes, &three.color_changes));
    assert_eq!((&one.depth_changes, &one.ranking), (&three.depth_changes, &three.ranking));
    assert_ne!(one.owner_changes, other.owner_changes);
}

#[test]
fn the_ranking_adds_up_and_names_pixels_that_changed() {
    let whole = run(&subject("z-fighting"), FEW, TaskControl::quiet()).unwrap();
    let result = &whole.findings;
    assert!(result.ranking.is_sorted_by(|a, b| a.changes >= b.changes));
    // Each change of owner counts for both triangles, or for one triangle if the other side is the background.
    let changes: u64 = result.owner_changes.pixels().iter().map(|count| u64::from(*count)).sum();
    let shares: u64 = result.ranking.iter().map(|fragile| fragile.changes).sum();
    assert!((changes..=2 * changes).contains(&shares), "{shares} of {changes}");
    for fragile in &result.ranking {
        let (x, y) = fragile.worst_pixel;
        assert_eq!(result.owner_changes.at(x, y), fragile.worst_changes);
        assert!(fragile.worst_changes > 0 && fragile.worst_changes <= FEW.runs);
        assert_eq!(whole.triangle_of(fragile).unwrap().id, fragile.triangle);
    }
}

#[test]
fn the_heat_map_is_dark_exactly_where_nothing_changed() {
    let result = found(&subject("z-fighting"), FEW);
    let (image, most) = picture(&result, Heat::Owner).unwrap();
    assert_eq!(most, result.summary().owner.most);
    for (pixel, count) in image.pixels().iter().zip(result.owner_changes.pixels()) {
        let is_grey = pixel[0] == pixel[1] && pixel[1] == pixel[2];
        assert_eq!(is_grey, *count == 0, "{pixel:?} {count}");
    }
    let settings = Settings { depth_test: DepthTest::Off, ..Settings::default() };
    let without = found(&ProbedView { settings, ..subject("triangle") }, Probe { runs: 1, ..FEW });
    assert!(picture(&without, Heat::Depth).is_none());
}

#[test]
fn a_cancelled_probe_finds_nothing() {
    assert!(
        run(&subject("triangle"), FEW, TaskControl { cancel: &AtomicBool::new(true), ..TaskControl::quiet() })
            .is_none()
    );
}

#[test]
fn each_triangle_has_the_changes_and_the_worst_pixel_of_all_runs() {
    let subject = subject("z-fighting");
    let result = found(&subject, FEW);
    // Counted from complete pictures, one triangle at a time.
    let still = draw::draw_still(&subject).owner;
    let runs: Vec<_> = (0..FEW.runs).map(|run| draw::jittered(&subject, FEW, run).owner).collect();
    let changed = |x, y| runs.iter().filter(|run| run.at(x, y) != still.at(x, y)).count() as u16;
    for fragile in &result.ranking {
        let (mut changes, mut worst) = (0, None::<((u32, u32), u16)>);
        for (x, y) in (0..SIZE.height).flat_map(|y| (0..SIZE.width).map(move |x| (x, y))) {
            let of = |run: &&Image<TriangleId>| {
                let owners = [run.at(x, y), still.at(x, y)];
                owners[0] != owners[1] && owners.contains(&fragile.triangle)
            };
            let here = runs.iter().filter(of).count() as u64;
            changes += here;
            if here > 0 && worst.is_none_or(|(_, most)| changed(x, y) > most) {
                worst = Some(((x, y), changed(x, y)));
            }
        }
        assert_eq!((fragile.changes, Some((fragile.worst_pixel, fragile.worst_changes))), (changes, worst));
    }
}
