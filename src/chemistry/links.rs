//! The joint between flow and chemistry: which voxels exchange molecules, and how strongly.

/// A weighted graph of voxels in compressed rows: the neighbours of voxel i stand at
/// `offsets[i]..offsets[i + 1]`. Each pair appears in both rows with the same conductance.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Links {
    /// Start of each row; one more than there are voxels.
    pub offsets: Vec<u32>,
    /// The voxel on the other side of each link.
    pub neighbour: Vec<u32>,
    /// Conductance G per unit diffusivity, m (area over distance): a molecule of diffusivity D hops
    /// i -> j at rate D G_ij / V_i, and a continuous amount changes by D G_ij (C_j - C_i).
    pub conductance: Vec<f64>,
}

impl Links {
    /// A graph of `voxels` voxels without any link.
    #[must_use]
    pub fn none(voxels: usize) -> Links {
        Links { offsets: vec![0; voxels + 1], ..Links::default() }
    }

    /// From a list of pairs (i, j, G), each given once.
    #[must_use]
    pub fn from_pairs(voxels: usize, pairs: &[(usize, usize, f64)]) -> Links {
        let mut rows: Vec<Vec<(u32, f64)>> = vec![Vec::new(); voxels];
        for &(i, j, g) in pairs {
            rows[i].push((j as u32, g));
            rows[j].push((i as u32, g));
        }
        let mut links = Links { offsets: vec![0], ..Links::default() };
        for mut row in rows {
            row.sort_by_key(|&(j, _)| j);
            for (j, g) in row {
                links.neighbour.push(j);
                links.conductance.push(g);
            }
            links.offsets.push(links.neighbour.len() as u32);
        }
        links
    }

    /// Number of voxels.
    #[must_use]
    pub fn voxels(&self) -> usize {
        self.offsets.len().saturating_sub(1)
    }

    /// Neighbours and conductances of voxel `i`.
    #[inline]
    pub fn row(&self, i: usize) -> impl ExactSizeIterator<Item = (usize, f64)> + '_ {
        let range = self.offsets[i] as usize..self.offsets[i + 1] as usize;
        self.neighbour[range.clone()].iter().zip(&self.conductance[range]).map(|(&j, &g)| (j as usize, g))
    }
}
