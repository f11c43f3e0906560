//! What a file gives, and its repair.

use std::collections::HashMap;

use glam::{DVec2, DVec3};
use serde::Serialize;

use crate::error::MeshError;

/// Triangles as a file gives them, not yet checked.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Soup {
    /// Positions of the vertices, in any unit.
    pub positions: Vec<DVec3>,
    /// Normals, one for each vertex, of any length above 0.
    pub normals: Option<Vec<DVec3>>,
    /// Texture coordinates, one for each vertex.
    pub uv: Option<Vec<DVec2>>,
    /// Three vertices of each triangle, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
}

/// Counts of what a mesh has and of what was repaired.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct MeshNotes {
    /// Vertices that triangles name.
    pub vertices: usize,
    /// Triangles with an area.
    pub triangles: usize,
    /// Vertices that no triangle names, dropped.
    pub unreferenced: usize,
    /// Triangles without area, dropped.
    pub degenerate: usize,
    /// Edges of more than two triangles; counted, not repaired.
    pub non_manifold_edges: usize,
    /// Edges of one triangle only: rims of holes.
    pub open_edges: usize,
    /// Neighbours of opposite winding; counted, not repaired.
    pub flipped_edges: usize,
    /// Vertices whose normals were made from the faces around.
    pub normals_made: usize,
    /// Given normals that point to the other side than the faces around; kept.
    pub opposed_normals: usize,
    /// Whether the faces enclose a volume from its inside: what is lit is then the inner side.
    pub is_inside_out: bool,
    /// Whether the file has texture coordinates.
    pub has_texture_coordinates: bool,
}

impl MeshNotes {
    /// Returns a line of text for each thing that was repaired or may surprise.
    pub fn lines(&self) -> Vec<String> {
        let counted = [
            (self.unreferenced, "vertices that no triangle names, dropped"),
            (self.degenerate, "triangles without area, dropped"),
            (self.non_manifold_edges, "edges of more than two triangles"),
            (self.open_edges, "edges of one triangle only (rims of holes)"),
            (self.flipped_edges, "edges between triangles of opposite winding"),
            (self.normals_made, "normals made from the faces around"),
            (self.opposed_normals, "normals that point away from the side the faces show; kept"),
        ];
        let some = counted.into_iter().filter(|(count, _)| *count > 0);
        let mut lines: Vec<String> = some.map(|(count, what)| format!("{count} {what}")).collect();
        if self.is_inside_out {
            lines.push(
                "faces look inwards; flip their winding if the outside should be lit".to_owned(),
            );
        }
        lines
    }
}

/// Share of its box that a body fills at least.
const LEAST_VOLUME: f64 = 0.02;

/// Twice the area, over the square of the longest edge, below which a triangle has none.
const THINNEST: f64 = 1e-12;

impl Soup {
    /// Returns a torus about the vertical, 3 across, with a tube of half that: smooth normals, every angle to a
    /// light, and texture coordinates, u around the axis and v around the tube.
    pub fn torus() -> Self {
        const AROUND: u32 = 96;
        const TUBE: u32 = 48;
        let mut soup = Self { normals: Some(Vec::new()), uv: Some(Vec::new()), ..Self::default() };
        for i in 0..=AROUND {
            for j in 0..=TUBE {
                let (u, v) = (f64::from(i) / f64::from(AROUND), f64::from(j) / f64::from(TUBE));
                // Both ends of a turn are one place, to the last digit.
                let [(sin_u, cos_u), (sin_v, cos_v)] =
                    [u.fract(), v.fract()].map(|turn| (std::f64::consts::TAU * turn).sin_cos());
                let normal = DVec3::new(sin_u * cos_v, sin_v, cos_u * cos_v);
                soup.positions.push(DVec3::new(sin_u, 0.0, cos_u) + 0.5 * normal);
                soup.normals.get_or_insert_default().push(normal);
                soup.uv.get_or_insert_default().push(DVec2::new(u, v));
                if i < AROUND && j < TUBE {
                    let at = i * (TUBE + 1) + j;
                    let across = at + TUBE + 1;
                    soup.triangles.extend([[at, across, across + 1], [at, across + 1, at + 1]]);
                }
            }
        }
        soup
    }

