// Marks functions that run on the host and on the device. The one place that asks for __CUDACC__.
#pragma once

#ifdef __CUDACC__
#define RAYSHEAF_HD __host__ __device__
#else
#define RAYSHEAF_HD
#endif

// What few items of a loop come to: kernels call it, and the loops in it stay loops, so that it
// takes few registers and little code.
#ifdef __CUDA_ARCH__
#define RAYSHEAF_HD_CALLED __host__ __device__ __noinline__
#define RAYSHEAF_ROLLED _Pragma("unroll 1")
#else
#define RAYSHEAF_HD_CALLED RAYSHEAF_HD
#define RAYSHEAF_ROLLED
#endif
