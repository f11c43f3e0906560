//! Hemispheres of lights over one viewer, coloured and with isolines: figures 1 and 2 of Barla, Belcour and
//! Pacanowski 2015.

use std::f64::consts::PI;

use brdf_model::Brdf;
use brdf_param::{DirectionPair, Parametrization, spherical_direction};
use brdf_study::{Centre, Slice, radial_shares};
use glam::DVec3;
use plotters::prelude::*;

use crate::axis::{Ticked, draw_axes};
use crate::colours::{INK, NO_DATA, TEST_FUNCTIONS};
use crate::error::{PlotError, drawing};
use crate::heat::{Contours, Field, HeatScale, draw_bar};
use crate::plot::{Bitmap, Plot, Sheet, on_sheet};

/// The parametrizations of the paper.
const SHOWN: [Parametrization; 3] =
    [Parametrization::HalfDifference, Parametrization::Orthographic, Parametrization::Hybrid];
/// Radians between the normal and the camera, which stands over the mirror or the back direction: from here both
/// are near the middle for viewers from 30° to 75°.
const CAMERA_THETA: f64 = 50.0 * PI / 180.0;
/// Units of the radius of a hemisphere.
const RADIUS: i32 = 100;
/// Cells of a picture along that radius.
const CELLS: usize = 150;
/// Room around a hemisphere, above it for the title, and over all for the heading.
const MARGIN: i32 = 10;
const TITLE: i32 = 22;
const HEADING: i32 = 30;
/// Room of the colours of both axes, and the side of their square.
const CODE: i32 = 200;
const CODE_SIDE: i32 = 120;
/// Room of the scale of luminance.
const BAR: i32 = 100;
/// Isolines of coordinates and functions: tenths of a range.
const TENTHS: usize = 9;
/// Decades of luminance that colours span at most, and isolines over them.
const DECADES: f64 = 3.0;
const LEVELS: usize = 10;
/// Isolines of the first and the second coordinate: apart in greyscale too.
const COORDINATES: [[u8; 3]; 2] = [[255, 255, 255], [0, 0, 0]];
const MARKS: &str = "dot: viewer, cross: mirror direction";

/// Plots both radial coordinates of the parametrizations in the paper on the hemisphere of lights, for viewers at
/// `theta_o_deg` degrees from the normal: figure 1 of Barla, Belcour and Pacanowski 2015.
///
/// A row for each parametrization. First the colours: red grows with the first coordinate, green with the second.
/// Then the hemispheres, seen from the side of the mirror direction and from that of the viewer. Lines are tenths of
/// both ranges, white for the first coordinate and black for the second.
///
/// ```
/// let plot = brdf_plot::plot_coordinate_hemispheres(&[60.0])?;
/// assert!(plot.svg().contains("theta_o = 60°, back side"));
/// # Ok::<(), brdf_plot::PlotError>(())
/// ```
///
/// # Errors
///
/// [`PlotError::Nothing`] without a viewer; [`PlotError::Drawing`].
pub fn plot_coordinate_hemispheres(theta_o_deg: &[f64]) -> Result<Plot, PlotError> {
    let domes: Vec<Dome> = SHOWN
        .iter()
        .flat_map(|&parametrization| {
            Dome::all(theta_o_deg).map(move |dome| (parametrization, dome))
        })
        .map(|(parametrization, mut dome)| {
            let shares = dome.field(|pair| Some(radial_shares(parametrization, &pair)));
            dome.colour(shares.iter().map(|at| at.map(coded)));
            for (axis, colour) in COORDINATES.into_iter().enumerate() {
                dome.isolines(shares.iter().map(|at| at.map(|s| s[axis])), steps(TENTHS), colour);
            }
            dome
        })
        .collect();
    let layout = Layout { columns: 2 * theta_o_deg.len(), before: CODE, after: 0 };
    let heading = format!("tenths of the first coordinate white, of the second black; {MARKS}");
    layout.plot(&heading, &domes, |sheet, bitmaps| {
        SHOWN.into_iter().enumerate().try_for_each(|(row, parametrization)| {
            draw_code(sheet, bitmaps, HEADING + int(row) * step().1, parametrization)
        })
    })
}

