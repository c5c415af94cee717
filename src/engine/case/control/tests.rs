use std::cell::RefCell;
use std::time::{Duration, Instant};

use super::*;
use crate::case::{
    AttributeVertex, Case, ClipTri, CoplanarPair, Exactly, Float, Options, Real, Task, TriAttr, TriCoverage, Upscale,
};
use crate::case::{answer, solve};
use crate::image::Image;
use crate::pipeline::settings::FillRule;

/// Returns a JSON list that repeats `item` `count` times.
fn list(count: usize, item: &str) -> String {
    format!("[{}]", vec![item; count].join(","))
}

/// Returns a case of the given kind with enough work for several progress reports.
fn case(kind: &str) -> Case {
    let vertices = list(3, r#"{"x":1,"y":1,"z":0,"w":1,"u":0,"v":0}"#);
    let vertices = vertices.replacen("\"x\":1", "\"x\":9", 1).replacen("\"y\":1", "\"y\":9", 2);
    let fields = match kind {
        "tri_coverage" => {
            let triangles = list(50, "[[0,0],[60,0],[0,200]]");
            format!(r#""width":64,"height":200,"rule":"top_left","triangles":{triangles}"#)
        }
        "poly_fill" => r#""width":64,"height":500,"rule":"even_odd","contours":[[[0,0],[60,0],[0,500]]]"#.to_owned(),
        "tri_attr" => format!(r#""vertices":{vertices},"eval":{}"#, list(9_000, "[3,4]")),
        "coplanar_pair" => format!(r#""first":{vertices},"second":{vertices},"eval":{}"#, list(5_000, "[3,4]")),
        "clip_tri" => {
            let triangles = list(50, "[[-1,-1,0.5,1],[1,-1,0.5,1],[-1,1,0.5,1]]");
            format!(r#""width":32,"height":32,"triangles":{triangles}"#)
        }
        "tri_area" => r#""width":100,"height":100,"triangle":[[0,0],[90,10],[10,90]]"#.to_owned(),
        "line" => r#""p0":[0,0],"p1":[9000,70],"last_pixel":true"#.to_owned(),
        "real_line" => r#""p0":[0.5,0.25],"p1":[9000,70]"#.to_owned(),
        "distance_line" => r#""width":100,"height":100,"p0":[0,0],"p1":[99,90]"#.to_owned(),
        "circle" => r#""c":[0,0],"r":2000"#.to_owned(),
        "ellipse" => r#""c":[0,0],"a":2000,"b":1000"#.to_owned(),
        "region_fill" => {
            let grid = list(64, &list(64, "0"));
            format!(r#""grid":{grid},"seed":[3,3],"mode":"flood","connectivity":4,"new":1"#)
        }
        "depth" => {
            format!(r#""mapping":"standard","format":"f32","near":1,"far":3,"z":{}"#, list(9_000, "2"))
        }
        "texture" => {
            format!(r#""texels":[[0,255]],"filter":"bilinear","address":"wrap","uv":{}"#, list(9_000, "[0.3,0.1]"))
        }
        "upscale" => {
            let image = list(40, &list(40, "7"));
            format!(r#""image":{image},"scale":2,"kernel":"bilinear","phase":"corner""#)
        }
        _ => panic!("a case of the kind `{kind}` is missing here"),
    };
    let json = format!(r#"{{"id":"x","kind":"{kind}",{fields}}}"#);
    Case::parse(json.as_bytes(), "x.json".as_ref()).unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn every_kind_reports_its_progress() {
    for kind in Task::KINDS {
        let shares = RefCell::new(Vec::new());
        let report_progress = |share| shares.borrow_mut().push(share);
        let never = AtomicBool::new(false);
        answer(&case(kind), Options::default(), &Control::new(&report_progress, &never)).unwrap();
        let shares = shares.into_inner();
        assert!(shares.len() >= 3, "{kind}: {shares:?}");
        assert!(shares.is_sorted() && shares.iter().all(|share| (0.0..=1.0).contains(share)), "{kind}: {shares:?}");
    }
}

#[test]
fn every_kind_can_be_cancelled_in_the_middle() {
    for kind in Task::KINDS {
        let reports = Cell::new(0);
        let stop = AtomicBool::new(false);
        let report_progress = |_| {
            reports.set(reports.get() + 1);
            stop.store(true, Ordering::Relaxed);
        };
        let case = case(kind);
        assert!(solve(&case, Options::default(), &Control::new(&report_progress, &stop)).is_none(), "{kind}");
        assert_eq!(reports.get(), 1, "{kind} goes on after it was cancelled");
        assert!(solve(&case, Options::default(), &Control::default()).is_some(), "{kind}");
    }
}

/// Returns one case for each kind that can have a large answer to a small input. Each answer exceeds the memory limit.
fn too_large() -> Vec<(&'static str, Task)> {
    let large = Exactly([[0.0, 0.0], [16384.0, 3.0], [5.0, 2048.0]].map(|corner| Exactly(corner.map(Float))));
    let front =
        Exactly([[-1.0, -1.0, 0.5, 1.0], [1.0, -1.0, 0.5, 1.0], [-1.0, 1.0, 0.5, 1.0]].map(|c| Exactly(c.map(Float))));
    let vertex = |x: f32, y: f32| {
        let [x, y, z, w, u, v] = [x, y, 0.0, 1.0, 0.0, 0.0].map(Float);
        AttributeVertex { x, y, z, w, u, v }
    };
    let vertices = Exactly([vertex(0.0, 0.0), vertex(9.0, 0.0), vertex(0.0, 9.0)]);
    let (width, height) = (16_384, 2_048);
    let json = |kind: &'static str, fields: &str| {
        let json = format!(r#"{{"id":"x","kind":"{kind}",{fields}}}"#);
        let case = Case::parse(json.as_bytes(), "x.json".as_ref()).unwrap_or_else(|error| panic!("{error}"));
        (kind, case.task)
    };
    let eval = vec![Exactly([1, 1]); 2_400_000];
    let triangles = vec![large; 20_000];
    let image = Image::filled(2_048, 1_024, Real(0.0));
    let (scale, kernel, phase) = (Real(4.0), "lanczos3".to_owned(), "corner".to_owned());
    vec![
        ("tri_coverage", Task::TriCoverage(TriCoverage { width, height, rule: FillRule::TopLeft, triangles })),
        ("clip_tri", Task::ClipTri(ClipTri { width, height, triangles: vec![front; 2] })),
        ("tri_attr", Task::TriAttr(TriAttr { vertices, eval: eval.clone() })),
        ("coplanar_pair", Task::CoplanarPair(CoplanarPair { first: vertices, second: vertices, eval })),
        ("upscale", Task::Upscale(Upscale { image, scale, kernel, phase })),
        json("tri_area", r#""width":16384,"height":2048,"triangle":[[0,0],[32768,0],[0,4096]]"#),
        json("line", r#""p0":[0,0],"p1":[90000000,7],"last_pixel":false"#),
        json("real_line", r#""p0":[0.5,0],"p1":[90000000,7]"#),
        json("circle", r#""c":[0,0],"r":4000000000"#),
        json("ellipse", r#""c":[0,0],"a":4,"b":4000000000"#),
    ]
}

#[test]
fn answers_beyond_the_limit_are_refused_quickly_and_name_the_limit() {
    for (kind, task) in too_large() {
        let begun = Instant::now();
        let refusal = answer(&Case { id: "x".to_owned(), task }, Options::default(), &Control::default());
        let reason = refusal.expect_err(kind).to_string();
        assert!(reason.starts_with("the answer has more than ") && reason.ends_with("the limit"), "{reason}");
        // Nearly all refusals take milliseconds. Without the limit, computing an answer took up to minutes and
        // gigabytes.
        assert!(begun.elapsed() < Duration::from_secs(10), "{kind}: {:?}", begun.elapsed());
    }
}
