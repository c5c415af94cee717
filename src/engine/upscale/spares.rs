//! Buffers that several threads use one after another.

use std::sync::{Mutex, PoisonError};

/// Buffers that are not in use.
#[derive(Debug)]
pub(super) struct Spares<T>(Mutex<Vec<T>>);

impl<T> Default for Spares<T> {
    fn default() -> Self {
        Self(Mutex::new(Vec::new()))
    }
}

impl<T> Spares<T> {
    /// Calls `of` with a buffer that is not in use, or with a new one.
    pub(super) fn with<R>(&self, new: impl FnOnce() -> T, of: impl FnOnce(&mut T) -> R) -> R {
        let lock = || self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let spare = lock().pop();
        let mut buffer = spare.unwrap_or_else(new);
        let result = of(&mut buffer);
        lock().push(buffer);
        result
    }
}
