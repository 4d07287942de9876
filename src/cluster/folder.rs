//! A folder for the blocks of an ensemble: made whole or not at all, and never mixed with another ensemble.

use super::{Ensemble, FOLDER, Folder};
use crate::error::{Fault, ModelError, RunError};
use crate::model::{FlowFile, Model, load};
use crate::record::ModelText;
use crate::tables::write_bytes;
use std::path::{Component, Path, PathBuf};

/// Folder of copies below the folder of blocks.
const INPUT: &str = "input";

/// Makes the folder of blocks below `results` for an ensemble whose model was read from files with `text` and replays
/// the `flow` of a file, or finds the one that is there for the same ensemble: scripts can be written anew without
/// losing blocks.
///
/// The model, its reactions file and that flow are copied, as far apart as they were, so that later changes to them
/// leave the blocks still to run alone.
///
/// # Errors
/// A folder that holds something else, or cannot be written; a model whose copy does not read as the model.
pub fn prepare(
    results: &Path,
    mut ensemble: Ensemble,
    text: &ModelText,
    flow: Option<&Path>,
) -> Result<Folder, ModelError> {
    let path = results.join(FOLDER);
    let shown = path.display();
    let other = "name another folder with --out";
    for dir in [results, &path] {
        if dir.exists() && !dir.is_dir() {
            return Err(Fault::general(format!("{} is not a folder", dir.display()), other).into());
        }
    }
    if path.exists() {
        if !path.join(super::DESCRIPTION).exists() {
            return Err(Fault::general(
                format!("{shown} is there and holds no blocks of an ensemble"),
                other,
            )
            .into());
        }
        let there = Folder::open(&path)?;
        let faults: Vec<Fault> = ensemble
            .differences(&there.ensemble)
            .into_iter()
            .map(|(what, then, now)| {
                Fault::general(
                    format!("{shown} holds blocks of another ensemble: the {what} was {then}, now {now}"),
                    format!("{other}, or remove that one with its blocks"),
                )
            })
            .collect();
        return if faults.is_empty() { Ok(there) } else { Err(ModelError { faults }) };
    }
    if results.join("run.json").exists() {
        return Err(Fault::general(format!("{} already holds a run", results.display()), other).into());
    }
    let copies = copies(&text.files, flow)?;
    ensemble.model = Path::new(INPUT).join(&copies[0].0);

    // All of it under another name first: a folder that has its name is complete.
    let new = !results.exists();
    let staged = stage(results, &ensemble, &copies).and_then(|staged| {
        check_copy(&staged, text, &ensemble)?;
        let kept = staged.keep();
        std::fs::rename(&kept, &path).map_err(|error| {
            let _ = std::fs::remove_dir_all(&kept);
            unwritable(&path, &error)
        })?;
        Ok(())
    });
    if staged.is_err() && new {
        let _ = std::fs::remove_dir(results);
    }
    staged?;
    Ok(Folder { path, ensemble })
}

fn unwritable(path: &Path, error: &dyn std::fmt::Display) -> Fault {
    Fault::general(format!("{}: {error}", path.display()), "name another folder with --out")
}

/// Copies and description in a folder that is removed again if it is not kept.
fn stage(
    results: &Path,
    ensemble: &Ensemble,
    copies: &[(PathBuf, Content)],
) -> Result<tempfile::TempDir, ModelError> {
    let io = |error: std::io::Error| unwritable(results, &error);
    std::fs::create_dir_all(results).map_err(io)?;
    let mut builder = tempfile::Builder::new();
    builder.prefix(".writing-");
    // Without this the folder would keep the private mode of a temporary one.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o755));
    let staged = builder.tempdir_in(results).map_err(io)?;
    let written = |error: RunError| unwritable(results, &error);
    for (relative, content) in copies {
        let target = staged.path().join(INPUT).join(relative);
        match content {
            Content::Text(text) => write_bytes(&target, text.as_bytes()).map_err(written)?,
            Content::File(path) => {
                std::fs::create_dir_all(target.parent().unwrap_or(&target)).map_err(io)?;
                std::fs::copy(path, &target).map_err(|error| unwritable(path, &error))?;
            }
        }
    }
    let folder = Folder { path: staged.path().to_path_buf(), ensemble: ensemble.clone() };
    folder.write_description().map_err(written)?;
    Ok(staged)
}

