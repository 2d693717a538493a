//! AVX-512: vectors of 16 rays.
#![allow(unsafe_code, reason = "intrinsics")]

use std::arch::x86_64::{
    __m512, __m512i, __mmask16, _CMP_LE_OQ, _CMP_LT_OQ, _CMP_NGT_UQ, _MM_FROUND_NO_EXC, _MM_FROUND_TO_NEAREST_INT,
    _MM_FROUND_TO_NEG_INF, _mm_setr_epi8, _mm_unpacklo_epi32, _mm_unpacklo_epi64, _mm512_abs_ps, _mm512_add_epi32,
    _mm512_add_ps, _mm512_cvtepu8_epi32, _mm512_cvttps_epi32, _mm512_fmadd_ps, _mm512_i32gather_epi32, _mm512_loadu_ps,
    _mm512_loadu_si512, _mm512_mask_add_ps, _mm512_mask_blend_ps, _mm512_mask_cmp_ps_mask, _mm512_mask_cmpgt_epi32_mask,
    _mm512_mask_sub_ps, _mm512_maskz_compress_epi32, _mm512_maskz_cvtepi32_ps, _mm512_max_epu32, _mm512_min_epu32,
    _mm512_mullo_epi32, _mm512_permutexvar_epi32, _mm512_permutexvar_ps, _mm512_reduce_ps, _mm512_roundscale_ps,
    _mm512_set1_epi32, _mm512_set1_ps, _mm512_setr_epi32, _mm512_setzero_si512, _mm512_slli_epi32, _mm512_srli_epi32,
    _mm512_storeu_ps, _mm512_storeu_si512,
};

use super::lanes::{Lanes, Work};

/// Proof that the processor has AVX-512 F, BW, DQ and VL, and POPCNT. With `GATHER`, bytes are fetched by the gather
/// instruction, else one by one.
#[derive(Debug, Clone, Copy)]
pub struct Avx512<const GATHER: bool>(());

const DOWN: i32 = _MM_FROUND_TO_NEG_INF | _MM_FROUND_NO_EXC;
const NEAREST: i32 = _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC;

impl<const GATHER: bool> Avx512<GATHER> {
    /// Returns the proof, if the processor has the instruction set.
    pub fn new() -> Option<Self> {
        let has = is_x86_feature_detected!("avx512f")
            && is_x86_feature_detected!("avx512bw")
            && is_x86_feature_detected!("avx512dq")
            && is_x86_feature_detected!("avx512vl")
            && is_x86_feature_detected!("popcnt");
        has.then_some(Self(()))
    }
}

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

impl<const GATHER: bool> Lanes for Avx512<GATHER> {
    const COUNT: usize = 16;
    type Float = __m512;
    type Int = __m512i;
    type Mask = __mmask16;
    type Compaction = __m512i;

    lanewise! {
        splat(number: f32) -> __m512 { _mm512_set1_ps(number) }
        splat_int(number: i32) -> __m512i { _mm512_set1_epi32(number) }
        add(a: __m512, b: __m512) -> __m512 { _mm512_add_ps(a, b) }
        multiply_add(a: __m512, b: __m512, c: __m512) -> __m512 { _mm512_fmadd_ps(a, b, c) }
        floor(a: __m512) -> __m512 { _mm512_roundscale_ps::<DOWN>(a) }
        distance_to_integer(a: __m512) -> __m512 { _mm512_abs_ps(_mm512_reduce_ps::<NEAREST>(a)) }
        to_int(a: __m512) -> __m512i { _mm512_cvttps_epi32(a) }
        to_float(mask: __mmask16, a: __m512i) -> __m512 { _mm512_maskz_cvtepi32_ps(mask, a) }
        add_int(a: __m512i, b: __m512i) -> __m512i { _mm512_add_epi32(a, b) }
        multiply_int(a: __m512i, b: __m512i) -> __m512i { _mm512_mullo_epi32(a, b) }
        pack(a: __m512i, b: __m512i) -> __m512i { _mm512_add_epi32(_mm512_slli_epi32::<16>(a), b) }
        is_less(mask: __mmask16, a: __m512, b: __m512) -> __mmask16 { _mm512_mask_cmp_ps_mask::<_CMP_LT_OQ>(mask, a, b) }
        is_at_most(mask: __mmask16, a: __m512, b: __m512) -> __mmask16 { _mm512_mask_cmp_ps_mask::<_CMP_LE_OQ>(mask, a, b) }
        is_not_greater(mask: __mmask16, a: __m512, b: __m512) -> __mmask16 { _mm512_mask_cmp_ps_mask::<_CMP_NGT_UQ>(mask, a, b) }
        is_positive(mask: __mmask16, a: __m512i) -> __mmask16 { _mm512_mask_cmpgt_epi32_mask(mask, a, _mm512_setzero_si512()) }
        select(mask: __mmask16, a: __m512, b: __m512) -> __m512 { _mm512_mask_blend_ps(mask, b, a) }
    }

    fn with_features(self, work: impl Work) {
        #[inline(never)]
        #[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl,popcnt")]
        fn with_features(work: impl Work) {
            work.run();
        }
        // SAFETY: `self` is proof that the processor has the instruction set.
        unsafe { with_features(work) }
    }

