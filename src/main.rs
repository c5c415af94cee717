//! The program. See `rasterscope --help`.

fn main() -> std::process::ExitCode {
    rasterscope::cli::run()
}
