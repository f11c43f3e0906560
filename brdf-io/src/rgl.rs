//! RGL `.bsdf`: a tensor file of named, typed arrays at absolute offsets.

use brdf_model::{RglBrdf, RglTables};

use crate::FormatError;
use crate::bytes::{Cursor, f32_values, slice};
use crate::detect::RGL_MAGIC;

/// More fields or dimensions than any real file has; a header that claims more is lying.
const MAX_FIELDS: u32 = 256;
const MAX_DIMENSIONS: u16 = 16;
const FLOAT32: u8 = 10;

/// One array of the file.
struct Field {
    name: String,
    kind: u8,
    offset: u64,
    shape: Vec<usize>,
}

/// Reads an RGL material with RGB values, isotropic or anisotropic.
///
/// # Errors
///
/// [`FormatError`] for a header that does not fit the file, missing fields or unusable tables. A
/// spectral file is refused by name.
pub fn read_rgl(bytes: &[u8]) -> Result<RglBrdf, FormatError> {
    let fields = read_header(bytes)?;
    let floats = |name: &str, dimensions: usize| -> Result<(Vec<f32>, Vec<usize>), FormatError> {
        let field = find(&fields, name)?;
        if field.kind != FLOAT32 || field.shape.len() != dimensions {
            return Err(FormatError::Missing {
                what: format!("field {name:?} of {dimensions} dimensions in f32"),
                expected: format!(
                    "that instead of type {} and shape {:?}",
                    field.kind, field.shape
                ),
            });
        }
        let count = field.shape.iter().try_fold(4_usize, |n, &side| n.checked_mul(side));
        let length = count.unwrap_or(usize::MAX);
        let data = slice(bytes, field.offset, length, &format!("field {name:?}"))?;
        Ok((f32_values(data), field.shape.clone()))
    };
    if fields.iter().any(|f| f.name == "spectra") && !fields.iter().any(|f| f.name == "rgb") {
        return Err(FormatError::Missing {
            what: "field \"rgb\": this is a spectral file".to_owned(),
            expected: "the RGB file of the same material, *_rgb.bsdf".to_owned(),
        });
    }
    let (phi_i, _) = floats("phi_i", 1)?;
    let (theta_i, _) = floats("theta_i", 1)?;
    let plane = |(values, shape): (Vec<f32>, Vec<usize>)| (values, [shape[0], shape[1]]);
    let ndf = plane(floats("ndf", 2)?);
    let sigma = plane(floats("sigma", 2)?);
    let incidences = [phi_i.len(), theta_i.len()];
    let (vndf, vndf_shape) = floats("vndf", 4)?;
    let (rgb, rgb_shape) = floats("rgb", 5)?;
    if vndf_shape[..2] != incidences || rgb_shape[..2] != incidences || rgb_shape[2] != 3 {
        return Err(FormatError::Missing {
            what: format!("matching shapes: vndf {vndf_shape:?}, rgb {rgb_shape:?}"),
            expected: format!("slices for {} azimuths and {} angles", incidences[0], incidences[1]),
        });
    }
    Ok(RglBrdf::new(RglTables {
        phi_i,
        theta_i,
        ndf,
        sigma,
        vndf: (vndf, [vndf_shape[2], vndf_shape[3]]),
        rgb: (rgb, [rgb_shape[3], rgb_shape[4]]),
    })?)
}

fn read_header(bytes: &[u8]) -> Result<Vec<Field>, FormatError> {
    let mut cursor = Cursor::new(bytes, 0);
    if cursor.take(RGL_MAGIC.len(), "the magic word")? != RGL_MAGIC {
        return Err(FormatError::Field {
            offset: 0,
            what: "the magic word",
            found: "something else".to_owned(),
            expected: "\"tensor_file\"".to_owned(),
        });
    }
    let version = [cursor.u8("the version")?, cursor.u8("the version")?];
    if version[0] != 1 {
        return Err(FormatError::Field {
            offset: RGL_MAGIC.len(),
            what: "the version",
            found: format!("{}.{}", version[0], version[1]),
            expected: "1.x".to_owned(),
        });
    }
    let offset = cursor.offset();
    let count = cursor.u32("the number of fields")?;
    if count > MAX_FIELDS {
        return Err(FormatError::Field {
            offset,
            what: "the number of fields",
            found: count.to_string(),
            expected: format!("at most {MAX_FIELDS}"),
        });
    }
    (0..count).map(|_| read_field(&mut cursor)).collect()
}

fn read_field(cursor: &mut Cursor<'_>) -> Result<Field, FormatError> {
    let name_length = cursor.u16("a field name")?;
    let name = cursor.take(name_length.into(), "a field name")?;
    let name = String::from_utf8_lossy(name).into_owned();
    let offset = cursor.offset();
    let dimensions = cursor.u16("a number of dimensions")?;
    if dimensions > MAX_DIMENSIONS {
        return Err(FormatError::Field {
            offset,
            what: "a number of dimensions",
            found: dimensions.to_string(),
            expected: format!("at most {MAX_DIMENSIONS}"),
        });
    }
    let kind = cursor.u8("a field type")?;
    let offset = cursor.u64("a field offset")?;
    let shape: Result<Vec<usize>, FormatError> = (0..dimensions)
        .map(|_| {
            let side = cursor.u64("a field shape")?;
            // A side that no memory holds fails later, against the length of the file.
            Ok(usize::try_from(side).unwrap_or(usize::MAX))
        })
        .collect();
    Ok(Field { name, kind, offset, shape: shape? })
}

fn find<'a>(fields: &'a [Field], name: &str) -> Result<&'a Field, FormatError> {
    fields.iter().find(|field| field.name == name).ok_or_else(|| FormatError::Missing {
        what: format!("field {name:?}"),
        expected: format!(
            "it beside {}",
            fields.iter().map(|f| f.name.as_str()).collect::<Vec<_>>().join(", ")
        ),
    })
}
