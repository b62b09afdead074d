// One text for CUDA (NVRTC) and OpenCL C 1.2. Rules of the dialect:
// * C99 expressions and control flow; no templates, references or overloads of one's own, no 3-vectors in buffers;
// * only + - * / sqrt fabs on reals, never a built-in dot, cross, length or pow: each vendor rounds them differently;
// * LOCAL variables are declared at the top level of a kernel, and every work-item of a group reaches each BARRIER;
// * a pointer to local memory is IN_LOCAL, as LOCAL is for what is declared;
// * FOR_EACH holds the work of one item: `continue` ends it early, `return` does not; a BARRIER stands outside it;
// * structs passed by value hold reals first, then 32-bit numbers, so that both compilers lay them out alike.
#if defined(__CUDACC__) || defined(__CUDACC_RTC__)

#define KERNEL(threads, groups) extern "C" __global__ void __launch_bounds__(threads, groups)
#define DEVICE static __device__ __forceinline__
#define GLOBAL
#define LOCAL __shared__
#define IN_LOCAL
#define RESTRICT __restrict__

typedef double real;
typedef unsigned int u32;
typedef int i32;
typedef unsigned long long u64;
typedef long long i64;
struct alignas(32) Quad { real x, y, z, w; };

DEVICE Quad QUAD(real x, real y, real z, real w) {
    Quad q;
    q.x = x;
    q.y = y;
    q.z = z;
    q.w = w;
    return q;
}
// Two loads of 16 bytes through the read-only path: faster than the four loads a compiler makes of `p[i]`.
DEVICE Quad LOAD(const Quad *p, size_t i) {
    const double2 *halves = (const double2 *)(p + i);
    const double2 low = __ldg(halves), high = __ldg(halves + 1);
    return QUAD(low.x, low.y, high.x, high.y);
}
#define LOAD_REAL(p, i) __ldg((p) + (i))

// Asks for a word that will be read soon.
#define WILL_READ(p) asm volatile("prefetch.global.L2 [%0];" ::"l"(p))

#define GROUP_INDEX ((u32)blockIdx.x)
#define LOCAL_INDEX ((u32)threadIdx.x)
#define GROUP_COUNT ((u32)gridDim.x)
#define ITEM_INDEX (GROUP_INDEX * (u32)blockDim.x + LOCAL_INDEX)
#define BARRIER __syncthreads()
#define ATOMIC_ADD(p, v) atomicAdd((p), (u32)(v))
#define ATOMIC_OR(p, v) atomicOr((p), (u32)(v))
#define ATOMIC_MAX(p, v) atomicMax((p), (u32)(v))
#define BITS_OF(x) ((u64)__double_as_longlong(x))
#define REAL_OF(bits) __longlong_as_double((long long)(bits))
#define FLOAT_BITS(x) ((u32)__float_as_uint(x))
// Place of the lowest bit that is set, of 64.
#define LOWEST_BIT(x) ((u32)(__ffsll((long long)(x)) - 1))
#ifndef INFINITY
#define INFINITY __longlong_as_double(0x7ff0000000000000LL)
#endif
#ifndef NAN
#define NAN __longlong_as_double(0x7ff8000000000000LL)
#endif

#else

#pragma OPENCL EXTENSION cl_khr_fp64 : enable
#pragma OPENCL FP_CONTRACT OFF

#define KERNEL(threads, groups) __kernel __attribute__((reqd_work_group_size(threads, 1, 1))) void
#define DEVICE static inline
#define GLOBAL __global
#define LOCAL __local
#define IN_LOCAL __local
#define RESTRICT restrict

typedef double real;
typedef uint u32;
typedef int i32;
typedef ulong u64;
typedef long i64;
typedef double4 Quad;

#define QUAD(x, y, z, w) ((Quad)((x), (y), (z), (w)))
#define LOAD(p, i) ((p)[i])
#define LOAD_REAL(p, i) ((p)[i])
// NVIDIA's compiler drops the built-in.
#ifdef __NV_CL_C_VERSION
#define WILL_READ(p) asm volatile("prefetch.global.L2 [%0];" ::"l"(p))
#else
#define WILL_READ(p) prefetch((p), 1)
#endif

#define GROUP_INDEX ((u32)get_group_id(0))
#define LOCAL_INDEX ((u32)get_local_id(0))
#define GROUP_COUNT ((u32)get_num_groups(0))
#define ITEM_INDEX ((u32)get_global_id(0))
#define BARRIER barrier(CLK_LOCAL_MEM_FENCE)
#define ATOMIC_ADD(p, v) atomic_add((p), (u32)(v))
#define ATOMIC_OR(p, v) atomic_or((p), (u32)(v))
#define ATOMIC_MAX(p, v) atomic_max((p), (u32)(v))
#define BITS_OF(x) as_ulong((double)(x))
#define REAL_OF(bits) as_double((u64)(bits))
#define FLOAT_BITS(x) as_uint((float)(x))
#define LOWEST_BIT(x) ((u32)(63u - clz((u64)(x) & (~(u64)(x) + 1u))))

#endif

#define FOR_EACH(i, n) for (u32 i = ITEM_INDEX; i < (n); i = (n))
