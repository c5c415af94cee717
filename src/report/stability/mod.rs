//! Stability.

pub mod case;

pub mod catalogue;

pub mod oracle;

pub mod spans;

mod wire;
