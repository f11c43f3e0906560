//! JSON Schemas of everything that the command prints as JSON.

use brdf_container::{
    BrdfComparison, CompressReport, CompressedBtfInfo, MaterialInfo, TextureComparison,
};
use brdf_fit::{
    CompactReport, Comparison, FactoredReport, FolderComparison, KeptReport, SeparableReport,
};
use brdf_paint::{PaintReport, SetupReport};
use brdf_relight::{ErrorBreakdown, PrecomputeReport, SpeedReport, SweepReport, TurntableReport};
use brdf_study::StudyReport;
use btf_io::{BtfInfo, DecompressReport, SynthReport};
use btf_vq::RateRow;
use schemars::{Schema, schema_for};

/// Returns the name and the JSON Schema (draft 2020-12) of each record, in alphabetical order. Names begin with that of
/// the command that prints the record.
///
/// ```
/// let schemas = brdf_report::schemas();
/// assert!(schemas.iter().any(|(name, _)| *name == "compare"));
/// ```
pub fn schemas() -> Vec<(&'static str, Schema)> {
    vec![
        ("btf-compare", schema_for!(TextureComparison)),
        ("btf-compare-brdfs", schema_for!(BrdfComparison)),
        ("btf-compress", schema_for!(CompressReport)),
        ("btf-decompress", schema_for!(DecompressReport)),
        ("btf-info", schema_for!(BtfInfo)),
        ("btf-info-compressed", schema_for!(CompressedBtfInfo)),
        ("btf-study", schema_for!(Vec<RateRow>)),
        ("btf-synth", schema_for!(SynthReport)),
        ("compare", schema_for!(Comparison)),
        ("compare-folders", schema_for!(FolderComparison)),
        ("factor", schema_for!(FactoredReport)),
        ("factor-compact", schema_for!(CompactReport)),
        ("factor-keep", schema_for!(KeptReport)),
        ("factor-separable", schema_for!(SeparableReport)),
        ("info", schema_for!(Vec<MaterialInfo>)),
        ("paint-extract", schema_for!(PaintReport)),
        ("paint-setup", schema_for!(SetupReport)),
        ("relight-bench", schema_for!(SpeedReport)),
        ("relight-compare", schema_for!(ErrorBreakdown)),
        ("relight-precompute", schema_for!(PrecomputeReport)),
        ("relight-sweep", schema_for!(SweepReport)),
        ("relight-turntable", schema_for!(TurntableReport)),
        ("study", schema_for!(StudyReport)),
    ]
}
