//! Stability.

pub mod case;

pub mod catalogue;

pub mod column;

pub mod csv;

pub mod html;

pub mod machine;

pub mod measure;

pub mod metric;

pub mod oracle;

pub mod spans;

pub mod subject;

pub mod sweep;

pub mod text;

pub mod timing;

pub mod tradeoff;

mod wire;
