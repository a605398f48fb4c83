//! Thins a flight out to what a screen can show, without losing its peaks.

/// The most points of one curve.
pub(super) const MOST_POINTS: usize = 3000;

/// Which rows of some columns to draw, so that a peak of one sample is still seen: of each stretch
/// those where a column is lowest or highest, and one where a column has a gap. All columns keep
/// the same rows, or values side by side would not be of the same instant.
pub(super) fn rows(columns: &[&[f32]]) -> Vec<usize> {
    let len = columns.iter().map(|c| c.len()).reduce(usize::min);
    let len = len.unwrap_or(0);
    if len <= MOST_POINTS {
        return (0..len).collect();
    }
    // Often the same row is extreme in several ways: try short stretches first. The last try
    // cannot be too long.
    let most_in_stretch = 3 * columns.len();
    let tries = (1..=most_in_stretch).map(|in_stretch| {
        let stretch = len.div_ceil(MOST_POINTS / in_stretch);
        extremes(columns, len, stretch)
    });
    let mut fitting = tries.filter(|rows| rows.len() <= MOST_POINTS);
    fitting.next().unwrap_or_default()
}

/// The rows of each stretch where a column is lowest, highest, or has a gap.
fn extremes(columns: &[&[f32]], len: usize, stretch: usize) -> Vec<usize> {
    let mut rows = Vec::new();
    for start in (0..len).step_by(stretch) {
        let end = (start + stretch).min(len);
        for column in columns {
            let finite = || (start..end).filter(|row| column[*row].is_finite());
            let lower = |a: usize, b: usize| if column[b] < column[a] { b } else { a };
            let higher = |a: usize, b: usize| if column[b] > column[a] { b } else { a };
            rows.extend(finite().reduce(lower));
            rows.extend(finite().reduce(higher));
            rows.extend((start..end).find(|row| !column[*row].is_finite()));
        }
    }
    rows.sort_unstable();
    rows.dedup();
    rows
}

/// Evenly spaced elements, the first and the last among them.
pub(super) fn spaced<T: Copy>(points: &[T]) -> Vec<T> {
    if points.len() <= MOST_POINTS {
        return points.to_vec();
    }
    let last = points.len() - 1;
    let pick = |i: usize| points[i * last / (MOST_POINTS - 1)];
    (0..MOST_POINTS).map(pick).collect()
}

/// A number rounded to 0.1 mm (or what that is in other units): short in the file.
pub(super) fn short(value: f32) -> f64 {
    (f64::from(value) * 1e4).round() / 1e4
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_points_stay_as_they_are() {
        assert_eq!(rows(&[&[1.0, f32::NAN, 2.0], &[0.0; 3]]), [0, 1, 2]);
        assert!(rows(&[]).is_empty() && rows(&[&[]]).is_empty());
        assert_eq!(spaced(&[1, 2]), [1, 2]);
        assert_eq!(short(0.123_456), 0.1235);
        assert!(short(f32::NAN).is_nan());
    }

    #[test]
    fn many_points_keep_their_peaks_gaps_and_order() {
        let mut first = vec![0.0; 100_000];
        let mut second = first.clone();
        first[4321] = 9.0;
        first[50_000] = -7.0;
        second[70_001] = f32::NAN;
        second[99_999] = 3.0;
        let rows = rows(&[&first, &second]);
        assert!(rows.len() <= MOST_POINTS, "{}", rows.len());
        assert!(rows.is_sorted_by(|a, b| a < b));
        for row in [4321, 50_000, 70_001, 99_999] {
            assert!(rows.binary_search(&row).is_ok(), "{row}");
        }
    }

    #[test]
    fn wild_columns_full_of_gaps_stay_within_the_bound() {
        let wild = |seed: usize| -> Vec<f32> {
            let value = |row: usize| (row * 7919 + seed) % 1013;
            let gap = |v: usize| {
                if v.is_multiple_of(5) { f32::NAN } else { v as f32 }
            };
            (0..200_000).map(|row| gap(value(row))).collect()
        };
        let columns: Vec<Vec<f32>> = (0..4).map(|i| wild(i * 31)).collect();
        let columns: Vec<&[f32]> = columns.iter().map(Vec::as_slice).collect();
        let rows = rows(&columns);
        assert!((1000..=MOST_POINTS).contains(&rows.len()), "{}", rows.len());
    }

    #[test]
    fn a_path_keeps_its_ends() {
        let points: Vec<usize> = (0..100_000).collect();
        let spaced = spaced(&points);
        assert_eq!(spaced.len(), MOST_POINTS);
        assert_eq!(spaced.first(), Some(&0));
        assert_eq!(spaced.last(), Some(&99_999));
    }
}
