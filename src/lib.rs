//! Fredholm solves x = b + K x on the surfaces of a scene; this crate re-exports the public face of
//! its parts.
//!
//! Data flows one way: a [`scene`] is cut into a [`mesh`]; [`coupling`] assembles what its elements
//! exchange, with [`visibility`] and [`quadrature`]; a solver of [`iterative`] or [`direct`], whose
//! contract is [`linop`], finds the field; [`discretisation`] has other bases and equations than
//! constants on elements; [`hierarchical`] finds the elements that an accuracy asks for, and links
//! between elements of any size instead of a matrix; [`waves`] has the electromagnetic couplings;
//! [`montecarlo`] estimates the same fields from random paths; [`report`] writes what people look
//! at; [`study`] puts all of it together: a scene, a question and its answer.
//!
//! A study in whole: a scene is solved to 1 %, the irradiance of a surface is printed with its
//! stated error, and the results are written into a folder.
//!
//! ```
//! use fredholm::study::{Quiet, ResultFolder, SolveOptions, solve};
//! # let folder = tempfile::tempdir()?;
//!
//! let options = SolveOptions { accuracy: Some(0.01), ..SolveOptions::default() };
//! let mut solved = solve("scenes/occluder.toml", &options, &Quiet)?;
//! let floor = solved.surface("floor").ok_or("the scene has no floor")?;
//! println!("{:.4} ± {:.4} W/m²", floor.irradiance[0], floor.error[0]);
//! solved.write(&ResultFolder::claim(&folder)?)?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! The parts can be used one by one, too. In a closed room of one material the radiosity is M/(1 −
//! ρ) everywhere:
//!
//! ```
//! use fredholm::coupling::form_factor::PairIntegrator;
//! use fredholm::coupling::{Extent, Radiosity, assemble};
//! use fredholm::iterative::GaussSeidel;
//! use fredholm::linop::{MultiVector, Quiet, SecondKind, Solver, Stop};
//! use fredholm::scene::Scene;
//! use fredholm::visibility::Occluders;
//!
//! let text = r#"
//!     [materials.wall]
//!     reflectance = 0.75
//!     exitance = 1
//!
//!     [[surface]]
//!     name = "room"
//!     material = "wall"
//!     box = { min = [0, 0, 0], max = [1, 1, 1], inward = true }
//!     divide = [2, 2]
//! "#;
//! let scene = Scene::from_str(text, "room.toml")?;
//! let mesh = scene.mesh()?;
//!
//! let occluders = Occluders::new(mesh.occluders())?;
//! let integrator = PairIntegrator::new(mesh.patches(), &occluders, 1e-9);
//! let assembled = assemble::<f64>(&integrator, &Quiet)?;
//!
//! let extents = mesh.patches().map(|patch| Extent { area: patch.area(), exposed: patch.area() });
//! let reflectance = MultiVector::from_vec(mesh.len(), 1, scene.reflectance(&mesh))?;
//! let exitance = MultiVector::from_vec(mesh.len(), 1, scene.exitance(&mesh))?;
//! let radiosity = Radiosity::new(extents.collect(), reflectance, exitance)?;
//!
//! let system = SecondKind::new(&assembled.matrix, radiosity.scaling())?;
//! let mut x = radiosity.exitance().clone();
//! let stop = Stop { tolerance: 1e-12, max_iterations: 100 };
//! GaussSeidel.solve(&system, radiosity.exitance(), &mut x, &stop, &mut Quiet)?;
//! assert!(x.as_slice().iter().all(|b| (b - 4.0).abs() < 1e-8));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub use fredholm_coupling as coupling;
pub use fredholm_direct as direct;
pub use fredholm_discretisation as discretisation;
pub use fredholm_hierarchical as hierarchical;
pub use fredholm_iterative as iterative;
pub use fredholm_linop as linop;
pub use fredholm_mesh as mesh;
pub use fredholm_montecarlo as montecarlo;
pub use fredholm_quadrature as quadrature;
pub use fredholm_report as report;
pub use fredholm_scene as scene;
pub use fredholm_study as study;
pub use fredholm_visibility as visibility;
pub use fredholm_waves as waves;
