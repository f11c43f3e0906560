//! What of the sky reaches a vertex and how much it counts for each term.

use glam::{DVec3, Mat3, Vec3};

use crate::chunk::{Entries, SparseVectors};
use crate::coefficients::{Coding, Selection, magnitudes};
use crate::cube::{FACE_TEXELS, TEXELS, direction, solid_angle};
use crate::frame::tangent_frame;
use crate::haar;
use crate::maps::{BrdfMaps, MapStack, Terms};
use crate::ray_packet::Occluder;
use crate::surface::ShadingPoint;
use crate::visibility::{Quality, Visibility};

impl SparseVectors {
    /// Adds a term of which no channel is above `largest`; what rounds to 0 is left out.
    pub(crate) fn add_term<'a>(
        &mut self,
        largest: f32,
        values: impl Iterator<Item = (u16, &'a [f32])>,
        coding: Coding,
    ) {
        let before = self.places.len();
        for (place, value) in values {
            let code = coding.encode(value, largest);
            if code != 0 {
                self.places.push(place);
                self.codes.push(code);
            }
        }
        self.largest.push(largest);
        self.counts.push(u16::try_from(self.places.len() - before).unwrap_or(u16::MAX));
    }
}

/// Directions and solid angles of all texels of the cube, as `f32`.
#[derive(Clone, Debug)]
pub struct CubeDirections {
    directions: Vec<Vec3>,
    solid_angles: Vec<f32>,
}

impl Default for CubeDirections {
    #[expect(clippy::cast_possible_truncation, reason = "transport is f32")]
    fn default() -> Self {
        Self {
            directions: (0..TEXELS).map(|texel| direction(texel).as_vec3()).collect(),
            solid_angles: (0..TEXELS).map(|texel| solid_angle(texel) as f32).collect(),
        }
    }
}

impl CubeDirections {
    /// Returns the unit directions of all texels.
    pub fn directions(&self) -> &[Vec3] {
        &self.directions
    }

    /// Returns the solid angles of all texels, sr.
    pub fn solid_angles(&self) -> &[f32] {
        &self.solid_angles
    }
}

/// Scratch memory for the transport of one vertex, used again for the next. It holds a value for each texel of the
/// cube and each value of the light maps, and the visibility of the texels.
#[derive(Clone, Debug)]
pub struct TransportWorkspace {
    /// Visible share of each texel, for the vertex that was last looked from.
    pub visibility: Visibility,
    /// `[texel or coefficient][term, channel]`.
    values: Vec<f32>,
    /// Faces that hold anything but zeros.
    lit: [bool; 6],
    scratch: Vec<f32>,
    magnitudes: Vec<f32>,
    selection: Selection,
    places: Vec<u16>,
}

impl TransportWorkspace {
    /// Returns a workspace for light maps of `width` values a texel: the number of terms times the channels of each,
    /// [`MapStack::width`]. It takes about 24,576 × 4 × `width` bytes.
    pub fn new(width: usize) -> Self {
        Self {
            visibility: Visibility::default(),
            values: vec![0.0; TEXELS * width],
            lit: [false; 6],
            scratch: vec![0.0; FACE_TEXELS * width],
            magnitudes: vec![0.0; TEXELS],
            selection: Selection::default(),
            places: Vec::new(),
        }
    }

    /// Computes the transport of a vertex: solid angle times visible share times cosine times light maps, for each
    /// texel of the cube, `[texel][value]`.
    ///
    /// Multiplied by radiance and summed over texels it is the light that each term receives (Eq. 3, with the
    /// cosine).
    ///
    /// # Panics
    ///
    /// Unless the light maps are as wide as the workspace.
    pub fn transport(
        &mut self,
        sky: &CubeDirections,
        occluder: &Occluder,
        site: &ShadingPoint,
        light: &MapStack,
        quality: Quality,
    ) -> &[f32] {
        self.visibility.look(occluder, site.position, site.normal, quality);
        self.weigh(sky, site.normal, light);
        &self.values
    }

