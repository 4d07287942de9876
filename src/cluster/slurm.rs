//! Scripts for Slurm: an array job with a task a block, a merge job that depends on it, and what submits both.

use super::{Ensemble, Job};
use crate::error::Fault;
use std::path::Path;

/// Name, text and whether it is to be run by hand.
pub type Script = (&'static str, String, bool);

/// The scripts `block.sh`, `merge.sh` and `submit.sh`. Paths of folders are found when they run, so that the folder
/// can be moved; the path of the binary is written in and replaced by the variable `GILLESPH`.
///
/// # Errors
/// A binary whose path cannot be written in a script, a partition that is no name.
pub fn slurm(ensemble: &Ensemble, job: &Job, binary: &Path) -> Result<Vec<Script>, Fault> {
    let mut requests =
        vec![format!("#SBATCH --cpus-per-task={}", job.threads), format!("#SBATCH --time={}", job.time.text)];
    if let Some(memory) = &job.memory {
        requests.push(format!("#SBATCH --mem={}", memory.text));
    }
    if let Some(partition) = &job.partition {
        requests.push(format!("#SBATCH --partition={}", name_of_partition(partition)?));
    }
    let values = [
        ("@JOB@", job_name(&ensemble.name)),
        ("@REQUESTS@", requests.join("\n")),
        ("@WARNING@", job.time.warning().to_string()),
        ("@THREADS@", job.threads.to_string()),
        ("@BINARY@", word(path_text(binary)?)),
    ];
    let filled = |template: &str| fill(template, &values);
    Ok(vec![
        ("block.sh", filled(include_str!("scripts/block.sh")), false),
        ("merge.sh", filled(include_str!("scripts/merge.sh")), false),
        ("submit.sh", filled(include_str!("scripts/submit.sh")), true),
    ])
}

/// Puts values in the places of a template. What was put in is not looked at again.
pub(super) fn fill(template: &str, values: &[(&str, String)]) -> String {
    let mut filled = String::new();
    let mut rest = template;
    while let Some(at) = rest.find('@') {
        let (before, from) = rest.split_at(at);
        filled.push_str(before);
        match values.iter().find(|(place, _)| from.starts_with(place)) {
            Some((place, value)) => {
                filled.push_str(value);
                rest = &from[place.len()..];
            }
            None => {
                filled.push('@');
                rest = &from[1..];
            }
        }
    }
    filled + rest
}

/// A path as text.
///
/// # Errors
/// A path that is no text, or has characters that end a line.
pub(super) fn path_text(path: &Path) -> Result<&str, Fault> {
    path.to_str().filter(|text| !text.contains(char::is_control)).ok_or_else(|| {
        Fault::general(
            format!("the path {} cannot be written in a script", path.display()),
            "give the folders names without line breaks, in UTF-8",
        )
    })
}

/// A text as one word of the shell, in quotes where it needs them.
#[must_use]
pub fn word(text: &str) -> String {
    let plain = |c: char| c.is_alphanumeric() || "/._-+:,%".contains(c);
    if !text.is_empty() && text.chars().all(plain) {
        return text.into();
    }
    format!("'{}'", text.replace('\'', r"'\''"))
}

/// Name of the jobs: letters, digits and `.-_` only, for commas part lists of names.
fn job_name(model: &str) -> String {
    let plain = |c: char| if c.is_ascii_alphanumeric() || ".-_".contains(c) { c } else { '_' };
    format!("gillesph-{}", model.chars().map(plain).collect::<String>())
}

/// A name of a partition, or several with commas.
pub(super) fn name_of_partition(text: &str) -> Result<&str, Fault> {
    let plain = |c: char| c.is_ascii_alphanumeric() || ".-_,".contains(c);
    if text.is_empty() || !text.chars().all(plain) {
        return Err(Fault::general(
            format!("--partition {text}: expected the name of a partition"),
            "`sinfo` lists the partitions",
        ));
    }
    Ok(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_put_in_is_not_replaced_again() {
        let values = [("@A@", "@B@".to_string()), ("@B@", "it's".to_string())];
        assert_eq!(fill("x@A@y@B@@C@ a@b", &values), "x@B@yit's@C@ a@b");
        assert_eq!(fill("USR1@@B@", &values), "USR1@it's");
    }

    #[test]
    fn words_of_the_shell_keep_what_they_hold() {
        assert_eq!(word("a b'c$d"), r"'a b'\''c$d'");
        assert_eq!(word("/opt/bin/gillesph"), "/opt/bin/gillesph");
        assert_eq!(word("~/bin"), "'~/bin'");
        assert_eq!(job_name("Schlögl, 2"), "gillesph-Schl_gl__2");
    }
}
