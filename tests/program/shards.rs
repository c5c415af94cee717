//! Experiments divided into shards: merged parts give what one run gives, and parts that do not fit are refused by name.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use rasterscope::explain;
use rasterscope::image::{Image, file};
use serde_json::Value;
use tempfile::TempDir;

/// Numbers of shards that are merged.
const COUNTS: [usize; 3] = [1, 4, 7];

/// Small stability report: cases of three classes, of which one is a depth class.
const STABILITY: [&str; 14] = [
    "stability",
    "--class",
    "needles",
    "--class",
    "benign",
    "--class",
    "depth-thin",
    "--rasterizer",
    "scanline",
    "--rasterizer",
    "scanline-published",
    "--arithmetic",
    "fixed",
    "--untimed",
];

/// Stability report of one class, without times.
const NEEDLES: [&str; 8] =
    ["stability", "--class", "needles", "--rasterizer", "scanline", "--arithmetic", "fixed", "--untimed"];

const PROBE: [&str; 10] = ["probe", "z-fighting", "--size", "80x50", "--ulps", "32", "--runs", "9", "--seed", "7"];

const REPORT: [&str; 9] = ["report", "triangle", "shared-edges", "--size", "16x12", "--rounds", "1", "--turn", "0"];

fn run(folder: &Path, args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_rasterscope")).args(args).current_dir(folder).output().unwrap()
}