/// The copy must read as the model did, and from the copies alone.
fn check_copy(staged: &tempfile::TempDir, text: &ModelText, ensemble: &Ensemble) -> Result<(), ModelError> {
    let copy = load::model(&staged.path().join(&ensemble.model), &ensemble.overrides);
    let inside = |(path, _): &(String, String)| Path::new(path).starts_with(staged.path());
    let same = |copy: &Model| {
        let flow = match &copy.flow {
            Some(FlowFile::Record(path) | FlowFile::Replay(path)) => path.starts_with(staged.path()),
            None => true,
        };
        copy.text.hash == ensemble.hash && copy.text.files.iter().all(inside) && flow
    };
    if copy.is_ok_and(|copy| same(&copy)) {
        return Ok(());
    }
    Err(Fault::general(
        format!(
            "{} cannot be copied: it names a file by a path that leads elsewhere from the copy",
            text.files[0].0
        ),
        "name reactions and flow in a model by relative paths such as ../reactions/x.yaml",
    )
    .into())
}

/// What a copy is made of.
enum Content<'c> {
    Text(&'c str),
    File(&'c Path),
}

/// Files with their paths relative to the folder they have in common, the model first.
fn copies<'c>(
    texts: &'c [(String, String)],
    flow: Option<&'c Path>,
) -> Result<Vec<(PathBuf, Content<'c>)>, Fault> {
    let texts = texts.iter().map(|(path, text)| (Path::new(path), Content::Text(text)));
    let mut whole = Vec::new();
    for (path, content) in texts.chain(flow.map(|path| (path, Content::File(path)))) {
        let absolute = std::path::absolute(path)
            .map_err(|error| Fault::general(format!("{}: {error}", path.display()), ""))?;
        whole.push((plain(&absolute), content));
    }
    let mut common =
        whole.first().and_then(|(path, _)| path.parent()).map(Path::to_path_buf).unwrap_or_default();
    while !whole.iter().all(|(path, _)| path.starts_with(&common)) {
        common.pop();
    }
    for (path, _) in &mut whole {
        *path = path.strip_prefix(&common).map_or(path.clone(), Path::to_path_buf);
    }
    Ok(whole)
}

/// `/a/b/../c` -> `/a/c`, by the letters alone as models are read.
fn plain(path: &Path) -> PathBuf {
    let mut plain = PathBuf::new();
    for part in path.components() {
        match part {
            Component::ParentDir => {
                plain.pop();
            }
            Component::CurDir => {}
            other => plain.push(other),
        }
    }
    plain
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn copies_stay_as_far_apart_as_the_files() {
        let named = |paths: &[&str]| -> Vec<PathBuf> {
            let files: Vec<_> = paths.iter().map(|path| ((*path).to_string(), String::new())).collect();
            copies(&files, None).unwrap().into_iter().map(|(path, _)| path).collect()
        };
        assert_eq!(named(&["/a/m.yaml"]), [Path::new("m.yaml")]);
        assert_eq!(named(&["x/m.yaml"]), [Path::new("m.yaml")]);
        assert_eq!(
            named(&["/a/models/m.yaml", "/a/models/../reactions/r.yaml"]),
            [Path::new("models/m.yaml"), Path::new("reactions/r.yaml")]
        );
        assert_eq!(named(&["/a/m.yaml", "/a/r/s.yaml"]), [Path::new("m.yaml"), Path::new("r/s.yaml")]);
    }
}
