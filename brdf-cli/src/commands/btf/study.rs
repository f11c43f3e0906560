//! `brdf btf study`.

use std::io::Write;
use std::path::PathBuf;

use anyhow::bail;
use brdf_report::{rate_csv, rate_plot, rate_text};
use btf_vq::{RateMethod, RateSettings, study_rates};

use super::inputs::is_brdf;
use super::loading::{MemoryArgs, load, notes};
use crate::args::{positive, stem};
use crate::outputs::{FolderArgs, show};
use crate::progress::Watch;

/// Measure what compression loses at which size, beside its rivals
///
/// Compresses a BTF to several ratios by refined codebooks, by local principal components in bytes and in
/// f32 and by one level of vector quantization; as published with several thresholds of MSE; and by
/// principal components of each view. Bytes are those of books, bases and texels without headers. f32
/// rivals and those of a view are not rounded: no storage of them does better. Writes study.csv and
/// study.svg. Larger books take longer: with the defaults it is about half an hour for 256² texels.
///
/// Example: brdf btf study wool -o wool-study
#[derive(clap::Args)]
#[command(mut_arg("output", |arg| arg.default_value("btf-study")))]
pub(in crate::commands) struct Study {
    /// BTF
    #[arg(value_name = "IN")]
    input: PathBuf,

    #[command(flatten)]
    folder: FolderArgs,

    /// What is measured [default: everything]
    #[arg(long, value_enum, value_delimiter = ',')]
    methods: Vec<MethodArg>,

    /// Raw bytes over bytes
    #[arg(long, value_delimiter = ',', value_parser = positive, default_values_t = [2000.0, 764.0, 300.0])]
    ratios: Vec<f64>,

    /// Thresholds of the paper's mode
    #[arg(long, value_delimiter = ',', value_parser = positive, default_values_t = [0.012, 0.004, 0.001])]
    epsilons: Vec<f64>,

    /// Components of each view
    #[arg(long, value_delimiter = ',', default_values_t = [1, 2])]
    components: Vec<usize>,

    /// Every how many images are compared
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..), default_value_t = 7)]
    every: u32,

    #[command(flatten)]
    memory: MemoryArgs,

    /// Print the rows as JSON
    #[arg(long)]
    json: bool,
}

choices! {
    /// What is measured.
    enum MethodArg for RateMethod {
        /// Refined codebooks
        Refined => Refined,
        /// As published, with a threshold of MSE
        Paper => Paper,
        /// Local principal components in bytes
        Lpca => Lpca,
        /// The same in f32
        LpcaF32 => LpcaF32,
        /// One level of vector quantization
        OneLevel => OneLevel,
        /// Principal components of each view
        ViewPca => ViewPca,
    }
}

impl Study {
    pub(in crate::commands) fn run(self, out: &mut impl Write) -> anyhow::Result<()> {
        let mut folder = self.folder.create()?;
        if is_brdf(&self.input) {
            bail!("{}: expected the images of a BTF", self.input.display());
        }
        for note in notes(&self.input)? {
            writeln!(std::io::stderr(), "{}: {note}", self.input.display())?;
        }
        let settings = RateSettings {
            methods: match self.methods.is_empty() {
                true => RateMethod::ALL.to_vec(),
                false => self.methods.iter().copied().map(RateMethod::from).collect(),
            },
            ratios: self.ratios,
            epsilons: self.epsilons,
            components: self.components,
            every: self.every as usize,
        };
        let watch = Watch::start();
        let source = load(&self.input, self.memory, &watch)?;
        let rows = watch.run(|job| study_rates(&stem(&self.input), &source, &settings, job))?;
        drop(watch);
        folder.write("study.csv", rate_csv(&rows).as_bytes())?;
        folder.write("study.svg", rate_plot(&rows)?.svg().as_bytes())?;
        let place = folder.finish()?;
        show(out, self.json, &rows, || {
            format!("{}{}\n", rate_text(&rows), place.join("study.svg").display())
        })
    }
}
