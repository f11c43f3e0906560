//! Paintings that put `brdf paint extract` to the test: a rendered one whose truth is known, and some that no
//! material can match. Each is shown as painted, as reconstructed, from new views and on another mesh.
//!
//! `cargo run --release -p brdf-cli --example paint_gallery [FOLDER]` writes `gallery/index.html` and its pictures.
//! Bunny and dragon are found through `BRDF_DATA`; without them, rings take their places.

#![expect(clippy::print_stdout, reason = "an example prints")]

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::time::Instant;

use anyhow::Context as _;
use brdf_files::{MappedFile, OutputFolder};
use brdf_image::{DIFFERENCE_GAIN, DisplayImage, Panel, ToneMap, encode_png, strip};
use brdf_job::Job;
use brdf_mesh::{Camera, Mesh, Soup, parse_mesh};
use brdf_model::{Analytic, Preset};
use brdf_paint::pictures::{compared, contradictions_view, painted, reconstructed};
use brdf_paint::{
    Extraction, GroundTruth, LightSource, PaintParams, PaintSamples, PaintView, PaintedImage,
    PixelSurface, SolverChoice, ViewBuffers, extract, face_views, vertex_views,
};
use brdf_render::{DirectionalLight, Light, MeshView, render_mesh};
use glam::{DVec2, DVec3};
use maud::html;
use serde_json::json;

/// Sides of the paintings and of the panels of the contact sheet.
const SIZE: usize = 320;
const SMALL: usize = 192;
const TONE: ToneMap = ToneMap { exposure: 1.0 };

fn main() -> anyhow::Result<()> {
    let folder = std::env::args_os().nth(1).map_or_else(|| "gallery".into(), PathBuf::from);
    let [mesh, other] = [open("bunny.ply")?, open("dragon_res3.ply")?];
    let views = vertex_views(&mesh);
    let unseen = face_views(&mesh);
    let all = buffers(&mesh, &views, SIZE);
    let mut folder = OutputFolder::new(&folder, true)?;
    let (mut sections, mut rows, mut figures) = (Vec::new(), Vec::new(), Vec::new());
    for painting in paintings(&all)? {
        let shown = Shown::of(&painting, &mesh, &views, &all)?;
        println!("{}: {}", painting.name, shown.figures());
        let mut pictures = shown.strips(&views, &all);
        pictures.push(shown.new_views(&mesh, &unseen));
        pictures.push((on_another(&other, &shown), "on another mesh, two views".to_owned()));
        let conflicts = contradictions_view(&shown.turns.contradictions);
        pictures.push((conflicts, "over u and v; red: views contradict each other".to_owned()));
        let mut named = Vec::new();
        for (at, (picture, caption)) in pictures.into_iter().enumerate() {
            let name = format!("{}-{at}.png", painting.name);
            folder.write(&name, &encode_png(&picture)?)?;
            named.push((name, caption));
        }
        rows.push(shown.row(&mesh, &other, &views[0], &unseen[7]));
        figures.push(json!({ "painting": painting.name, "figures": shown.figures() }));
        sections.push(html! {
            h2 { (painting.title) }
            p { (painting.what) }
            p { b { "Judged by eye. " } (painting.judged) }
            p { (shown.figures()) }
            @for (name, caption) in &named {
                figure { img src=(name) alt=(caption); figcaption { (caption) } }
            }
        });
    }
    folder.write("sheet.png", &encode_png(&stacked(&rows))?)?;
    let page = html! {
        (maud::DOCTYPE)
        html lang="en" {
            head { meta charset="utf-8"; title { "Painted materials" } style { (STYLE) } }
            body { h1 { "Painted materials" } @for section in &sections { (section) } }
        }
    };
    folder.write("index.html", page.into_string().as_bytes())?;
    let report = json!({ "brdf": env!("CARGO_PKG_VERSION"), "paintings": figures });
    folder.write("report.json", (serde_json::to_string_pretty(&report)? + "\n").as_bytes())?;
    folder.finish()?;
    Ok(())
}