    /// What is worth keeping, a unit normal for each vertex, and what was done.
    pub(crate) fn repaired(mut self) -> Result<(Self, Vec<DVec3>, MeshNotes), MeshError> {
        self.check()?;
        let given = self.triangles.len();
        let positions = std::mem::take(&mut self.positions);
        self.triangles.retain(|triangle| !is_degenerate(triangle.map(|at| positions[at as usize])));
        self.positions = positions;
        let degenerate = given - self.triangles.len();
        if self.triangles.is_empty() {
            return Err(MeshError::Empty { triangles: given, degenerate });
        }
        let unreferenced = self.drop_unreferenced();
        let (normals, normals_made, opposed_normals) = self.unit_normals();
        let mut notes = MeshNotes {
            vertices: self.positions.len(),
            triangles: self.triangles.len(),
            unreferenced,
            degenerate,
            normals_made,
            opposed_normals,
            is_inside_out: self.is_inside_out(),
            has_texture_coordinates: self.uv.is_some(),
            ..MeshNotes::default()
        };
        self.count_edges(&mut notes);
        Ok((self, normals, notes))
    }

    fn check(&self) -> Result<(), MeshError> {
        let vertices = self.positions.len();
        let counts = [
            ("normal", self.normals.as_ref().map(Vec::len)),
            ("texture coordinate", self.uv.as_ref().map(Vec::len)),
        ];
        for (what, count) in counts {
            if let Some(found) = count.filter(|count| *count != vertices) {
                return Err(MeshError::Count { what, found, expected: vertices });
            }
        }
        for (triangle, corners) in self.triangles.iter().enumerate() {
            if let Some(&vertex) = corners.iter().find(|at| **at as usize >= vertices) {
                return Err(MeshError::Index { triangle, vertex, vertices });
            }
        }
        let mut named = vec![false; vertices];
        self.triangles.iter().flatten().for_each(|at| named[*at as usize] = true);
        let normals = self.normals.as_deref().unwrap_or_default();
        let uv = self.uv.as_deref().unwrap_or_default();
        for vertex in (0..vertices).filter(|vertex| named[*vertex]) {
            let refuse = |what| Err(MeshError::NotFinite { what, vertex });
            if !self.positions[vertex].is_finite() {
                return refuse("position");
            }
            if normals.get(vertex).is_some_and(|n| !n.is_finite()) {
                return refuse("normal");
            }
            if uv.get(vertex).is_some_and(|at| !at.is_finite()) {
                return refuse("texture coordinate");
            }
        }
        Ok(())
    }

    fn drop_unreferenced(&mut self) -> usize {
        let mut place = vec![None; self.positions.len()];
        let mut kept = Vec::new();
        for corner in self.triangles.iter_mut().flatten() {
            let slot = &mut place[*corner as usize];
            *corner = *slot.get_or_insert_with(|| {
                kept.push(*corner as usize);
                u32::try_from(kept.len() - 1).unwrap_or(u32::MAX)
            });
        }
        let dropped = self.positions.len() - kept.len();
        self.positions = kept.iter().map(|at| self.positions[*at]).collect();
        if let Some(values) = &mut self.normals {
            *values = kept.iter().map(|at| values[*at]).collect();
        }
        if let Some(values) = &mut self.uv {
            *values = kept.iter().map(|at| values[*at]).collect();
        }
        dropped
    }

