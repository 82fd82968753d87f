//! debug
use fredholm_hierarchical::*;
use fredholm_iterative::CgTheta;
use fredholm_linop::*;
use fredholm_scene::Scene;
use fredholm_visibility::Occluders;
use fredholm_mesh::Vec3;
use fredholm_coupling::form_factor::*;
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let scene = Scene::load(&a[1]).unwrap();
    let mesh = scene.face_mesh().unwrap();
    let (rows, bands) = (mesh.len(), scene.bands().len());
    let surfaces = Surfaces {
        reflectance: MultiVector::from_vec(rows, bands, scene.reflectance(&mesh)).unwrap(),
        exitance: MultiVector::from_vec(rows, bands, scene.exitance(&mesh)).unwrap(),
    };
    let occluders = Occluders::new(mesh.occluders()).unwrap();
    let problem = Problem { mesh: &mesh, occluders: &occluders, surfaces: &surfaces };
    let options = Options { accuracy: a[2].parse().unwrap(), linear: std::env::var_os("CONSTANT").is_none(), residual: 1e-5, bytes: 8 << 30, max_iterations: 200 };
    let s = solve(&problem, &options, &CgTheta, None, &Patient).unwrap();
    let p = Vec3::new(a[3].parse().unwrap(), a[4].parse().unwrap(), a[5].parse().unwrap());
    let i = (0..rows).min_by(|x, y| mesh.patch(*x).centroid().distance(p).total_cmp(&mesh.patch(*y).centroid().distance(p))).unwrap();
    let exposed: Vec<f64> = s.system.elements().iter().map(|e| e.exposed).collect();
    let op = HierarchicalOperator::new(&s.tree, &s.links, &exposed);
    let roots: Vec<usize> = op.leaves().iter().map(|&l| s.tree.nodes()[l as usize].root().unwrap()).collect();
    let integ = PairIntegrator::new(mesh.patches(), &occluders, 1e-3);
    let mut w = Workspace::default();
    let mut x = MultiVector::from_fn(roots.len(), 1, |k, _| if roots[k] == i { 1.0 } else { 0.0 });
    let mut y = MultiVector::zeros(roots.len(), 1);
    op.apply(&x, &mut y); x.row_mut(0);
    let mut g = vec![0.0; rows]; let mut b = vec![0.0; rows];
    for k in 0..roots.len() { g[roots[k]] += y.row(k)[0]; b[roots[k]] += s.radiosity.row(k)[0] * s.system.elements()[k].area / mesh.patch(roots[k]).area(); }
    let area = mesh.patch(i).area();
    let mut d: Vec<(f64, usize, f64, f64)> = (0..rows).map(|j| { let e = integ.exchange(i, j, &mut w).value / area; (b[j] * (g[j] / area - e), j, g[j] / area, e) }).collect();
    d.sort_by(|a, b| b.0.abs().total_cmp(&a.0.abs()));
    trace(&s, s.tree.roots()[i]);
    println!("root {i} {} at {:?}", mesh.surfaces()[mesh.surface_of(i)].name, mesh.patch(i).centroid());
    for (k, j, h, e) in d.iter().take(14) { println!("{k:.2e} {j} {} {:.3?} hier {h:.4e} exact {e:.4e} B {:.3}", mesh.surfaces()[mesh.surface_of(*j)].name, mesh.patch(*j).centroid(), b[*j]); }
    let surf = |f: &dyn Fn(&(f64, usize, f64, f64)) -> f64| { let mut v = vec![0.0; mesh.surfaces().len()]; for t in &d { v[mesh.surface_of(t.1)] += f(t); } v };
    let (h, e) = (surf(&|t| t.2), surf(&|t| t.3));
    for (k, s) in mesh.surfaces().iter().enumerate() { println!("{} hier {:.4} exact {:.4}", s.name, h[k], e[k]); }
}
fn trace(s: &Solution, i: u32) {
    let mut n = Some(i);
    while let Some(k) = n {
        let x = &s.tree.nodes()[k as usize];
        println!("node {k} area {:.3e}", x.area());
        for l in &s.links {
            let o = if l.a == k { l.b } else if l.b == k { l.a } else { continue };
            let y = &s.tree.nodes()[o as usize];
            let p = y.patch().unwrap();
            if p.normal().y.abs() < 0.9 && p.centroid().distance(s.tree.nodes()[i as usize].patch().unwrap().centroid()) < 0.25 { println!("  <- {o} {:.3} area {:.3e} open {:.3e} share {:.3} spread {:?} doubt {:.2} {}", p.centroid(), y.area(), l.open / x.area(), l.share, l.rest, l.doubt, l.partly); }
        }
        n = x.parent();
    }
}
