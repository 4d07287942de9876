//! Reading nodes: every reader pushes its fault and goes on, so that all faults are reported at once.

mod fields;
mod values;

pub use crate::quantity::{did_you_mean, nearest};
pub use fields::Fields;
pub(crate) use values::is_name;

use crate::error::{Fault, ModelError, Place};

/// The faults found so far.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Faults {
    pub list: Vec<Fault>,
}

impl Faults {
    /// No fault yet.
    #[must_use]
    pub fn new() -> Faults {
        Faults::default()
    }

    /// Adds a fault at a place.
    pub fn at(&mut self, place: &Place, reason: impl Into<String>, remedy: impl Into<String>) {
        self.push(Fault::at(place, reason, remedy));
    }

    /// Adds a fault unless the same one is known.
    pub fn push(&mut self, fault: Fault) {
        if !self.list.contains(&fault) {
            self.list.push(fault);
        }
    }

    /// Names the key of each number that is out of its bounds, where the tree knows it.
    pub fn name_keys(&mut self, root: &super::node::Node) {
        for fault in &mut self.list {
            let bounds = fault.reason.contains(" may not be negative, found ")
                || fault.reason.starts_with("expected a positive ")
                || fault.reason.starts_with("expected a number from ");
            let key = fault.place.as_ref().filter(|_| bounds).and_then(|place| root.key_of(place));
            if let Some(key) = key {
                fault.reason = format!("\"{key}\": {}", fault.reason);
            }
        }
    }

    /// Whether nothing is wrong.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.list.is_empty()
    }

    /// All faults in order of file, line and column.
    #[must_use]
    pub fn into_error(self) -> ModelError {
        ModelError::sorted(self.list)
    }

    /// The value if nothing is wrong, all faults otherwise.
    ///
    /// # Errors
    /// Any fault in the list; without one, a missing value is a fault of its own.
    pub fn finish<T>(self, value: Option<T>) -> Result<T, ModelError> {
        match value {
            Some(value) if self.list.is_empty() => Ok(value),
            None if self.list.is_empty() => Err(Fault::general("the input could not be read", "").into()),
            _ => Err(self.into_error()),
        }
    }
}

#[cfg(test)]
mod tests;
