//! Squares numbers in pieces, is interrupted, and goes on where it was; the result appears whole.
//!
//! `cargo run -p brdf-files --example resume`
#![allow(clippy::print_stdout, reason = "an example")]

use std::path::Path;

use brdf_files::{ChunkLog, FileError, MappedFile, Overwrite, write_atomically};

/// Identifies the work: pieces of other work are not taken up.
const KEY: [u8; 32] = *b"squares of the numbers below 10!";

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = tempfile::tempdir()?;
    let result = folder.path().join("squares.csv");
    println!("first run, stopped after 4 pieces: {:?}", squares(&result, 4)?);
    println!("second run: {:?}", squares(&result, 10)?);
    println!("{}", String::from_utf8_lossy(&MappedFile::open(&result)?));
    match write_atomically(&result, b"", Overwrite::Ours) {
        Err(error @ FileError::InTheWay { .. }) => println!("without permission: {error}"),
        other => println!("unexpected: {other:?}"),
    }
    Ok(())
}

/// Makes at most `most` pieces, and the file once all are there. Returns the pieces of earlier runs and of this one.
fn squares(result: &Path, most: usize) -> Result<(usize, usize), FileError> {
    let (mut log, mut pieces) = ChunkLog::resume(&result.with_extension("work"), &KEY)?;
    let earlier = pieces.len();
    for number in earlier..10.min(earlier + most) {
        let piece = format!("{number},{}\n", number * number).into_bytes();
        log.append(&piece)?;
        pieces.push(piece);
    }
    if pieces.len() == 10 {
        write_atomically(result, &pieces.concat(), Overwrite::Ours)?;
        log.remove()?;
    }
    Ok((earlier, pieces.len() - earlier))
}
