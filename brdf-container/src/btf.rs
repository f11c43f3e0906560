//! Compressed BTFs in a container: every packed book a tensor of bytes, named as in the paper; see
//! [`btf_vq::Header`] for what the bits mean.

use std::path::Path;
use std::sync::Arc;

use btf_vq::{BtfModel, BtfRecord, Header, LpcaHeader, LpcaModel, SharedBytes, VqModel};
use safetensors::SafeTensors;
use safetensors::tensor::Dtype;
use serde::{Deserialize, Serialize};

use brdf_files::{FileError, MappedFile};

use crate::error::ContainerError;
use crate::head::{Head, KEY, VERSION, library, serialize};
use crate::kind::Kind;

#[derive(Serialize, Deserialize)]
struct Record<H> {
    #[serde(flatten)]
    head: Head,
    header: H,
    made: BtfRecord,
}

/// A compressed BTF and its file.
#[derive(Clone, Debug)]
pub struct CompressedBtf {
    /// The model, reading from the mapped file.
    pub model: BtfModel,
    /// How it was made.
    pub made: BtfRecord,
    /// Bytes of the whole file.
    pub bytes: usize,
}

/// Returns the bytes of a compressed BTF's file.
///
/// # Errors
///
/// [`ContainerError::Library`] if they cannot be put together.
pub fn write_btf(model: &BtfModel, made: &BtfRecord) -> Result<Vec<u8>, ContainerError> {
    let made = made.clone();
    let record = match model {
        BtfModel::Vq(model) => {
            let head = Head::of(Kind::BtfVq);
            serde_json::to_string(&Record { head, header: model.header(), made })
        }
        BtfModel::Lpca(model) => {
            let head = Head::of(Kind::BtfLpca);
            serde_json::to_string(&Record { head, header: model.header(), made })
        }
    };
    let record = record.map_err(|e| library("model record", &e))?;
    let streams = model.stream_bytes();
    let tensors = streams
        .iter()
        .enumerate()
        .map(|(at, (name, len))| (name.as_str(), Dtype::U8, vec![*len], model.stream(at)));
    serialize(tensors, record)
}

/// Returns a compressed BTF. The file is mapped, not read; every index is checked.
///
/// # Errors
///
/// [`FileError`] for a file that is no compressed BTF, or is not whole and consistent.
pub fn open_compressed_btf(path: &Path) -> Result<CompressedBtf, FileError> {
    let file = Arc::new(MappedFile::open(path)?);
    read_btf(file).map_err(FileError::content(path))
}

/// Returns a compressed BTF from the bytes of its file.
///
/// # Errors
///
/// [`ContainerError`] for anything that is not whole and consistent.
pub fn read_btf(file: Arc<MappedFile>) -> Result<CompressedBtf, ContainerError> {
    let bytes: &[u8] = (*file).as_ref();
    let (offset, metadata) =
        SafeTensors::read_metadata(bytes).map_err(|e| library("safetensors", &e))?;
    SafeTensors::deserialize(bytes).map_err(|e| library("safetensors", &e))?;
    let text = metadata.metadata().as_ref().and_then(|m| m.get(KEY)).ok_or_else(not_ours)?;
    let head: Head = serde_json::from_str(text).map_err(|e| library("record", &e))?;
    if head.version() != VERSION {
        return Err(ContainerError::Version { found: head.version(), expected: VERSION });
    }
    let ranges = |names: Vec<String>| -> Result<Vec<_>, ContainerError> {
        let range = |name: &String| {
            let info = metadata.info(name).filter(|info| info.dtype == Dtype::U8);
            let start = offset + 8;
            let info = info.ok_or_else(|| ContainerError::Missing {
                what: format!("tensor {name} of bytes"),
                expected: "one for each book of the header".to_owned(),
            })?;
            Ok(start + info.data_offsets.0..start + info.data_offsets.1)
        };
        names.iter().map(range).collect()
    };
    let len = bytes.len();
    let shared = || -> SharedBytes { Arc::new(SharedFile(Arc::clone(&file))) };
    let (model, made) = match head.kind {
        Kind::BtfVq => {
            let record: Record<Header> = parse(text)?;
            let ranges = ranges(record.header.stream_names())?;
            (BtfModel::Vq(VqModel::new(record.header, shared(), ranges)?), record.made)
        }
        Kind::BtfLpca => {
            let record: Record<LpcaHeader> = parse(text)?;
            let ranges = ranges(record.header.stream_names())?;
            (BtfModel::Lpca(LpcaModel::new(record.header, shared(), ranges)?), record.made)
        }
        _ => return Err(not_ours()),
    };
    Ok(CompressedBtf { model, made, bytes: len })
}

fn parse<'a, T: Deserialize<'a>>(text: &'a str) -> Result<T, ContainerError> {
    serde_json::from_str(text).map_err(|e| library("model record", &e))
}

fn not_ours() -> ContainerError {
    ContainerError::Missing {
        what: "compressed BTF in it".to_owned(),
        expected: "one that brdf wrote".to_owned(),
    }
}

/// A mapped file that models share.
struct SharedFile(Arc<MappedFile>);

impl AsRef<[u8]> for SharedFile {
    fn as_ref(&self) -> &[u8] {
        &self.0
    }
}
