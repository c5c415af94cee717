//! How wrong a picture is, and how long it took.

pub mod bench;

pub mod error;

pub mod stages;

pub mod timing;
