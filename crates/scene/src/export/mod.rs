//! A scene in the formats of others: the flat pieces of its surfaces, what they reflect and emit in
//! red, green and blue, and its camera.
//!
//! A format is one file in this folder and one row of [`ExportFormat::ALL`]. The radiance of an
//! emitter is M/π, where M is its exitance.

mod glb;
mod gmsh;
mod mitsuba;
mod obj;
mod pbrt;
mod ply;
mod radiance;
mod stl;

use std::collections::{BTreeSet, HashMap};
use std::f64::consts::PI;
use std::path::Path;

use fredholm_mesh::{Patch, Vec3};

use crate::error::{ErrorKind, SceneError};
use crate::part::{Origin, Part};
use crate::resolve::{Camera, Material, colours};
use crate::scene::Scene;

/// A format to write.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ExportFormat {
    /// Wavefront OBJ and its material library.
    Obj,
    /// STL, binary.
    Stl,
    /// PLY, binary, little endian.
    Ply,
    /// Binary glTF 2.0.
    Glb,
    /// Gmsh 4.1, text.
    Gmsh,
    /// Radiance.
    Radiance,
    /// Mitsuba 3.
    Mitsuba,
    /// pbrt-v4.
    Pbrt,
}

impl ExportFormat {
    /// All of them with their names and the endings of their files.
    pub const ALL: [(Self, &'static str, &'static str); 8] = [
        (Self::Obj, "obj", "obj"),
        (Self::Stl, "stl", "stl"),
        (Self::Ply, "ply", "ply"),
        (Self::Glb, "gltf", "glb"),
        (Self::Gmsh, "gmsh", "msh"),
        (Self::Radiance, "radiance", "rad"),
        (Self::Mitsuba, "mitsuba", "xml"),
        (Self::Pbrt, "pbrt", "pbrt"),
    ];

    /// The format whose files end in this way, in small or capital letters.
    #[must_use]
    pub fn of(path: &Path) -> Option<Self> {
        let ending = crate::import::ending(path);
        Self::ALL.iter().find(|(_, _, known)| *known == ending).map(|(format, ..)| *format)
    }

    /// How its files end.
    #[must_use]
    pub fn ending(self) -> &'static str {
        Self::ALL.iter().find(|(format, ..)| *format == self).map_or("", |(_, _, ending)| ending)
    }
}

/// A surface as others read it.
#[derive(Clone, Debug, PartialEq)]
pub struct OutlineSurface {
    /// Its name.
    pub name: String,
    /// Index of its material.
    pub material: usize,
    /// Index of the material of its back, where it is lit there.
    pub back: Option<usize>,
    /// Flat convex polygons of three or four corners, m, counter-clockwise seen from the front.
    pub faces: Vec<Vec<Vec3>>,
}

/// A material as others read it: red, green and blue.
#[derive(Clone, Debug, PartialEq)]
pub struct OutlineMaterial {
    /// Its name.
    pub name: String,
    /// Reflectance.
    pub reflectance: [f64; 3],
    /// Exitance, W/m².
    pub exitance: [f64; 3],
}

impl OutlineMaterial {
    /// Whether it emits.
    fn emits(&self) -> bool {
        self.exitance.iter().any(|&m| m > 0.0)
    }

    /// Radiance M/π, W/(m² sr).
    fn radiance(&self) -> [f64; 3] {
        self.exitance.map(|m| m / PI)
    }
}

/// The surfaces, materials and camera of a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Outline {
    /// The surfaces.
    pub surfaces: Vec<OutlineSurface>,
    /// The materials.
    pub materials: Vec<OutlineMaterial>,
    /// Where the picture is taken from, if that is known.
    pub camera: Option<Camera>,
}

/// The files of a format, and what it cannot express.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Exported {
    /// Names, relative to a folder, with their contents; the one to open first.
    pub files: Vec<(String, Vec<u8>)>,
    /// What is not as in the scene.
    pub notes: Vec<String>,
}

