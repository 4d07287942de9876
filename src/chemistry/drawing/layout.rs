//! Layers from left to right (Sugiyama, Tagawa & Toda 1981): cycles are cut, nodes get the layer of their
//! longest path, long edges a bend in each layer they cross, and layers are ordered by barycentres.

/// A node to be placed; sizes in pixels.
pub(super) struct Box2 {
    pub width: f64,
}

/// Where nodes lie and through which points edges run.
pub(super) struct Layout {
    /// Centre of each node.
    pub centre: Vec<[f64; 2]>,
    /// For each edge the points between its ends.
    pub bends: Vec<Vec<[f64; 2]>>,
    pub size: [f64; 2],
}

/// Vertical distance of neighbours in a layer.
const ROW: f64 = 64.0;
/// Horizontal space between layers.
const GAP: f64 = 56.0;
/// Space round the drawing.
const MARGIN: f64 = 24.0;
/// Sweeps of the barycentre ordering; it settles in a few.
const SWEEPS: usize = 12;

/// Places nodes joined by directed edges.
pub(super) fn place(nodes: &[Box2], edges: &[(usize, usize)]) -> Layout {
    let forward = without_cycles(nodes.len(), edges);
    let layer = layers(nodes.len(), &forward);
    let mut level = layer.clone();
    // Chains of bends for edges that cross layers.
    let mut chains: Vec<Vec<usize>> = Vec::new();
    let mut joined: Vec<(usize, usize)> = Vec::new();
    for &(from, to) in &forward {
        let mut chain = Vec::new();
        let mut last = from;
        for between in layer[from] + 1..layer[to] {
            level.push(between);
            chain.push(level.len() - 1);
            joined.push((last, level.len() - 1));
            last = level.len() - 1;
        }
        joined.push((last, to));
        chains.push(chain);
    }
    let rows = ordered(&level, &joined);
    let depth = rows.len().max(1);
    let tallest = rows.iter().map(Vec::len).max().unwrap_or(0).max(1);
    let mut centre = vec![[0.0; 2]; level.len()];
    let mut x = MARGIN;
    for row in &rows {
        let width = row.iter().filter_map(|&n| nodes.get(n)).map(|n| n.width).fold(20.0, f64::max);
        let top = MARGIN + 0.5 * ROW * (tallest - row.len()) as f64;
        for (k, &n) in row.iter().enumerate() {
            centre[n] = [x + 0.5 * width, top + (k as f64 + 0.5) * ROW];
        }
        x += width + GAP;
    }
    let size = [x - if depth > 0 { GAP } else { 0.0 } + MARGIN, tallest as f64 * ROW + 2.0 * MARGIN];
    let bends = chains
        .iter()
        .zip(edges.iter().zip(&forward))
        .map(|(chain, (edge, forward))| {
            let mut points: Vec<[f64; 2]> = chain.iter().map(|&n| centre[n]).collect();
            if edge != forward {
                points.reverse();
            }
            points
        })
        .collect();
    centre.truncate(nodes.len());
    Layout { centre, bends, size }
}

/// The edges with those turned round that close a cycle in a depth-first walk.
fn without_cycles(nodes: usize, edges: &[(usize, usize)]) -> Vec<(usize, usize)> {
    let mut entered_by = vec![0_usize; nodes];
    edges.iter().for_each(|&(_, to)| entered_by[to] += 1);
    // Nodes that nothing leads to come first, so that they end up on the left.
    let mut roots: Vec<usize> = (0..nodes).collect();
    roots.sort_by_key(|&n| (entered_by[n] > 0, n));
    let mut order = vec![usize::MAX; nodes];
    let mut finished = 0;
    let mut seen = vec![false; nodes];
    for root in roots {
        if seen[root] {
            continue;
        }
        seen[root] = true;
        // Each entry: a node and the next of its edges to look at.
        let mut stack = vec![(root, 0)];
        while let Some((node, at)) = stack.pop() {
            let next = (at..edges.len()).find(|&e| edges[e].0 == node && !seen[edges[e].1]);
            if let Some(e) = next {
                stack.push((node, e + 1));
                seen[edges[e].1] = true;
                stack.push((edges[e].1, 0));
            } else {
                order[node] = finished;
                finished += 1;
            }
        }
    }
    // Edges of a depth-first walk lead to nodes that finish earlier, except those that close cycles.
    edges.iter().map(|&(a, b)| if order[a] > order[b] { (a, b) } else { (b, a) }).collect()
}

