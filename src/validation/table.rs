//! Reference tables: comma-separated numbers below one line of names.

/// A table of reference values; text columns and empty cells are not numbers.
pub struct Table {
    names: Vec<String>,
    rows: Vec<Vec<String>>,
}

impl Table {
    /// Reads a table.
    pub fn read(text: &str) -> Table {
        let mut lines =
            text.lines().map(|line| line.split(',').map(|cell| cell.trim().to_string()).collect());
        let names: Vec<String> = lines.next().unwrap_or_default();
        Table { names, rows: lines.collect() }
    }

    /// A cell's text.
    pub fn text(&self, row: usize, name: &str) -> &str {
        let column = self.names.iter().position(|known| known == name);
        column.and_then(|c| self.rows.get(row)?.get(c)).map_or("", String::as_str)
    }

    /// A cell's number; not a number if it holds none.
    pub fn number(&self, row: usize, name: &str) -> f64 {
        self.text(row, name).parse().unwrap_or(f64::NAN)
    }

    /// Numbers of a column, every `step`-th row from the first.
    pub fn every(&self, name: &str, step: usize) -> Vec<f64> {
        (0..self.len()).step_by(step).map(|row| self.number(row, name)).collect()
    }

    /// Number of rows.
    pub fn len(&self) -> usize {
        self.rows.len()
    }
}