const STYLE: &str = "body { font: 15px/1.5 system-ui, sans-serif; margin: 2rem auto; max-width: 84rem; padding: 0 1rem; }
img { max-width: 100%; height: auto; } figure { margin: .5rem 0; } figcaption { font-size: .85rem; color: #52525b; }";

fn open(name: &str) -> anyhow::Result<Mesh> {
    let data = std::env::var_os("BRDF_DATA").map_or_else(|| "../shared/data".into(), PathBuf::from);
    let path = data.join("meshes").join(name);
    let (mesh, _) = if Path::new(&path).exists() {
        parse_mesh(&MappedFile::open(&path)?)?
    } else {
        println!("{}: not there; a ring instead", path.display());
        Mesh::new(Soup::torus())?
    };
    Ok(mesh.with_sphere_coordinates())
}

fn buffers(mesh: &Mesh, views: &[PaintView], size: usize) -> Vec<ViewBuffers> {
    views.iter().map(|view| ViewBuffers::of(mesh, view, size, size)).collect()
}

/// What is painted on a surface by the view of a number; None leaves it transparent.
type Brush = Box<dyn Fn(usize, &PaintView, &PixelSurface) -> Option<[f64; 3]>>;

struct Painting {
    name: &'static str,
    title: &'static str,
    what: &'static str,
    judged: &'static str,
    brush: Brush,
}

impl Painting {
    /// Eight bits a channel, as from a painting program.
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a share of 255")]
    fn image(&self, at: usize, view: &PaintView, buffers: &ViewBuffers) -> PaintedImage {
        let shown = |surface: &PixelSurface| (self.brush)(at, view, surface);
        let pixels = buffers.pixels.iter().map(|surface| {
            let Some(colour) = surface.as_ref().and_then(shown) else { return [0.0; 4] };
            let [r, g, b] = colour.map(|v| (255.0 * v.clamp(0.0, 1.0).powf(1.0 / 2.2)) as u8);
            let [r, g, b] = [r, g, b].map(|v| (f32::from(v) / 255.0).powf(2.2));
            [r, g, b, 1.0]
        });
        PaintedImage { width: buffers.width, height: buffers.height, pixels: pixels.collect() }
    }
}

fn mix(a: [f64; 3], b: [f64; 3], share: f64) -> [f64; 3] {
    let share = share.clamp(0.0, 1.0);
    std::array::from_fn(|c| (1.0 - share) * a[c] + share * b[c])
}

/// The axes of the mesh in those of a surface cannot be told from its normal alone, but angles to the normal can.
fn highlight(view: &PaintView, surface: &PixelSurface, shift: f64) -> f64 {
    let LightSource::Direction(light) = view.light else { return 0.0 };
    let half = (light - view.camera.forward() + shift * view.camera.up()).normalize();
    surface.normal.dot(half).max(0.0).powi(60)
}

fn paintings(views: &[ViewBuffers]) -> anyhow::Result<Vec<Painting>> {
    let preset = |name: &str| Preset::find(name).context("a built-in material").map(|p| p.brdf());
    let brdfs: [Analytic; 3] =
        [preset("lafortune-blue-paint")?, preset("red-plastic")?, preset("ggx")?];
    let scale = truth(&brdfs, 1.0).scaled_for(views).scale;
    let blended: Brush = Box::new(move |_, _, surface| {
        if !surface.is_seen_and_lit() {
            return Some([0.0; 3]);
        }
        let pair = brdf_param::DirectionPair::new(surface.wi, surface.wo);
        let value = truth(&brdfs, scale).value(&pair, surface.uv) * surface.wi.z;
        Some(value.channels())
    });
    let lit = |surface: &PixelSurface| surface.wi.z.max(0.0);
    Ok(vec![
        Painting {
            name: "blended",
            title: "Three blended materials, rendered",
            what: "Blue paint, red plastic and gold, whose truth is known from everywhere.",
            judged: JUDGED[0],
            brush: blended,
        },
        Painting {
            name: "outline",
            title: "An outline",
            what: "Paper white, shaded softly, with a red line wherever the surface turns away from the camera.",
            judged: JUDGED[1],
            brush: Box::new(move |_, _, surface| {
                let line = (0.45 - surface.wo.z) / 0.1 + 0.5;
                Some(mix([0.85, 0.8, 0.7], [0.6, 0.04, 0.02], line).map(|v| v * lit(surface)))
            }),
        },
        Painting {
            name: "highlight",
            title: "A highlight where no mirror would put it",
            what: "Green, with a highlight that is moved upwards in every picture, away from the half vector.",
            judged: JUDGED[2],
            brush: Box::new(move |_, view, surface| {
                let spot = highlight(view, surface, 1.2);
                let matt = [0.06, 0.3, 0.1].map(|v| v * lit(surface));
                Some(mix(matt, [0.95; 3], spot))
            }),
        },
        Painting {
            name: "contradiction",
            title: "Views that contradict each other",
            what: "Every other view is red, the rest are blue: no material is both.",
            judged: JUDGED[3],
            brush: Box::new(move |at, _, surface| {
                let colour = if at % 2 == 0 { [0.75, 0.08, 0.05] } else { [0.05, 0.12, 0.7] };
                Some(colour.map(|v| v * lit(surface)))
            }),
        },
        Painting {
            name: "flat",
            title: "Flat colours without shading, three views",
            what: "Stripes filled in by someone who did not care where the light is; only views 0, 4 and 8 are painted.",
            judged: JUDGED[4],
            brush: Box::new(move |at, _, surface| {
                let stripe = DVec2::new(6.0 * surface.uv.x, 9.0 * surface.uv.y);
                let colour = if (stripe.x + stripe.y).fract() < 0.5 {
                    [0.9, 0.55, 0.1]
                } else {
                    [0.15, 0.1, 0.35]
                };
                (at % 4 == 0).then_some(colour)
            }),
        },
    ])
}

fn truth(brdfs: &[Analytic; 3], scale: f64) -> GroundTruth<'_> {
    GroundTruth { brdfs: [&brdfs[0], &brdfs[1], &brdfs[2]], scale }
}

