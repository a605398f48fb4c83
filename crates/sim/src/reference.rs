//! The reference: the tables of parameters and of failsafes, for the terminal and as pages in
//! `docs/`, made of the declarations that the core itself flies by.

mod failsafes;
mod parameters;

use std::fmt::Write;

pub use failsafes::{failsafes, failsafes_page};
pub use parameters::{parameters, parameters_page, unknown};

/// A value as it is read best: no row of zeros.
fn value(value: f32) -> String {
    if value != 0.0 && value.abs() < 1e-3 {
        format!("{value:e}")
    } else {
        value.to_string()
    }
}

/// A table with columns as wide as they need to be, the last one apart.
fn columns(rows: &[Vec<String>]) -> String {
    let count = rows.iter().map(Vec::len).max().unwrap_or(0);
    let width = |column: usize| {
        let cells = rows.iter().filter_map(|row| row.get(column));
        cells.map(|cell| cell.chars().count()).max().unwrap_or(0)
    };
    let widths: Vec<usize> = (0..count).map(width).collect();
    let mut text = String::new();
    for row in rows {
        let mut line = String::new();
        for (cell, width) in row.iter().zip(&widths) {
            let _ = write!(line, "{cell:width$}  ");
        }
        text.push_str(line.trim_end());
        text.push('\n');
    }
    text
}

/// A table in Markdown; the first row names the columns.
fn markdown(rows: &[Vec<String>]) -> String {
    let mut text = String::new();
    for (index, row) in rows.iter().enumerate() {
        text.push('|');
        for cell in row {
            let _ = write!(text, " {} |", cell.replace('|', "\\|"));
        }
        text.push('\n');
        if index == 0 {
            text.push('|');
            row.iter().for_each(|_| text.push_str("---|"));
            text.push('\n');
        }
    }
    text
}

fn row<const N: usize>(cells: [&str; N]) -> Vec<String> {
    cells.map(String::from).to_vec()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_short() {
        for (number, text) in [
            (0.0, "0"),
            (3.13e-5, "3.13e-5"),
            (0.65, "0.65"),
            (-1.0, "-1"),
            (65535.0, "65535"),
        ] {
            assert_eq!(value(number), text);
        }
    }

    #[test]
    fn columns_are_aligned_and_lines_end_with_their_text() {
        let rows = [row(["a", "bcd", "x"]), row(["aa", "b", ""])];
        assert_eq!(columns(&rows), "a   bcd  x\naa  b\n");
    }

    #[test]
    fn a_bar_does_not_end_a_cell() {
        let rows = [row(["a", "b"]), row(["1|2", ""])];
        assert_eq!(markdown(&rows), "| a | b |\n|---|---|\n| 1\\|2 |  |\n");
    }
}
