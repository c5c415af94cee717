//! Command-line entry point of Rasterscope. See `rasterscope --help`.

fn main() -> std::process::ExitCode {
    rasterscope::cli::run()
}
