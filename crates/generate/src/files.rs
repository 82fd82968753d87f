//! A scene file and the mesh files beside it.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// A scene as text, with the mesh files that it names.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Files {
    /// Name of the scene file.
    pub name: String,
    /// Text of the scene file.
    pub scene: String,
    /// Names and texts of the files that it names; a name may have folders before it.
    pub others: Vec<(String, String)>,
}

impl Files {
    /// Writes the files into a folder, which is made where there is none; tells where the scene
    /// file lies.
    ///
    /// # Errors
    /// What the operating system says.
    pub fn write(&self, folder: &Path) -> io::Result<PathBuf> {
        fs::create_dir_all(folder)?;
        for (name, text) in &self.others {
            let path = folder.join(name);
            path.parent().map_or(Ok(()), fs::create_dir_all)?;
            fs::write(path, text)?;
        }
        let path = folder.join(&self.name);
        fs::write(&path, &self.scene)?;
        Ok(path)
    }
}

/// A rectangle in pieces as a surface of a scene file.
pub(crate) fn quad(name: &str, material: &str, corners: [[f64; 3]; 4], divide: [usize; 2]) -> String {
    format!(
        "[[surface]]\nname = \"{name}\"\nmaterial = \"{material}\"\nquad = {corners:?}\ndivide = {divide:?}\n"
    )
}