impl Scene {
    /// The surfaces as others read them, in red, green and blue. Of a scene with other bands, one
    /// is taken for grey.
    ///
    /// # Errors
    /// [`ErrorKind::Name`] for a scene with several bands that are no colours, and for an unknown
    /// `band`.
    ///
    /// ```
    /// use fredholm_scene::{ExportFormat, Scene};
    /// let text = "[materials.clay]\nreflectance = 0.5\n[[surface]]\nname = \"a\"\nmaterial = \"clay\"\n\
    ///             box = { min = [0, 0, 0], max = [1, 1, 1] }\n";
    /// let outline = Scene::from_str(text, "a.toml")?.outline(None)?;
    /// assert_eq!(outline.surfaces[0].faces.len(), 6);
    /// let exported = outline.export(ExportFormat::Obj, "a");
    /// assert_eq!(exported.files[0].0, "a.obj");
    /// # Ok::<(), fredholm_scene::SceneError>(())
    /// ```
    pub fn outline(&self, band: Option<&str>) -> Result<Outline, SceneError> {
        let materials = self.materials().iter().map(|material| self.coloured(material, band));
        let materials = materials.collect::<Result<_, _>>()?;
        let surfaces = if self.overlaps() { self.parted()? } else { self.whole()? };
        Ok(Outline { surfaces, materials, camera: self.camera().copied() })
    }

    fn coloured(&self, material: &Material, band: Option<&str>) -> Result<OutlineMaterial, SceneError> {
        let refuse = |what: String| {
            let help = format!(
                "choose a band that stands for grey by `fredholm export --band`: {}",
                self.bands().join(", ")
            );
            Err(SceneError::new(ErrorKind::Name, self.path(), what, help))
        };
        let of = |values: &[f64]| match band {
            Some(name) => self.bands().iter().position(|band| band == name).map(|k| [values[k]; 3]),
            None => colours(self.bands(), values),
        };
        match (of(&material.reflectance), of(&material.exitance)) {
            (Some(reflectance), Some(exitance)) => {
                Ok(OutlineMaterial { name: material.name.clone(), reflectance, exitance })
            }
            _ => match band {
                Some(name) => refuse(format!("the scene has no band `{name}`")),
                None => refuse("the bands of the scene are not red, green and blue".to_owned()),
            },
        }
    }

    /// The undivided pieces of the parts.
    fn whole(&self) -> Result<Vec<OutlineSurface>, SceneError> {
        let mut surfaces: Vec<OutlineSurface> = vec![];
        for part in self.parts() {
            if is_back(part) {
                set_back(&mut surfaces, part.name.as_str(), part.material);
                continue;
            }
            let mut faces = vec![];
            for shape in part.shapes.iter() {
                let pieces = shape.blockers(&part.cutting).map_err(|error| self.unmeshable(part, &error))?;
                faces.extend(pieces.iter().map(|patch| patch.corners().to_vec()));
            }
            surfaces.push(OutlineSurface {
                name: part.name.clone(),
                material: part.material,
                back: None,
                faces,
            });
        }
        Ok(surfaces)
    }

    /// The faces of the mesh, where some pieces lie on others and only one of both is there.
    fn parted(&self) -> Result<Vec<OutlineSurface>, SceneError> {
        let mesh = self.face_mesh()?;
        let mut surfaces: Vec<OutlineSurface> = vec![];
        let mut number = vec![None; mesh.surfaces().len()];
        for (k, surface) in mesh.surfaces().iter().enumerate() {
            if self.parts().get(k).is_some_and(is_back) {
                set_back(&mut surfaces, &surface.name, surface.material);
                continue;
            }
            number[k] = Some(surfaces.len());
            let (name, material) = (surface.name.clone(), surface.material);
            surfaces.push(OutlineSurface { name, material, back: None, faces: vec![] });
        }
        for (leaf, patch) in mesh.patches().enumerate() {
            if let Some(k) = number[mesh.surface_of(leaf)] {
                surfaces[k].faces.push(Patch::corners(patch).to_vec());
            }
        }
        surfaces.retain(|surface| !surface.faces.is_empty());
        Ok(surfaces)
    }
}

/// Whether a part is the back of another.
fn is_back(part: &Part) -> bool {
    part.cutting.flipped
}

fn set_back(surfaces: &mut [OutlineSurface], name: &str, material: usize) {
    let front = name.strip_suffix("/back").unwrap_or(name);
    if let Some(surface) = surfaces.iter_mut().find(|surface| surface.name == front) {
        surface.back = Some(material);
    }
}

