//! The program: the window when started plainly, headless commands otherwise. See `rasterscope --help`.

mod cli;

fn main() -> std::process::ExitCode {
    cli::run()
}
