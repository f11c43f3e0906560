//! Files: measured BRDF formats in; models, textures and images out.
//!
//! Every reader takes bytes, so that it can be tested and fuzzed without files, and checks every
//! count against the bytes that are there before it allocates. [`open_measurement`] recognizes a
//! format by content: extensions of this field collide.

mod alta;
mod atomic;
mod btf;
mod bytes;
mod chunk_log;
mod container;
mod cornell;
mod detect;
mod error;
mod exr_image;
mod mapped;
mod measurement;
mod merl;
mod mesh;
mod nbrdf;
mod paint;
mod pictures;
mod projections;
mod rgl;
mod spectrum;
mod table;
mod utia;

pub use alta::read_alta;
pub use atomic::{OutputFolder, Overwrite, check_overwrite, write_atomically};
pub use btf::{
    Btf, BtfError, BtfFile, BtfImages, BtfInput, BtfNotes, ImageAngles, LoadedBtf, NamedDirection,
    UboWriter, WrittenImages, open_btf, parse_image_name, read_albedo, read_btf_image, read_map,
};
pub use chunk_log::ChunkLog;
pub use container::{
    BasisFile, BasisRecord, BtfModelFile, BtfRecord, Contained, FitRecord, FitSettings, ModelFile,
    PaintRecord, PaintedFile, RankRecord, RelightFile, RelightRecord, SearchSettings,
    SeparableFile, SeparableRecord, SeparableSettings, TermRecord, basis_to_bytes,
    btf_model_to_bytes, chunk_from_bytes, chunk_to_bytes, model_to_bytes, open_btf_model,
    painted_to_bytes, parse_basis, parse_btf_model, parse_painted, parse_relight, read_container,
    record_of, relight_to_bytes, samples_to_bytes, separable_to_bytes, table_to_bytes,
};
pub use cornell::{Spectra, read_cornell};
pub use detect::{Format, detect};
pub use error::{FormatError, IoError};
pub use exr_image::write_exr;
pub use mapped::MappedFile;
pub use measurement::{Measured, Measurement, ReadOptions, open_measurement, parse_measurement};
pub use merl::{merl_to_bytes, read_merl};
pub use mesh::{parse_mesh, read_mesh};
pub use nbrdf::{nbrdf_names, read_nbrdf};
pub use paint::{
    PaintScene, TruthRecord, buffers_to_exr, painting_to_exr, read_buffers, read_painting,
    read_scene, read_views, scene_to_toml,
};
pub use pictures::{parse_environment, png_bytes, read_environment};
pub use projections::{ProjectionFile, read_projections};
pub use rgl::read_rgl;
pub use spectrum::SpectrumToRgb;
pub use table::{
    Column, ColumnMap, direction_rows, direction_table_header, read_table, samples_to_csv,
};
pub use utia::read_utia;
