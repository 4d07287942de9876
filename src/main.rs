<<<<<<< HEAD
//! The binary `gillesph`.

fn main() -> std::process::ExitCode {
    gillesph::cli::main()
}
=======
fn main() {}
>>>>>>> input
