//! Setting of the desktop that reduces motion, as far as configuration files tell it.

use std::path::{Path, PathBuf};

use crate::disk;

/// Maximum size of a configuration file that is read, in bytes.
const MAX_BYTES: u64 = 1 << 20;

/// Settings that reduce motion: path of the file below the configuration folder, section, key, and value.
const SETTINGS: [(&str, &str, &str, &[&str]); 3] = [
    ("gtk-4.0/settings.ini", "Settings", "gtk-enable-animations", &["0", "false"]),
    ("gtk-3.0/settings.ini", "Settings", "gtk-enable-animations", &["0", "false"]),
    ("kdeglobals", "KDE", "AnimationDurationFactor", &["0"]),
];

/// Whether the desktop reduces motion; `false` if that is unknown.
pub(crate) fn reduces_motion() -> bool {
    let home = || std::env::var_os("HOME").map(|home| PathBuf::from(home).join(".config"));
    let folder = std::env::var_os("XDG_CONFIG_HOME").map(PathBuf::from).or_else(home);
    folder.is_some_and(|folder| is_reduced_in(&folder))
}

/// Whether a configuration folder contains a setting that reduces motion.
fn is_reduced_in(folder: &Path) -> bool {
    SETTINGS.iter().any(|(file, section, key, values)| {
        let text = disk::read_own(&folder.join(file), MAX_BYTES).unwrap_or_default();
        let text = String::from_utf8_lossy(&text);
        value(&text, section, key).is_some_and(|value| values.contains(&value))
    })
}

/// Returns the last value of a key in a section of an INI file.
fn value<'a>(text: &'a str, section: &str, key: &str) -> Option<&'a str> {
    let mut current = "";
    let mut found = None;
    for line in text.lines().map(str::trim) {
        if let Some(name) = line.strip_prefix('[').and_then(|line| line.strip_suffix(']')) {
            current = name;
        } else if let Some((name, value)) = line.split_once('=')
            && (current, name.trim()) == (section, key)
        {
            found = Some(value.trim());
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settings_of_desktops_are_recognized() {
        for (file, text, reduced) in [
            ("gtk-3.0/settings.ini", "[Settings]\ngtk-theme-name=A\ngtk-enable-animations = false\n", true),
            ("gtk-4.0/settings.ini", "[Settings]\ngtk-enable-animations=0\n", true),
            ("gtk-4.0/settings.ini", "[Settings]\ngtk-enable-animations=true\n", false),
            ("gtk-4.0/settings.ini", "[Other]\ngtk-enable-animations=0\n", false),
            ("kdeglobals", "[General]\nAnimationDurationFactor=1\n[KDE]\nAnimationDurationFactor=0\n", true),
            ("kdeglobals", "[KDE]\nAnimationDurationFactor=0.5\n", false),
        ] {
            let folder = tempfile::tempdir().unwrap();
            let path = folder.path().join(file);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(path, text).unwrap();
            assert_eq!(is_reduced_in(folder.path()), reduced, "{text}");
        }
        assert!(!is_reduced_in(Path::new("/nowhere")));
    }
}
