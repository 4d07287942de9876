//! Two runs made by hand: what is shared, left out, paired and found.

use super::*;
use crate::random::{Purpose, Stream, stream};
use crate::samples::{Columns, SeriesBlock};
use crate::tables::SeriesTable;
use rand_distr::{Distribution, Poisson};

/// Runs of X in water, X in all (the same numbers), a constant K in all; `times` Poisson numbers of this
/// mean.
fn side(seed: u64, realizations: std::ops::Range<u32>, mean: f64, times: usize) -> Side {
    let columns = Columns {
        groups: ["water", "all", "all"].map(String::from).to_vec(),
        species: ["X", "X", "K"].map(String::from).to_vec(),
    };
    let poisson = Poisson::new(mean).unwrap();
    let block = |realization: u32| {
        let mut s: Stream = stream(seed, u64::from(realization), Purpose::Reactions);
        let amount: Vec<f64> = (0..times)
            .flat_map(|_| {
                let x: f64 = poisson.sample(&mut s);
                [x, x, 7.0]
            })
            .collect();
        SeriesBlock { realization, concentration: vec![0.0; amount.len()], amount }
    };
    let series = SeriesTable {
        times: (1..=times).map(|k| k as f64).collect(),
        columns,
        blocks: realizations.map(block).collect(),
    };
    Side { folder: format!("run_{seed}"), model: "poisson".into(), seed, series }
}

fn fault(a: &Side, b: &Side, question: &Question) -> String {
    compare(a, b, question).unwrap_err().to_string()
}

#[test]
fn constants_and_repeated_numbers_are_left_out() {
    let (a, b) = (side(1, 0..100, 50.0, 3), side(2, 0..80, 50.0, 3));
    let found = compare(&a, &b, &Question::default()).unwrap();
    assert_eq!((found.means, found.variances, found.equal, found.repeated), (3, 3, 3, 3));
    assert_eq!((found.pairing, found.a.realizations, found.b.realizations), (Pairing::Independent, 100, 80));
    assert!(found.rows.iter().all(|row| row.group == "water" && row.judged == "independent"));
    assert!(found.rows.windows(2).all(|pair| pair[0].p <= pair[1].p));
    let mut c = b.clone();
    c.series.blocks.iter_mut().for_each(|block| block.amount[2] = 8.0);
    let found = compare(&a, &c, &Question::default()).unwrap();
    let first = &found.rows[0];
    assert!(found.differs && first.species == "K" && first.judged == "certain" && first.p_adjusted == 0.0);
    assert!(found.verdict.contains("K in all at 1 s, mean +14 %"), "{}", found.verdict);
    assert_eq!(found.verdict.matches("differs").count(), 1);
}

#[test]
fn runs_of_one_seed_are_pairs() {
    let (a, whole) = (side(1, 0..100, 50.0, 2), side(1, 0..100, 50.0, 2));
    let same = compare(&a, &whole, &Question::default()).unwrap();
    assert!(!same.differs && same.rows.is_empty() && same.equal == 4, "{same:?}");
    assert!(same.verdict.contains("all 4 quantities are equal"), "{}", same.verdict);
    // One molecule more in every third realization: nothing beside a spread of seven, but all pairs go one
    // way.
    let mut b = whole.clone();
    for block in b.series.blocks.iter_mut().step_by(3) {
        block.amount[..2].iter_mut().for_each(|x| *x += 1.0);
    }
    let found = compare(&a, &b, &Question::default()).unwrap();
    assert!(found.pairing == Pairing::Paired && found.differs && found.rows[0].judged == "paired");
    b.seed = 2;
    assert!(!compare(&a, &b, &Question::default()).unwrap().differs);
    // Blocks of one ensemble that hardly overlap are independent; the two in both are left out once.
    let next = compare(&a, &side(1, 98..200, 50.0, 2), &Question::default()).unwrap();
    assert_eq!((next.pairing, next.a.realizations, next.b.realizations), (Pairing::Independent, 100, 100));
    // Half of the smaller one: the pairs alone.
    let half = compare(&a, &side(1, 50..120, 51.0, 2), &Question::default()).unwrap();
    assert_eq!((half.pairing, half.a.realizations, half.b.realizations), (Pairing::Paired, 50, 50));
}

