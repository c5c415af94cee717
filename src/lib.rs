//! Rasterscope: a software rendering pipeline that anyone can open up, stop at any stage, and question.

pub mod math;

pub mod image;

pub mod flat2d;

pub mod scene;

pub mod pipeline;

pub mod upscale;

pub mod measure;
