//! 3×3 blocks, rows first, and the few operations on them that the filter consists of.
//!
//! Written out, so that nothing is indexed by a variable and every product is one instruction.

/// Three numbers.
pub(crate) type Row = [f32; 3];

/// A 3×3 block, row by row.
pub(crate) type Block = [Row; 3];

/// No covariance.
pub(crate) const ZERO: Block = [[0.0; 3]; 3];

/// Column `k` of a block.
#[inline(always)]
pub(crate) fn column(m: &Block, k: usize) -> Row {
    let [a, b, c] = m;
    [a[k], b[k], c[k]]
}

/// Writes column `k` of a block.
#[inline(always)]
pub(crate) fn set_column(m: &mut Block, k: usize, v: Row) {
    let [a, b, c] = m;
    (a[k], b[k], c[k]) = (v[0], v[1], v[2]);
}

/// The block with these columns.
#[inline(always)]
pub(crate) fn from_columns(a: Row, b: Row, c: Row) -> Block {
    [[a[0], b[0], c[0]], [a[1], b[1], c[1]], [a[2], b[2], c[2]]]
}

/// Makes the lower triangle equal to the upper.
#[inline(always)]
pub(crate) fn mirror(m: &mut Block) {
    m[1][0] = m[0][1];
    m[2][0] = m[0][2];
    m[2][1] = m[1][2];
}

/// v times a number.
#[inline(always)]
pub(crate) fn scaled(v: Row, s: f32) -> Row {
    [v[0] * s, v[1] * s, v[2] * s]
}

/// x += s y.
#[inline(always)]
pub(crate) fn add_row(x: &mut Row, s: f32, y: Row) {
    x[0] += s * y[0];
    x[1] += s * y[1];
    x[2] += s * y[2];
}

/// x += s Y.
#[inline(always)]
pub(crate) fn add(x: &mut Block, s: f32, y: &Block) {
    add_row(&mut x[0], s, y[0]);
    add_row(&mut x[1], s, y[1]);
    add_row(&mut x[2], s, y[2]);
}

/// X += s Yᵀ.
#[inline(always)]
pub(crate) fn add_transposed(x: &mut Block, s: f32, y: &Block) {
    add_row(&mut x[0], s, column(y, 0));
    add_row(&mut x[1], s, column(y, 1));
    add_row(&mut x[2], s, column(y, 2));
}

/// s on the diagonal, added.
#[inline(always)]
pub(crate) fn add_diagonal(x: &mut Block, s: f32) {
    x[0][0] += s;
    x[1][1] += s;
    x[2][2] += s;
}

/// X += k cᵀ.
#[inline(always)]
pub(crate) fn add_outer(x: &mut Block, k: Row, c: Row) {
    add_row(&mut x[0], k[0], c);
    add_row(&mut x[1], k[1], c);
    add_row(&mut x[2], k[2], c);
}

/// X += k cᵀ for k parallel to c: the upper triangle is computed and mirrored.
#[inline(always)]
pub(crate) fn add_outer_symmetric(x: &mut Block, k: Row, c: Row) {
    x[0][0] += k[0] * c[0];
    x[0][1] += k[0] * c[1];
    x[0][2] += k[0] * c[2];
    x[1][1] += k[1] * c[1];
    x[1][2] += k[1] * c[2];
    x[2][2] += k[2] * c[2];
    mirror(x);
}

/// M h.
#[inline(always)]
pub(crate) fn product(m: &Block, h: Row) -> Row {
    [dot(m[0], h), dot(m[1], h), dot(m[2], h)]
}

/// a · b.
#[inline(always)]
pub(crate) fn dot(a: Row, b: Row) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}
