//! Memory limit, progress and cancellation for loading a model.

use std::fmt;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

use super::{Scene, SceneError, Warning};
use crate::image::file::PictureFile;
use crate::image::{Image, Rgba8};

/// Background colour of a loaded model, as sRGB codes. It contrasts with both bright and dark surfaces.
pub(super) const BACKGROUND: [u8; 3] = [38, 38, 38];

/// Maximum magnitude of a coordinate. The product of three such coordinates, as in a determinant, is still finite in
/// f32.
pub(super) const MAX_COORDINATE: f32 = 1e12;

/// Memory per texel, in bytes: 4 for the codes, and at most 28 for the linear-light copies and mip levels made for
/// rendering.
const BYTES_PER_TEXEL: u64 = 32;

/// Loaded scene, with warnings about skipped or repaired content.
#[derive(Clone, Debug)]
pub struct Loaded {
    /// Loaded scene, which is valid and has at least one triangle.
    pub scene: Scene,
    /// Warnings in order of first occurrence; repetitions are counted instead of listed.
    pub warnings: Vec<Warning>,
    /// Assumptions about properties that the file does not specify, and properties that are not rendered by design;
    /// they do not indicate a fault.
    pub notes: Vec<Warning>,
}

impl From<Scene> for Loaded {
    /// Converts a scene to a loaded scene without warnings or notes.
    fn from(scene: Scene) -> Self {
        Self { scene, warnings: Vec::new(), notes: Vec::new() }
    }
}

/// Memory limit for the meshes and textures of a model, including temporary buffers used while loading.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MemoryLimit {
    mib: u32,
}

impl MemoryLimit {
    /// Creates a limit of `mib` MiB.
    pub const fn mib(mib: u32) -> Self {
        Self { mib }
    }

    /// Returns the limit in bytes.
    pub fn bytes(self) -> u64 {
        u64::from(self.mib) << 20
    }
}

impl Default for MemoryLimit {
    /// Returns 4 GiB, enough for about 20 million triangles or 128 million texels.
    fn default() -> Self {
        Self::mib(4096)
    }
}

impl fmt::Display for MemoryLimit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} MiB", self.mib)
    }
}

/// Memory limit, progress callback and cancellation flag for loading a model.
#[derive(Clone, Copy)]
pub struct LoadControl<'a> {
    /// Memory limit for the model.
    pub memory: MemoryLimit,
    /// Callback that receives the completed fraction, from 0 to 1, several times a second.
    pub progress: &'a (dyn Fn(f32) + Sync),
    /// Cancellation flag: once `true`, the load ends with [`SceneError::Cancelled`].
    pub cancel: &'a AtomicBool,
}

impl LoadControl<'static> {
    /// Creates a control that ignores progress and never cancels.
    pub fn quiet(memory: MemoryLimit) -> Self {
        static NEVER: AtomicBool = AtomicBool::new(false);
        Self { memory, progress: &|_| {}, cancel: &NEVER }
    }
}

impl fmt::Debug for LoadControl<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("LoadControl").field("memory", &self.memory).finish_non_exhaustive()
    }
}

/// Number of lines of text between progress reports. Reading them takes a few milliseconds.
const LINES_PER_REPORT: usize = 1 << 14;

/// Memory accounting and progress while a model is loaded.
#[derive(Debug)]
pub(super) struct Load<'a> {
    path: &'a Path,
    control: LoadControl<'a>,
    used_bytes: u64,
    /// Work since the last report, in lines of text or equivalent units.
    unreported: usize,
    /// Completed fraction of the load at the start of the current step, and the step's fraction of the load, both in
    /// [0, 1].
    step: (f32, f32),
}

impl<'a> Load<'a> {
    /// Starts loading the file at `path`.
    pub(super) fn new(path: &'a Path, control: LoadControl<'a>) -> Self {
        Self { path, control, used_bytes: 0, unreported: 0, step: (0.0, 0.0) }
    }

    /// Returns the memory limit of the load.
    pub(super) fn memory(&self) -> MemoryLimit {
        self.control.memory
    }

    /// Starts the next step of the load; `share` is its fraction of the whole load.
    pub(super) fn begin(&mut self, share: f32) {
        self.step = (self.step.0 + self.step.1, share);
    }

    /// Reports the completed fraction of the current step, from 0 to 1. Must be called at least about every 20 ms.
    ///
    /// # Errors
    /// Returns an error if the load is cancelled.
    pub(super) fn advance(&self, share: f32) -> Result<(), SceneError> {
        (self.control.progress)((self.step.0 + share * self.step.1).min(1.0));
        if self.is_cancelled() {
            return Err(SceneError::Cancelled { path: self.path.to_owned() });
        }
        Ok(())
    }

    /// Counts work, in lines of text or equivalent units, and reports progress at regular intervals. `completed`
    /// returns the completed fraction of the current step, from 0 to 1.
    ///
    /// # Errors
    /// Returns an error if the load is cancelled.
    #[inline]
    pub(super) fn work(&mut self, lines: usize, completed: impl FnOnce() -> f32) -> Result<(), SceneError> {
        self.unreported += lines;
        if self.unreported < LINES_PER_REPORT {
            return Ok(());
        }
        self.unreported = 0;
        self.advance(completed())
    }

