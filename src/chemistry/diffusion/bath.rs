//! What molecules on their way meet besides free voxels: held voxels and doors in surfaces.

/// A held voxel or a door of a hop table: it sends out at a constant rate whatever happens, and takes in what reaches
/// it. In one step it sends `mean` molecules on each expected virtual jump.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Bath {
    /// Row of the hop table.
    pub node: u32,
    /// Molecules it sends by.
    pub mean: f64,
    /// Molecules sent out.
    pub sent: f64,
    /// Molecules taken in.
    pub taken: f64,
}

impl Bath {
    /// A bath that has sent and taken nothing yet.
    #[must_use]
    pub fn new(node: usize, mean: f64) -> Bath {
        Bath { node: node as u32, mean, sent: 0.0, taken: 0.0 }
    }

    /// Molecules sent less those taken.
    #[must_use]
    pub fn emitted(&self) -> f64 {
        self.sent - self.taken
    }
}

/// Into which voxels doors send; held voxels send to all of their neighbours.
pub type Open<'a> = &'a dyn Fn(usize) -> bool;

/// Doors send into every voxel.
pub const ALL: Open<'static> = &|_| true;

/// A way through a surface, for one diffusivity D, in units of it (1/m²): rates at which a molecule of a voxel leaves,
/// and at which molecules enter a voxel.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Door {
    pub out: Vec<(u32, f64)>,
    pub into: Vec<(u32, f64)>,
}
