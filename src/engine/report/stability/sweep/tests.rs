use std::sync::atomic::Ordering;
use std::sync::{LazyLock, Mutex};

use super::*;
use crate::case::Case as CaseFile;
use crate::pipeline::settings::{Arithmetic, Rasterizer};
use crate::report::stability::catalogue;
use crate::report::stability::csv::csv;
use crate::report::stability::html::html;
use crate::report::stability::measure::{Expected, answer};
use crate::report::stability::text::text;
use crate::report::stability::tradeoff;

/// Returns a plan for the classes with these ids.
fn plan(classes: &[&str], timed: bool) -> StabilityPlan {
    let classes = classes.iter().map(|id| catalogue::by_id(id).unwrap()).collect();
    StabilityPlan { classes, timed, ..StabilityPlan::default() }
}

fn report(plan: &StabilityPlan) -> StabilityReport {
    run(plan, &|_| {}, &AtomicBool::new(false)).unwrap()
}

/// Returns a report on fast classes without times, computed only once.
fn small() -> &'static StabilityReport {
    static SMALL: LazyLock<StabilityReport> = LazyLock::new(|| {
        let classes = [
            "benign",
            "slivers",
            "mesh-strips",
            "near-crossing",
            "columns",
            "thin",
            "coplanar",
            "depth-thin",
            "depth-published",
        ];
        report(&plan(&classes, false))
    });
    &SMALL
}

fn cell<'a>(report: &'a StabilityReport, class: &str, label: &str) -> &'a ReportCell {
    let class = report.classes.iter().find(|c| c.class.id == class).unwrap();
    class.cells.iter().find(|cell| cell.column.label() == label).unwrap_or_else(|| panic!("no column {label}"))
}

#[test]
fn integers_and_exact_predicates_pass_where_published_methods_do_not() {
    let report = small();
    for class in ["benign", "slivers", "mesh-strips"] {
        for label in ["scanline · fixed", "tiled · exact"] {
            assert_eq!(cell(report, class, label).verdict, Verdict::Pass, "{class} {label}");
        }
        assert_eq!(cell(report, class, "bounding-box-published · f64").verdict, Verdict::Measured, "{class}");
    }
    let published = cell(report, "mesh-strips", "bounding-box-published · f64");
    assert!(published.measures.get(Metric::Seams) > Some(100.0));
    assert!(cell(report, "slivers", "scanline · fixed").measures.get(Metric::WrongUnsnapped) > Some(10.0));
    assert!(cell(report, "thin", "affine · f64").measures.get(Metric::WeightError) > Some(0.1));
    assert!(cell(report, "thin", "perspective · f64").measures.get(Metric::WeightError) < Some(1e-5));
}

#[test]
fn the_worst_cases_show_the_fault_when_they_are_opened_again() {
    let report = small();
    let mut opened = 0;
    for class in &report.classes {
        for cell in &class.cells {
            let Some(worst) = &cell.worst else { continue };
            let case: StabilityCase = serde_json::from_str(&worst.case.to_json()).unwrap();
            let outcome = answer(&case, &Expected::new(&case), cell.column).unwrap();
            let file = CaseFile::parse(worst.case.to_json().as_bytes(), "worst.json".as_ref());
            assert!(file.is_ok(), "{}: {file:?}", class.class.id);
            let faulty = |measures: Option<Measures>| {
                let value = |metric| measures.and_then(|measures| measures.get(metric));
                value(class.class.headline) > Some(0.0) || value(Metric::NotFinite) > Some(0.0)
            };
            // Seams may disappear when a mesh is reduced to a part. All other faults must also appear in the reduced
            // case.
            if class.class.headline != Metric::Seams && faulty(worst.measures) {
                assert!(faulty(outcome.measures), "{}: {}", cell.column.label(), case.to_json());
                opened += 1;
            }
        }
    }
    assert!(opened > 15, "only {opened}");
}

#[test]
fn the_counts_of_the_worst_cases_can_be_recomputed_from_the_complete_cases() {
    let report: serde_json::Value = serde_json::from_str(&serde_json::to_string(small()).unwrap()).unwrap();
    let mut recomputed = 0;
    for (class, written) in small().classes.iter().zip(report["classes"].as_array().unwrap()) {
        let complete: Vec<StabilityCase> = serde_json::from_value(written["worst_cases"].clone()).unwrap();
        for cell in &class.cells {
            let Some(worst) = &cell.worst else { continue };
            let case = complete.iter().find(|case| case.id == worst.of).expect("the complete case is saved");
            let outcome = answer(case, &Expected::new(case), cell.column).unwrap();
            assert_eq!(outcome.measures, worst.measures, "{} {}", worst.of, cell.column.label());
            recomputed += 1;
        }
        let used = |case: &StabilityCase| class.cells.iter().any(|c| c.worst.as_ref().is_some_and(|w| w.of == case.id));
        assert!(complete.iter().all(used), "{}: a case that no cell names", class.class.id);
    }
    assert!(recomputed > 15, "only {recomputed}");
}

#[test]
fn the_same_plan_gives_the_same_report() {
    let plan = plan(&["slivers", "thin"], false);
    let once = report(&plan);
    for (a, b) in once.classes.iter().zip(&report(&plan).classes) {
        assert_eq!(serde_json::to_string(&a.cells).unwrap(), serde_json::to_string(&b.cells).unwrap());
    }
}

