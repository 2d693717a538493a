//! AVX2: vectors of 8 rays.
#![allow(unsafe_code, reason = "intrinsics")]

use std::arch::x86_64::{
    __m256, __m256i, _CMP_LE_OQ, _CMP_LT_OQ, _CMP_NGT_UQ, _mm_cvtsi64_si128, _mm256_add_epi32, _mm256_add_ps, _mm256_and_ps,
    _mm256_and_si256, _mm256_andnot_ps, _mm256_blendv_ps, _mm256_castps_si256, _mm256_castsi256_ps, _mm256_cmp_ps,
    _mm256_cmpgt_epi32, _mm256_cvtepi32_ps, _mm256_cvtepu8_epi32, _mm256_cvttps_epi32, _mm256_floor_ps, _mm256_fmadd_ps,
    _mm256_loadu_ps, _mm256_loadu_si256, _mm256_min_epu32, _mm256_min_ps, _mm256_movemask_ps, _mm256_mullo_epi32,
    _mm256_permutevar8x32_epi32, _mm256_permutevar8x32_ps, _mm256_set1_epi32, _mm256_set1_ps, _mm256_setr_epi32,
    _mm256_slli_epi32, _mm256_storeu_ps, _mm256_storeu_si256, _mm256_sub_ps,
};

use super::lanes::{Lanes, Work};

/// Proof that the processor has AVX2, FMA and POPCNT.
#[derive(Debug, Clone, Copy)]
pub struct Avx2(());

impl Avx2 {
    /// Returns the proof, if the processor has the instruction set.
    pub fn new() -> Option<Self> {
        let has = is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma") && is_x86_feature_detected!("popcnt");
        has.then_some(Self(()))
    }
}

/// For each mask of lanes: the indices of the lanes whose bit is set, then zeros.
static COMPACTIONS: [[i32; 8]; 256] = {
    let mut table = [[0; 8]; 256];
    let mut bits = 0;
    while bits < 256 {
        let (mut lane, mut kept) = (0, 0);
        while lane < 8 {
            if bits >> lane & 1 == 1 {
                table[bits][kept] = lane;
                kept += 1;
            }
            lane += 1;
        }
        bits += 1;
    }
    table
};

/// Defines methods that consist of one expression of intrinsics.
macro_rules! lanewise {
    ($($name:ident($($argument:ident: $type:ty),*) -> $result:ty { $body:expr })*) => {
        $(#[inline(always)]
        fn $name(self, $($argument: $type),*) -> $result {
            // SAFETY: `self` is proof that the processor has the instruction set; no memory is accessed.
            unsafe { $body }
        })*
    };
}

impl Lanes for Avx2 {
    const COUNT: usize = 8;
    type Float = __m256;
    type Int = __m256i;
    type Mask = __m256;
    type Compaction = __m256i;

    lanewise! {
        splat(number: f32) -> __m256 { _mm256_set1_ps(number) }
        splat_int(number: i32) -> __m256i { _mm256_set1_epi32(number) }
        add(a: __m256, b: __m256) -> __m256 { _mm256_add_ps(a, b) }
        multiply_add(a: __m256, b: __m256, c: __m256) -> __m256 { _mm256_fmadd_ps(a, b, c) }
        floor(a: __m256) -> __m256 { _mm256_floor_ps(a) }
        to_int(a: __m256) -> __m256i { _mm256_cvttps_epi32(a) }
        to_float(mask: __m256, a: __m256i) -> __m256 { _mm256_and_ps(mask, _mm256_cvtepi32_ps(a)) }
        add_int(a: __m256i, b: __m256i) -> __m256i { _mm256_add_epi32(a, b) }
        multiply_int(a: __m256i, b: __m256i) -> __m256i { _mm256_mullo_epi32(a, b) }
        pack(a: __m256i, b: __m256i) -> __m256i { _mm256_add_epi32(_mm256_slli_epi32::<16>(a), b) }
        is_less(mask: __m256, a: __m256, b: __m256) -> __m256 { _mm256_and_ps(mask, _mm256_cmp_ps::<_CMP_LT_OQ>(a, b)) }
        is_at_most(mask: __m256, a: __m256, b: __m256) -> __m256 { _mm256_and_ps(mask, _mm256_cmp_ps::<_CMP_LE_OQ>(a, b)) }
        is_not_greater(mask: __m256, a: __m256, b: __m256) -> __m256 { _mm256_and_ps(mask, _mm256_cmp_ps::<_CMP_NGT_UQ>(a, b)) }
        is_positive(mask: __m256, a: __m256i) -> __m256 {
            _mm256_and_ps(mask, _mm256_castsi256_ps(_mm256_cmpgt_epi32(a, _mm256_set1_epi32(0))))
        }
        and_not(a: __m256, b: __m256) -> __m256 { _mm256_andnot_ps(b, a) }
        bits(mask: __m256) -> u32 { _mm256_movemask_ps(mask) as u32 }
        select(mask: __m256, a: __m256, b: __m256) -> __m256 { _mm256_blendv_ps(b, a, mask) }
    }