/// Plots the three test functions on the hemisphere of lights, for viewers at `theta_o_deg` degrees from the normal:
/// the top of figure 2 of Barla, Belcour and Pacanowski 2015.
///
/// Lines are tenths of the functions: specular red, Fresnel black, grazing blue. Hemispheres are seen from the side of the
/// mirror direction and from that of the viewer.
///
/// # Errors
///
/// [`PlotError::Nothing`] without a viewer; [`PlotError::Drawing`].
pub fn plot_test_function_hemispheres(theta_o_deg: &[f64]) -> Result<Plot, PlotError> {
    let domes: Vec<Dome> = Dome::all(theta_o_deg)
        .map(|mut dome| {
            let paper = dome.field(|_| Some([250; 3]));
            dome.colour(paper.into_iter());
            for (function, colour) in TEST_FUNCTIONS {
                let values = dome.field(|pair| Some(function.value(&pair)));
                dome.isolines(values.into_iter(), steps(TENTHS), colour);
            }
            dome
        })
        .collect();
    let layout = Layout { columns: domes.len(), before: 0, after: 0 };
    layout.plot(&format!("tenths of S red, F black, G blue; {MARKS}"), &domes, |_, _| Ok(()))
}

/// Plots the luminance of a material on the hemisphere of lights, with isolines, for viewers at `theta_o_deg` degrees
/// from the normal.
///
/// Luminance is on a logarithm; grey: no data. Hemispheres are seen from the side of the mirror direction and from that
/// of the viewer.
///
/// # Errors
///
/// [`PlotError::Nothing`] without a viewer or for a material that is dark or unknown everywhere;
/// [`PlotError::Drawing`].
pub fn plot_luminance_hemispheres(
    name: &str,
    brdf: &dyn Brdf,
    theta_o_deg: &[f64],
) -> Result<Plot, PlotError> {
    let mut domes: Vec<Dome> = Dome::all(theta_o_deg).collect();
    let fields: Vec<Vec<Option<f64>>> = domes
        .iter()
        .map(|dome| dome.field(|pair| brdf.has_data(&pair).then(|| brdf.eval(&pair).luminance())))
        .collect();
    let values = || fields.iter().flatten().flatten();
    if !values().any(|value| *value > 0.0) {
        return Err(PlotError::Nothing { what: "the material is dark or unknown everywhere" });
    }
    let all = Field { columns: 1, values: fields.iter().flatten().copied().collect() };
    let scale = HeatScale::log_over("luminance (1/sr)", [&all], DECADES);
    let [low, high] = scale.range.map(f64::log10);
    for (dome, values) in domes.iter_mut().zip(&fields) {
        let [r, g, b, _] = NO_DATA;
        let colours = dome.field(|_| Some([r, g, b]));
        let known = values.iter().map(|value| value.map(|v| scale.colour(v)));
        dome.colour(known.zip(colours).map(|(known, grey)| known.or(grey)));
        let logs = values.iter().map(|value| value.map(|v| v.max(1e-30).log10()));
        let levels = steps(LEVELS).map(|share| low + share * (high - low));
        dome.isolines(logs, levels, [255; 3]);
    }
    let layout = Layout { columns: domes.len(), before: 0, after: BAR };
    layout.plot(&format!("{name}; {MARKS}"), &domes, |sheet, bitmaps| {
        let corner = (int(domes.len()) * step().0, HEADING + TITLE);
        draw_bar(sheet, bitmaps, corner, &scale)
    })
}

/// `count` shares strictly between 0 and 1.
fn steps(count: usize) -> impl Iterator<Item = f64> {
    (1..=count).map(move |step| step as f64 / (count + 1) as f64)
}

/// The colour of two shares, red and green; never so dark that black lines are lost.
fn coded(shares: [f64; 2]) -> [u8; 3] {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a byte")]
    let [red, green] = shares.map(|share| (80.0 + 160.0 * share.clamp(0.0, 1.0)) as u8);
    [red, green, 80]
}

/// Points of a line, each some units from the last, so that whole units make no stairs.
fn thinned(line: impl Iterator<Item = (i32, i32)>) -> Vec<(i32, i32)> {
    const APART: i32 = 4;
    let mut kept: Vec<(i32, i32)> = Vec::new();
    let mut last = None;
    for at in line {
        let is_far =
            kept.last().is_none_or(|&(x, y)| (at.0 - x).abs().max((at.1 - y).abs()) >= APART);
        if is_far {
            kept.push(at);
        }
        last = Some(at);
    }
    kept.extend(last.filter(|end| kept.last() != Some(end)));
    kept
}

fn int(count: usize) -> i32 {
    i32::try_from(count).unwrap_or(1)
}