/// What was seen in the pictures of each painting.
const JUDGED: [&str; 5] = [
    "By turns only sharp borders differ, by about a texel of the map, in painted views and in new ones; highlights stay \
     on what they belong to. On the dragon no seam shows; spots stretch towards the poles, and its dark specks are folded \
     triangles of the mesh. As published, five products come out as pale shadows of the three colours.",
    "By turns the line is where it was painted and follows the camera in new views and on the dragon: it is a factor of \
     |wo⊥|. Nothing fails. As published, the surface is mottled: pixels of the line scale down all that shares a texel.",
    "Fails where it must. From painted views highlights come back blurred, with pale edges, by baking them into the maps; \
     new views show those maps as stains, and highlights where the light is and where it was painted. The paper's radial \
     factors know how far the half vector is from the normal, not to which side. As published, hardly a highlight is left.",
    "Fails where it must. Patches of red, blue and purple, each a view that won; what the views share is kept, their \
     shading. The map of contradictions is red nearly everywhere that two views see. As published, the least of \
     both: nearly black.",
    "By turns stripes are as painted, with borders a texel wide; the new view keeps them, flat as they were. Pixels that \
     the light does not reach are black, since no material is bright there. What no view shows is filled with the mean of \
     its surroundings, smoothly. As published, the stripes all but vanish.",
];

/// A painting and what became of it.
struct Shown<'a> {
    painting: &'a Painting,
    images: Vec<PaintedImage>,
    turns: Extraction,
    published: Extraction,
    /// Root mean square over other views and lights, where what belongs there is known.
    held_out: Option<f64>,
    seconds: f64,
}

impl<'a> Shown<'a> {
    fn of(
        painting: &'a Painting,
        mesh: &Mesh,
        views: &[PaintView],
        all: &[ViewBuffers],
    ) -> anyhow::Result<Self> {
        let mut samples = PaintSamples::new();
        let mut images = Vec::new();
        for (at, (view, buffers)) in views.iter().zip(all).enumerate() {
            let image = painting.image(at, view, buffers);
            samples.add(at, &view.name, buffers, &image, 0.1)?;
            images.push(image);
        }
        let params = PaintParams { map_size: 128, wraps: true, ..PaintParams::default() };
        let start = Instant::now();
        let turns = extract(&samples, &params, &Job::new())?;
        let seconds = start.elapsed().as_secs_f64();
        let solver = SolverChoice::Paper;
        let published = extract(&samples, &PaintParams { solver, ..params }, &Job::new())?;
        let held_out = if painting.name == "blended" {
            let mut unseen = PaintSamples::new();
            for (at, view) in face_views(mesh).iter().enumerate() {
                let buffers = ViewBuffers::of(mesh, view, SIZE, SIZE);
                let image = painting.image(at, view, &buffers);
                unseen.add(at, &view.name, &buffers, &image, 0.1)?;
            }
            Some(turns.material.errors(&unseen).rms)
        } else {
            None
        };
        Ok(Self { painting, images, turns, published, held_out, seconds })
    }

