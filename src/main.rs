//! Program entry point: opens the window if started without a command, and runs headless commands otherwise. See
//! `rasterscope --help`.

mod cli;

fn main() -> std::process::ExitCode {
    cli::run()
}
