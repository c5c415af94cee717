//! Registry of upscalers: the built-in ones, followed by registered ones in the order of their registration.
//!
//! The registry only grows, so that an index into it stays valid.

use std::sync::{PoisonError, RwLock};

use thiserror::Error;

use super::{BUILT_IN, Upscaler};

/// Upscalers that were registered while the program runs.
static REGISTERED: RwLock<Vec<&'static dyn Upscaler>> = RwLock::new(Vec::new());

/// Reason why an upscaler cannot be registered.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum RegisterError {
    /// The id is not in kebab case.
    #[error(
        "`{0}` is not an id of an upscaler: expected lower-case letters, digits and single hyphens, starting with a \
         letter, such as `my-net`"
    )]
    BadId(String),
    /// Another upscaler has the id.
    #[error("there is already an upscaler `{0}`; choose another id")]
    DuplicateId(String),
    /// The upscaler offers no scale, no anchor or no filtering colour space.
    #[error("`{0}` must offer at least one scale, one anchor and one filtering colour space")]
    NoOffers(String),
}

/// Adds an upscaler to the registry. Afterwards, recipes accept its id, and menus, comparisons, reports and measurements
/// include it, like a built-in upscaler.
///
/// # Errors
/// Fails if the id is not in kebab case or is taken, or if one of the lists in [`Upscaler::offers`] is empty.
pub fn register(upscaler: &'static dyn Upscaler) -> Result<(), RegisterError> {
    let (id, offers) = (upscaler.id(), upscaler.offers());
    if !is_kebab_case(id) {
        return Err(RegisterError::BadId(id.to_owned()));
    }
    if offers.scales.is_empty() || offers.anchors.is_empty() || offers.lights.is_empty() {
        return Err(RegisterError::NoOffers(id.to_owned()));
    }
    let mut registered = REGISTERED.write().unwrap_or_else(PoisonError::into_inner);
    if BUILT_IN.iter().chain(registered.iter()).any(|other| other.id() == id) {
        return Err(RegisterError::DuplicateId(id.to_owned()));
    }
    registered.push(upscaler);
    Ok(())
}

/// Adds an upscaler that is created at run time; see [`register`]. Its memory is never freed.
///
/// # Errors
/// Fails like [`register`].
pub fn register_boxed(upscaler: Box<dyn Upscaler>) -> Result<(), RegisterError> {
    register(Box::leak(upscaler))
}

/// Returns all upscalers in menu order: [`BUILT_IN`], followed by the registered ones.
pub fn all() -> Vec<&'static dyn Upscaler> {
    let registered = REGISTERED.read().unwrap_or_else(PoisonError::into_inner);
    BUILT_IN.iter().chain(registered.iter()).copied().collect()
}

/// Returns the upscaler at an index of [`all`], which must have been obtained from [`index_of`].
pub(super) fn at(index: usize) -> &'static dyn Upscaler {
    // Built-in upscalers need no lock.
    BUILT_IN.get(index).copied().unwrap_or_else(|| {
        let registered = REGISTERED.read().unwrap_or_else(PoisonError::into_inner);
        registered[index - BUILT_IN.len()]
    })
}

/// Returns the index in [`all`] of the upscaler with this id.
pub(super) fn index_of(id: &str) -> Option<usize> {
    all().iter().position(|upscaler| upscaler.id() == id)
}

/// Whether `id` consists of lower-case letters, digits and single hyphens, and starts with a letter.
fn is_kebab_case(id: &str) -> bool {
    let is_word = |word: &str| !word.is_empty() && word.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit());
    id.starts_with(|c: char| c.is_ascii_lowercase()) && id.split('-').all(is_word)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ids_are_in_kebab_case() {
        for id in ["a", "my-net", "fsr1", "x-2-y"] {
            assert!(is_kebab_case(id), "{id}");
        }
        for id in ["", "My-net", "my_net", "my net", "-a", "a-", "a--b", "2x", "a=b", "é"] {
            assert!(!is_kebab_case(id), "{id}");
        }
        assert!(BUILT_IN.iter().all(|upscaler| is_kebab_case(upscaler.id())));
    }

    #[test]
    fn ids_of_built_in_upscalers_are_taken() {
        assert_eq!(register(BUILT_IN[0]), Err(RegisterError::DuplicateId("native".to_owned())));
        assert_eq!(all().len(), BUILT_IN.len());
    }
}
