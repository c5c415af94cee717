//! Paths of files in a project, relative to its folder.

use std::path::{Component, Path, PathBuf};

/// Returns an absolute path for a stored one.
pub(super) fn absolute(stored: &Path, folder: &Path) -> PathBuf {
    // The components of the result have no `.`, which a path begins with if it could be mistaken for an id.
    folder.join(stored).components().collect()
}

/// Returns the path of a file relative to the absolute `folder`. A file that shares only the root with the folder keeps
/// its absolute path.
pub(super) fn relative(path: &Path, folder: &Path) -> PathBuf {
    let path = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
    let shared = path.components().zip(folder.components()).take_while(|(a, b)| a == b);
    let (mut count, mut has_name) = (0, false);
    for (component, _) in shared {
        count += 1;
        has_name |= matches!(component, Component::Normal(_));
    }
    if !has_name {
        return path;
    }
    let up = folder.components().skip(count).map(|_| Component::ParentDir);
    let relative: PathBuf = up.chain(path.components().skip(count)).collect();
    // A bare name could be the id of a built-in scene, and the folder itself has no name here.
    if relative.components().count() <= 1 { Path::new(".").join(relative) } else { relative }
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    #[test]
    fn paths_come_back_from_their_relative_form() {
        let folder = Path::new("/home/a/projects");
        for (path, stored) in [
            ("/home/a/projects/chess", "./chess"),
            ("/home/a/projects/models/chair.obj", "models/chair.obj"),
            ("/home/a/models/chair.obj", "../models/chair.obj"),
            ("/srv/chair.obj", "/srv/chair.obj"),
            ("/home/a/projects", "./"),
        ] {
            assert_eq!(relative(Path::new(path), folder), Path::new(stored));
        }
        assert_eq!(absolute(Path::new("./chess"), folder), Path::new("/home/a/projects/chess"));
        assert_eq!(absolute(Path::new("./"), folder), folder);
        assert_eq!(absolute(Path::new("/srv/chair.obj"), folder), Path::new("/srv/chair.obj"));
        assert_eq!(absolute(Path::new("../m/c.obj"), folder), Path::new("/home/a/projects/../m/c.obj"));
    }
}
