//! The files that a scene is made of, read once each, and their common fingerprint.

use std::collections::BTreeMap;
use std::io;
use std::path::{Path, PathBuf};

use sha2::{Digest, Sha256};

use crate::source::read;

/// Reads files named by a scene, relative to it, and remembers what it read.
#[derive(Debug)]
pub(crate) struct Files {
    folder: PathBuf,
    read: BTreeMap<PathBuf, Vec<u8>>,
}

impl Files {
    /// For the scene file at `scene`.
    pub fn beside(scene: &Path) -> Self {
        Self { folder: scene.parent().unwrap_or(Path::new("")).to_owned(), read: BTreeMap::new() }
    }

    /// The same, where some files are there already, by the names that the scene has for them.
    pub fn with(self, files: BTreeMap<PathBuf, Vec<u8>>) -> Self {
        Self { read: files, ..self }
    }

    /// Where a file named by the scene lies.
    pub fn path(&self, name: &Path) -> PathBuf {
        self.folder.join(name)
    }

    /// The bytes of a file named by the scene.
    pub fn load(&mut self, name: &Path) -> io::Result<Vec<u8>> {
        if let Some(bytes) = self.read.get(name) {
            return Ok(bytes.clone());
        }
        let bytes = read(&self.path(name))?;
        self.read.insert(name.to_owned(), bytes.clone());
        Ok(bytes)
    }

    /// SHA-256 (FIPS 180-4) of the scene's text and of the name, length and bytes of every other
    /// file, in the order of the names; in hexadecimal. It does not depend on where the files lie.
    pub fn fingerprint(&self, scene: &str) -> String {
        let mut digest = Sha256::new();
        digest.update((scene.len() as u64).to_le_bytes());
        digest.update(scene);
        for (name, bytes) in &self.read {
            digest.update(name.to_string_lossy().as_bytes());
            digest.update([0]);
            digest.update((bytes.len() as u64).to_le_bytes());
            digest.update(bytes);
        }
        format!("{:x}", digest.finalize())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_fingerprint_is_that_of_the_bytes_in_order() {
        // printf '\003\000\000\000\000\000\000\000abc' | sha256sum
        let expected = "ce91dc5eec0139adf091900d225971d6ad246a845bad791b5693a9d0d55dd391";
        assert_eq!(Files::beside(Path::new("a/b.toml")).fingerprint("abc"), expected);
    }
}
