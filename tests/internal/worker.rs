//! Tests of the renderer thread: newest request first, no work when idle, measurements in rounds.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

use rasterscope::chain::{Recipe, run};
use rasterscope::inspect::Buffer;
use rasterscope::measure::metric::Metric;
use rasterscope::measure::motion::Turn;
use rasterscope::measure::reference::Reference;
use rasterscope::pipeline::viewport::Viewport;
use rasterscope::scene::SceneSource;
use rasterscope::ui::engine::{Look, Request, Shown};
use rasterscope::ui::session::timings::request::MeasureRequest;
use rasterscope::ui::worker::{MEASURE_ROUNDS, Worker, WorkerRequest, WorkerResponse};
use rasterscope::upscale::Upscaling;

/// Time limit of an answer, sufficient for a busy machine.
const TIMEOUT: Duration = Duration::from_secs(180);

fn request(scene: &str, (width, height): (u32, u32)) -> Request {
    let scene = SceneSource::named(scene.into()).load().unwrap().scene;
    Request {
        camera: scene.home,
        scene: Arc::new(scene),
        sequence: None,
        is_replayed: false,
        recipe: Recipe::default(),
        viewport: Viewport { width, height },
        shown: Shown::Buffer(Buffer::Color),
        triangle_limit: None,
        fragment_limit: None,
        pick: None,
        look: Look::default(),
    }
}

fn show(request: &Request) -> WorkerRequest {
    WorkerRequest::Show(Box::new(request.clone()))
}

fn measure(of: Request, turn: Turn) -> WorkerRequest {
    WorkerRequest::Measure(Box::new(MeasureRequest {
        number: 1,
        of,
        reference: Reference::Native,
        turn,
        metric: Metric::Flip,
    }))
}

/// Returns the answers up to and including the first that `last` accepts. Panics after [`TIMEOUT`].
fn answers_until(worker: &mut Worker, last: impl Fn(&WorkerResponse) -> bool) -> Vec<WorkerResponse> {
    let start = Instant::now();
    let mut answers = Vec::new();
    while start.elapsed() < TIMEOUT {
        match worker.poll() {
            Some(answer) => {
                answers.push(answer);
                if answers.last().is_some_and(&last) {
                    return answers;
                }
            }
            None => std::thread::sleep(Duration::from_millis(1)),
        }
    }
    panic!("no such answer among {}", answers.len());
}

/// Returns all answers that arrive within `time`.
fn answers_within(worker: &mut Worker, time: Duration) -> Vec<WorkerResponse> {
    std::thread::sleep(time);
    std::iter::from_fn(|| worker.poll()).collect()
}

#[test]
fn a_request_is_answered_with_its_frame_and_then_its_stage_times() {
    let mut worker = Worker::spawn(|| ());
    let request = request("triangle", (64, 48));
    worker.send(show(&request));
    let answers = answers_until(&mut worker, |answer| matches!(answer, WorkerResponse::Stages(_)));
    let [WorkerResponse::View(view), WorkerResponse::Stages(figures)] = &answers[..] else {
        panic!("{} answers", answers.len())
    };
    let expected = run(&request.scene, &request.camera, &request.recipe, request.viewport, &mut ());
    assert_eq!(*view.picture, *expected.image());
    assert!(view.fresh);
    assert!(figures.times.rasterize > Duration::ZERO);
}

#[test]
fn a_still_view_is_redrawn_until_it_has_converged() {
    let mut worker = Worker::spawn(|| ());
    let mut request = request("cubes", (64, 48));
    let native = run(&request.scene, &request.camera, &request.recipe, request.viewport, &mut ());
    request.recipe.upscaler = Upscaling::new("checkerboard-temporal", 1).unwrap();
    worker.send(show(&request));
    let answers = answers_until(&mut worker, |answer| matches!(answer, WorkerResponse::Stages(_)));
    let [WorkerResponse::View(first), WorkerResponse::View(second), WorkerResponse::Stages(_)] = &answers[..] else {
        panic!("{} answers", answers.len())
    };
    assert_ne!(*first.picture, *native.image());
    assert_eq!(*second.picture, *native.image());
    assert!(answers_within(&mut worker, Duration::from_millis(300)).is_empty());
}

