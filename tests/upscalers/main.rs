//! Upscalers that are not built in: registered from Rust.
//!
//! The registry of a process never shrinks. Therefore these tests have a program of their own, and each registers its
//! own ids.

mod registered;
