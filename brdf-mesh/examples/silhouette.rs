//! Draws the built-in torus with characters by how far its surface turns towards the camera.
//!
//! `cargo run -p brdf-mesh --example silhouette`
#![allow(clippy::print_stdout, reason = "an example")]

use brdf_mesh::{Camera, Mesh, Soup};
use glam::{DVec2, DVec3};

const COLUMNS: usize = 64;
const ROWS: usize = 32;

fn main() -> Result<(), brdf_mesh::MeshError> {
    let (torus, notes) = Mesh::new(Soup::torus())?;
    println!("{} vertices, {} triangles", notes.vertices, notes.triangles);
    for line in notes.lines() {
        println!("{line}");
    }
    let from = DVec3::new(0.0, 0.7, 0.8).normalize();
    let camera = Camera::around(torus.centre(), torus.radius(), from);
    for row in 0..ROWS {
        let line = (0..COLUMNS).map(|column| {
            // Characters are about twice as high as wide.
            let place = DVec2::new(column as f64 + 0.5, 2.0 * row as f64 + 1.0);
            let ray = camera.ray(place, COLUMNS, 2 * ROWS);
            match torus.hit(camera.eye, ray, 0.0) {
                None => ' ',
                Some(hit) => match torus.surface(&hit).to_local(-ray).z {
                    cosine if cosine > 0.9 => '@',
                    cosine if cosine > 0.7 => 'o',
                    cosine if cosine > 0.4 => ':',
                    _ => '.',
                },
            }
        });
        println!("{}", line.collect::<String>().trim_end());
    }
    Ok(())
}