#[test]
fn only_the_newest_of_the_waiting_requests_is_answered() {
    let mut worker = Worker::spawn(|| ());
    let busy = request("chess", (640, 480));
    worker.send(show(&busy));
    // When these requests arrive, the thread is busy with the first request or has not started it.
    let mut newest = request("triangle", (32, 32));
    for x in 0..50 {
        newest.pick = Some((x % 32, 7));
        worker.send(show(&newest));
    }
    let is_newest =
        |answer: &WorkerResponse| matches!(answer, WorkerResponse::View(view) if view.request.same_view(&newest));
    let answers = answers_until(&mut worker, is_newest);
    let views = answers.iter().filter(|answer| matches!(answer, WorkerResponse::View(_))).count();
    assert!(views <= 3, "{views} of 51 requests were answered");
    assert!(
        answers_within(&mut worker, Duration::from_millis(300)).iter().all(|a| matches!(a, WorkerResponse::Stages(_)))
    );
}

#[test]
fn the_window_is_woken_for_every_answer() {
    let wakes = Arc::new(AtomicUsize::new(0));
    let counter = wakes.clone();
    let mut worker = Worker::spawn(move || {
        counter.fetch_add(1, Ordering::SeqCst);
    });
    assert_eq!(wakes.load(Ordering::SeqCst), 0);
    worker.send(show(&request("triangle", (16, 16))));
    answers_until(&mut worker, |answer| matches!(answer, WorkerResponse::Stages(_)));
    std::thread::sleep(Duration::from_millis(100));
    assert_eq!(wakes.load(Ordering::SeqCst), 2, "once for the view, once for its stage times");
}

#[test]
fn an_idle_worker_does_nothing() {
    let wakes = Arc::new(AtomicUsize::new(0));
    let counter = wakes.clone();
    let mut worker = Worker::spawn(move || {
        counter.fetch_add(1, Ordering::SeqCst);
    });
    worker.send(show(&request("triangle", (16, 16))));
    answers_until(&mut worker, |answer| matches!(answer, WorkerResponse::Stages(_)));
    std::thread::sleep(Duration::from_millis(100));
    let before = wakes.load(Ordering::SeqCst);
    assert!(answers_within(&mut worker, Duration::from_millis(300)).is_empty());
    assert_eq!(wakes.load(Ordering::SeqCst), before);
}

#[test]
fn another_pick_keeps_the_frame() {
    let mut worker = Worker::spawn(|| ());
    let mut request = request("triangle", (64, 48));
    worker.send(show(&request));
    let is_view = |answer: &WorkerResponse| matches!(answer, WorkerResponse::View(_));
    let first = answers_until(&mut worker, is_view).pop();
    request.pick = Some((32, 24));
    worker.send(show(&request));
    let second = answers_until(&mut worker, is_view).pop();
    let (Some(WorkerResponse::View(first)), Some(WorkerResponse::View(second))) = (first, second) else {
        panic!("two views")
    };
    assert!(Arc::ptr_eq(&first.frame, &second.frame) && Arc::ptr_eq(&first.picture, &second.picture));
    assert!(!second.fresh);
    assert_eq!(second.report.as_ref().map(|report| (report.x, report.y)), Some((32, 24)));
}

#[test]
fn a_measurement_times_every_method_once_per_round() {
    let mut worker = Worker::spawn(|| ());
    worker.send(measure(request("triangle", (32, 24)), Turn { degrees: 0.5, frames: 2, ..Turn::STILL }));
    let answers = answers_until(&mut worker, |answer| matches!(answer, WorkerResponse::Measured(_)));
    let samples: Vec<_> = answers
        .iter()
        .filter_map(|answer| match answer {
            WorkerResponse::Sample { upscaling, milliseconds, progress, .. } => {
                Some((*upscaling, *milliseconds, *progress))
            }
            _ => None,
        })
        .collect();
    let methods: Vec<_> = Upscaling::every().collect();
    assert_eq!(samples.len(), MEASURE_ROUNDS * methods.len());
    let mut sorted = methods.clone();
    sorted.sort_unstable();
    for round in samples.chunks(methods.len()) {
        let mut of: Vec<_> = round.iter().map(|(upscaling, ..)| *upscaling).collect();
        of.sort_unstable();
        assert!(of.into_iter().eq(sorted.iter().copied()), "{round:?}");
    }
    let progress = answers.iter().filter_map(|answer| match answer {
        WorkerResponse::Sample { progress, .. } | WorkerResponse::MethodError { progress, .. } => Some(*progress),
        _ => None,
    });
    let progress: Vec<_> = progress.collect();
    assert!(progress.is_sorted(), "progress grows");
    assert!(progress.last() > Some(&0.99), "all but frames without news: {:?}", progress.last());
    assert!(samples.iter().all(|sample| sample.1 > 0.0));
    let noises =
        answers.iter().filter(|answer| matches!(answer, WorkerResponse::Noise { noise, .. } if noise.pairs >= 5));
    assert_eq!(noises.count(), MEASURE_ROUNDS, "a noise floor after each round");
    for method in methods {
        let of_method = answers.iter().filter_map(|answer| match answer {
            WorkerResponse::MethodError { upscaling, error, .. } if *upscaling == method => Some(error.motion.frames),
            _ => None,
        });
        assert_eq!(of_method.collect::<Vec<_>>(), [1, 2], "{}: frame by frame", method.label());
    }
}