    fn figures(&self) -> String {
        let (turns, published) = (self.turns.errors, self.published.errors);
        let mut text = format!(
            "RMS {:.3} (as published {:.3}), largest {:.2}; {} of {} cells contradicted; {:.1} s",
            turns.rms,
            published.rms,
            turns.max,
            self.turns.contradictions.count(),
            self.turns.contradictions.apart.len(),
            self.seconds
        );
        if let Some(rms) = self.held_out {
            let _ = write!(text, "; {rms:.3} over 36 views and lights that were not painted");
        }
        text
    }

    /// Painted views beside their reconstructions.
    fn strips(&self, views: &[PaintView], all: &[ViewBuffers]) -> Vec<(DisplayImage, String)> {
        let shown = [0, 4, 9].into_iter().map(|at| {
            let [image, difference] = compared(&all[at], &self.images[at], &self.turns.material);
            let [turns, published] =
                [&self.turns, &self.published].map(|made| reconstructed(&all[at], &made.material));
            let panel = |picture, caption: &str| Panel { picture, caption: caption.to_owned() };
            let is_painted = self.images[at].pixels.iter().any(|pixel| pixel[3] > 0.0);
            let picture = strip(&[
                panel(image, if is_painted { "painted" } else { "not painted" }),
                panel(TONE.apply(&turns), "by turns"),
                panel(difference, &format!("difference ×{DIFFERENCE_GAIN}")),
                panel(TONE.apply(&published), "as published"),
            ]);
            (picture, views[at].name.clone())
        });
        shown.collect()
    }

    /// Views that were not painted, beside what would have been painted.
    fn new_views(&self, mesh: &Mesh, unseen: &[PaintView]) -> (DisplayImage, String) {
        let mut panels = Vec::new();
        for at in [7, 23] {
            let buffers = ViewBuffers::of(mesh, &unseen[at], SIZE, SIZE);
            let image = self.painting.image(0, &unseen[at], &buffers);
            let films = [painted(&buffers, &image), reconstructed(&buffers, &self.turns.material)];
            let captions = ["would be painted", "reconstructed"];
            for (film, caption) in films.iter().zip(captions) {
                panels.push(Panel { picture: TONE.apply(film), caption: caption.to_owned() });
            }
        }
        (strip(&panels), "views and lights that were not painted".to_owned())
    }

    /// A line of the contact sheet.
    fn row(&self, mesh: &Mesh, other: &Mesh, view: &PaintView, unseen: &PaintView) -> DisplayImage {
        let own = ViewBuffers::of(mesh, view, SMALL, SMALL);
        let image = self.painting.image(0, view, &own);
        let new = ViewBuffers::of(mesh, unseen, SMALL, SMALL);
        let panel = |picture, caption: &str| Panel { picture, caption: caption.to_owned() };
        let material = &self.turns.material;
        strip(&[
            panel(TONE.apply(&painted(&own, &image)), self.painting.name),
            panel(TONE.apply(&reconstructed(&own, material)), "reconstructed"),
            panel(TONE.apply(&reconstructed(&new, material)), "new view"),
            panel(elsewhere(other, self, DVec3::new(0.3, 0.3, 0.9), SMALL), "other mesh"),
        ])
    }
}

fn elsewhere(other: &Mesh, shown: &Shown<'_>, from: DVec3, size: usize) -> DisplayImage {
    let camera = Camera::around(other.centre(), other.radius(), from.normalize());
    let light = Light::Directional(DirectionalLight::default());
    let view = MeshView { size, ..MeshView::default() };
    TONE.apply(&render_mesh(other, &shown.turns.material, &light, &camera, &view))
}

fn on_another(other: &Mesh, shown: &Shown<'_>) -> DisplayImage {
    let from = [("front", DVec3::new(0.3, 0.3, 0.9)), ("back", DVec3::new(-0.4, 0.3, -0.9))];
    let panels = from.map(|(caption, from)| Panel {
        picture: elsewhere(other, shown, from, SIZE),
        caption: caption.to_owned(),
    });
    strip(&panels)
}

fn stacked(rows: &[DisplayImage]) -> DisplayImage {
    let width = rows.iter().map(DisplayImage::width).max().unwrap_or(1);
    let height = rows.iter().map(DisplayImage::height).sum::<usize>().max(1);
    let mut sheet = DisplayImage::filled(width, height, [24, 24, 27]);
    let mut top = 0;
    for row in rows {
        sheet.paste(row, 0, top);
        top += row.height();
    }
    sheet
}
