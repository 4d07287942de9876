use super::*;
use crate::error::Source;
use proptest::prelude::*;
use rstest::rstest;
use std::sync::Arc;

fn place(text: &str) -> Place {
    let source = Arc::new(Source::new("law", text));
    Place { source, line: 1, column: 1, width: 1 }
}

const VARIABLES: [(&str, Dimension); 2] = [("S", Dimension::CONCENTRATION), ("n", Dimension::NONE)];

fn constants() -> Vec<(String, Quantity)> {
    [("vmax", "1 uM/s"), ("km", "3 mol/m^3"), ("k", "2"), ("h", "2.5"), ("D", "1 um^2/s")]
        .map(|(name, text)| (name.to_string(), Quantity::parse(text).unwrap()))
        .to_vec()
}

fn compile(text: &str, expected: Dimension) -> Result<Program, Vec<Fault>> {
    let expression = Expression::parse(text, &place(text)).map_err(|fault| vec![fault])?;
    expression.compile(&VARIABLES, &constants(), expected)
}

#[rstest]
#[case("1 + 2 * 3", 7.0)]
#[case("2 ^ 3 ^ 2", 512.0)]
#[case("-2 ^ 2", -4.0)]
#[case("2 ^ -1", 0.5)]
#[case("8 / 4 / 2", 1.0)]
#[case("7 - 2 - 1", 4.0)]
#[case("(1 + 2) * 3", 9.0)]
#[case("if(n > 2, 10, 20)", 10.0)]
#[case("if(n <= 2, 10, 20)", 20.0)]
#[case("min(3, n, 1) + max(1, 2)", 3.0)]
#[case("exp(0) + ln(1) + log10(100) + sqrt(4) + abs(-1) + tanh(0) + sin(0) + cos(0)", 7.0)]
#[case("pow(2, 10) + step(-1) + step(0) + heaviside(n)", 1026.0)]
#[case("2 * pi", std::f64::consts::TAU)]
#[case("n^2 + n^3", 36.0)]
#[case("n^h", 3.0_f64.powf(2.5))]
#[case("--n", 3.0)]
#[case("+n", 3.0)]
#[case("1e-3 * n", 3e-3)]
#[case("S == 4 mol/m^3", 0.0)]
#[case("5 mM < S", 0.0)]
#[case("S > 5 uM", 1.0)]
fn values(#[case] text: &str, #[case] value: f64) {
    let program = compile(text, Dimension::NONE).unwrap();
    assert_eq!(program.eval(&[2.0, 3.0]), value, "{text}");
}

#[test]
fn laws_have_dimensions_and_uses() {
    let rate = Dimension::CONCENTRATION_RATE;
    let law = compile("vmax * S / (km + S)", rate).unwrap();
    // Both sides are the same three operations on the same numbers.
    assert_eq!(law.eval(&[2.0, 0.0]), 1e-3 * 2.0 / (3.0 + 2.0));
    assert_eq!(law.uses(), [0]);
    assert_eq!(compile("vmax", rate).unwrap().constant(), Some(1e-3));
    assert!(compile("vmax * S^h / (km^h + S^h)", rate).is_ok());
    assert!(compile("k * S", rate).is_ok(), "a bare parameter fits any dimension");
    assert!(compile("vmax * exp(-S / km)", rate).is_ok());
    assert!(compile("D * S / (10 um)^2", rate).is_ok());
    assert!(compile("D * S / 10 um^2", rate).is_ok());
    assert!(compile("2 s^-1 * S", rate).is_ok());
    assert_eq!(compile("2 * 3 + k", Dimension::NONE).unwrap().constant(), Some(8.0));
}

