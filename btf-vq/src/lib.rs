//! Bidirectional *texture* functions (not BPF Type Format) in nested codebooks.

mod source;

pub use source::{BtfLayout, BtfSource, Encoding, SourceError, View};
