//! Image error metrics and frame timing.

pub(crate) mod against;

pub(crate) mod bench;

pub mod difference;

pub(crate) mod equality;

pub mod error;

pub mod flip;

pub(crate) mod skipped_work;

pub(crate) mod machine;

pub mod motion;

pub(crate) mod noise;

pub(crate) mod pair;

pub mod reference;

pub(crate) mod region;

pub(crate) mod response;

pub(crate) mod rounds;

pub(crate) mod scaling;

pub(crate) mod stages;

pub(crate) mod timing;

pub(crate) mod window_cost;
