//! Stability.

pub mod case;

pub mod catalogue;

pub mod column;

pub mod measure;

pub mod metric;

pub mod oracle;

pub mod spans;

pub mod subject;

mod wire;