impl Outline {
    /// The files of a format; the main one is called `stem` and ends as the format does.
    #[must_use]
    pub fn export(&self, format: ExportFormat, stem: &str) -> Exported {
        match format {
            ExportFormat::Obj => obj::export(self, stem),
            ExportFormat::Stl => stl::export(self, stem),
            ExportFormat::Ply => ply::export(self, stem),
            ExportFormat::Glb => glb::export(self, stem),
            ExportFormat::Gmsh => gmsh::export(self, stem),
            ExportFormat::Radiance => radiance::export(self, stem),
            ExportFormat::Mitsuba => mitsuba::export(self, stem),
            ExportFormat::Pbrt => pbrt::export(self, stem),
        }
    }

    /// The same with fronts only, the light around a mesh file left out, and names without the
    /// first part, which stands for the file.
    #[must_use]
    pub fn bare(mut self, scene: &Scene) -> Self {
        let sky: Vec<&str> =
            scene.parts().iter().filter(|p| p.origin == Origin::Sky).map(|p| p.name.as_str()).collect();
        self.surfaces.retain(|surface| !sky.contains(&surface.name.as_str()));
        for surface in &mut self.surfaces {
            surface.back = None;
            if let Some((_, rest)) = surface.name.split_once('/') {
                surface.name = rest.to_owned();
            }
        }
        self
    }

    /// Fronts and backs, each with the name of its surface and its material.
    fn sides(&self) -> Vec<(String, usize, Vec<Vec<Vec3>>)> {
        let mut sides = vec![];
        for OutlineSurface { name, material, back, faces } in &self.surfaces {
            sides.push((name.clone(), *material, faces.clone()));
            if let Some(back) = back {
                let turned = |face: &Vec<Vec3>| face.iter().rev().copied().collect();
                sides.push((format!("{name}/back"), *back, faces.iter().map(turned).collect()));
            }
        }
        sides
    }
}

/// Says that a format holds no materials.
fn without_materials(format: &str) -> Vec<String> {
    vec![format!("{format} holds no materials: reflectances and exitances are left out")]
}

/// Names without blanks, each different from all others.
fn words<'a>(names: impl Iterator<Item = &'a str>) -> Vec<String> {
    let mut taken = BTreeSet::new();
    let word = |name: &str| {
        let plain: String =
            name.chars().map(|c| if c.is_whitespace() || c == '#' { '_' } else { c }).collect();
        let numbered = (2..).map(|k| format!("{plain}_{k}"));
        let free = std::iter::once(plain.clone()).chain(numbered).find(|word| !taken.contains(word));
        let word = free.unwrap_or(plain);
        taken.insert(word.clone());
        word
    };
    names.map(word).collect()
}

/// Corners that are the same number for number are one.
#[derive(Default)]
struct Merged {
    places: Vec<Vec3>,
    number: HashMap<[u64; 3], usize>,
}

impl Merged {
    /// The number of a corner, from 0.
    fn index(&mut self, corner: Vec3) -> usize {
        // Both zeros are one.
        let key = corner.to_array().map(|x| (x + 0.0).to_bits());
        let next = self.places.len();
        let index = *self.number.entry(key).or_insert(next);
        if index == next {
            self.places.push(corner);
        }
        index
    }

    fn face(&mut self, face: &[Vec3]) -> Vec<usize> {
        face.iter().map(|&corner| self.index(corner)).collect()
    }
}

/// The triangles of a convex polygon.
fn fan(face: &[usize]) -> impl Iterator<Item = [usize; 3]> + '_ {
    face.get(1..).unwrap_or_default().windows(2).map(|side| [face[0], side[0], side[1]])
}

/// Three numbers with blanks between them, each the shortest that reads back to the same bits.
fn triple(values: [f64; 3]) -> String {
    values.map(|x| format!("{}", x + 0.0)).join(" ")
}

/// A PLY file of the triangles of polygons.
fn triangles(faces: &[Vec<Vec3>]) -> Vec<u8> {
    let of = |face: &Vec<Vec3>| -> Vec<[Vec3; 3]> {
        face[1..].windows(2).map(|side| [face[0], side[0], side[1]]).collect()
    };
    let all: Vec<[Vec3; 3]> = faces.iter().flat_map(of).collect();
    ply::write(all.iter().map(|triangle| (0, triangle.as_slice())), &[])
}
