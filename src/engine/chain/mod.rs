//! Entry point for drawing, shared by the window, the command line, reports and tests: renders a [`Frame`] of a scene
//! as seen by a camera, with the settings of a [`Recipe`].

mod driver;
mod executor;
mod finish;
mod frame;
mod motion;
mod pixel_samples;
mod pool;
mod progressive;
mod recipe;
mod renderer;
pub(crate) mod replay;
mod run;
pub(crate) mod samples;
#[cfg(test)]
mod tests;
mod view;
pub mod whole;

pub use crate::pipeline::framebuffer::KeepDepth;
pub use crate::pipeline::motion::FrameView;
pub use frame::Frame;
pub(crate) use frame::FrameTimes;
pub use frame::PrecedingView;
pub use frame::ViewChange;
pub use motion::MotionBuffers;
pub use progressive::ProgressiveRender;
pub use recipe::Recipe;
pub use recipe::SetError;
pub use recipe::SettingKey;
pub use recipe::SettingStage;
pub use recipe::ValueForm;
pub use recipe::Values;
pub use recipe::Word;
pub use renderer::RenderInputs;
pub use renderer::Renderer;
pub use renderer::SavedHistory;
pub use renderer::execution;
pub(crate) use run::prepare_again;
pub(crate) use run::redraw;
pub use run::run;
pub use run::run_unobserved;