#[test]
fn what_does_not_fit_is_named() {
    let (a, b) = (side(1, 0..10, 5.0, 8), side(2, 0..10, 5.0, 10));
    let text = fault(&a, &b, &Question::default());
    assert!(text.contains("9 s, 10 s only in run_2") && text.contains("--common-times"), "{text}");
    let common = Question { common_times: true, ..Question::default() };
    let found = compare(&a, &b, &common).unwrap();
    assert!(found.times_only_b == [9.0, 10.0] && found.text(1).contains("only in b: 9 s, 10 s"));
    let mut c = side(2, 0..10, 5.0, 8);
    c.series.columns.species = ["Y", "Y", "L"].map(String::from).to_vec();
    let text = fault(&a, &c, &Question::default());
    assert!(
        text.contains("no quantity in common: X in water, X in all, K in all against Y in water"),
        "{text}"
    );
    c.series.times.iter_mut().for_each(|t| *t += 0.5);
    let text = fault(&a, &c, &common);
    assert!(text.contains("the output times differ") && text.contains("no quantity"), "{text}");
    let few = fault(&side(1, 0..5, 5.0, 1), &side(1, 4..6, 5.0, 1), &Question::default());
    assert!(few.contains("too few others"), "{few}");
}

#[test]
fn fewer_questions_see_more() {
    let (a, b) = (side(1, 0..100, 50.0, 20), side(2, 0..100, 50.0, 20));
    let all = compare(&a, &b, &Question { difference: Some(0.05), ..Question::default() }).unwrap();
    let only = vec![Wanted::parse("X in water at 20 s").unwrap()];
    let one = compare(&a, &b, &Question { only, difference: Some(0.05), ..Question::default() }).unwrap();
    assert_eq!((all.means, one.means, one.variances), (20, 1, 1));
    let last = |found: &Comparison| {
        found.rows.iter().find(|row| row.time == 20.0 && row.moment == "mean").unwrap().clone()
    };
    let (wide, narrow) = (last(&all), last(&one));
    assert!(narrow.p == wide.p && narrow.detectable < wide.detectable && narrow.power > wide.power);
    assert!(one.verdict.contains("more in the mean of X in water at 20 s"), "{}", one.verdict);
    let rare = vec![Wanted::parse("Z").unwrap()];
    assert!(fault(&a, &b, &Question { only: rare, ..Question::default() }).contains("no species \"Z\""));
}

#[test]
fn differences_are_found_as_often_as_predicted_and_false_alarms_stay_at_the_level() {
    // 400 repeats of 200 + 200 realizations at three times, of mean 50 and 53 (6 %): the share found at a
    // time has a standard deviation below 2.5 %, five of them allowed, as the prediction itself is for one
    // test alone.
    let (mut alarms, mut hits, mut predicted) = (0, 0, 0.0);
    for r in 0..400 {
        let a = side(1000 + r, 0..200, 50.0, 3);
        let none = compare(&a, &side(3000 + r, 0..200, 50.0, 3), &Question::default()).unwrap();
        alarms += i32::from(none.differs);
        let question = Question { difference: Some(0.06), ..Question::default() };
        let found = compare(&a, &side(5000 + r, 0..200, 53.0, 3), &question).unwrap();
        let row = found.rows.iter().find(|row| row.time == 2.0 && row.moment == "mean").unwrap();
        hits += i32::from(row.differs);
        predicted += row.power / 400.0;
    }
    let share = f64::from(hits) / 400.0;
    // Holm's later steps are milder than the first, for which the power is stated: up to 3 % more are found.
    assert!(share > predicted - 0.1 && share < predicted + 0.13, "{share} {predicted}");
    assert!(predicted > 0.7 && predicted < 0.95, "{predicted}");
    // 5 % of 400 at most: 20 with a standard deviation of 4.4, four of them allowed.
    assert!(alarms <= 38, "{alarms}");
}
