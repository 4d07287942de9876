//! The binary `gillesph`.

fn main() -> std::process::ExitCode {
    gillesph::cli::main()
}