    /// Normals of the file, or means of the faces around by their angles; vertices at one place have
    /// one normal, so that seams of texture coordinates do not show. Counts those that were made, and those of the file
    /// that point away from the faces around.
    fn unit_normals(&self) -> (Vec<DVec3>, usize, usize) {
        let key = |p: DVec3| p.to_array().map(|v| (v + 0.0).to_bits());
        let mut around: HashMap<[u64; 3], DVec3> = HashMap::new();
        for triangle in &self.triangles {
            let corners = triangle.map(|at| self.positions[at as usize]);
            let face = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalize();
            for at in 0..3 {
                let [own, next, last] = [0, 1, 2].map(|step| corners[(at + step) % 3]);
                let angle = (next - own).angle_between(last - own);
                *around.entry(key(own)).or_default() += angle * face;
            }
        }
        let (mut made, mut opposed) = (0, 0);
        let normals = self.positions.iter().enumerate().map(|(vertex, position)| {
            let given = self.normals.as_ref().and_then(|normals| normals[vertex].try_normalize());
            let faces = around[&key(*position)];
            opposed += usize::from(given.is_some_and(|given| given.dot(faces) < 0.0));
            given.unwrap_or_else(|| {
                made += 1;
                // Two faces back to back leave none; any side will do.
                faces.try_normalize().unwrap_or(DVec3::Y)
            })
        });
        let normals = normals.collect();
        (normals, made, opposed)
    }

    /// Whether the signed volume is clearly negative; sheets have next to none.
    fn is_inside_out(&self) -> bool {
        let corners = || self.triangles.iter().flatten().map(|at| self.positions[*at as usize]);
        let low = corners().fold(DVec3::INFINITY, DVec3::min);
        let high = corners().fold(DVec3::NEG_INFINITY, DVec3::max);
        let middle = 0.5 * (low + high);
        let volume = |triangle: &[u32; 3]| {
            let [a, b, c] = triangle.map(|at| self.positions[at as usize] - middle);
            a.dot(b.cross(c)) / 6.0
        };
        let whole = (high - low).element_product();
        self.triangles.iter().map(volume).sum::<f64>() < -LEAST_VOLUME * whole
    }

    /// By places, since seams split vertices.
    fn count_edges(&self, notes: &mut MeshNotes) {
        let mut places: HashMap<[u64; 3], u32> = HashMap::new();
        let place: Vec<u32> = self
            .positions
            .iter()
            .map(|p| {
                let next = u32::try_from(places.len()).unwrap_or(u32::MAX);
                *places.entry(p.to_array().map(|v| (v + 0.0).to_bits())).or_insert(next)
            })
            .collect();
        // Triangles that go along an edge from its lower to its higher place, and back.
        let mut edges: HashMap<[u32; 2], [usize; 2]> = HashMap::new();
        for triangle in &self.triangles {
            let corners = triangle.map(|at| place[at as usize]);
            for at in 0..3 {
                let (a, b) = (corners[at], corners[(at + 1) % 3]);
                let uses = edges.entry([a.min(b), a.max(b)]).or_default();
                uses[usize::from(a > b)] += 1;
            }
        }
        for uses in edges.values() {
            match uses {
                [1, 1] => {}
                [1, 0] | [0, 1] => notes.open_edges += 1,
                [2, 0] | [0, 2] => notes.flipped_edges += 1,
                _ => notes.non_manifold_edges += 1,
            }
        }
    }
}

