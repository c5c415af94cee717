//! Rasterscope: a software rendering pipeline that anyone can open up, stop at any stage, and question.

mod disk;

pub mod math;

pub mod image;

pub mod scene;

pub mod pipeline;

pub mod upscale;