/// From one hemisphere to the next, to the right and down.
fn step() -> (i32, i32) {
    (2 * (RADIUS + MARGIN), TITLE + Camera::height() + 2 * MARGIN)
}

/// An orthographic camera at azimuth 0 or π that looks at a hemisphere.
struct Camera {
    towards: DVec3,
    right: DVec3,
    up: DVec3,
}

impl Camera {
    fn over(side: Centre) -> Self {
        let towards = spherical_direction(CAMERA_THETA, side.azimuth());
        let right = DVec3::Z.cross(towards).normalize();
        Self { towards, right, up: towards.cross(right) }
    }

    /// The direction that is seen at a place of the picture, in radii from the middle of the surface to the right
    /// and up, or `None` beside the hemisphere.
    fn direction(&self, right: f64, up: f64) -> Option<DVec3> {
        let depth_sq = 1.0 - right * right - up * up;
        let seen = right * self.right + up * self.up + depth_sq.max(0.0).sqrt() * self.towards;
        (depth_sq >= 0.0 && seen.z > 0.0).then_some(seen)
    }

    /// The place of a direction, or `None` on the far side.
    fn place(&self, w: DVec3) -> Option<[f64; 2]> {
        (w.dot(self.towards) > 0.0).then(|| [w.dot(self.right), w.dot(self.up)])
    }

    /// How far the near rim lies below the middle of the surface, in radii.
    fn below() -> f64 {
        CAMERA_THETA.cos()
    }

    /// Units of a picture from the near rim to the top.
    #[expect(clippy::cast_possible_truncation, reason = "units of a small panel")]
    fn height() -> i32 {
        (f64::from(RADIUS) * (1.0 + Self::below())).ceil() as i32
    }
}

/// A picture of a hemisphere: cells row by row from the lowest, as in [`Field`].
struct Dome {
    title: String,
    theta_o: f64,
    camera: Camera,
    colours: Vec<Option<[u8; 3]>>,
    contours: Vec<Contours>,
}

impl Dome {
    const COLUMNS: usize = 2 * CELLS;

