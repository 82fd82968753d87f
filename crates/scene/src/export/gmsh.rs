//! Gmsh 4.1 as text: a surface and a physical group for each surface.

use std::fmt::Write;

use fredholm_mesh::Bounds;

use super::{Exported, Merged, Outline, triple};

pub(super) fn export(outline: &Outline, stem: &str) -> Exported {
    let sides = outline.sides();
    let (mut merged, mut blocks, mut number) = (Merged::default(), vec![], 0);
    for (k, (_, _, faces)) in sides.iter().enumerate() {
        for (kind, sides) in [(2, 3), (3, 4)] {
            let of: Vec<_> = faces.iter().filter(|face| face.len() == sides).collect();
            let mut block = format!("2 {} {kind} {}\n", k + 1, of.len());
            for face in &of {
                number += 1;
                let nodes: Vec<String> =
                    merged.face(face).iter().map(|node| (node + 1).to_string()).collect();
                // Writing to a string cannot fail.
                let _ = writeln!(block, "{number} {}", nodes.join(" "));
            }
            if !of.is_empty() {
                blocks.push(block);
            }
        }
    }
    let mut text = format!("$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$PhysicalNames\n{}\n", sides.len());
    for (k, (name, ..)) in sides.iter().enumerate() {
        let _ = writeln!(text, "2 {} \"{}\"", k + 1, name.replace('"', "'"));
    }
    let _ = writeln!(text, "$EndPhysicalNames\n$Entities\n0 0 {} 0", sides.len());
    for (k, (_, _, faces)) in sides.iter().enumerate() {
        let bounds = Bounds::around(faces.iter().flatten().copied());
        let [low, high] = bounds.map_or([[0.0; 3]; 2], |b| [b.min.to_array(), b.max.to_array()]);
        let _ = writeln!(text, "{} {} {} 1 {} 0", k + 1, triple(low), triple(high), k + 1);
    }
    let count = merged.places.len();
    let _ = writeln!(text, "$EndEntities\n$Nodes\n1 {count} 1 {count}\n2 1 0 {count}");
    for tag in 1..=count {
        let _ = writeln!(text, "{tag}");
    }
    for place in &merged.places {
        let _ = writeln!(text, "{}", triple(place.to_array()));
    }
    let _ = writeln!(text, "$EndNodes\n$Elements\n{} {number} 1 {number}", blocks.len());
    blocks.iter().for_each(|block| text.push_str(block));
    text.push_str("$EndElements\n");
    let notes = outline.without_materials("Gmsh");
    Exported { files: vec![(format!("{stem}.msh"), text.into_bytes())], notes }
}
