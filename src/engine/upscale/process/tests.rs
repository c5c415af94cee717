use std::path::Path;
use std::time::Instant;

use super::*;

/// Time limit for a frame in tests. The limit for the start is five times as long.
const LIMIT: Duration = Duration::from_millis(600);

/// Size of the full picture in pixels.
const SIZE: (u32, u32) = (9, 6);

/// Shell commands that read the opening message and answer it.
const OPEN: &str = "head -c 20 >/dev/null; printf 'RSUPSCAL\\001\\000\\000\\000';";

/// Shell commands that read a frame of 9 × 6 px at ×2 in the format `f32`: 36 + 5 · 3 · 16 bytes.
const READ_F32: &str = "head -c 276 >/dev/null;";

/// Returns an upscaler whose process runs a shell script, which is written to `folder`.
fn shell(folder: &Path, options: &str, script: &str) -> ProcessUpscaler {
    let path = folder.join("upscaler.sh");
    std::fs::write(&path, script).unwrap();
    described(&format!("{options}=sh '{}'", path.display()))
}

fn described(spec: &str) -> ProcessUpscaler {
    ProcessUpscaler::new(&spec.parse().unwrap(), LIMIT)
}

/// Scale and anchor are those of `nearest` at ×2; the process upscaler reads nothing else.
fn how() -> Upscaling {
    Upscaling::new("nearest", 2).unwrap()
}

fn samples() -> Image<Rgba8> {
    Image::from_fn(SIZE.0.div_ceil(2), SIZE.1.div_ceil(2), |x, y| [x as u8, y as u8, 7, 255])
}

fn upscaled(upscaler: &ProcessUpscaler) -> Image<Rgba8> {
    let mut full = Image::filled(SIZE.0, SIZE.1, [9; 4]);
    upscaler.upscale(how(), &UpscaleInputs::from(&samples()), &mut full);
    full
}

/// Asserts that the upscaler fails with a message that contains `words` within a second after `limit`, and that the
/// fallback and later frames need no process.
fn assert_fails(upscaler: &ProcessUpscaler, limit: Duration, words: &str) {
    let nearest = how().upscale(&UpscaleInputs::from(&samples()), SIZE.0, SIZE.1);
    let begun = Instant::now();
    assert_eq!(upscaled(upscaler), nearest, "{words}");
    let elapsed = begun.elapsed();
    assert!(elapsed < limit + Duration::from_secs(1), "{words}: {elapsed:?}");
    let message = upscaler.failure().unwrap_or_default();
    assert!(message.contains(words), "{words}: {message}");
    assert!(message.contains("nearest neighbour"), "{message}");
    let begun = Instant::now();
    assert_eq!(upscaled(upscaler), nearest);
    assert!(begun.elapsed() < Duration::from_millis(200), "no second start: {words}");
}

#[test]
fn a_process_that_cannot_be_started_or_ends_is_reported() {
    let folder = tempfile::tempdir().unwrap();
    assert_fails(&described("x=/no/such/program"), Duration::ZERO, "cannot be started: No such file");
    let ending = shell(folder.path(), "x", "echo first >&2; echo 'no module named net' >&2; exit 3");
    assert_fails(&ending, Duration::ZERO, "exit code 3; last line of its standard error: no module named net");
    let silent = shell(folder.path(), "x", &format!("{OPEN} exit 0"));
    assert_fails(&silent, Duration::ZERO, "exit code 0; it wrote nothing to standard error");
    let killed = shell(folder.path(), "x", &format!("{OPEN} head -c 36 >/dev/null; kill -9 $$"));
    assert_fails(&killed, Duration::ZERO, "signal 9");
}

#[test]
fn a_process_that_hangs_is_stopped_at_the_limit() {
    let folder = tempfile::tempdir().unwrap();
    let hanging = shell(folder.path(), "x", "exec sleep 60");
    assert_fails(&hanging, LIMIT * START_LIMIT, "0 of 12 bytes of the opening answer");
    let late = shell(folder.path(), "x", &format!("{OPEN} exec sleep 60"));
    assert_fails(&late, LIMIT, "within 600ms: 0 of 12 bytes of the header");
    let head = "printf '\\000\\000\\000\\000\\011\\000\\000\\000\\006\\000\\000\\000'";
    let stuck = shell(folder.path(), "x", &format!("{OPEN} {head}; printf abc; exec sleep 60"));
    assert_fails(&stuck, LIMIT, "3 of 216 bytes of the picture");
}

