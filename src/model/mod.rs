//! From YAML to a checked model: the only place that knows files, strings and units as people write them.

pub mod node;
pub mod reactions;
pub mod reader;