    #[inline(always)]
    fn distance_to_integer(self, a: __m256) -> __m256 {
        // SAFETY: `self` is proof that the processor has the instruction set; no memory is accessed.
        unsafe {
            let beyond = _mm256_sub_ps(a, _mm256_floor_ps(a));
            _mm256_min_ps(beyond, _mm256_sub_ps(_mm256_set1_ps(1.0), beyond))
        }
    }

    fn with_features(self, work: impl Work) {
        #[inline(never)]
        #[target_feature(enable = "avx2,fma,popcnt")]
        fn with_features(work: impl Work) {
            work.run();
        }
        // SAFETY: `self` is proof that the processor has the instruction set.
        unsafe { with_features(work) }
    }

    #[inline(always)]
    fn sides(self, mask: __m256, codes: __m256i) -> (__m256, __m256) {
        // SAFETY: `self` is proof that the processor has the instruction set; no memory is accessed.
        unsafe {
            let code = _mm256_and_si256(_mm256_castps_si256(mask), codes);
            let is_even = _mm256_cmpgt_epi32(code, _mm256_set1_epi32(1));
            // A comparison that holds gives -1.
            let breadth = _mm256_add_epi32(code, is_even);
            let length = _mm256_add_epi32(breadth, _mm256_and_si256(breadth, is_even));
            (_mm256_cvtepi32_ps(length), _mm256_cvtepi32_ps(breadth))
        }
    }

    #[inline(always)]
    fn first_lanes(self, count: usize) -> __m256 {
        let count = self.splat_int(count.min(Self::COUNT) as i32);
        // SAFETY: `self` is proof that the processor has the instruction set; no memory is accessed.
        unsafe { _mm256_castsi256_ps(_mm256_cmpgt_epi32(count, _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7))) }
    }

    #[inline(always)]
    fn gather(self, bytes: &[u8], indices: __m256i) -> __m256i {
        assert!((1..=i32::MAX as usize).contains(&bytes.len()));
        // SAFETY: `self` is proof that the processor has the instruction set. A vector and the array have the same size, and
        // all bits are valid. After the minimum no index is past the end.
        unsafe {
            let indices = _mm256_min_epu32(indices, _mm256_set1_epi32((bytes.len() - 1) as i32));
            let indices: [u32; 8] = std::mem::transmute(indices);
            debug_assert!(indices.iter().all(|&index| (index as usize) < bytes.len()));
            let byte = |lane: usize| u64::from(*bytes.get_unchecked(indices[lane] as usize)) << (8 * lane);
            let gathered = (0..8).fold(0, |all, lane| all | byte(lane));
            _mm256_cvtepu8_epi32(_mm_cvtsi64_si128(gathered as i64))
        }
    }

    #[inline(always)]
    fn load(self, numbers: &[f32], at: usize) -> __m256 {
        let numbers = &numbers[at..at + Self::COUNT];
        // SAFETY: `self` is proof that the processor has the instruction set; the slice is as long as a vector.
        unsafe { _mm256_loadu_ps(numbers.as_ptr()) }
    }

    #[inline(always)]
    fn load_int(self, numbers: &[i32], at: usize) -> __m256i {
        let numbers = &numbers[at..at + Self::COUNT];
        // SAFETY: `self` is proof that the processor has the instruction set; the slice is as long as a vector.
        unsafe { _mm256_loadu_si256(numbers.as_ptr().cast()) }
    }

    #[inline(always)]
    fn compaction(self, bits: u32) -> __m256i {
        self.load_int(&COMPACTIONS[bits as usize], 0)
    }

    #[inline(always)]
    fn store_compacted(self, compaction: __m256i, numbers: &mut [f32], at: usize, a: __m256) {
        // SAFETY: `self` is proof that the processor has the instruction set; no memory is accessed.
        self.store(numbers, at, unsafe { _mm256_permutevar8x32_ps(a, compaction) });
    }

    #[inline(always)]
    fn store_int_compacted(self, compaction: __m256i, numbers: &mut [i32], at: usize, a: __m256i) {
        // SAFETY: `self` is proof that the processor has the instruction set; no memory is accessed.
        self.store_int(numbers, at, unsafe { _mm256_permutevar8x32_epi32(a, compaction) });
    }

    #[inline(always)]
    fn store(self, numbers: &mut [f32], at: usize, a: __m256) {
        let numbers = &mut numbers[at..at + Self::COUNT];
        // SAFETY: `self` is proof that the processor has the instruction set; the slice is as long as a vector.
        unsafe { _mm256_storeu_ps(numbers.as_mut_ptr(), a) }
    }

    #[inline(always)]
    fn store_int(self, numbers: &mut [i32], at: usize, a: __m256i) {
        let numbers = &mut numbers[at..at + Self::COUNT];
        // SAFETY: `self` is proof that the processor has the instruction set; the slice is as long as a vector.
        unsafe { _mm256_storeu_si256(numbers.as_mut_ptr().cast(), a) }
    }
}
