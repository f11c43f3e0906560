//! Text in whatever encoding and with whatever line ends it comes.

use std::borrow::Cow;

use crate::error::FormatError;

/// Returns the text of a file with `\n` at the ends of lines.
///
/// UTF-8 and UTF-16 are told by their marks; what is not UTF-8 is read as Latin-1, since only comments and names can have
/// letters beyond ASCII.
///
/// # Errors
///
/// [`FormatError::Field`] at the first byte that no text has.
pub(crate) fn decode(bytes: &[u8]) -> Result<Cow<'_, str>, FormatError> {
    let text = match bytes {
        [0xEF, 0xBB, 0xBF, rest @ ..] => utf8_or_latin1(rest),
        [0xFF, 0xFE, rest @ ..] => utf16(rest, u16::from_le_bytes),
        [0xFE, 0xFF, rest @ ..] => utf16(rest, u16::from_be_bytes),
        _ => utf8_or_latin1(bytes),
    };
    let is_control = |byte: &u8| *byte < b' ' && !b"\t\n\r\x0c\x1a".contains(byte);
    if let Some(at) = text.as_bytes().iter().position(is_control) {
        return Err(FormatError::Field {
            offset: at,
            what: "the text",
            found: format!("a byte of {:#04x}", text.as_bytes()[at]),
            expected: "plain text".to_owned(),
        });
    }
    Ok(if text.contains('\r') {
        text.replace("\r\n", "\n").replace('\r', "\n").into()
    } else {
        text
    })
}

fn utf8_or_latin1(bytes: &[u8]) -> Cow<'_, str> {
    match std::str::from_utf8(bytes) {
        Ok(text) => text.into(),
        Err(_) => bytes.iter().map(|&byte| char::from(byte)).collect::<String>().into(),
    }
}

fn utf16(bytes: &[u8], unit: fn([u8; 2]) -> u16) -> Cow<'_, str> {
    let units: Vec<u16> = bytes.as_chunks::<2>().0.iter().map(|&pair| unit(pair)).collect();
    String::from_utf16_lossy(&units).into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_encoding_and_line_end_gives_the_same_text() {
        let wanted = "größe\n1 2\n";
        let utf16 = |mark: [u8; 2], bytes: fn(u16) -> [u8; 2]| {
            let units = "größe\r1 2\r\n".encode_utf16().flat_map(bytes);
            mark.into_iter().chain(units).collect::<Vec<u8>>()
        };
        for bytes in [
            wanted.as_bytes().to_vec(),
            "\u{feff}größe\r\n1 2\r\n".as_bytes().to_vec(),
            b"gr\xf6\xdfe\r1 2\r".to_vec(),
            utf16([0xFF, 0xFE], u16::to_le_bytes),
            utf16([0xFE, 0xFF], u16::to_be_bytes),
        ] {
            assert_eq!(decode(&bytes).unwrap(), wanted);
        }
        assert!(decode(b"1 2\0").is_err());
    }
}
