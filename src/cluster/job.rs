//! What a job asks of a scheduler, as people write it: time limit, memory, processors.

use crate::error::Fault;

/// What each block asks for.
#[derive(Clone, Debug)]
pub struct Job {
    pub time: TimeLimit,
    pub memory: Option<Memory>,
    pub threads: u32,
    pub partition: Option<String>,
}

/// A time limit in the words of Slurm, and what they come to.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TimeLimit {
    pub text: String,
    /// s.
    pub seconds: u64,
}

impl TimeLimit {
    /// Reads `M`, `M:S`, `H:M:S`, `D-H`, `D-H:M` or `D-H:M:S`.
    ///
    /// # Errors
    /// Anything else, and less than a minute: schedulers count in minutes.
    pub fn parse(text: &str) -> Result<TimeLimit, Fault> {
        let fault = |reason: String| {
            Fault::general(
                format!("--time {text}: {reason}"),
                "write hours:minutes:seconds, or days-hours:minutes:seconds, e.g. --time 02:00:00",
            )
        };
        let unreadable = || fault("expected a time limit".into());
        let (days, rest) = match text.split_once('-') {
            Some((days, rest)) => (Some(days), rest),
            None => (None, text),
        };
        let number = |part: &str| -> Result<u64, Fault> {
            let digits = !part.is_empty() && part.bytes().all(|b| b.is_ascii_digit());
            part.parse().ok().filter(|n| digits && *n <= 1_000_000).ok_or_else(unreadable)
        };
        let parts = rest.split(':').map(number).collect::<Result<Vec<u64>, Fault>>()?;
        let seconds = match (days, parts.as_slice()) {
            (None, [m]) => 60 * m,
            (None, [m, s]) => 60 * m + s,
            (None, [h, m, s]) => 3600 * h + 60 * m + s,
            (Some(_), [h]) => 3600 * h,
            (Some(_), [h, m]) => 3600 * h + 60 * m,
            (Some(_), [h, m, s]) => 3600 * h + 60 * m + s,
            _ => return Err(unreadable()),
        };
        let seconds = seconds + 86_400 * days.map_or(Ok(0), number)?;
        if seconds < 60 {
            return Err(fault("at least a minute is needed".into()));
        }
        Ok(TimeLimit { text: text.to_string(), seconds })
    }

    /// Seconds before the limit at which a block is told to stop: enough to end a step and write what there is.
    #[must_use]
    pub fn warning(&self) -> u64 {
        (self.seconds / 4).min(120)
    }
}

/// Memory of a job in the words of Slurm, and what they come to.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Memory {
    pub text: String,
    /// MiB, rounded up.
    pub mebibytes: u64,
}

impl Memory {
    /// Reads a whole number with `K`, `M`, `G` or `T`; without a letter it is MiB.
    ///
    /// # Errors
    /// Anything else, and nothing.
    pub fn parse(text: &str) -> Result<Memory, Fault> {
        let fault = || {
            Fault::general(
                format!("--memory {text}: expected a whole number with K, M, G or T"),
                "write e.g. --memory 4G",
            )
        };
        let digits = text.trim_end_matches(|c: char| "kmgtKMGT".contains(c));
        let number: u64 =
            digits.parse().ok().filter(|n| (1..=1_000_000_000).contains(n)).ok_or_else(fault)?;
        if !digits.bytes().all(|b| b.is_ascii_digit()) {
            return Err(fault());
        }
        let mebibytes = match text[digits.len()..].to_ascii_uppercase().as_str() {
            "" | "M" => number,
            "K" => number.div_ceil(1024),
            "G" => number * 1024,
            "T" => number * 1024 * 1024,
            _ => return Err(fault()),
        };
        Ok(Memory { text: text.to_string(), mebibytes })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_read_as_slurm_reads_them() {
        for (text, seconds) in [
            ("90", 5400),
            ("90:30", 5430),
            ("02:00:00", 7200),
            ("1-0", 86_400),
            ("1-02:30", 95_400),
            ("2-00:00:01", 172_801),
        ] {
            assert_eq!(TimeLimit::parse(text).unwrap().seconds, seconds, "{text}");
        }
        for text in ["", "2h", "1:2:3:4", "-1", "1-", "+5", "00:00:30", "0", "99999999999999999999", "1 0"] {
            assert!(TimeLimit::parse(text).is_err(), "{text}");
        }
        assert_eq!(TimeLimit::parse("02:00:00").unwrap().warning(), 120);
        assert_eq!(TimeLimit::parse("1").unwrap().warning(), 15);
    }

    #[test]
    fn memory_is_read_as_slurm_reads_it() {
        for (text, mebibytes) in [("4G", 4096), ("500", 500), ("500m", 500), ("1K", 1), ("2T", 2_097_152)] {
            assert_eq!(Memory::parse(text).unwrap().mebibytes, mebibytes, "{text}");
        }
        for text in ["", "G", "4GB", "0", "4.5G", "-1", "+4G", "4 G", "4GG"] {
            assert!(Memory::parse(text).is_err(), "{text}");
        }
    }
}
