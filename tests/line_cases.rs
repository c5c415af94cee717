//! Lines against answers in exact arithmetic.
#![expect(clippy::print_stderr, reason = "says what was checked")]

mod cases;

use rasterscope::flat2d::line::midpoint_line;

#[test]
fn pixels_are_those_of_the_exact_midpoint_rule() {
    let all = cases::of_class("line");
    for (case, expected) in &all {
        let end = |name: &str| -> (i64, i64) { serde_json::from_value(case[name].clone()).expect("a pixel") };
        let mut pixels: Vec<_> = midpoint_line(end("p0"), end("p1")).collect();
        if case["last_pixel"] == false {
            pixels.pop();
        }
        let exact: Vec<(i64, i64)> = serde_json::from_value(expected["pixels"].clone()).expect("pixels");
        assert_eq!(pixels, exact, "{}", case["id"]);
    }
    eprintln!("{} line cases checked", all.len());
}
