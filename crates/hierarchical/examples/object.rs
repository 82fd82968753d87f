//! Writes a room with a curved object of about N triangles into a folder, as `object.toml` and
//! `object.obj`:
//! `cargo run --release -p fredholm-hierarchical --example object -- ball|ring|bowl N DIR`.

#[path = "../tests/common/shapes.rs"]
mod shapes;

use std::error::Error;
use std::path::Path;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [name, count, folder] = &arguments[..] else {
        return Err("give ball, ring or bowl, a number of triangles and a folder".into());
    };
    let object = shapes::object(name, count.parse()?).ok_or("the objects are ball, ring and bowl")?;
    let folder = Path::new(folder);
    std::fs::create_dir_all(folder)?;
    std::fs::write(folder.join("object.obj"), object)?;
    std::fs::write(folder.join("object.toml"), shapes::room_with("object.obj"))?;
    Ok(())
}
