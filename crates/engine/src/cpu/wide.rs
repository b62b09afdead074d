//! The only place where the CPU back end names an instruction set: it picks, at run time, the widest the machine has.
#![allow(
    unsafe_code,
    reason = "calling a function compiled for AVX-512 is sound only after the machine was asked for it"
)]

use super::bodies::Quad;
use super::contact::{Crushed, Rows, Scene, Variant, rows_lanes};
use tdem_physics::real::{Lanes, WIDTH};

/// How eight quads are brought into lanes.
pub(super) trait Machine {
    /// The first numbers of eight quads, the second ones, the third, the fourth.
    fn load(field: &[Quad], index: &[u32; WIDTH]) -> [Lanes; 4];
}

/// Any machine.
struct Portable;

impl Machine for Portable {
    #[inline(always)]
    fn load(field: &[Quad], index: &[u32; WIDTH]) -> [Lanes; 4] {
        let mut lanes = [Lanes([0.0; WIDTH]); 4];
        for l in 0..WIDTH {
            let quad = field[index[l] as usize].0;
            for k in 0..4 {
                lanes[k].0[l] = quad[k];
            }
        }
        lanes
    }
}

/// The contact loop for the widest registers of this machine.
pub(super) fn rows_widest<V: Variant>(scene: &Scene<'_>, rows: &mut Rows<'_>) -> Crushed {
    #[cfg(target_arch = "x86_64")]
    if is_x86_feature_detected!("avx512f") && is_x86_feature_detected!("avx512dq") {
        // SAFETY: the machine has just said that it has these features.
        return unsafe { x86::rows_avx512::<V>(scene, rows) };
    }
    rows_lanes::<V, Portable>(scene, rows)
}

#[cfg(target_arch = "x86_64")]
mod x86 {
    use super::{Crushed, Lanes, Machine, Quad, Rows, Scene, Variant, WIDTH, rows_lanes};
    use std::arch::x86_64::{
        __m512d, _mm256_load_pd, _mm512_castpd256_pd512, _mm512_insertf64x4, _mm512_permutex2var_pd, _mm512_setr_epi64,
        _mm512_store_pd, _mm512_unpackhi_pd, _mm512_unpacklo_pd,
    };

    /// A machine with AVX-512; only [`rows_avx512`] names it.
    struct Avx512;

    impl Machine for Avx512 {
        #[inline(always)]
        fn load(field: &[Quad], index: &[u32; WIDTH]) -> [Lanes; 4] {
            // SAFETY: only `rows_avx512` uses this type, and it is called on machines that have the feature.
            unsafe { load(field, index) }
        }
    }

    #[target_feature(enable = "avx512f,avx512dq")]
    pub(super) fn rows_avx512<V: Variant>(scene: &Scene<'_>, rows: &mut Rows<'_>) -> Crushed {
        rows_lanes::<V, Avx512>(scene, rows)
    }

    /// Eight rows of four to four rows of eight: eight 32-byte loads and twelve shuffles.
    #[target_feature(enable = "avx512f,avx512dq")]
    #[inline]
    fn load(field: &[Quad], index: &[u32; WIDTH]) -> [Lanes; 4] {
        // SAFETY: a quad is 32 bytes at a multiple of 32.
        let quad = |l: usize| unsafe { _mm256_load_pd(field[index[l] as usize].0.as_ptr()) };
        let both = |l: usize| _mm512_insertf64x4::<1>(_mm512_castpd256_pd512(quad(l)), quad(l + 4));
        let rows = [both(0), both(1), both(2), both(3)];
        // x0 x1 z0 z1 x4 x5 z4 z5 and so on: pairs of lanes.
        let xz01 = _mm512_unpacklo_pd(rows[0], rows[1]);
        let yw01 = _mm512_unpackhi_pd(rows[0], rows[1]);
        let xz23 = _mm512_unpacklo_pd(rows[2], rows[3]);
        let yw23 = _mm512_unpackhi_pd(rows[2], rows[3]);
        let low = _mm512_setr_epi64(0, 1, 8, 9, 4, 5, 12, 13);
        let high = _mm512_setr_epi64(2, 3, 10, 11, 6, 7, 14, 15);
        [
            lanes(_mm512_permutex2var_pd(xz01, low, xz23)),
            lanes(_mm512_permutex2var_pd(yw01, low, yw23)),
            lanes(_mm512_permutex2var_pd(xz01, high, xz23)),
            lanes(_mm512_permutex2var_pd(yw01, high, yw23)),
        ]
    }

    #[target_feature(enable = "avx512f,avx512dq")]
    #[inline]
    fn lanes(register: __m512d) -> Lanes {
        let mut lanes = Lanes([0.0; WIDTH]);
        // SAFETY: lanes are 64 bytes at a multiple of 64.
        unsafe { _mm512_store_pd(lanes.0.as_mut_ptr(), register) };
        lanes
    }
}
