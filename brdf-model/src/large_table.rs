//! Tables of many megabytes that are read at random: kept on large memory pages where the system
//! has them, since finding small ones costs more than reading them.

use std::fmt;
use std::ops::{Deref, DerefMut};

use memmap2::MmapMut;

/// RGB cells.
pub(crate) enum LargeTable {
    /// Anonymous memory on large pages.
    Mapped(MmapMut),
    /// Where there is none to be had.
    Plain(Vec<[f32; 3]>),
}

impl LargeTable {
    /// A table of zeros.
    pub(crate) fn zeros(len: usize) -> Self {
        match MmapMut::map_anon(len * size_of::<[f32; 3]>()) {
            Ok(memory) => {
                // A wish: without it everything works, only slower.
                #[cfg(target_os = "linux")]
                let _ = memory.advise(memmap2::Advice::HugePage);
                Self::Mapped(memory)
            }
            Err(_) => Self::Plain(vec![[0.0; 3]; len]),
        }
    }
}

impl Deref for LargeTable {
    type Target = [[f32; 3]];

    fn deref(&self) -> &[[f32; 3]] {
        match self {
            Self::Mapped(memory) => bytemuck::cast_slice(memory),
            Self::Plain(cells) => cells,
        }
    }
}

impl DerefMut for LargeTable {
    fn deref_mut(&mut self) -> &mut [[f32; 3]] {
        match self {
            Self::Mapped(memory) => bytemuck::cast_slice_mut(memory),
            Self::Plain(cells) => cells,
        }
    }
}

impl Clone for LargeTable {
    fn clone(&self) -> Self {
        let mut copy = Self::zeros(self.len());
        copy.copy_from_slice(self);
        copy
    }
}

impl PartialEq for LargeTable {
    fn eq(&self, other: &Self) -> bool {
        **self == **other
    }
}

impl fmt::Debug for LargeTable {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("LargeTable").field("cells", &self.len()).finish()
    }
}
