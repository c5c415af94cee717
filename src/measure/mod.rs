//! How wrong a picture is, and how long it took.

pub mod bench;

pub mod error;

pub mod flip;

pub mod leaving_out;

pub mod region;

pub mod stages;

pub mod timing;