    /// The same for the visibility that is there.
    fn weigh(&mut self, sky: &CubeDirections, normal: DVec3, light: &MapStack) {
        let width = light.width();
        assert_eq!(self.values.len(), TEXELS * width, "room for the light maps");
        for face in 0..6 {
            let texels = face * FACE_TEXELS..(face + 1) * FACE_TEXELS;
            let shares = &self.visibility.shares()[texels.clone()];
            let was_lit = self.lit[face];
            self.lit[face] = shares.iter().any(|share| *share > 0);
            let values = &mut self.values[texels.start * width..texels.end * width];
            if !self.lit[face] {
                if was_lit {
                    values.fill(0.0);
                }
                continue;
            }
            pulp::Arch::new().dispatch(Weigh {
                frame: tangent_frame(normal).as_mat3(),
                directions: &sky.directions[texels.clone()],
                solid_angles: &sky.solid_angles[texels],
                shares,
                light,
                values,
            });
        }
    }

    /// Transforms the values that [`TransportWorkspace::transport`] made to wavelet coefficients, in place, and
    /// returns them.
    pub fn transform(&mut self) -> &[f32] {
        let width = self.values.len() / TEXELS;
        for (face, values) in self.values.chunks_exact_mut(FACE_TEXELS * width).enumerate() {
            if self.lit[face] {
                haar::transform(values, width, &mut self.scratch);
            }
        }
        &self.values
    }

    /// Returns the `count` largest wavelet coefficients of each of `terms` terms.
    pub fn select(&mut self, terms: usize, count: usize) -> SparseVectors {
        let width = self.values.len() / TEXELS;
        let channels = width / terms;
        let coding = Coding::of(channels);
        let mut kept = SparseVectors::default();
        for term in 0..terms {
            let first = term * channels;
            magnitudes(&self.values, width, first, channels, &mut self.magnitudes);
            self.selection.largest(&self.magnitudes, count, &mut self.places);
            let of = |place: u16| &self.values[usize::from(place) * width + first..][..channels];
            let all = self.places.iter().flat_map(|place| of(*place));
            let largest = all.fold(0.0_f32, |most, v| most.max(v.abs()));
            kept.add_term(largest, self.places.iter().map(|place| (*place, of(*place))), coding);
        }
        kept
    }

    /// Coefficients, times the weight of their term, that hold an energy of at least `least`.
    pub(crate) fn gather(&self, terms: &Terms, least: f32) -> Entries {
        let mut entries = Entries::default();
        let faces = self.values.chunks_exact(FACE_TEXELS * terms.width()).enumerate();
        for (face, values) in faces.filter(|(face, _)| self.lit[*face]) {
            let first = face * FACE_TEXELS * terms.weights.len();
            let weights = terms.weights.iter().cycle();
            for ((column, values), weight) in
                (first..).zip(values.chunks_exact(terms.channels)).zip(weights)
            {
                let energy = weight * weight * values.iter().map(|v| v * v).sum::<f32>();
                if energy >= least && energy > 0.0 {
                    entries.columns.push(u32::try_from(column).unwrap_or(u32::MAX));
                    entries.values.extend(values.iter().map(|v| weight * v));
                }
            }
        }
        entries
    }
}

/// What a vertex that sees the whole sky holds: the sum of squares of its transport, times those of the weights of terms.
pub(crate) fn open_energy(sky: &CubeDirections, maps: &BrdfMaps, terms: &Terms) -> f64 {
    let mut values = vec![0.0; terms.width()];
    let texels = sky.directions.iter().zip(&sky.solid_angles);
    let energies = texels.filter(|(direction, _)| direction.z > 0.0).map(|(direction, angle)| {
        maps.light.read(*direction, direction.z * angle, &mut values);
        let each = values.chunks_exact(terms.channels).zip(&terms.weights);
        each.map(|(values, weight)| {
            f64::from(*weight).powi(2) * values.iter().map(|v| f64::from(*v).powi(2)).sum::<f64>()
        })
        .sum::<f64>()
    });
    energies.sum()
}

struct Weigh<'a> {
    frame: Mat3,
    directions: &'a [Vec3],
    solid_angles: &'a [f32],
    shares: &'a [u8],
    light: &'a MapStack,
    values: &'a mut [f32],
}

impl pulp::NullaryFnOnce for Weigh<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let to_local = self.frame.transpose();
        let texels = self.directions.iter().zip(self.solid_angles).zip(self.shares);
        let values = self.values.chunks_exact_mut(self.light.width());
        for (((direction, solid_angle), share), values) in texels.zip(values) {
            if *share == 0 {
                values.fill(0.0);
                continue;
            }
            let local = to_local * *direction;
            let weight = solid_angle * local.z.max(0.0) * f32::from(*share) / 16.0;
            self.light.read(local, weight, values);
        }
    }
}