/// Runs the program, which must succeed, and returns its standard output.
#[track_caller]
fn output(folder: &Path, args: &[&str]) -> String {
    let output = run(folder, args);
    assert!(output.status.success(), "{args:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

fn folder() -> TempDir {
    tempfile::tempdir().unwrap()
}

fn read(folder: &Path, name: &str) -> String {
    fs::read_to_string(folder.join(name)).unwrap()
}

fn json(text: &str) -> Value {
    serde_json::from_str(text).unwrap()
}

/// Runs all shards of an experiment, and returns the names of their parts.
#[track_caller]
fn parts(folder: &Path, experiment: &[&str], count: usize) -> Vec<String> {
    let part = |index: usize| {
        let (shard, name) = (format!("{index}/{count}"), format!("part-{index}-of-{count}.json"));
        output(folder, &[experiment, &["--shard", &shard, "-o", &name]].concat());
        name
    };
    (1..=count).map(part).collect()
}

fn merge(folder: &Path, parts: &[String], to: &str) -> Output {
    let parts = parts.iter().map(String::as_str);
    run(folder, &["merge"].into_iter().chain(parts).chain(["-o", to]).collect::<Vec<_>>())
}

/// Runs an experiment in 1, 4 and 7 shards, merges the parts in reverse order, and calls `check` with each folder.
#[track_caller]
fn for_each_division(folder: &Path, experiment: &[&str], check: impl Fn(&Path)) {
    for count in COUNTS {
        let mut parts = parts(folder, experiment, count);
        parts.reverse();
        let merged = merge(folder, &parts, &format!("merged-{count}"));
        assert!(merged.status.success(), "{count}: {}", String::from_utf8_lossy(&merged.stderr));
        check(&folder.join(format!("merged-{count}")));
    }
}

/// Changes a part in place.
fn edit(folder: &Path, name: &str, change: impl FnOnce(&mut Value)) {
    let mut part = json(&read(folder, name));
    change(&mut part);
    fs::write(folder.join(name), part.to_string()).unwrap();
}

/// Checks that merging fails with one sentence that contains all of `words`, and writes nothing.
#[track_caller]
fn assert_refused(folder: &Path, parts: &[String], words: &[&str]) {
    let refused = merge(folder, parts, "refused");
    let message = String::from_utf8(refused.stderr).unwrap();
    assert_eq!((refused.status.code(), message.lines().count()), (Some(2), 1), "{message}");
    assert!(words.iter().all(|word| message.contains(word)), "not all of {words:?} in: {message}");
    assert!(refused.stdout.is_empty() && !folder.join("refused").exists());
}

#[test]
fn merged_stability_reports_equal_that_of_one_run() {
    let folder = folder();
    let in_form = |form: &[&str]| output(folder.path(), &[&STABILITY[..], form].concat());
    let (text, csv) = (in_form(&[]), in_form(&["--csv"]));
    let without_header = |text: &str| text.split_once('\n').unwrap().1.to_owned();
    let without_machine = |text: &str| {
        let mut report = json(text);
        assert!(report["duration"].is_f64() && report["machine"]["threads"].is_u64());
        let fields = report.as_object_mut().unwrap();
        assert!(fields.remove("machine").is_some() && fields.remove("duration").is_some());
        report
    };
    let whole = without_machine(&in_form(&["--json"]));
    for_each_division(folder.path(), &STABILITY, |merged| {
        assert_eq!(without_header(&read(merged, "stability.txt")), without_header(&text));
        assert_eq!(read(merged, "stability.csv"), csv);
        assert_eq!(without_machine(&read(merged, "stability.json")), whole);
        assert!(read(merged, "stability.html").starts_with("<!doctype html>"));
    });
}

#[test]
fn every_class_is_timed_by_one_shard_and_its_machine_is_named_if_there_are_several() {
    let folder = folder();
    let timed = &STABILITY[..13];
    let parts = parts(folder.path(), timed, 2);
    assert!(merge(folder.path(), &parts, "one").status.success());
    let report = json(&read(&folder.path().join("one"), "stability.json"));
    let classes = report["classes"].as_array().unwrap();
    for cell in classes.iter().flat_map(|class| class["cells"].as_array().unwrap()) {
        assert!(cell["time"]["rounds"].as_u64() >= Some(5), "{cell}");
    }
    assert!(classes.iter().all(|class| class.get("machine").is_none()));
    assert!(report["timing_noise"]["pairs"].as_u64() >= Some(3));
    edit(folder.path(), &parts[1], |part| part["run"]["machine"]["host"] = "node-7".into());
    assert!(merge(folder.path(), &parts, "two").status.success());
    let two = folder.path().join("two");
    let report = json(&read(&two, "stability.json"));
    assert_eq!(report["machines"].as_array().unwrap().len(), 2);
    let is_on_node: Vec<bool> = report["classes"]
        .as_array()
        .unwrap()
        .iter()
        .map(|class| class["machine"].as_str().unwrap().starts_with("node-7: "))
        .collect();
    assert_eq!(is_on_node, [false, true, false], "classes are timed in turn");
    let csv = read(&two, "stability.csv");
    assert!(csv.lines().next().unwrap().ends_with(",rounds,machine"), "{csv}");
    assert!(csv.lines().filter(|line| line.contains(",benign,")).all(|line| line.contains("\"node-7: ")));
    for name in ["stability.txt", "stability.html"] {
        assert!(read(&two, name).contains("node-7: "), "{name}");
    }
}

#[test]
fn merged_probes_equal_that_of_one_run() {
    let folder = folder();
    let (text, json) = (output(folder.path(), &PROBE), output(folder.path(), &[&PROBE[..], &["--json"]].concat()));
    let heats = ["owner", "depth", "color"];
    for heat in heats {
        let name = format!("heat-{heat}.png");
        output(folder.path(), &[&PROBE[..], &["--heat", heat, "-o", &name]].concat());
    }
    for_each_division(folder.path(), &PROBE, |merged| {
        assert_eq!((read(merged, "probe.txt"), read(merged, "probe.json")), (text.clone(), json.clone()));
        for name in heats.map(|heat| format!("heat-{heat}.png")) {
            assert_eq!(file::read(&merged.join(&name)).unwrap(), file::read(&folder.path().join(&name)).unwrap());
        }
    });
}

#[test]
fn merged_error_reports_have_the_errors_of_one_run() {
    let folder = folder();
    output(folder.path(), &[&REPORT[..], &["-o", "whole"]].concat());
    /// Returns the report without times and what depends on them.
    fn untimed(folder: &Path) -> Value {
        let mut report = json(&read(folder, "report.json"));
        report.as_object_mut().unwrap().retain(|key, _| key != "machine");
        for scene in report["scenes"].as_array_mut().unwrap() {
            scene.as_object_mut().unwrap().retain(|key, _| !["noise", "shares"].contains(&&key[..]));
            for row in scene["rows"].as_array_mut().unwrap() {
                let times =
                    ["frame_ms", "parts_ms", "native_ms", "dominated_by", "within_noise_of", "native_within_noise"];
                row.as_object_mut().unwrap().retain(|key, _| !times.contains(&&key[..]));
            }
        }
        report
    }
    let whole = untimed(&folder.path().join("whole"));
    assert!(whole["scenes"][1]["rows"][5]["error"]["flip"].as_f64() > Some(0.0));
    let pictures = |folder: &Path| {
        let page = read(folder, "index.html");
        page.split("src=\"data:image/png;base64,").skip(1).map(|text| text[..64].to_owned()).collect::<Vec<_>>()
    };
    for_each_division(folder.path(), &REPORT, |merged| {
        assert_eq!(untimed(merged), whole);
        assert_eq!(pictures(merged), pictures(&folder.path().join("whole")));
        let report = json(&read(merged, "report.json"));
        for scene in report["scenes"].as_array().unwrap() {
            assert_eq!(scene["shares"].as_array().unwrap().len(), 5, "measured by one of the shards");
            for row in scene["rows"].as_array().unwrap() {
                assert!(row["native_ms"]["frame"].as_f64() > Some(0.0) && row["frame_ms"]["n"] == 1, "{row}");
            }
        }
    });
}

#[test]
fn rows_of_other_machines_are_compared_by_their_ratio_to_native_rendering() {
    let folder = folder();
    let parts = parts(folder.path(), &REPORT, 2);
    // A machine that is exactly a thousand times slower changes no speed-up and no ranking.
    let slow = |part: &mut Value, factor: f64| {
        let scale = |value: &mut Value| *value = (value.as_f64().unwrap() * factor).into();
        for scene in part["run"]["results"]["scenes"].as_array_mut().unwrap() {
            for row in scene["rows"].as_object_mut().unwrap().values_mut() {
                for times in ["frame_ms", "native_ms", "parts_ms"] {
                    row[times].as_object_mut().unwrap().values_mut().filter(|time| time.is_f64()).for_each(scale);
                }
            }
        }
        part["run"]["machine"]["host"] = "slow".into();
    };
    let report = |to: &str| {
        assert!(merge(folder.path(), &parts, to).status.success());
        json(&read(&folder.path().join(to), "report.json"))
    };
    let before = report("before");
    edit(folder.path(), &parts[1], |part| slow(part, 1024.0));
    let after = report("after");
    let standing = |report: &Value| -> Vec<Value> {
        let rows = report["scenes"].as_array().unwrap().iter().flat_map(|scene| scene["rows"].as_array().unwrap());
        rows.flat_map(|row| ["dominated_by", "within_noise_of", "native_within_noise"].map(|key| row[key].clone()))
            .collect()
    };
    assert_eq!(standing(&before), standing(&after));
    let rows = after["scenes"][0]["rows"].as_array().unwrap();
    for (index, row) in rows.iter().enumerate() {
        assert_eq!(row["machine"].as_str().unwrap().starts_with("slow: "), index % 2 == 1, "{index}");
    }
    let merged = folder.path().join("after");
    let csv = read(&merged, "report.csv");
    assert!(csv.lines().next().unwrap().ends_with(",native_ms,machine"));
    assert!(csv.lines().nth(2).unwrap().contains(",\"slow: "));
    let page = read(&merged, "index.html");
    assert!(page.contains("<th class=\"words\">machine</th>") && page.contains("as multiples of it"), "{page}");
}

#[test]
fn merged_explanations_of_a_folder_equal_those_of_one_run() {
    let folder = folder();
    let theirs = folder.path().join("theirs");
    fs::create_dir(&theirs).unwrap();
    output(folder.path(), &["render", "triangle", "--size", "32x18", "-o", "theirs/a.png"]);
    output(folder.path(), &["render", "triangle", "--size", "32x18", "--set", "wireframe=true", "-o", "theirs/c.png"]);
    let ours = file::read(&theirs.join("a.png")).unwrap();
    let flipped = Image::from_fn(32, 18, |x, y| ours.at(x, 17 - y));
    file::write_png(&theirs.join("b.png"), &flipped).unwrap();
    fs::write(theirs.join("notes.txt"), "not a picture").unwrap();
    // Few faults, because the search draws them all.
    let considered = ["flip-vertical", "red-blue-swapped", "blurred"];
    let without =
        explain::ALL.iter().filter(|fault| !considered.contains(&fault.id)).flat_map(|fault| ["--without", fault.id]);
    let explain: Vec<&str> = ["explain", "theirs", "triangle", "--at", "16,9"].into_iter().chain(without).collect();
    let (text, whole) = (output(folder.path(), &explain), output(folder.path(), &[&explain[..], &["--json"]].concat()));
    let report = json(&whole);
    let named =
        |key: &str| report["pictures"].as_array().unwrap().iter().map(|one| one[key].clone()).collect::<Vec<_>>();
    assert_eq!(named("picture"), ["a.png", "b.png", "c.png"]);
    assert_eq!(named("confidence"), ["agrees", "complete", "unknown"]);
    assert_eq!(report["pictures"][1]["causes"][0]["fault"], "flip-vertical");
    let mut alone = explain.clone();
    alone[1] = "theirs/b.png";
    let alone = json(&output(folder.path(), &[&alone[..], &["--json"]].concat()));
    for (key, value) in alone.as_object().unwrap() {
        assert_eq!(report["pictures"][1][key], *value, "{key}");
    }
    assert!(text.contains("b.png\n") && text.matches("pixel 16,9: theirs ").count() == 3, "{text}");
    for_each_division(folder.path(), &explain, |merged| {
        assert_eq!(read(merged, "explanations.txt"), text);
        assert_eq!(read(merged, "explanations.json"), whole);
    });
    output(folder.path(), &[&explain[..], &["-o", "drawings"]].concat());
    for name in ["a.png/ours.png", "b.png/ours-with-faults.png", "c.png/unexplained.png"] {
        assert!(folder.path().join("drawings").join(name).exists(), "{name}");
    }
}

#[test]
fn parts_that_do_not_fit_are_refused_by_name() {
    let folder = folder();
    let folder = folder.path();
    let parts = parts(folder, &NEEDLES, 3);
    let [first, second, third] = [0, 1, 2].map(|index| parts[index].clone());
    let copy = |from: &str, to: &str| assert!(fs::copy(folder.join(from), folder.join(to)).is_ok());

    assert_refused(folder, &[first.clone(), third.clone()], &[&first, "shard 2/3 is missing"]);
    assert_refused(folder, std::slice::from_ref(&third), &[&third, "shards 1/3 and 2/3 are missing"]);
    copy(&second, "again.json");
    let again = [first.clone(), "again.json".to_owned(), second.clone(), third.clone()];
    assert_refused(folder, &again, &["again.json", &second, "are both shard 2/3"]);

    let other = |args: &[&str], name: &str| drop(output(folder, &[args, &["-o", name]].concat()));
    let with = |name: &str| [first.clone(), name.to_owned(), third.clone()];
    other(&[&NEEDLES[..], &["--shard", "2/3", "--seed", "2"]].concat(), "seed.json");
    assert_refused(folder, &with("seed.json"), &["seed.json", &first, "plan.seed is 2 instead of 1"]);
    other(&[&NEEDLES[..], &["--shard", "2/4"]].concat(), "of-4.json");
    assert_refused(folder, &with("of-4.json"), &["of-4.json", &first, "one of 4 shards instead of 3"]);
    other(&["probe", "triangle", "--size", "8x8", "--runs", "3", "--shard", "2/3"], "probe.json");
    assert_refused(folder, &with("probe.json"), &["probe.json", &first, "`probe` instead of `stability`"]);

    let whole = read(folder, &second);
    fs::write(folder.join("cut.json"), &whole[..whole.len() / 2]).unwrap();
    assert_refused(folder, &with("cut.json"), &["cut.json", "not a complete part"]);
    fs::write(folder.join("other.json"), "[1, 2]").unwrap();
    assert_refused(folder, &with("other.json"), &["other.json", "not a complete part"]);
    assert_refused(folder, &with("nowhere.json"), &["nowhere.json", "cannot read it"]);
    let changed = |name: &str, change: fn(&mut Value)| {
        copy(&second, name);
        edit(folder, name, change);
    };
    changed("hole.json", |part| {
        drop(part["run"]["results"]["classes"][0]["cases"].as_object_mut().unwrap().remove("1"));
    });
    assert_refused(folder, &with("hole.json"), &["hole.json", "no result of case 1 of needles"]);
    changed("old.json", |part| part["rasterscope"] = "0.0.9".into());
    assert_refused(folder, &with("old.json"), &["old.json", "written by Rasterscope 0.0.9"]);
    changed("format.json", |part| part["part_format"] = 0.into());
    assert_refused(folder, &with("format.json"), &["format.json", "in format 0 instead of 3"]);
}

#[test]
fn parts_of_a_model_that_changed_are_refused() {
    let folder = folder();
    let write = |top: &str| {
        fs::write(folder.path().join("model.obj"), format!("v -1 -1 0\nv 1 -1 0\nv 0 {top} 0\nf 1 2 3\n")).unwrap();
    };
    let probe = ["probe", "model.obj", "--size", "16x16", "--runs", "2"];
    write("1");
    output(folder.path(), &[&probe[..], &["--shard", "1/2", "-o", "a.json"]].concat());
    write("0.5");
    output(folder.path(), &[&probe[..], &["--shard", "2/2", "-o", "b.json"]].concat());
    assert_refused(
        folder.path(),
        &["a.json".to_owned(), "b.json".to_owned()],
        &["b.json", "another experiment", "plan."],
    );
}

#[test]
fn an_interrupted_part_makes_the_merged_result_partial() {
    let folder = folder();
    let parts = parts(folder.path(), &NEEDLES, 2);
    edit(folder.path(), &parts[0], |part| part["run"]["partial"] = true.into());
    let merged = merge(folder.path(), &parts, "merged");
    assert_eq!(merged.status.code(), Some(130));
    assert!(String::from_utf8(merged.stderr).unwrap().contains("marked as partial"));
    let report = json(&read(&folder.path().join("merged"), "stability.json"));
    assert_eq!((report["partial"].as_bool(), report["classes"].as_array().unwrap().len()), (Some(true), 1));
    // Without all of its cases, a class has no result.
    edit(folder.path(), &parts[0], |part| {
        part["run"]["results"]["classes"][0]["cases"] = Value::Object(Default::default());
    });
    let nothing = merge(folder.path(), &parts, "nothing");
    assert_eq!((nothing.status.code(), folder.path().join("nothing").exists()), (Some(130), false));
}

#[test]
fn shards_are_named_in_words_if_they_cannot_be() {
    let folder = folder();
    for (shard, words) in [
        ("0/3", "shards of 3 are numbered from 1 to 3"),
        ("4/3", "shards of 3 are numbered from 1 to 3"),
        ("a/b", "expected a shard as I/N"),
    ] {
        for command in ["stability", "probe", "report", "explain"] {
            let refused = run(folder.path(), &[command, "--shard", shard, "-o", "part.json"]);
            let message = String::from_utf8(refused.stderr).unwrap();
            assert_eq!((refused.status.code(), message.lines().count()), (Some(2), 1), "{message}");
            assert!(message.contains("--shard") && message.contains(words), "{command}: {message}");
        }
    }
    assert!(fs::read_dir(&folder).unwrap().next().is_none());
}
