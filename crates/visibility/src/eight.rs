//! Eight numbers of f32 at once: the same arithmetic for every machine.
//!
//! What a processor with AVX2 does in one instruction another does in a few. Products and sums may
//! be rounded once or twice, so what is computed here decides an answer only where bounds on all
//! roundings leave no doubt.

#![allow(clippy::inline_always, reason = "what is not inlined is compiled for the narrowest vectors")]

/// Numbers in a vector.
pub(crate) const WIDTH: usize = 8;

/// What can be done with eight numbers.
pub(crate) trait Eight: Copy {
    /// Eight numbers.
    type Vector: Copy;

    fn load(self, numbers: &[f32; WIDTH]) -> Self::Vector;
    fn store(self, vector: Self::Vector) -> [f32; WIDTH];
    fn splat(self, number: f32) -> Self::Vector;
    fn sub(self, a: Self::Vector, b: Self::Vector) -> Self::Vector;
    fn mul(self, a: Self::Vector, b: Self::Vector) -> Self::Vector;
    /// a b + c.
    fn mul_add(self, a: Self::Vector, b: Self::Vector, c: Self::Vector) -> Self::Vector;
    /// a b − c.
    fn mul_sub(self, a: Self::Vector, b: Self::Vector, c: Self::Vector) -> Self::Vector;
    fn min(self, a: Self::Vector, b: Self::Vector) -> Self::Vector;
    fn max(self, a: Self::Vector, b: Self::Vector) -> Self::Vector;
    /// Bit i is set where a < b in lane i, which is never so for what is not a number.
    fn less(self, a: Self::Vector, b: Self::Vector) -> u32;
    /// Bit i is set where a ≤ b in lane i, which is never so for what is not a number.
    fn at_most(self, a: Self::Vector, b: Self::Vector) -> u32;
}

/// Work that is compiled once for every instruction set.
pub(crate) trait Work {
    type Output;

    fn run<E: Eight>(self, eight: E) -> Self::Output;
}

/// Does the work with the widest vectors that the processor has.
#[inline]
pub(crate) fn run<W: Work>(work: W) -> W::Output {
    #[cfg(target_arch = "x86_64")]
    if let Some(simd) = pulp::x86::V3::try_new() {
        return simd.vectorize(avx::Call { work, simd });
    }
    work.run(Plain)
}

/// Arrays, which the compiler makes vectors of where it can.
#[derive(Clone, Copy, Debug)]
struct Plain;

impl Plain {
    #[inline(always)]
    fn each(a: [f32; WIDTH], b: [f32; WIDTH], f: impl Fn(f32, f32) -> f32) -> [f32; WIDTH] {
        std::array::from_fn(|i| f(a[i], b[i]))
    }

    #[inline(always)]
    fn bits(a: [f32; WIDTH], b: [f32; WIDTH], f: impl Fn(f32, f32) -> bool) -> u32 {
        (0..WIDTH).map(|i| u32::from(f(a[i], b[i])) << i).sum()
    }
}

impl Eight for Plain {
    type Vector = [f32; WIDTH];

    #[inline(always)]
    fn load(self, numbers: &[f32; WIDTH]) -> Self::Vector {
        *numbers
    }

    #[inline(always)]
    fn store(self, vector: Self::Vector) -> [f32; WIDTH] {
        vector
    }

    #[inline(always)]
    fn splat(self, number: f32) -> Self::Vector {
        [number; WIDTH]
    }

    #[inline(always)]
    fn sub(self, a: Self::Vector, b: Self::Vector) -> Self::Vector {
        Self::each(a, b, |a, b| a - b)
    }

    #[inline(always)]
    fn mul(self, a: Self::Vector, b: Self::Vector) -> Self::Vector {
        Self::each(a, b, |a, b| a * b)
    }

    #[inline(always)]
    fn mul_add(self, a: Self::Vector, b: Self::Vector, c: Self::Vector) -> Self::Vector {
        std::array::from_fn(|i| a[i] * b[i] + c[i])
    }

    #[inline(always)]
    fn mul_sub(self, a: Self::Vector, b: Self::Vector, c: Self::Vector) -> Self::Vector {
        std::array::from_fn(|i| a[i] * b[i] - c[i])
    }

    #[inline(always)]
    fn min(self, a: Self::Vector, b: Self::Vector) -> Self::Vector {
        Self::each(a, b, |a, b| if a < b { a } else { b })
    }

    #[inline(always)]
    fn max(self, a: Self::Vector, b: Self::Vector) -> Self::Vector {
        Self::each(a, b, |a, b| if a > b { a } else { b })
    }

    #[inline(always)]
    fn less(self, a: Self::Vector, b: Self::Vector) -> u32 {
        Self::bits(a, b, |a, b| a < b)
    }

    #[inline(always)]
    fn at_most(self, a: Self::Vector, b: Self::Vector) -> u32 {
        Self::bits(a, b, |a, b| a <= b)
    }
}

#[cfg(target_arch = "x86_64")]
mod avx {
    use std::arch::x86_64::{__m256, _CMP_LE_OQ, _CMP_LT_OQ};

    use pulp::NullaryFnOnce;
    use pulp::bytemuck::cast;
    use pulp::x86::V3;

    use super::{Eight, WIDTH, Work};

    /// A call within code for AVX2.
    pub(super) struct Call<W> {
        pub work: W,
        pub simd: V3,
    }

    impl<W: Work> NullaryFnOnce for Call<W> {
        type Output = W::Output;

        #[inline(always)]
        fn call(self) -> W::Output {
            self.work.run(self.simd)
        }
    }

    impl Eight for V3 {
        type Vector = __m256;

        #[inline(always)]
        fn load(self, numbers: &[f32; WIDTH]) -> __m256 {
            cast(*numbers)
        }

        #[inline(always)]
        fn store(self, vector: __m256) -> [f32; WIDTH] {
            cast(vector)
        }

        #[inline(always)]
        fn splat(self, number: f32) -> __m256 {
            self.avx._mm256_set1_ps(number)
        }

        #[inline(always)]
        fn sub(self, a: __m256, b: __m256) -> __m256 {
            self.avx._mm256_sub_ps(a, b)
        }

        #[inline(always)]
        fn mul(self, a: __m256, b: __m256) -> __m256 {
            self.avx._mm256_mul_ps(a, b)
        }

        #[inline(always)]
        fn mul_add(self, a: __m256, b: __m256, c: __m256) -> __m256 {
            self.fma._mm256_fmadd_ps(a, b, c)
        }

        #[inline(always)]
        fn mul_sub(self, a: __m256, b: __m256, c: __m256) -> __m256 {
            self.fma._mm256_fmsub_ps(a, b, c)
        }

        #[inline(always)]
        fn min(self, a: __m256, b: __m256) -> __m256 {
            self.avx._mm256_min_ps(a, b)
        }

        #[inline(always)]
        fn max(self, a: __m256, b: __m256) -> __m256 {
            self.avx._mm256_max_ps(a, b)
        }

        #[inline(always)]
        fn less(self, a: __m256, b: __m256) -> u32 {
            self.avx._mm256_movemask_ps(self.avx._mm256_cmp_ps::<_CMP_LT_OQ>(a, b)) as u32
        }

        #[inline(always)]
        fn at_most(self, a: __m256, b: __m256) -> u32 {
            self.avx._mm256_movemask_ps(self.avx._mm256_cmp_ps::<_CMP_LE_OQ>(a, b)) as u32
        }
    }
}
