//! `flow: { record: FILE }` and `flow: { replay: FILE }`: a flow that serves many runs.

use super::node::Node;
use super::reader::{Faults, Fields};
use std::path::{Path, PathBuf};

/// What is to become of the flow.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum FlowFile {
    /// Write it to a file as it goes.
    Record(PathBuf),
    /// Take it from a file.
    Replay(PathBuf),
}

/// Reads `flow:`; paths are relative to the folder of the model.
pub(super) fn read(node: &Node, folder: &Path, faults: &mut Faults) -> Option<FlowFile> {
    let mut fields = Fields::of(node, "flow", faults)?;
    let (record, replay) = (fields.optional("record"), fields.optional("replay"));
    fields.finish(faults);
    match (record, replay) {
        (Some(n), None) => Some(FlowFile::Record(folder.join(n.text(faults)?))),
        (None, Some(n)) => {
            let path = folder.join(n.text(faults)?);
            if !path.is_file() {
                let reason = format!("{} is not there", path.display());
                faults.at(&n.place, reason, "record it first: flow: { record: FILE }");
                return None;
            }
            Some(FlowFile::Replay(path))
        }
        _ => {
            faults.at(
                &node.place,
                "expected either `record` or `replay`",
                "e.g. flow: { record: channel.flow }, and flow: { replay: channel.flow } where it is used",
            );
            None
        }
    }
}