    /// Pictures for all viewers from the mirror side, then from the back.
    fn all(theta_o_deg: &[f64]) -> impl Iterator<Item = Self> {
        Centre::ALL.into_iter().flat_map(|side| {
            theta_o_deg.iter().map(move |degrees| Self {
                title: format!("theta_o = {degrees}°, {} side", side.name()),
                theta_o: degrees.to_radians(),
                camera: Camera::over(side),
                colours: Vec::new(),
                contours: Vec::new(),
            })
        })
    }

    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "rows of a small picture"
    )]
    fn rows() -> usize {
        (CELLS as f64 * f64::from(Camera::height()) / f64::from(RADIUS)).round() as usize
    }

    /// A value for each cell, `None` beside the hemisphere.
    fn field<T>(&self, value: impl Fn(DirectionPair) -> Option<T>) -> Vec<Option<T>> {
        let wo = Centre::Back.direction(self.theta_o);
        let radii = |cell: usize| (cell as f64 + 0.5) / CELLS as f64;
        (0..Self::rows() * Self::COLUMNS)
            .map(|index| {
                let right = radii(index % Self::COLUMNS) - 1.0;
                let up = radii(index / Self::COLUMNS) - Camera::below();
                value(DirectionPair::new(self.camera.direction(right, up)?, wo))
            })
            .collect()
    }

    fn colour(&mut self, colours: impl Iterator<Item = Option<[u8; 3]>>) {
        self.colours = colours.collect();
    }

    fn isolines(
        &mut self,
        values: impl Iterator<Item = Option<f64>>,
        levels: impl Iterator<Item = f64>,
        colour: [u8; 3],
    ) {
        let field = Field { columns: Self::COLUMNS, values: values.collect() };
        self.contours.push(Contours { field, levels: levels.collect(), colour });
    }

    /// Units from the left and from the top of the picture, of a place in radii.
    #[expect(clippy::cast_possible_truncation, reason = "units of a small panel")]
    fn unit(corner: (i32, i32), [right, up]: [f64; 2]) -> (i32, i32) {
        let radius = f64::from(RADIUS);
        let down = f64::from(Camera::height()) - radius * (up + Camera::below());
        (corner.0 + (radius * (right + 1.0)).round() as i32, corner.1 + down.round() as i32)
    }

    fn draw(
        &self,
        sheet: &Sheet<'_>,
        bitmaps: &mut Vec<Bitmap>,
        (left, top): (i32, i32),
    ) -> Result<(), PlotError> {
        let style = ("sans-serif", 13).into_font().color(&INK);
        sheet
            .draw(&Text::new(self.title.clone(), (left + MARGIN, top + 2), style))
            .map_err(|e| drawing(&e))?;
        let corner = (left + MARGIN, top + TITLE);
        let pixels = self
            .colours
            .chunks_exact(Self::COLUMNS)
            .rev()
            .flatten()
            .flat_map(|colour| colour.map_or([0; 4], |[r, g, b]| [r, g, b, 255]))
            .collect();
        let place = [corner.0, corner.1, 2 * RADIUS, Camera::height()];
        bitmaps.push(Bitmap { place, columns: Self::COLUMNS, rows: Self::rows(), pixels });
        let extent = [2.0, Self::rows() as f64 / CELLS as f64];
        for contours in &self.contours {
            let [r, g, b] = contours.colour;
            for line in contours.lines(extent)? {
                let points =
                    line.iter().map(|(x, y)| Self::unit(corner, [x - 1.0, y - Camera::below()]));
                let path = PathElement::new(thinned(points), RGBColor(r, g, b).stroke_width(1));
                sheet.draw(&path).map_err(|e| drawing(&e))?;
            }
        }
        self.draw_rim(sheet, corner)?;
        self.draw_marks(sheet, corner)
    }

    /// The outline: half a circle above, the near half of the surface's rim below.
    fn draw_rim(&self, sheet: &Sheet<'_>, corner: (i32, i32)) -> Result<(), PlotError> {
        let rim: Vec<(i32, i32)> = (0..=180)
            .map(|step| {
                let (sin, cos) = (2.0 * PI * f64::from(step) / 180.0).sin_cos();
                let up = if sin < 0.0 { sin * Camera::below() } else { sin };
                Self::unit(corner, [cos, up])
            })
            .collect();
        sheet.draw(&PathElement::new(rim, INK.stroke_width(1))).map_err(|e| drawing(&e))
    }

    fn draw_marks(&self, sheet: &Sheet<'_>, corner: (i32, i32)) -> Result<(), PlotError> {
        let place = |centre: Centre| {
            self.camera.place(centre.direction(self.theta_o)).map(|at| Self::unit(corner, at))
        };
        if let Some(at) = place(Centre::Back) {
            let dot = |radius, colour: RGBColor| Circle::new(at, radius, colour.filled());
            sheet.draw(&dot(5, WHITE)).map_err(|e| drawing(&e))?;
            sheet.draw(&dot(4, INK)).map_err(|e| drawing(&e))?;
        }
        if let Some((x, y)) = place(Centre::Mirror) {
            for (width, colour) in [(5, WHITE), (2, INK)] {
                for side in [-1, 1] {
                    let ends = vec![(x - 5, y - 5 * side), (x + 5, y + 5 * side)];
                    let stroke = PathElement::new(ends, colour.stroke_width(width));
                    sheet.draw(&stroke).map_err(|e| drawing(&e))?;
                }
            }
        }
        Ok(())
    }
}

/// Rows of hemispheres, with room before and after each row.
struct Layout {
    columns: usize,
    before: i32,
    after: i32,
}