#[rstest]
#[case("vmax * Q", 8, 1, "unknown name \"Q\"")]
#[case("vmx * S", 1, 3, "unknown name \"vmx\"")]
#[case("S + vmax", 1, 8, "adds concentration (mol/m^3) and concentration per time")]
#[case("vmax * exp(S)", 12, 1, "exp needs a pure number")]
#[case("vmax * S", 1, 8, "expected concentration per time")]
#[case("vmax * S^S", 10, 1, "exponent needs a pure number")]
#[case("S < vmax", 1, 8, "compares")]
#[case("vmax * n^n^S", 12, 1, "exponent needs")]
#[case("vmax * S^n", 8, 1, "base of an exponent that varies")]
#[case("if(n, S, vmax)", 1, 14, "chooses between")]
#[case("vmax * (1 / (2 - 2))", 8, 13, "not a finite number")]
#[case("vmax +", 6, 1, "ends where a value")]
#[case("vmax * (S", 8, 1, "not closed")]
#[case("vmax * S)", 9, 1, "never opened")]
#[case("vmax S", 6, 1, "operator is missing")]
#[case("2 S", 3, 1, "read as a unit")]
#[case("2 k_x", 3, 3, "read as a unit")]
#[case("S/2 km", 5, 2, "may be the unit or the declared name")]
#[case("1 uM/km", 6, 2, "may be the unit or the declared name")]
#[case("0.5 1/s", 5, 1, "between two numbers")]
#[case("foo(S)", 1, 3, "unknown function")]
#[case("exp", 1, 3, "is a function")]
#[case("exp()", 1, 5, "takes 1 value, found 0")]
#[case("min(S)", 1, 6, "takes 2 values, found 1")]
#[case("S ** 2", 3, 2, "no operator")]
#[case("[S] * 2", 1, 1, "unexpected \"[\"")]
#[case("S = 2", 3, 1, "unexpected \"=\"")]
#[case("1 < n < 2", 7, 1, "do not chain")]
#[case("1_0 * S", 1, 3, "not a number")]
#[case("", 1, 1, "empty")]
#[case("1, 2", 2, 1, "comma")]
fn faults_say_where(#[case] text: &str, #[case] column: u32, #[case] width: u32, #[case] reason: &str) {
    let faults = compile(text, Dimension::CONCENTRATION_RATE).unwrap_err();
    let fault = &faults[0];
    let place = fault.place.as_ref().unwrap();
    assert!(fault.reason.contains(reason), "{text}: {}", fault.reason);
    assert_eq!((place.column, place.width), (column, width), "{text}: {}", fault.reason);
}

#[test]
fn excessive_expressions_are_refused() {
    let deep = |n: usize| format!("{}S{}", "(".repeat(n), ")".repeat(n));
    assert!(compile(&deep(5000), Dimension::CONCENTRATION).is_err());
    assert!(compile(&deep(400), Dimension::CONCENTRATION).unwrap_err()[0].reason.contains("too deep"));
    assert!(compile(&"-".repeat(5000), Dimension::NONE).is_err());
    let right = format!("{}n{}", "n + (".repeat(40), ")".repeat(40));
    assert!(compile(&right, Dimension::NONE).unwrap_err()[0].reason.contains("intermediate"));
    let long = vec!["n"; 5000].join(" + ");
    assert!(compile(&long, Dimension::NONE).is_err(), "a sum of thousands of terms nests to the left");
}

proptest! {
    #[test]
    fn no_text_panics(text in "[Snk0-9a-z+*/^(), .<>=-]{0,40}") {
        let _ = compile(&text, Dimension::NONE).map(|program| program.eval(&[1.0, 2.0]));
    }
}

/// `cargo test --release law_speed -- --ignored --nocapture`
#[test]
#[ignore = "prints a timing"]
fn law_speed() {
    let law = compile("vmax * S / (km + S)", Dimension::CONCENTRATION_RATE).unwrap();
    let start = std::time::Instant::now();
    let mut sum = 0.0;
    for k in 0..10_000_000 {
        sum += law.eval(std::hint::black_box(&[f64::from(k), 1.0]));
    }
    println!("{:.1} ns per evaluation ({sum:e})", start.elapsed().as_secs_f64() * 100.0);
}
