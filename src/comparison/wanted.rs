//! A quantity as people write it: `RL in membrane at 0.8 s`, or a part of that.

use crate::error::Fault;
use crate::quantity::readable::show;
use crate::quantity::{Dimension, Quantity, did_you_mean};
use crate::samples::Columns;

/// A choice of quantities; what is not said is free.
#[derive(Clone, Debug, PartialEq)]
pub struct Wanted {
    text: String,
    species: Option<String>,
    group: Option<String>,
    /// s.
    time: Option<f64>,
}

impl Wanted {
    /// Reads `SPECIES`, `SPECIES in GROUP`, `SPECIES in GROUP at TIME`, `in GROUP`, `at TIME`.
    ///
    /// # Errors
    /// A time that is none; words that are left over.
    pub fn parse(text: &str) -> Result<Wanted, Fault> {
        let remedy =
            "write a quantity as SPECIES in GROUP at TIME, e.g. \"RL in membrane at 0.8 s\", or a part of it";
        let padded = format!(" {} ", text.trim());
        let (rest, time) = match padded.rsplit_once(" at ") {
            Some((rest, time)) => (rest, Some(seconds(text, time.trim())?)),
            None => (padded.as_str(), None),
        };
        let padded = format!("{rest} ");
        let (species, group) = match padded.rsplit_once(" in ") {
            Some((species, group)) => (species.trim(), Some(group.trim())),
            None => (padded.trim(), None),
        };
        let nothing = species.is_empty() && group.is_none() && time.is_none();
        if nothing || species.contains(' ') || group.is_some_and(|g| g.is_empty() || g.contains(' ')) {
            return Err(Fault::general(format!("--only \"{text}\": this is no quantity"), remedy));
        }
        Ok(Wanted {
            text: text.to_string(),
            species: (!species.is_empty()).then(|| species.to_string()),
            group: group.map(String::from),
            time,
        })
    }

    /// Marks what is meant among times x columns.
    ///
    /// # Errors
    /// A species, group or time that is not there, with what may have been meant.
    pub(super) fn mark(&self, times: &[f64], columns: &Columns, asked: &mut [bool]) -> Result<(), Fault> {
        let fault = |what: String, remedy: String| {
            Fault::general(format!("--only \"{}\": {what} in both runs", self.text), remedy)
        };
        let known = |what: &str, word: &Option<String>, names: &[String]| match word {
            Some(word) if !names.contains(word) => {
                let mut distinct = names.to_vec();
                distinct.sort();
                distinct.dedup();
                let near = did_you_mean(word, names.iter().map(String::as_str));
                let list = format!("there is {}", distinct.join(", "));
                let remedy = if near.is_empty() { list } else { format!("{near} {list}") };
                Err(fault(format!("there is no {what} \"{word}\""), remedy))
            }
            _ => Ok(()),
        };
        known("species", &self.species, &columns.species)?;
        known("group", &self.group, &columns.groups)?;
        let span = times.iter().fold(0.0f64, |m, t| m.max(t.abs()));
        let near = |t: f64, wanted: f64| (t - wanted).abs() <= 1e-9 * span;
        if let Some(wanted) = self.time
            && !times.iter().any(|&t| near(t, wanted))
        {
            let nearest = times.iter().min_by(|a, b| (*a - wanted).abs().total_cmp(&(*b - wanted).abs()));
            let remedy =
                nearest.map_or_else(String::new, |t| format!("the nearest time is {}", show(*t, "s")));
            return Err(fault(format!("there is no output at {}", show(wanted, "s")), remedy));
        }
        let fits = |own: &Option<String>, name: &String| own.as_ref().is_none_or(|own| own == name);
        let mut any = false;
        for (t, &time) in times.iter().enumerate() {
            for c in 0..columns.len() {
                if fits(&self.species, &columns.species[c])
                    && fits(&self.group, &columns.groups[c])
                    && self.time.is_none_or(|wanted| near(time, wanted))
                {
                    asked[t * columns.len() + c] = true;
                    any = true;
                }
            }
        }
        if any { Ok(()) } else { Err(fault("this species is not in this group".into(), String::new())) }
    }
}

fn seconds(text: &str, time: &str) -> Result<f64, Fault> {
    let fault =
        |reason: String, remedy: String| Fault::general(format!("--only \"{text}\": {reason}"), remedy);
    let quantity = Quantity::parse(time).map_err(|f| fault(f.reason, f.remedy))?;
    if quantity.dimension == Dimension::TIME || quantity.dimension == Dimension::NONE {
        return Ok(quantity.value);
    }
    Err(fault(format!("\"{time}\" is no time"), "write a time, e.g. 0.8 s".into()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn marked(text: &str) -> Result<Vec<usize>, String> {
        let columns = Columns {
            groups: ["membrane", "water", "all", "all"].map(String::from).to_vec(),
            species: ["RL", "L", "RL", "L"].map(String::from).to_vec(),
        };
        let mut asked = vec![false; 8];
        let wanted = Wanted::parse(text).map_err(|f| f.to_string())?;
        wanted.mark(&[0.0, 0.8], &columns, &mut asked).map_err(|f| f.to_string())?;
        Ok((0..8).filter(|&k| asked[k]).collect())
    }

    #[test]
    fn parts_of_a_quantity_choose_columns_and_times() {
        assert_eq!(marked("RL in membrane at 0.8 s").unwrap(), [4]);
        assert_eq!(marked("RL in membrane").unwrap(), [0, 4]);
        assert_eq!(marked("L").unwrap(), [1, 3, 5, 7]);
        assert_eq!(marked("at 800 ms").unwrap(), [4, 5, 6, 7]);
        assert_eq!(marked("in all at 0.8").unwrap(), [6, 7]);
        assert_eq!(marked("  L   in water at 0 s ").unwrap(), [1]);
    }

    #[test]
    fn what_is_not_there_is_named() {
        let fault = |text: &str| marked(text).unwrap_err();
        assert!(fault("Rl in membrane").contains("did you mean \"RL\"?"));
        assert!(fault("RL in membran").contains("did you mean \"membrane\"?"));
        assert!(fault("RL at 0.7 s").contains("nearest time is 800 ms"));
        assert!(fault("RL at 3 um").contains("no time"));
        assert!(fault("RL at noon").contains("expected a number"));
        assert!(fault("RL in water").contains("not in this group"));
        for text in ["", "two words", "RL in", "RL in two groups"] {
            assert!(fault(text).contains("no quantity"), "{text}");
        }
    }
}
