// Marks functions that run on the host and on the device. The one place that asks for __CUDACC__.
#pragma once

#ifdef __CUDACC__
#define RAYSHEAF_HD __host__ __device__
#else
#define RAYSHEAF_HD
#endif

// Marks the lambda that is the body of a device's loop (exec/device.h). Not RAYSHEAF_HD: nvcc
// copies a lambda of the host and the device by a pointer to a function that each source file has
// of its own. The loop that the linker keeps may be another file's, whose pointer is null.
#ifdef __CUDACC__
#define RAYSHEAF_DEVICE __device__
#else
#define RAYSHEAF_DEVICE
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