/// Length of the longest path that leads to each node of a graph without cycles.
fn layers(nodes: usize, edges: &[(usize, usize)]) -> Vec<usize> {
    let mut layer = vec![0_usize; nodes];
    for _ in 0..nodes {
        let mut changed = false;
        for &(a, b) in edges {
            if layer[b] < layer[a] + 1 {
                layer[b] = layer[a] + 1;
                changed = true;
            }
        }
        if !changed {
            break;
        }
    }
    // Sources move right, next to what they lead to.
    for n in 0..nodes {
        let next = edges.iter().filter(|e| e.0 == n).map(|e| layer[e.1]).min();
        if let Some(next) = next.filter(|_| !edges.iter().any(|e| e.1 == n)) {
            layer[n] = next - 1;
        }
    }
    layer
}

/// Nodes of each layer from top to bottom, with few crossings.
fn ordered(level: &[usize], edges: &[(usize, usize)]) -> Vec<Vec<usize>> {
    let depth = level.iter().max().map_or(0, |deepest| deepest + 1);
    let mut rows = vec![Vec::new(); depth];
    for (n, &l) in level.iter().enumerate() {
        rows[l].push(n);
    }
    let mut place = vec![0.0; level.len()];
    let number = |rows: &[Vec<usize>], place: &mut [f64]| {
        for row in rows {
            for (k, &n) in row.iter().enumerate() {
                place[n] = k as f64 - 0.5 * (row.len() - 1) as f64;
            }
        }
    };
    number(&rows, &mut place);
    let mut best = (crossings(&rows, edges, &place), rows.clone());
    for sweep in 0..SWEEPS {
        let layers: Vec<usize> =
            if sweep % 2 == 0 { (0..depth).collect() } else { (0..depth).rev().collect() };
        for l in layers {
            let barycentre = |n: usize| {
                let near: Vec<f64> = edges
                    .iter()
                    .filter_map(|&(a, b)| {
                        if sweep % 2 == 0 { (b == n).then(|| place[a]) } else { (a == n).then(|| place[b]) }
                    })
                    .collect();
                if near.is_empty() { place[n] } else { near.iter().sum::<f64>() / near.len() as f64 }
            };
            let mut keyed: Vec<(f64, usize)> = rows[l].iter().map(|&n| (barycentre(n), n)).collect();
            keyed.sort_by(|a, b| a.0.total_cmp(&b.0));
            rows[l] = keyed.into_iter().map(|(_, n)| n).collect();
            number(&rows, &mut place);
        }
        let now = crossings(&rows, edges, &place);
        if now < best.0 {
            best = (now, rows.clone());
        }
    }
    best.1
}

/// Pairs of edges that cross.
fn crossings(rows: &[Vec<usize>], edges: &[(usize, usize)], place: &[f64]) -> usize {
    let mut layer = vec![0; place.len()];
    for (l, row) in rows.iter().enumerate() {
        row.iter().for_each(|&n| layer[n] = l);
    }
    let crosses = |e: &(usize, usize), f: &(usize, usize)| {
        layer[e.0] == layer[f.0] && (place[e.0] - place[f.0]) * (place[e.1] - place[f.1]) < 0.0
    };
    edges.iter().enumerate().map(|(k, e)| edges[..k].iter().filter(|f| crosses(e, f)).count()).sum()
}