impl Layout {
    fn plot(
        &self,
        heading: &str,
        domes: &[Dome],
        beside: impl FnOnce(&Sheet<'_>, &mut Vec<Bitmap>) -> Result<(), PlotError>,
    ) -> Result<Plot, PlotError> {
        if domes.is_empty() {
            return Err(PlotError::Nothing { what: "no viewers" });
        }
        let rows = domes.len().div_ceil(self.columns);
        let width = self.before + int(self.columns) * step().0 + self.after;
        let height = HEADING + int(rows) * step().1;
        on_sheet((width.unsigned_abs(), height.unsigned_abs()), |sheet, bitmaps| {
            let style = ("sans-serif", 14).into_font().color(&INK);
            sheet
                .draw(&Text::new(heading.to_owned(), (MARGIN, 8), style))
                .map_err(|e| drawing(&e))?;
            for (index, dome) in domes.iter().enumerate() {
                let column = int(index % self.columns) * step().0;
                let top = HEADING + int(index / self.columns) * step().1;
                dome.draw(sheet, bitmaps, (self.before + column, top))?;
            }
            beside(sheet, bitmaps)
        })
    }
}

/// Cells of the square of colours along a side.
const CODE_CELLS: usize = 60;

/// The colours of both axes of a parametrization.
fn draw_code(
    sheet: &Sheet<'_>,
    bitmaps: &mut Vec<Bitmap>,
    top: i32,
    parametrization: Parametrization,
) -> Result<(), PlotError> {
    let ([x, y], extent) = Slice::axes(parametrization);
    let (left, under, right) = (62, 40, CODE - 62 - CODE_SIDE);
    let share = |cell: usize| (cell as f64 + 0.5) / CODE_CELLS as f64;
    let pixels = (0..CODE_CELLS * CODE_CELLS)
        .flat_map(|index| {
            let shares = [share(index % CODE_CELLS), 1.0 - share(index / CODE_CELLS)];
            let [r, g, b] = coded(shares);
            [r, g, b, 255]
        })
        .collect();
    let place = [left, top + TITLE, CODE_SIDE, CODE_SIDE];
    bitmaps.push(Bitmap { place, columns: CODE_CELLS, rows: CODE_CELLS, pixels });
    let style = ("sans-serif", 13).into_font().color(&INK);
    let title = Text::new(parametrization.name(), (left, top + 2), style);
    sheet.draw(&title).map_err(|e| drawing(&e))?;
    let size = (CODE.unsigned_abs(), (TITLE + CODE_SIDE + under).unsigned_abs());
    let mut chart = ChartBuilder::on(&sheet.clone().shrink((0, top), size))
        .margin_top(TITLE)
        .margin_left(4)
        .margin_right(right)
        .x_label_area_size(under)
        .y_label_area_size(left - 4)
        .build_cartesian_2d(Ticked::up_to(extent), Ticked::up_to(extent))
        .map_err(|e| drawing(&e))?;
    draw_axes(&mut chart, x, y)
}

#[cfg(test)]
mod tests {
    use brdf_model::{Preset, Rgb};

    use super::*;

    #[test]
    fn a_camera_sees_a_direction_where_it_places_it() {
        for side in Centre::ALL {
            let camera = Camera::over(side);
            for theta in [0.0, 0.4, 1.2] {
                let w = side.direction(theta);
                let [right, up] = camera.place(w).expect("a direction on the near side");
                let seen = camera.direction(right, up).expect("a place on the hemisphere");
                assert!(seen.distance(w) < 1e-9, "{seen} for {w}");
            }
            let hidden = spherical_direction(1.5, side.azimuth() + PI);
            assert_eq!(camera.place(hidden), None);
            assert_eq!(camera.direction(0.0, -0.99 * Camera::below() - 0.01), None);
        }
    }

    #[test]
    fn pictures_hold_a_hemisphere_and_nothing_beside_it() {
        let Some(dome) = Dome::all(&[30.0]).next() else { panic!("a picture for each viewer") };
        let cells = dome.field(|pair| Some(pair.wi));
        assert_eq!(cells.len(), Dome::rows() * Dome::COLUMNS);
        assert!(cells.iter().flatten().all(|wi| wi.z > 0.0 && (wi.length() - 1.0).abs() < 1e-9));
        // Half a disc and half an ellipse.
        let expected = 0.5 * PI * (1.0 + Camera::below()) * (CELLS * CELLS) as f64;
        let seen = cells.iter().flatten().count() as f64;
        assert!((seen / expected - 1.0).abs() < 0.01, "{seen} cells of {expected}");
    }

    #[test]
    fn thinned_lines_keep_their_ends() {
        let line = |last: i32| (0..=last).map(|x| (x, x / 8));
        assert_eq!(thinned(line(10)), [(0, 0), (4, 0), (8, 1), (10, 1)]);
        assert_eq!(thinned(line(0)), [(0, 0)]);
        assert!(thinned(std::iter::empty()).is_empty());
    }

    #[test]
    fn without_a_viewer_or_light_there_is_nothing_to_plot() {
        struct Black;
        impl Brdf for Black {
            fn eval(&self, _: &DirectionPair) -> Rgb {
                Rgb::BLACK
            }
        }
        let gold = Preset::find("ggx").expect("a preset").brdf();
        for plot in [
            plot_coordinate_hemispheres(&[]),
            plot_test_function_hemispheres(&[]),
            plot_luminance_hemispheres("gold", &gold, &[]),
            plot_luminance_hemispheres("black", &Black, &[30.0]),
        ] {
            assert!(matches!(plot, Err(PlotError::Nothing { .. })));
        }
    }
}
