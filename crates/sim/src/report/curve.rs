//! Thins a flight out to what a screen can show, without losing its peaks.

/// The most points of one curve.
pub(super) const MOST_POINTS: usize = 3000;

/// A curve to draw; what is not finite is a gap.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Curve {
    pub x: Vec<f64>,
    pub y: Vec<f64>,
}

/// Thins out a curve over time: of each stretch its lowest and highest value stay, in order, so
/// that a peak of one sample is still seen, and a gap stays a gap.
pub(super) fn envelope(points: impl ExactSizeIterator<Item = (f32, f32)>) -> Curve {
    let mut curve = Curve::default();
    let mut push = |(x, y): (f32, f32)| {
        curve.x.push(short(x));
        curve.y.push(short(y));
    };
    // A lowest, a highest and a gap in each stretch.
    let stretch = points.len().div_ceil(MOST_POINTS / 3);
    if points.len() <= MOST_POINTS {
        points.for_each(push);
        return curve;
    }
    let points: Vec<_> = points.collect();
    for stretch in points.chunks(stretch) {
        let finite = || stretch.iter().enumerate().filter(|(_, p)| p.1.is_finite());
        let lowest = finite().reduce(|a, b| if b.1.1 < a.1.1 { b } else { a });
        let highest = finite().reduce(|a, b| if b.1.1 > a.1.1 { b } else { a });
        let gap = stretch.iter().enumerate().find(|(_, p)| !p.1.is_finite());
        let mut chosen: Vec<_> = [lowest, highest, gap].into_iter().flatten().collect();
        chosen.sort_by_key(|(index, _)| *index);
        chosen.dedup_by_key(|(index, _)| *index);
        chosen.into_iter().for_each(|(_, point)| push(*point));
    }
    curve
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
        let points = [(0.0, 1.0), (1.0, f32::NAN), (2.0, 0.123_456)];
        let curve = envelope(points.into_iter());
        assert_eq!(curve.x, [0.0, 1.0, 2.0]);
        assert_eq!(curve.y[2], 0.1235);
        assert!(curve.y[1].is_nan());
        assert_eq!(envelope([].into_iter()), Curve::default());
        assert_eq!(spaced(&[1, 2]), [1, 2]);
    }

    #[test]
    fn many_points_keep_their_peaks_gaps_order_and_ends() {
        let mut points: Vec<(f32, f32)> = (0..100_000).map(|i| (i as f32, 0.0)).collect();
        points[4321].1 = 9.0;
        points[50_000].1 = -7.0;
        points[70_001].1 = f32::NAN;
        let curve = envelope(points.iter().copied());
        assert!(curve.x.len() <= MOST_POINTS, "{}", curve.x.len());
        assert!(curve.x.is_sorted());
        let at = |time: f64| {
            let index = curve.x.iter().position(|x| *x == time);
            curve.y[index.expect("kept")]
        };
        assert_eq!((at(4321.0), at(50_000.0)), (9.0, -7.0));
        assert!(at(70_001.0).is_nan());

        let spaced = spaced(&points);
        assert_eq!(spaced.len(), MOST_POINTS);
        assert_eq!(spaced.first(), points.first());
        assert_eq!(spaced.last(), points.last());
    }
}
