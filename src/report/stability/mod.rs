//! Stability.

pub mod case;

pub mod oracle;

pub mod spans;

mod wire;
