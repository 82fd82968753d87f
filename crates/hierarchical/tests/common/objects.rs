//! Rooms with curved objects, loaded as a user's scene is.

use super::common::Bench;
use super::shapes;

/// A room with a named object of about `count` triangles.
pub fn bench(name: &str, count: usize) -> Bench {
    let folder = std::env::temp_dir().join(format!("fredholm-curved-{name}-{count}-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    std::fs::write(folder.join("object.obj"), shapes::object(name, count).unwrap()).unwrap();
    std::fs::write(folder.join("object.toml"), shapes::room_with("object.obj")).unwrap();
    let scene = fredholm_scene::Scene::load(folder.join("object.toml")).unwrap();
    std::fs::remove_dir_all(&folder).unwrap();
    Bench::new(scene)
}