fn is_degenerate([a, b, c]: [DVec3; 3]) -> bool {
    let (ab, ac) = (b - a, c - a);
    let longest = ab.length_squared().max(ac.length_squared()).max(b.distance_squared(c));
    let doubled = ab.cross(ac).length();
    // Written so that NaN and underflow are degenerate too.
    !(doubled > THINNEST * longest && doubled > f64::MIN_POSITIVE)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_turned_inside_out_is_noted() {
        let mut soup = Soup::torus();
        let (_, _, notes) = soup.clone().repaired().unwrap();
        assert!(!notes.is_inside_out && notes.opposed_normals == 0, "{notes:?}");
        soup.triangles.iter_mut().for_each(|triangle| triangle.swap(0, 1));
        let (_, _, notes) = soup.clone().repaired().unwrap();
        assert!(notes.is_inside_out && notes.opposed_normals == notes.vertices, "{notes:?}");
        assert!(notes.lines().iter().any(|line| line.contains("inwards")), "{:?}", notes.lines());
        let sheet = Soup {
            positions: vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::X + DVec3::Y],
            triangles: vec![[0, 2, 1], [1, 2, 3]],
            ..Soup::default()
        };
        assert!(!sheet.repaired().unwrap().2.is_inside_out, "a sheet has two sides");
    }

    /// A tetrahedron with a vertex that nobody names and a triangle without area.
    fn tetrahedron() -> Soup {
        let corner = |x, y, z| DVec3::new(x, y, z);
        Soup {
            positions: vec![
                corner(9.0, 9.0, 9.0),
                corner(1.0, 1.0, 1.0),
                corner(1.0, -1.0, -1.0),
                corner(-1.0, 1.0, -1.0),
                corner(-1.0, -1.0, 1.0),
            ],
            triangles: vec![[1, 2, 3], [1, 4, 2], [1, 3, 4], [2, 4, 3], [1, 2, 2]],
            ..Soup::default()
        }
    }

    #[test]
    fn what_is_dropped_and_made_is_counted() {
        let (soup, normals, notes) = tetrahedron().repaired().unwrap();
        let expected = MeshNotes {
            vertices: 4,
            triangles: 4,
            unreferenced: 1,
            degenerate: 1,
            normals_made: 4,
            ..MeshNotes::default()
        };
        assert_eq!(notes, expected);
        for (position, normal) in soup.positions.iter().zip(&normals) {
            assert!((position.normalize() - *normal).length() < 1e-12, "{normal} at {position}");
        }
    }

    #[test]
    fn the_torus_is_closed_and_faces_outwards() {
        let (soup, normals, notes) = Soup::torus().repaired().unwrap();
        assert_eq!((notes.open_edges, notes.non_manifold_edges, notes.flipped_edges), (0, 0, 0));
        assert_eq!(notes.normals_made, 0);
        for triangle in &soup.triangles {
            let [a, b, c] = triangle.map(|at| soup.positions[at as usize]);
            let normal = normals[triangle[0] as usize];
            assert!((b - a).cross(c - a).dot(normal) > 0.0, "counter-clockwise from outside");
        }
    }

    #[test]
    fn edges_are_counted_by_what_is_wrong_with_them() {
        let mut soup = tetrahedron();
        soup.triangles = vec![[1, 2, 3], [1, 4, 2], [1, 3, 4]];
        let (_, _, notes) = soup.clone().repaired().unwrap();
        assert_eq!((notes.open_edges, notes.flipped_edges, notes.non_manifold_edges), (3, 0, 0));
        soup.triangles = vec![[1, 2, 3], [1, 2, 4]];
        let (_, _, notes) = soup.clone().repaired().unwrap();
        assert_eq!((notes.open_edges, notes.flipped_edges, notes.non_manifold_edges), (4, 1, 0));
        soup.triangles.push([2, 1, 0]);
        let (_, _, notes) = soup.repaired().unwrap();
        assert_eq!(notes.non_manifold_edges, 1);
    }

    #[test]
    fn what_cannot_be_repaired_is_refused() {
        let mut soup = tetrahedron();
        soup.triangles = vec![[1, 2, 2], [3, 3, 3]];
        assert_eq!(
            soup.clone().repaired().unwrap_err(),
            MeshError::Empty { triangles: 2, degenerate: 2 }
        );
        soup.triangles = vec![[1, 2, 5]];
        let expected = MeshError::Index { triangle: 0, vertex: 5, vertices: 5 };
        assert_eq!(soup.clone().repaired().unwrap_err(), expected);
        soup.triangles = vec![[1, 2, 3]];
        soup.positions[2].y = f64::NAN;
        let expected = MeshError::NotFinite { what: "position", vertex: 2 };
        assert_eq!(soup.clone().repaired().unwrap_err(), expected);
        soup.positions[2].y = 0.0;
        soup.uv = Some(vec![DVec2::ZERO]);
        let what = "texture coordinate";
        let expected = MeshError::Count { what, found: 1, expected: 5 };
        assert_eq!(soup.repaired().unwrap_err(), expected);
    }
}
