//! The only place where the CPU back end names an instruction set: it picks, at run time, the widest the machine has.
#![allow(unsafe_code, reason = "an instruction may be used only on machines that were asked whether they have it")]

use super::bodies::Quad;
use tdem_physics::contact::Period;
use tdem_physics::real::{Lanes, WIDTH};
use tdem_physics::{Real, Vec3, vec3};

/// Eight numbers in lanes, and how they come from and go to memory.
pub(crate) trait Eight: Real {
    fn from_array(numbers: [f64; WIDTH]) -> Self;
    /// One bit per lane.
    fn bits(mask: Self::Mask) -> u8;
    /// The first numbers of eight quads, the second ones, the third, the fourth.
    fn load(field: &[Quad], index: &[u32; WIDTH]) -> [Self; 4];
    /// The same for vectors.
    fn load_triples(field: &[[f64; 3]], index: &[u32; WIDTH]) -> Vec3<Self>;
    /// The way back: eight quads from four rows of eight.
    fn quads(rows: [Self; 4]) -> [[f64; 4]; WIDTH];
}

/// Any machine: the compiler makes of it what it can.
impl Eight for Lanes {
    #[inline(always)]
    fn from_array(numbers: [f64; WIDTH]) -> Self {
        Lanes(numbers)
    }
    #[inline(always)]
    fn bits(mask: [u64; WIDTH]) -> u8 {
        let mut bits = 0;
        for l in 0..WIDTH {
            bits |= (mask[l] as u8 & 1) << l;
        }
        bits
    }
    #[inline(always)]
    fn load(field: &[Quad], index: &[u32; WIDTH]) -> [Self; 4] {
        let mut lanes = [Lanes([0.0; WIDTH]); 4];
        for l in 0..WIDTH {
            let quad = field[index[l] as usize].0;
            for k in 0..4 {
                lanes[k].0[l] = quad[k];
            }
        }
        lanes
    }
    #[inline(always)]
    fn load_triples(field: &[[f64; 3]], index: &[u32; WIDTH]) -> Vec3<Self> {
        let mut lanes = [Lanes([0.0; WIDTH]); 3];
        for l in 0..WIDTH {
            let triple = field[index[l] as usize];
            for k in 0..3 {
                lanes[k].0[l] = triple[k];
            }
        }
        vec3(lanes[0], lanes[1], lanes[2])
    }
    #[inline(always)]
    fn quads(rows: [Self; 4]) -> [[f64; 4]; WIDTH] {
        let mut quads = [[0.0; 4]; WIDTH];
        for l in 0..WIDTH {
            for k in 0..4 {
                quads[l][k] = rows[k].0[l];
            }
        }
        quads
    }
}

