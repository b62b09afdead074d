//! The history of a run as columns.

/// All complete rows of a history, column by column.
#[derive(Debug, Default)]
pub(super) struct History {
    names: Vec<String>,
    columns: Vec<Vec<f64>>,
}

impl History {
    /// Reads the text of a `history.csv`. The last row of a run that goes on may be cut off, and is then left out.
    pub(super) fn read(text: &str) -> Self {
        let whole = text.rfind('\n').map_or("", |end| &text[..end]);
        let mut lines = whole.lines();
        let names: Vec<String> = lines.next().map_or(Vec::new(), |first| first.split(',').map(str::to_owned).collect());
        let mut columns = vec![Vec::new(); names.len()];
        for line in lines {
            let mut cells = line.split(',').map(|cell| cell.parse().unwrap_or(f64::NAN));
            for column in &mut columns {
                column.push(cells.next().unwrap_or(f64::NAN));
            }
        }
        History { names, columns }
    }

    pub(super) fn rows(&self) -> usize {
        self.columns.first().map_or(0, Vec::len)
    }

    /// Names of all columns.
    pub(super) fn names(&self) -> &[String] {
        &self.names
    }

    /// A column by its name.
    pub(super) fn column(&self, name: &str) -> Option<&[f64]> {
        let place = self.names.iter().position(|known| known == name)?;
        self.columns.get(place).map(Vec::as_slice)
    }

    /// The last value of a column that is a number.
    pub(super) fn last(&self, name: &str) -> Option<f64> {
        self.column(name)?.iter().rev().copied().find(|value| value.is_finite())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_that_is_cut_off_is_left_out() {
        let history = History::read("step,time\n0,0e0\n10,1e-3\n20,2e");
        assert_eq!((history.rows(), history.last("time")), (2, Some(1e-3)));
        assert_eq!(history.column("nothing"), None);
        assert_eq!(History::read("").rows(), 0);
    }
}
