//! Tests of the program as a user starts it, and of what its documents say about it.

mod claims;
mod cli;
mod compare;
mod explain;
mod exports;
mod files;
#[cfg(feature = "ui")]
mod manual;
mod shards;