#[test]
fn only_what_was_asked_for_is_run() {
    let only = StabilityPlan {
        rasterizers: vec![Rasterizer::Tiled],
        arithmetics: vec![Arithmetic::F64],
        ..plan(&["benign", "thin", "depth-thin"], false)
    };
    let report = report(&only);
    let labels = |class: usize| report.classes[class].cells.iter().map(|cell| cell.column.label()).collect::<Vec<_>>();
    assert_eq!(labels(0), ["tiled · f64"]);
    assert_eq!(labels(1), ["affine · f64", "perspective · f64"]);
    assert_eq!(report.classes[2].cells.len(), ReportColumn::of(Family::Depth).len());
}

#[test]
fn progress_is_reported_to_the_end_and_cancelling_stops_the_run() {
    let heard = Mutex::new(Vec::new());
    let plan = plan(&["benign", "columns"], false);
    run(&plan, &|progress| heard.lock().unwrap().push(progress), &AtomicBool::new(false)).unwrap();
    let heard = heard.into_inner().unwrap();
    let cases: usize = plan.classes.iter().map(|class| class.cases(plan.seed).len()).sum();
    assert_eq!(heard.len(), cases + 1);
    assert!(heard.iter().any(|p| p.done == p.of) && heard.iter().all(|p| p.of == cases));
    assert!(run(&plan, &|_| {}, &AtomicBool::new(true)).is_none());
    let (timed, cancel) = (StabilityPlan { timed: true, ..plan }, AtomicBool::new(false));
    let cancel_timing = |progress: StabilityProgress| {
        cancel.fetch_or(progress.stage == SweepStage::Timing, Ordering::Relaxed);
    };
    let partial = run(&timed, &cancel_timing, &cancel).unwrap();
    assert!(partial.partial && partial.classes.len() == 2, "what was judged stays");
    assert!(partial.classes.iter().flat_map(|class| &class.cells).all(|cell| cell.time.is_none()));
}

#[test]
fn times_and_stiffness_are_measured() {
    let timed = StabilityPlan {
        rasterizers: vec![Rasterizer::BoundingBox, Rasterizer::Scanline],
        arithmetics: vec![Arithmetic::Fixed],
        ..plan(&["benign", "long-slivers", "thin"], true)
    };
    let report = report(&timed);
    assert!(report.timing_noise.is_some_and(|noise| noise.pairs >= 3 && noise.p90 >= 0.0));
    for cell in report.classes.iter().flat_map(|class| &class.cells) {
        let spread = cell.time.unwrap().ns_per_pixel.unwrap();
        assert!(spread.p10 > 0.0 && spread.p10 <= spread.median && spread.median <= spread.p90, "{spread:?}");
    }
    for label in ["bounding-box · fixed", "scanline · fixed"] {
        let cell = cell(&report, "long-slivers", label);
        assert_eq!(cell.measures.get(Metric::Stiffness), cell.time.unwrap().stiffness, "{label}");
        assert!(cell.time.unwrap().stiffness > Some(0.0), "{label}");
    }
    let points = tradeoff::coverage(&report);
    assert_eq!(points.len(), 2);
    assert!(points.iter().any(|point| point.optimal) && points.iter().all(|point| point.by_class.len() == 1));
    assert_eq!(tradeoff::weights(&report).len(), 2);
    assert!(html(&report).contains("Error against time"));
}

#[test]
fn every_format_of_the_report_has_every_cell() {
    let report = small();
    let cells: usize = report.classes.iter().map(|class| class.cells.len()).sum();
    let table = csv(report);
    let widths: Vec<usize> = table.lines().map(|line| line.split(',').count()).collect();
    assert_eq!(widths.len(), cells + 1);
    assert!(widths.iter().all(|width| *width == widths[0]), "{widths:?}");
    let json: serde_json::Value = serde_json::to_value(report).unwrap();
    assert_eq!(json["classes"][0]["cells"][0]["verdict"], "PASS");
    assert_eq!(json["classes"][0]["id"], "benign");
    let (text, page) = (text(report), html(report));
    for class in &report.classes {
        assert!(text.contains(&format!("  {} ", class.class.id)), "{}", class.class.id);
        assert!(page.contains(class.class.name), "{}", class.class.name);
    }
    assert!(text.contains("0 REFUSED"));
    assert!(!page.contains("Error against time"), "there are no times");
}

/// Returns the names of tags that `page` opens without closing, or closes without opening.
fn unbalanced(page: &str) -> Vec<String> {
    /// Void tags, which have no end tag.
    const VOID: [&str; 2] = ["meta", "!doctype"];
    let mut open: Vec<String> = Vec::new();
    let mut faults = Vec::new();
    for tag in page.split('<').skip(1) {
        let tag = tag.split('>').next().unwrap_or_default();
        let name: String =
            tag.trim_start_matches('/').chars().take_while(|c| !c.is_whitespace() && *c != '/').collect();
        if VOID.contains(&name.as_str()) || tag.ends_with('/') {
            continue;
        }
        if !tag.starts_with('/') {
            open.push(name);
        } else if open.pop().as_ref() != Some(&name) {
            faults.push(name);
        }
    }
    faults.extend(open);
    faults
}

#[test]
fn the_page_is_well_formed_and_loads_nothing() {
    let page = html(small());
    assert_eq!(unbalanced(&page), Vec::<String>::new());
    assert_eq!(unbalanced("<p><b></p>"), ["p", "p"]);
    for foreign in ["<script", "http://", "https://", "@import", "url("] {
        assert!(!page.contains(foreign), "{foreign}");
    }
    // Every link points to a case on the page.
    let targets = page.split("href=\"#").skip(1).map(|rest| rest.split('"').next().unwrap());
    let mut links = 0;
    for target in targets {
        assert!(page.contains(&format!("<details id=\"{target}\">")), "{target}");
        links += 1;
    }
    assert!(links > 20, "{links}");
}