/// Asks for the memory of an element that will be read soon; an index outside the field is ignored.
#[inline(always)]
pub(super) fn prefetch<T>(field: &[T], index: usize) {
    #[cfg(target_arch = "x86_64")]
    if let Some(element) = field.get(index) {
        // SAFETY: a prefetch reads nothing that the program can see, and the address is that of an element.
        unsafe {
            std::arch::x86_64::_mm_prefetch::<{ std::arch::x86_64::_MM_HINT_T0 }>(std::ptr::from_ref(element).cast());
        };
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = (field, index);
}

/// A box that repeats, for eight numbers.
#[inline(always)]
pub(super) fn lanes_period<R: Eight>(period: &Period<f64>) -> Period<R> {
    let eight = |v: &Vec3<f64>| vec3(R::lit(v.x), R::lit(v.y), R::lit(v.z));
    Period { length: eight(&period.length), half: eight(&period.half) }
}

/// A loop over eight numbers at a time, written for any kind of them.
pub(crate) trait Loop {
    /// What it finds.
    type Found;
    /// Must always be inlined, with all that it calls, or it is compiled without the instruction set of its caller.
    fn run<R: Eight>(self) -> Self::Found;
}

/// Runs a loop on any machine. Not inlined: it would be compiled once more into [`run_widest`].
#[inline(never)]
pub(crate) fn run_portable<L: Loop>(eight: L) -> L::Found {
    eight.run::<Lanes>()
}

/// Runs a loop with the widest registers of this machine.
pub(crate) fn run_widest<L: Loop>(eight: L) -> L::Found {
    #[cfg(target_arch = "x86_64")]
    {
        if is_x86_feature_detected!("avx512f")
            && is_x86_feature_detected!("avx512dq")
            && is_x86_feature_detected!("avx512vl")
        {
            // SAFETY: the machine has just said that it has these features.
            return unsafe { x86::run_avx512(eight) };
        }
        if is_x86_feature_detected!("avx2") {
            // SAFETY: the machine has just said that it has this feature.
            return unsafe { x86::run_avx2(eight) };
        }
    }
    run_portable(eight)
}

#[cfg(target_arch = "x86_64")]
mod x86 {
    use super::{Eight, Lanes, Loop, Quad, WIDTH};
    use std::arch::x86_64::{
        __m256d, __m512d, __mmask8, _CMP_GT_OQ, _mm256_load_pd, _mm256_maskz_loadu_pd, _mm512_abs_pd, _mm512_add_pd,
        _mm512_castpd256_pd512, _mm512_cmp_pd_mask, _mm512_div_pd, _mm512_insertf64x4, _mm512_loadu_pd,
        _mm512_mask_blend_pd, _mm512_mul_pd, _mm512_permutex2var_pd, _mm512_set1_pd, _mm512_setr_epi64,
        _mm512_shuffle_f64x2, _mm512_sqrt_pd, _mm512_store_pd, _mm512_sub_pd, _mm512_unpackhi_pd, _mm512_unpacklo_pd,
        _mm512_xor_pd,
    };
    use std::ops::{Add, Div, Mul, Neg, Sub};
    use tdem_physics::real::{Branch, Pack};
    use tdem_physics::{Real, Vec3, vec3};

    #[target_feature(enable = "avx512f,avx512dq,avx512vl")]
    pub(super) fn run_avx512<L: Loop>(eight: L) -> L::Found {
        eight.run::<Zmm>()
    }
    #[target_feature(enable = "avx2")]
    pub(super) fn run_avx2<L: Loop>(eight: L) -> L::Found {
        eight.run::<Lanes>()
    }

    /// Eight numbers in one AVX-512 register: what [`Lanes`] says, one instruction each. Only code that [`run_avx512`]
    /// calls makes one.
    #[derive(Clone, Copy)]
    pub(super) struct Zmm(__m512d);

    macro_rules! operators {
        ($($operator:ident $function:ident $instruction:ident),*) => {$(
            impl $operator for Zmm {
                type Output = Self;
                #[inline(always)]
                fn $function(self, other: Self) -> Self {
                    // SAFETY: a `Zmm` exists only where AVX-512 does.
                    Zmm(unsafe { $instruction(self.0, other.0) })
                }
            }
        )*};
    }
    operators!(Add add _mm512_add_pd, Sub sub _mm512_sub_pd, Mul mul _mm512_mul_pd, Div div _mm512_div_pd);

    impl Neg for Zmm {
        type Output = Self;
        #[inline(always)]
        fn neg(self) -> Self {
            // SAFETY: a `Zmm` exists only where AVX-512 does.
            Zmm(unsafe { _mm512_xor_pd(self.0, _mm512_set1_pd(-0.0)) })
        }
    }

    impl Real for Zmm {
        type Mask = __mmask8;

        #[inline(always)]
        fn lit(value: f64) -> Self {
            // SAFETY: only code that `run_avx512` calls uses this type.
            Zmm(unsafe { _mm512_set1_pd(value) })
        }
        #[inline(always)]
        fn sqrt(self) -> Self {
            // SAFETY: a `Zmm` exists only where AVX-512 does.
            Zmm(unsafe { _mm512_sqrt_pd(self.0) })
        }
        #[inline(always)]
        fn abs(self) -> Self {
            // SAFETY: a `Zmm` exists only where AVX-512 does.
            Zmm(unsafe { _mm512_abs_pd(self.0) })
        }
        #[inline(always)]
        fn gt(self, other: Self) -> __mmask8 {
            // SAFETY: a `Zmm` exists only where AVX-512 does.
            unsafe { _mm512_cmp_pd_mask::<_CMP_GT_OQ>(self.0, other.0) }
        }
        #[inline(always)]
        fn select(mask: __mmask8, if_true: Self, if_false: Self) -> Self {
            // SAFETY: a `Zmm` exists only where AVX-512 does.
            Zmm(unsafe { _mm512_mask_blend_pd(mask, if_false.0, if_true.0) })
        }
        /// Skipped as a whole when no lane needs it.
        #[inline(always)]
        fn when<T: Pack<Self>>(mask: __mmask8, value: T, then: impl Branch<T>) -> T {
            if mask == 0 {
                return value;
            }
            then.taken(value).zip(value, &mut |replaced, kept| Self::select(mask, replaced, kept))
        }
    }

    impl Eight for Zmm {
        #[inline(always)]
        fn from_array(numbers: [f64; WIDTH]) -> Self {
            // SAFETY: only code that `run_avx512` calls uses this type; the array has the eight numbers that are read.
            Zmm(unsafe { _mm512_loadu_pd(numbers.as_ptr()) })
        }
        #[inline(always)]
        fn bits(mask: __mmask8) -> u8 {
            mask
        }
        /// Eight loads of 32 bytes and twelve shuffles.
        #[inline(always)]
        fn load(field: &[Quad], index: &[u32; WIDTH]) -> [Self; 4] {
            let from = pointers(field, index);
            // SAFETY: only code that `run_avx512` calls uses this type; a quad is 32 bytes at a multiple of 32.
            unsafe {
                columns([
                    _mm256_load_pd(from[0]),
                    _mm256_load_pd(from[1]),
                    _mm256_load_pd(from[2]),
                    _mm256_load_pd(from[3]),
                    _mm256_load_pd(from[4]),
                    _mm256_load_pd(from[5]),
                    _mm256_load_pd(from[6]),
                    _mm256_load_pd(from[7]),
                ])
            }
        }
        #[inline(always)]
        fn load_triples(field: &[[f64; 3]], index: &[u32; WIDTH]) -> Vec3<Self> {
            let from = pointers(field, index);
            // SAFETY: only code that `run_avx512` calls uses this type; the mask reads three numbers of each triple.
            let [x, y, z, _] = unsafe {
                columns([
                    _mm256_maskz_loadu_pd(0b111, from[0]),
                    _mm256_maskz_loadu_pd(0b111, from[1]),
                    _mm256_maskz_loadu_pd(0b111, from[2]),
                    _mm256_maskz_loadu_pd(0b111, from[3]),
                    _mm256_maskz_loadu_pd(0b111, from[4]),
                    _mm256_maskz_loadu_pd(0b111, from[5]),
                    _mm256_maskz_loadu_pd(0b111, from[6]),
                    _mm256_maskz_loadu_pd(0b111, from[7]),
                ])
            };
            vec3(x, y, z)
        }
        #[inline(always)]
        fn quads([x, y, z, w]: [Self; 4]) -> [[f64; 4]; WIDTH] {
            let mut quads = Aligned([[0.0; 4]; WIDTH]);
            // SAFETY: a `Zmm` exists only where AVX-512 does; two quads are the 64 bytes that each store writes.
            unsafe {
                // Pairs of lanes: x0 y0 x2 y2 x4 y4 x6 y6, and so on.
                let xy_even = _mm512_unpacklo_pd(x.0, y.0);
                let xy_odd = _mm512_unpackhi_pd(x.0, y.0);
                let zw_even = _mm512_unpacklo_pd(z.0, w.0);
                let zw_odd = _mm512_unpackhi_pd(z.0, w.0);
                let low = _mm512_setr_epi64(0, 1, 8, 9, 2, 3, 10, 11);
                let high = _mm512_setr_epi64(4, 5, 12, 13, 6, 7, 14, 15);
                // Quads 0 and 2, 4 and 6, 1 and 3, 5 and 7.
                let q02 = _mm512_permutex2var_pd(xy_even, low, zw_even);
                let q46 = _mm512_permutex2var_pd(xy_even, high, zw_even);
                let q13 = _mm512_permutex2var_pd(xy_odd, low, zw_odd);
                let q57 = _mm512_permutex2var_pd(xy_odd, high, zw_odd);
                let to = quads.0.as_mut_ptr().cast::<f64>();
                _mm512_store_pd(to, _mm512_shuffle_f64x2::<0b01_00_01_00>(q02, q13));
                _mm512_store_pd(to.add(8), _mm512_shuffle_f64x2::<0b11_10_11_10>(q02, q13));
                _mm512_store_pd(to.add(16), _mm512_shuffle_f64x2::<0b01_00_01_00>(q46, q57));
                _mm512_store_pd(to.add(24), _mm512_shuffle_f64x2::<0b11_10_11_10>(q46, q57));
            }
            quads.0
        }
    }

    /// Where eight elements stand. One check for all of them: eight would cost more than the loads.
    #[inline(always)]
    fn pointers<T>(field: &[T], index: &[u32; WIDTH]) -> [*const f64; WIDTH] {
        let mut largest = 0;
        for l in 0..WIDTH {
            largest = if index[l] > largest { index[l] } else { largest };
        }
        assert!((largest as usize) < field.len(), "a neighbour list names a particle that does not exist");
        let start = field.as_ptr();
        let mut to = [start.cast(); WIDTH];
        for l in 0..WIDTH {
            // SAFETY: no index is larger than the largest, which is inside the field.
            to[l] = unsafe { start.add(index[l] as usize) }.cast();
        }
        to
    }

    /// Where whole registers are stored.
    #[repr(C, align(64))]
    struct Aligned([[f64; 4]; WIDTH]);

    /// Eight rows of four to four rows of eight: four insertions and eight shuffles.
    ///
    /// # Safety
    /// Only on machines with AVX-512.
    #[inline(always)]
    unsafe fn columns(q: [__m256d; WIDTH]) -> [Zmm; 4] {
        // SAFETY: the caller vouches for the machine.
        unsafe {
            let a = _mm512_insertf64x4::<1>(_mm512_castpd256_pd512(q[0]), q[4]);
            let b = _mm512_insertf64x4::<1>(_mm512_castpd256_pd512(q[1]), q[5]);
            let c = _mm512_insertf64x4::<1>(_mm512_castpd256_pd512(q[2]), q[6]);
            let d = _mm512_insertf64x4::<1>(_mm512_castpd256_pd512(q[3]), q[7]);
            // Pairs of lanes: x0 x1 z0 z1 x4 x5 z4 z5, and so on.
            let xz01 = _mm512_unpacklo_pd(a, b);
            let yw01 = _mm512_unpackhi_pd(a, b);
            let xz23 = _mm512_unpacklo_pd(c, d);
            let yw23 = _mm512_unpackhi_pd(c, d);
            let low = _mm512_setr_epi64(0, 1, 8, 9, 4, 5, 12, 13);
            let high = _mm512_setr_epi64(2, 3, 10, 11, 6, 7, 14, 15);
            [
                Zmm(_mm512_permutex2var_pd(xz01, low, xz23)),
                Zmm(_mm512_permutex2var_pd(yw01, low, yw23)),
                Zmm(_mm512_permutex2var_pd(xz01, high, xz23)),
                Zmm(_mm512_permutex2var_pd(yw01, high, yw23)),
            ]
        }
    }
}