    #[inline(always)]
    fn sides(self, mask: __mmask16, codes: __m512i) -> (__m512, __m512) {
        // SAFETY: `self` is proof that the processor has the instruction set; no memory is accessed.
        unsafe {
            let is_even = _mm512_mask_cmpgt_epi32_mask(mask, codes, _mm512_set1_epi32(1));
            let code = self.to_float(mask, codes);
            let breadth = _mm512_mask_sub_ps(code, is_even, code, _mm512_set1_ps(1.0));
            (_mm512_mask_add_ps(breadth, is_even, breadth, breadth), breadth)
        }
    }

    #[inline(always)]
    fn first_lanes(self, count: usize) -> __mmask16 {
        if count < Self::COUNT { (1 << count) - 1 } else { !0 }
    }

    #[inline(always)]
    fn and_not(self, a: __mmask16, b: __mmask16) -> __mmask16 {
        a & !b
    }

    #[inline(always)]
    fn bits(self, mask: __mmask16) -> u32 {
        mask.into()
    }

    #[inline(always)]
    fn gather(self, bytes: &[u8], indices: __m512i) -> __m512i {
        assert!((4..=i32::MAX as usize).contains(&bytes.len()));
        if GATHER {
            // SAFETY: `self` is proof that the processor has the instruction set. Each lane reads the byte at its index and
            // the three before it. After the minimum and the maximum, these are within `bytes`.
            return unsafe {
                let indices = _mm512_min_epu32(indices, _mm512_set1_epi32((bytes.len() - 1) as i32));
                let indices = _mm512_max_epu32(indices, _mm512_set1_epi32(3));
                let words = _mm512_i32gather_epi32::<1>(indices, bytes.as_ptr().wrapping_sub(3).cast());
                _mm512_srli_epi32::<24>(words)
            };
        }
        // SAFETY: `self` is proof that the processor has the instruction set. A vector and the array have the same size, and
        // all bits are valid. After the minimum no index is past the end.
        unsafe {
            let indices = _mm512_min_epu32(indices, _mm512_set1_epi32((bytes.len() - 1) as i32));
            let indices: [u32; 16] = std::mem::transmute(indices);
            debug_assert!(indices.iter().all(|&index| (index as usize) < bytes.len()));
            let byte = |lane: usize| *bytes.get_unchecked(indices[lane] as usize) as i8;
            // Four chains of insertions run in parallel.
            let quarter = |first: usize| {
                let [a, b, c, d] = [0, 1, 2, 3].map(|nth| byte(first + nth));
                _mm_setr_epi8(a, b, c, d, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0)
            };
            let low = _mm_unpacklo_epi32(quarter(0), quarter(4));
            let high = _mm_unpacklo_epi32(quarter(8), quarter(12));
            _mm512_cvtepu8_epi32(_mm_unpacklo_epi64(low, high))
        }
    }

    #[inline(always)]
    fn load(self, numbers: &[f32], at: usize) -> __m512 {
        let numbers = &numbers[at..at + Self::COUNT];
        // SAFETY: `self` is proof that the processor has the instruction set; the slice is as long as a vector.
        unsafe { _mm512_loadu_ps(numbers.as_ptr()) }
    }

    #[inline(always)]
    fn load_int(self, numbers: &[i32], at: usize) -> __m512i {
        let numbers = &numbers[at..at + Self::COUNT];
        // SAFETY: `self` is proof that the processor has the instruction set; the slice is as long as a vector.
        unsafe { _mm512_loadu_si512(numbers.as_ptr().cast()) }
    }

    #[inline(always)]
    fn compaction(self, bits: u32) -> __m512i {
        // SAFETY: `self` is proof that the processor has the instruction set; no memory is accessed.
        unsafe {
            let lanes = _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
            _mm512_maskz_compress_epi32(bits as __mmask16, lanes)
        }
    }

    #[inline(always)]
    fn store_compacted(self, compaction: __m512i, numbers: &mut [f32], at: usize, a: __m512) {
        // SAFETY: `self` is proof that the processor has the instruction set; no memory is accessed.
        self.store(numbers, at, unsafe { _mm512_permutexvar_ps(compaction, a) });
    }

    #[inline(always)]
    fn store_int_compacted(self, compaction: __m512i, numbers: &mut [i32], at: usize, a: __m512i) {
        // SAFETY: `self` is proof that the processor has the instruction set; no memory is accessed.
        self.store_int(numbers, at, unsafe { _mm512_permutexvar_epi32(compaction, a) });
    }

    #[inline(always)]
    fn store(self, numbers: &mut [f32], at: usize, a: __m512) {
        let numbers = &mut numbers[at..at + Self::COUNT];
        // SAFETY: `self` is proof that the processor has the instruction set; the slice is as long as a vector.
        unsafe { _mm512_storeu_ps(numbers.as_mut_ptr(), a) }
    }

    #[inline(always)]
    fn store_int(self, numbers: &mut [i32], at: usize, a: __m512i) {
        let numbers = &mut numbers[at..at + Self::COUNT];
        // SAFETY: `self` is proof that the processor has the instruction set; the slice is as long as a vector.
        unsafe { _mm512_storeu_si512(numbers.as_mut_ptr().cast(), a) }
    }
}
