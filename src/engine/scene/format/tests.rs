use std::sync::atomic::AtomicBool;

use super::*;
use crate::internal::sound::sound;
use crate::scene::MemoryLimit;

#[test]
fn content_decides_before_the_extension() {
    let folder = tempfile::tempdir().unwrap();
    for (name, content, expected) in [
        ("a.obj", "v 0 0 0\n", Some("OBJ")),
        ("a.OBJ", "", Some("OBJ")),
        ("a.GlTF", "", Some("glTF")),
        ("b.glb", "glTF\u{2}", Some("glTF")),
        ("c.obj", "glTF\u{2}", Some("glTF")),
        ("d.obj", "\u{feff} \n {}", Some("glTF")),
        ("e", "{\"asset\": {}}", Some("glTF")),
        ("f.txt", "v 0 0 0\n", None),
    ] {
        let path = folder.path().join(name);
        std::fs::write(&path, content).unwrap();
        assert_eq!(SceneFormat::of(&path).map(|format| format.name), expected, "{name}");
    }
    assert_eq!(SceneFormat::of(Path::new("/nowhere/x.glb")).map(|format| format.name), Some("glTF"));
    assert!(SceneFormat::of(folder.path()).is_none());
}

#[test]
fn a_file_of_no_known_format_is_an_error_that_lists_the_formats() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("model.xyz");
    std::fs::write(&path, [0, 1, 2, 3]).unwrap();
    let message = SceneFormat::load_file(&path, TrMeaning::Auto, LoadControl::quiet(MemoryLimit::mib(1)))
        .unwrap_err()
        .to_string();
    let lists_all = SceneFormat::ALL.iter().all(|format| message.contains(format.name));
    assert!(message.contains("model.xyz") && lists_all, "{message}");
}

#[test]
fn extensions_are_distinct_and_in_lower_case() {
    let mut extensions = SceneFormat::all_extensions();
    assert!(extensions.iter().all(|extension| extension.to_lowercase() == **extension));
    extensions.sort_unstable();
    extensions.dedup();
    assert_eq!(extensions.len(), SceneFormat::all_extensions().len());
}

/// Control of a load without limits.
fn unlimited() -> LoadControl<'static> {
    LoadControl::quiet(MemoryLimit::default())
}

/// Loads a file with this name and content in a new folder.
fn load(name: &str, content: &[u8], control: LoadControl<'_>) -> Result<Loaded, SceneError> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    std::fs::write(&path, content).unwrap();
    SceneFormat::load_file(&path, TrMeaning::Auto, control)
}

#[test]
fn examples_are_recognised_and_load_without_warnings() {
    let folder = tempfile::tempdir().unwrap();
    for format in SceneFormat::ALL {
        for extension in format.extensions {
            let path = folder.path().join(format!("model.{extension}"));
            std::fs::write(&path, format.example).unwrap();
            assert_eq!(SceneFormat::of(&path).map(|found| found.name), Some(format.name), "{extension}");
            let loaded = SceneFormat::load_file(&path, TrMeaning::Auto, unlimited()).unwrap();
            assert!(loaded.warnings.is_empty(), "{}: {:?}", format.name, loaded.warnings);
            assert_eq!(sound(&loaded), Ok(()), "{}", format.name);
            assert_eq!(loaded.scene.name, "model", "{}", format.name);
        }
    }
}

#[test]
fn no_two_formats_recognise_the_same_content() {
    for format in SceneFormat::ALL {
        let recognised = SceneFormat::ALL.iter().filter(|other| (other.starts)(format.example));
        assert!(recognised.clone().count() <= 1, "{}", format.name);
        assert!(recognised.into_iter().all(|other| other.name == format.name), "{}", format.name);
    }
}

#[test]
fn every_format_honours_cancellation_and_the_memory_limit() {
    for format in SceneFormat::ALL {
        let name = format!("model.{}", format.extensions[0]);
        let cancelled = LoadControl { cancel: &AtomicBool::new(true), ..unlimited() };
        let error = load(&name, format.example, cancelled).unwrap_err();
        assert!(matches!(error, SceneError::Cancelled { .. }), "{error}");
        let error = load(&name, format.example, LoadControl::quiet(MemoryLimit::mib(0))).unwrap_err().to_string();
        assert!(error.contains(&name) && error.contains("memory limit"), "{error}");
    }
}

#[test]
fn every_format_reports_its_progress_up_to_the_end() {
    for format in SceneFormat::ALL {
        let shares = std::sync::Mutex::new(Vec::new());
        let progress = |share| shares.lock().unwrap().push(share);
        let name = format!("model.{}", format.extensions[0]);
        load(&name, format.example, LoadControl { progress: &progress, ..unlimited() }).unwrap();
        let shares = shares.into_inner().unwrap();
        assert!(shares.is_sorted() && shares.last() == Some(&1.0), "{}: {shares:?}", format.name);
    }
}

#[test]
fn examples_that_are_cut_off_load_soundly_or_name_the_file_in_the_error() {
    for format in SceneFormat::ALL {
        let name = format!("model.{}", format.extensions[0]);
        for length in 0..format.example.len() {
            match load(&name, &format.example[..length], unlimited()) {
                Ok(loaded) => assert_eq!(sound(&loaded), Ok(()), "{} of {length} bytes", format.name),
                Err(error) => assert!(error.to_string().contains(&name), "{error}"),
            }
        }
    }
}
