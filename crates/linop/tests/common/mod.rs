//! Random numbers, full matrices by plain loops, and operators that override as little as possible.

use fredholm_linop::{Dense, LinearOperator, MultiVector, PackedSymmetric, Scalar, Storage, Symmetry};
use num_complex::Complex64;

/// A matrix with every entry, rows of columns.
pub type Full<T> = Vec<Vec<T>>;

/// xorshift64*, uniform on [0, 1).
pub struct Random(u64);

impl Random {
    pub fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1)
    }

    pub fn next(&mut self) -> f64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        (self.0.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 11) as f64 / (1u64 << 53) as f64
    }
}

/// A random number of the kind: real, or with an imaginary part.
pub trait Draw: Scalar {
    fn draw(random: &mut Random) -> Self;
}

impl Draw for f64 {
    fn draw(random: &mut Random) -> Self {
        2.0 * random.next() - 1.0
    }
}

impl Draw for Complex64 {
    fn draw(random: &mut Random) -> Self {
        Complex64::new(f64::draw(random), f64::draw(random))
    }
}

pub fn draw_vector<T: Draw>(dim: usize, rhs_count: usize, random: &mut Random) -> MultiVector<T> {
    MultiVector::from_fn(dim, rhs_count, |_, _| T::draw(random))
}

pub fn draw_full<T: Draw>(dim: usize, random: &mut Random) -> Full<T> {
    (0..dim).map(|_| (0..dim).map(|_| T::draw(random)).collect()).collect()
}

/// k_ij = turn(k_ji) above the diagonal.
pub fn mirrored<T: Scalar>(mut full: Full<T>, turn: impl Fn(T) -> T) -> Full<T> {
    for i in 0..full.len() {
        for j in i..full.len() {
            full[i][j] = turn(full[j][i]);
        }
    }
    full
}

pub fn dense<T: Scalar>(full: &Full<T>) -> Dense<T> {
    Dense::new(full.len(), full.concat()).unwrap()
}

pub fn packed<S: Storage>(full: &Full<f64>) -> PackedSymmetric<S> {
    let rows = full.iter().enumerate().flat_map(|(i, row)| row[..=i].iter().map(|&g| S::from_f64(g)));
    PackedSymmetric::new(full.len(), rows.collect()).unwrap()
}

/// Σ_j k_ij x_jl of right-hand side l with the matrix of that right-hand side.
pub fn product<T: Scalar>(matrices: &[Full<T>], x: &MultiVector<T>) -> MultiVector<T> {
    let matrix = |l: usize| &matrices[l % matrices.len()];
    MultiVector::from_fn(x.dim(), x.rhs_count(), |i, l| {
        (0..x.dim()).fold(T::zero(), |sum, j| sum + matrix(l)[i][j] * x.row(j)[l])
    })
}

pub fn assert_close<T: Scalar>(found: &[T], expected: &[T], tolerance: f64, what: &str) {
    assert_eq!(found.len(), expected.len(), "{what}");
    let scale = expected.iter().fold(1.0, |scale, value| value.abs().max(scale));
    for (at, (&a, &b)) in found.iter().zip(expected).enumerate() {
        assert!((a - b).abs() <= tolerance * scale, "{what}: {a:?} is not {b:?} at {at}");
    }
}

/// An operator that knows no more than it must: one matrix for all right-hand sides, or one per
/// right-hand side.
pub struct Bare<T> {
    pub matrices: Vec<Full<T>>,
    pub symmetry: Symmetry,
}

impl<T: Scalar> LinearOperator<T> for Bare<T> {
    fn dim(&self) -> usize {
        self.matrices[0].len()
    }

    fn apply(&self, x: &MultiVector<T>, y: &mut MultiVector<T>) {
        *y = product(&self.matrices, x);
    }

    fn rhs_count(&self) -> Option<usize> {
        (self.matrices.len() > 1).then_some(self.matrices.len())
    }

    fn symmetry(&self) -> Symmetry {
        self.symmetry
    }
}

/// An operator with its matrices by plain loops, one for all right-hand sides or one per right-hand
/// side.
pub struct Case<T> {
    pub name: String,
    pub operator: Box<dyn LinearOperator<T>>,
    pub matrices: Vec<Full<T>>,
}

impl<T: Draw> Case<T> {
    fn bare(name: &str, matrices: Vec<Full<T>>, symmetry: Symmetry) -> Self {
        let operator = Box::new(Bare { matrices: matrices.clone(), symmetry });
        Self { name: name.into(), operator, matrices }
    }
}

/// Operators of any scalar.
pub fn cases<T: Draw>(dim: usize, random: &mut Random) -> Vec<Case<T>> {
    let mut draw = || draw_full::<T>(dim, random);
    let full = draw();
    let symmetric = mirrored(draw(), |entry| entry);
    let other = mirrored(draw(), |entry| entry);
    let mut hermitian = mirrored(draw(), Scalar::conj);
    (0..dim).for_each(|i| hermitian[i][i] = T::from_real(hermitian[i][i].abs()));
    vec![
        Case { name: "dense".into(), operator: Box::new(dense(&full)), matrices: vec![full.clone()] },
        Case::bare("bare", vec![full], Symmetry::General),
        Case::bare("bare symmetric", vec![symmetric.clone()], Symmetry::Symmetric),
        Case::bare("bare hermitian", vec![hermitian], Symmetry::Hermitian),
        Case::bare("a matrix per right-hand side", vec![draw(), draw(), draw()], Symmetry::General),
        Case::bare("a symmetric matrix per right-hand side", vec![symmetric, other], Symmetry::Symmetric),
    ]
}

/// Operators of real numbers only.
pub fn real_cases(dim: usize, random: &mut Random) -> Vec<Case<f64>> {
    let full = mirrored(draw_full::<f64>(dim, random), |entry| entry);
    let rounded: Full<f64> =
        full.iter().map(|row| row.iter().map(|&g| f64::from(g as f32)).collect()).collect();
    vec![
        Case {
            name: "packed f64".into(),
            operator: Box::new(packed::<f64>(&full)),
            matrices: vec![full.clone()],
        },
        Case { name: "packed f32".into(), operator: Box::new(packed::<f32>(&full)), matrices: vec![rounded] },
    ]
}

/// I − D K by plain loops, a matrix per right-hand side.
pub fn second_kind<T: Scalar>(matrices: &[Full<T>], factor: &MultiVector<T>) -> Vec<Full<T>> {
    let unit = |i: usize, j: usize| if i == j { T::one() } else { T::zero() };
    let row = |l: usize, i: usize| {
        let k = &matrices[l % matrices.len()][i];
        (0..factor.dim()).map(|j| unit(i, j) - factor.row(i)[l] * k[j]).collect()
    };
    (0..factor.rhs_count()).map(|l| (0..factor.dim()).map(|i| row(l, i)).collect()).collect()
}
