//! Inputs of the kernels of shadings at a fragment, in floats.

use super::Shader;
use crate::pipeline::depth::depth_at;
use crate::pipeline::interpolate::Fragment;
use crate::pipeline::settings::Checker;
use crate::pipeline::shading::{CheckerInputs, LightInputs, SurfaceInputs};
use crate::pipeline::viewport::ScreenTriangle;

/// Inputs of the light at a fragment, in floats.
#[derive(Clone, Copy, Debug)]
pub(super) struct FragmentInputs<'a> {
    pub(super) shader: &'a Shader<'a>,
    pub(super) fragment: &'a Fragment,
}

impl LightInputs for FragmentInputs<'_> {
    type Number = f32;

    #[inline(always)]
    fn constant(&self, value: f32) -> f32 {
        value
    }

    #[inline(always)]
    fn normal(&self) -> [f32; 3] {
        self.shader.unit_normal(self.fragment).to_array()
    }

    #[inline(always)]
    fn vertex_light(&self) -> f32 {
        self.fragment.light
    }

    #[inline(always)]
    fn light_direction(&self) -> [f32; 3] {
        self.shader.light_direction.to_array()
    }

    #[inline(always)]
    fn ambient(&self) -> f32 {
        self.shader.settings.light.ambient
    }

    #[inline(always)]
    fn dark_factor(&self) -> f32 {
        self.shader.dark_factor()
    }
}

/// Inputs of a quantity at a fragment, in floats.
#[derive(Clone, Copy, Debug)]
pub(super) struct SurfacePoint<'a> {
    pub(super) inputs: FragmentInputs<'a>,
    pub(super) triangle: &'a ScreenTriangle,
}

impl LightInputs for SurfacePoint<'_> {
    type Number = f32;

    #[inline(always)]
    fn constant(&self, value: f32) -> f32 {
        value
    }

    #[inline(always)]
    fn normal(&self) -> [f32; 3] {
        self.inputs.normal()
    }

    #[inline(always)]
    fn vertex_light(&self) -> f32 {
        self.inputs.vertex_light()
    }

    #[inline(always)]
    fn light_direction(&self) -> [f32; 3] {
        self.inputs.light_direction()
    }

    #[inline(always)]
    fn ambient(&self) -> f32 {
        self.inputs.ambient()
    }

    #[inline(always)]
    fn dark_factor(&self) -> f32 {
        self.inputs.dark_factor()
    }
}

impl SurfaceInputs for SurfacePoint<'_> {
    fn eye_direction(&self) -> [f32; 3] {
        self.inputs.shader.eye_direction(self.inputs.fragment).to_array()
    }

    #[inline(always)]
    fn uv(&self) -> [f32; 2] {
        self.inputs.fragment.uv.to_array()
    }

    #[inline(always)]
    fn vertex_color(&self) -> [f32; 3] {
        self.inputs.fragment.color.to_array()
    }

    #[inline(always)]
    fn weights(&self) -> [f32; 3] {
        self.inputs.fragment.source_weights.to_array()
    }

    #[inline(always)]
    fn depth(&self) -> f32 {
        depth_at(self.triangle, &self.inputs.fragment.sample)
    }

    fn checker(&self) -> CheckerInputs<f32> {
        let Checker { squares, even, odd } = self.inputs.shader.settings.checker;
        CheckerInputs { squares, even: even.to_array(), odd: odd.to_array() }
    }
}