#[test]
fn a_wrong_size_and_an_answer_to_another_frame_are_reported() {
    let folder = tempfile::tempdir().unwrap();
    let head = "printf '\\000\\000\\000\\000\\011\\000\\000\\000\\007\\000\\000\\000'";
    let wrong = shell(folder.path(), "x", &format!("{OPEN} {head}; exec sleep 60"));
    assert_fails(&wrong, Duration::ZERO, "9 × 7 px instead of 9 × 6 px");
    let other = shell(folder.path(), "x", &format!("{OPEN} printf 'hello world!'; exec sleep 60"));
    assert_fails(&other, Duration::ZERO, "instead of 0");
}

#[test]
fn values_that_are_not_numbers_or_out_of_range_are_reported() {
    let folder = tempfile::tempdir().unwrap();
    let head = "printf '\\000\\000\\000\\000\\011\\000\\000\\000\\006\\000\\000\\000'";
    for (value, word) in [("\\000\\000\\300\\177", "NaN;"), ("\\000\\000\\000\\100", "2;")] {
        // Three black channels, the value, and black up to the end: 9 · 6 · 16 bytes.
        let pixels = format!("head -c 12 /dev/zero; printf '{value}'; head -c 848 /dev/zero");
        let bad = shell(folder.path(), "x:f32", &format!("{OPEN} {READ_F32} {head}; {pixels}; exec sleep 60"));
        assert_fails(&bad, Duration::ZERO, &format!("alpha of pixel (0, 0) is {word}"));
    }
}

#[test]
fn anything_else_than_the_header_is_reported() {
    let folder = tempfile::tempdir().unwrap();
    let long = shell(folder.path(), "x", "echo Loading the network, please wait; exec sleep 60");
    assert_fails(&long, Duration::ZERO, "first bytes are `Loading the ");
    let short = shell(folder.path(), "x", "echo hi");
    assert_fails(&short, Duration::ZERO, "first bytes are `hi\\n`");
    let newer = shell(folder.path(), "x", "printf 'RSUPSCAL\\002\\000\\000\\000'; exec sleep 60");
    assert_fails(&newer, Duration::ZERO, "version 2");
}

#[test]
fn one_process_upscales_many_frames_and_is_restarted_only_on_request() {
    let folder = tempfile::tempdir().unwrap();
    let starts = folder.path().join("starts");
    let marker = folder.path().join("works");
    // The first process ends at its first frame. The second one answers every frame with black pixels.
    let script = format!(
        "echo start >>'{0}'; {OPEN} if ! [ -e '{1}' ]; then touch '{1}'; exit 1; fi\n\
         for n in 0 1 2; do head -c 96 >/dev/null; printf \"\\\\00$n\\\\000\\\\000\\\\000\"; \
         printf '\\011\\000\\000\\000\\006\\000\\000\\000'; head -c 216 /dev/zero; done",
        starts.display(),
        marker.display()
    );
    let upscaler = shell(folder.path(), "x", &script);
    assert_fails(&upscaler, Duration::ZERO, "exit code 1");
    upscaler.retry();
    assert_eq!(upscaler.failure(), None);
    for _ in 0..3 {
        assert_eq!(upscaled(&upscaler), Image::filled(SIZE.0, SIZE.1, [0; 4]), "{:?}", upscaler.failure());
    }
    assert_eq!(std::fs::read_to_string(starts).unwrap(), "start\nstart\n");
    assert_fails(&upscaler, Duration::ZERO, "exit code 0");
}

#[test]
fn an_empty_picture_starts_no_process() {
    let upscaler = described("x=/no/such/program");
    let empty = Image::filled(0, 5, [0; 4]);
    upscaler.upscale(how(), &UpscaleInputs::from(&empty), &mut Image::filled(0, 5, [0; 4]));
    assert_eq!(upscaler.failure(), None);
}
