//! Numbers that follow no pattern, the same in every run: where the points of a pair of patches or
//! nodes begin.
//!
//! Two pairs must not share their points. Else the errors of many small links of one receiver would
//! go the same way and add up, where errors of their own average out.

use fredholm_mesh::Vec3;

/// Powers of the inverse root of x⁷ = x + 1 (the sequence R_d of M. Roberts 2018): a member and a
/// place on it for either side.
const R6: [f64; 6] = [
    0.898_653_712_628_699_2,
    0.807_578_495_221_344_7,
    0.725_733_412_969_759_7,
    0.652_183_025_943_971_5,
    0.586_086_697_577_969_3,
    0.526_687_986_700_735_7,
];

/// Numbers in [0, 1) from a seed (the generator SplitMix64 of G. L. Steele, D. Lea, C. H. Flood
/// 2014, doi:10.1145/2660193.2660195).
fn start<const N: usize>(seed: u64) -> [f64; N] {
    let mut state = seed;
    std::array::from_fn(|_| {
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = state;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        (z ^ (z >> 31)) as f64 / 2f64.powi(64)
    })
}

/// For both sides of a pair a member, as a number in [0, 1), and a place on it in [0, 1)²; one
/// after the other.
pub(super) struct Places {
    start: [f64; 6],
    drawn: u32,
}

impl Places {
    /// Those of a pair with this number.
    pub fn of(seed: u64) -> Self {
        Self { start: start(seed), drawn: 0 }
    }

    /// Those of a pair that lies at two points.
    pub fn at(x: Vec3, y: Vec3) -> Self {
        let bits = |v: Vec3| v.x.to_bits() ^ v.y.to_bits().rotate_left(21) ^ v.z.to_bits().rotate_left(42);
        // The factor tells one side from the other.
        Self::of(bits(x) ^ bits(y).wrapping_mul(0xd6e8_feb8_6659_fd93))
    }

    /// The next ones.
    pub fn next(&mut self) -> [(f64, [f64; 2]); 2] {
        self.drawn += 1;
        let at = |d: usize| (self.start[d] + f64::from(self.drawn) * R6[d]).fract();
        [(at(0), [at(1), at(2)]), (at(3), [at(4), at(5)])]
    }
}