#[test]
fn every_method_has_a_provisional_point_before_the_first_round() {
    let mut worker = Worker::spawn(|| ());
    let mut of = request("chess-motion", (32, 24));
    of.recipe.upscaler = Upscaling::new("taa", 2).unwrap();
    worker.send(measure(of, Turn::default()));
    let answers = answers_until(&mut worker, |answer| matches!(answer, WorkerResponse::Sample { .. }));
    let points = answers.iter().filter_map(|answer| match answer {
        WorkerResponse::MethodError { upscaling, error, milliseconds, .. } => {
            assert!(*milliseconds > 0.0);
            Some((*upscaling, error.motion.frames))
        }
        _ => None,
    });
    let points: Vec<_> = points.collect();
    let methods = Upscaling::every().count();
    assert!(points[..methods].iter().all(|(_, frames)| *frames == 1), "one frame of each");
    let mut first: Vec<_> = points[..methods].iter().map(|(upscaling, _)| *upscaling).collect();
    let reads_history: Vec<_> = first.iter().map(|upscaling| upscaling.upscaler().reads().history).collect();
    assert!(reads_history.is_sorted(), "methods that draw many frames before are last");
    let temporal = reads_history.iter().position(|reads| *reads).unwrap();
    assert_eq!(first[temporal], Upscaling::new("taa", 2).unwrap(), "the selected method is the first of them");
    first.sort_unstable();
    assert!(first.windows(2).all(|pair| pair[0] < pair[1]), "each method once");
}

#[test]
fn a_cancelled_measurement_stops_and_the_worker_continues() {
    let mut worker = Worker::spawn(|| ());
    worker.send(measure(request("chess", (160, 120)), Turn::default()));
    answers_until(&mut worker, |answer| matches!(answer, WorkerResponse::Sample { .. }));
    worker.send(WorkerRequest::CancelMeasure);
    let wanted = request("triangle", (16, 16));
    worker.send(show(&wanted));
    let answers = answers_until(&mut worker, |answer| matches!(answer, WorkerResponse::Stages(_)));
    assert!(!answers.iter().any(|answer| matches!(answer, WorkerResponse::Measured(_))));
    assert!(answers_within(&mut worker, Duration::from_millis(300)).is_empty(), "no samples after cancelling");
}

#[test]
fn requests_take_precedence_over_measuring() {
    let mut worker = Worker::spawn(|| ());
    let measured = request("chess", (32, 24));
    worker.send(measure(measured, Turn::default()));
    answers_until(&mut worker, |answer| matches!(answer, WorkerResponse::Sample { .. }));
    worker.send(show(&request("triangle", (16, 16))));
    let answers = answers_until(&mut worker, |answer| matches!(answer, WorkerResponse::View(_)));
    assert!(answers.len() <= 4, "{} samples were taken first", answers.len() - 1);
}

#[test]
fn the_inline_worker_gives_the_same_answers_synchronously() {
    let request = request("triangle", (64, 48));
    let mut inline = Worker::inline();
    inline.send(show(&request));
    let answers: Vec<_> = std::iter::from_fn(|| inline.poll()).collect();
    let [WorkerResponse::View(view), WorkerResponse::Stages(_)] = &answers[..] else {
        panic!("{} answers", answers.len())
    };
    let mut threaded = Worker::spawn(|| ());
    threaded.send(show(&request));
    let other = answers_until(&mut threaded, |answer| matches!(answer, WorkerResponse::View(_))).pop();
    assert!(matches!(other, Some(WorkerResponse::View(other)) if other.picture == view.picture));
}
