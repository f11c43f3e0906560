//! Pages that need no other file.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use brdf_plot::Plot;
use maud::{DOCTYPE, Markup, PreEscaped, html};

const STYLE: &str = "
body { font: 15px/1.5 system-ui, sans-serif; margin: 2rem auto; max-width: 62rem; padding: 0 1rem;
       color: #18181b; background: #fafafa; }
h1 { font-size: 1.5rem; } h2 { font-size: 1.15rem; margin-top: 2rem; }
img, svg { max-width: 100%; height: auto; } .factors { display: flex; flex-wrap: wrap; gap: 1rem; }
figure { margin: 0; } figcaption { font-size: .85rem; color: #52525b; max-width: 20rem; }
.factors img { image-rendering: pixelated; width: 256px; } .factors .sphere img { width: 128px; }
.matrix { font-size: .75rem; margin: .4rem 0; }
table { border-collapse: collapse; } th, td { padding: .25rem .7rem; text-align: right;
       border-bottom: 1px solid #d4d4d8; font-variant-numeric: tabular-nums; }
th:first-child, td:first-child { text-align: left; } code { background: #eee; padding: .1rem .3rem; }
";

/// Returns a page that needs no other file.
pub(crate) fn document(title: &str, content: &Markup) -> String {
    html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width";
                title { "brdf: " (title) }
                style { (PreEscaped(STYLE)) }
            }
            body {
                h1 { (title) }
                (content)
            }
        }
    }
    .into_string()
}

pub(crate) fn picture(png: &[u8], alt: &str) -> Markup {
    html! { img src=(format!("data:image/png;base64,{}", STANDARD.encode(png))) alt=(alt); }
}

pub(crate) fn slices_section(plot: Option<&Plot>) -> Markup {
    let Some(plot) = plot else { return html! {} };
    html! {
        h2 { "Slices" }
        (PreEscaped(plot.svg()))
        p { "Luminance of reference and approximation, colours on a common logarithm. Grey: no data." }
    }
}
