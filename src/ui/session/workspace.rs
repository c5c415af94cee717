//! Workspaces, the tasks that the window is divided into, and their panels.

use crate::pipeline::settings::{Choice, choice};

choice! {
    /// Task of the user, with its own layout of panels.
    #[derive(PartialOrd, Ord)]
    pub(crate) Workspace {
        Inspect = "inspect", "Inspect", "Step through the stages, and explain any pixel of the picture.";
        Geometry = "geometry", "Geometry",
            "See the scene from outside, the vertices at every stage, and the fate of every triangle.";
        Compare = "compare", "Compare", "Compare pictures of several upscalers or settings, by eye and by number.";
        Measure = "measure", "Measure", "Measure frame times, errors, scaling and skipped work.";
        Robustness = "robustness", "Robustness",
            "Find ill-conditioned cases: stability report, probe and assertions.";
        Lab = "lab", "2D lab", "Step through algorithms for lines, circles, polygons, fills and sampling.";
    }
}

choice! {
    /// Panel that can be docked in a workspace.
    #[derive(PartialOrd, Ord)]
    pub(crate) Panel {
        Stages = "stages", "Stages",
            "Stages of the pipeline with their times and counts, and the settings of the selected stage";
        Picture = "picture", "Picture", "Picture, with every buffer, stage and overlay";
        Pixel = "pixel", "Pixel",
            "Explanation of the picked pixel: every fragment, which one won, and why",
            also ["inspector", "pixel history"];
        Calculation = "calculation", "Calculation",
            "Every step from the corners of a triangle to the picked pixel, with numbers and rounding errors";
        Watch = "watch", "Watch",
            "Values of all buffers at the watched pixels, updated after every frame", also ["pin"];
        FilterTaps = "filter-taps", "Filter taps",
            "Samples from which the upscaler reconstructed the picked pixel, and its response to test signals";
        Histogram = "histogram", "Histogram",
            "Histogram and statistics of the shown values", also ["levels", "exposure"];
        MeshView = "mesh-view", "Mesh view", "Scene from a second camera, with the frustum and the culled triangles";
        Vertices = "vertices", "Vertices",
            "Vertices of the picked triangle, or of its object, at every stage", also ["vertex buffer", "mesh table"];
        TriangleFates = "triangle-fates", "Triangle fates",
            "Fate of every triangle and fragment, such as culled or visible; click a fate to select its triangles";
        FrameTime = "frame-time", "Frame time", "Frame time of each upscaler", also ["fps", "performance", "benchmark"];
        ErrorTime = "error-time", "Error vs time",
            "Error and time of each upscaler; click a point to compare that upscaler",
            also ["pareto", "quality", "psnr", "ssim", "flip", "metric"];
        OverTime = "over-time", "Error over time",
            "Error of the compared upscalers in every frame; click a frame to show it",
            also ["motion", "flicker", "ghosting", "lag", "clip", "temporal"];
        Scaling = "scaling", "Scaling", "Frame time against the number of triangles, pixels, layers and threads";
        SkippedWork = "skipped-work", "Skipped work", "Parts of the pipeline that each draw runs or skips, and why";
        Stability = "stability", "Stability",
            "Error and time of every rasterizer, arithmetic and depth format on ill-conditioned and extreme cases";
        Probe = "probe", "Probe",
            "Pixels that change if the camera or the vertices move by a few units in the last place";
        Assertions = "assertions", "Assertions",
            "Conditions that every fragment of a frame should satisfy, checked on demand";
        OtherRenderer = "other-renderer", "Other renderer",
            "Which faults turn our picture into a picture that another renderer drew of this view",
            also ["explain picture", "why different", "reference renderer", "diagnose", "bug"];
        PictureFiles = "picture-files", "Picture files",
            "Layers, ranges, histograms and stored values of the compared picture files",
            also ["exr", "layer", "aov", "channel", "levels"];
        Log = "log", "Log", "All messages, warnings and errors";
        Lab = "lab", "2D lab", "Step-by-step algorithms for lines, circles, polygons, fills and sampling";
    }
}

/// Change of the workspace or of its layout.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum WorkspaceChange {
    /// Switches to a workspace.
    Show(Workspace),
    /// Shows a panel, in the current workspace if it has the panel, otherwise in the first workspace that has it.
    Panel(Panel),
    /// Maximizes a panel, or restores the layout if the panel is already maximized.
    Maximize(Panel),
    /// Hides or shows all panels around the picture, or restores the layout if a panel is maximized.
    TogglePanels,
    /// Moves the keyboard focus to the next panel.
    NextPanel,
    /// Restores the default layout of the current workspace.
    ResetLayout,
}