    /// Whether the load has been cancelled.
    pub(super) fn is_cancelled(&self) -> bool {
        self.control.cancel.load(Ordering::Relaxed)
    }

    /// Adds memory to the accounting before it is allocated.
    ///
    /// # Errors
    /// Returns an error if the limit would be exceeded. The message is one sentence.
    pub(super) fn charge(&mut self, bytes: u64) -> Result<(), String> {
        let used_bytes = self.used_bytes.saturating_add(bytes);
        if used_bytes > self.control.memory.bytes() {
            let limit = self.control.memory;
            return Err(format!("the model needs more than the memory limit of {limit}; raise it with `--memory`"));
        }
        self.used_bytes = used_bytes;
        Ok(())
    }

    /// Removes released memory from the accounting.
    pub(super) fn release(&mut self, bytes: u64) {
        self.used_bytes = self.used_bytes.saturating_sub(bytes);
    }

    /// Reserves capacity for `additional` more elements in a list, and adds it to the accounting.
    ///
    /// # Errors
    /// Returns an error if the limit or the system allows no more memory. The message is one sentence.
    pub(super) fn reserve<T>(&mut self, list: &mut Vec<T>, additional: usize) -> Result<(), String> {
        let room = list.capacity() - list.len();
        if additional <= room {
            return Ok(());
        }
        // Doubling the capacity limits a list of n elements to log n reallocations.
        let more = (additional - room).max(list.capacity()).max(64);
        self.charge(bytes_of::<T>(more))?;
        list.try_reserve_exact(room + more).map_err(|_| "the system is out of memory".to_owned())
    }

    /// Appends an element to a list within the memory limit; see [`Load::reserve`] for errors.
    #[inline]
    pub(super) fn push<T>(&mut self, list: &mut Vec<T>, element: T) -> Result<(), String> {
        if list.len() == list.capacity() {
            self.reserve(list, 1)?;
        }
        list.push(element);
        Ok(())
    }

    /// Decodes a picture. Returns an error of one sentence without decoding it if the load is cancelled, or if the size
    /// in the picture's header would exceed the memory limit.
    pub(super) fn decode(&mut self, picture: PictureFile) -> Result<Image<Rgba8>, String> {
        if self.is_cancelled() {
            return Err("loading was cancelled".to_owned());
        }
        let ((width, height), path) = (picture.size(), picture.path().display().to_string());
        let bytes = texture_bytes((width, height));
        self.charge(bytes).map_err(|reason| format!("{path}: {width} × {height} texels, {reason}"))?;
        picture.decode().map_err(|e| {
            self.release(bytes);
            e.to_string()
        })
    }

    /// Drops a list that was filled by [`Load::push`] or [`Load::reserve`], and removes its memory from the accounting.
    pub(super) fn free<T>(&mut self, list: Vec<T>) {
        self.release(bytes_of::<T>(list.capacity()));
        drop(list);
    }
}

/// Returns the memory that a texture of this width and height may take, in bytes.
pub(super) fn texture_bytes((width, height): (u32, u32)) -> u64 {
    u64::from(width) * u64::from(height) * BYTES_PER_TEXEL
}

/// Returns the size of `count` elements of type `T`, in bytes.
pub(super) fn bytes_of<T>(count: usize) -> u64 {
    (count as u64).saturating_mul(size_of::<T>() as u64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_grow_up_to_the_limit_and_release_their_memory() {
        let mut load = Load::new(Path::new("a.obj"), LoadControl::quiet(MemoryLimit::mib(1)));
        let mut list = Vec::new();
        let error = (0_u64..).find_map(|number| load.push(&mut list, number).err()).unwrap();
        assert_eq!(error, "the model needs more than the memory limit of 1 MiB; raise it with `--memory`");
        assert_eq!((list.len(), list.capacity()), (1 << 17, 1 << 17));
        load.free(list);
        assert_eq!(load.used_bytes, 0);
        assert!(load.charge(u64::MAX).is_err());
    }

    #[test]
    fn steps_add_up_and_a_cancelled_load_ends() {
        let (heard, cancel) = (std::sync::Mutex::new(Vec::new()), AtomicBool::new(false));
        let progress = |share| heard.lock().unwrap().push(share);
        let control = LoadControl { memory: MemoryLimit::default(), progress: &progress, cancel: &cancel };
        let mut load = Load::new(Path::new("a.obj"), control);
        for share in [0.25, 0.75] {
            load.begin(share);
            load.advance(0.5).unwrap();
        }
        assert_eq!(*heard.lock().unwrap(), [0.125, 0.625]);
        cancel.store(true, Ordering::Relaxed);
        assert_eq!(load.advance(1.0).unwrap_err().to_string(), "a.obj: loading was cancelled");
    }
}
