//! States of what is under way, as bytes and back.

use super::keep::Keep;
use crate::error::RunError;
use serde::{Deserialize, Serialize};

/// Lets `keep` keep a state under a name.
pub(super) fn save<T: Serialize>(keep: &dyn Keep, name: &str, state: &T) -> Result<(), RunError> {
    keep.save(name, &mut |out| postcard::to_io(state, out).map(|_| ()).map_err(|error| error.to_string()))
}

/// A state from bytes.
pub(super) fn decode<T: for<'de> Deserialize<'de>>(state: &[u8], name: &str) -> Result<T, RunError> {
    postcard::from_bytes(state).map_err(|_| foreign(name))
}

/// A state that does not belong to this plan.
pub(super) fn foreign(name: &str) -> RunError {
    RunError::File {
        path: name.into(),
        reason: "the state kept does not belong to this model; start anew with --force".into(),
    }
}
