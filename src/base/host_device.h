// Marks functions that run on the host and on the device. No other file reads __CUDACC__.
#pragma once

#ifdef __CUDACC__
#define RAYSHEAF_HD __host__ __device__
#else
#define RAYSHEAF_HD
#endif

// Marks the lambda that is the body of a device's loop (exec/device.h). RAYSHEAF_HD does not work
// here: nvcc copies a lambda for host and device through a pointer to a function that each source
// file defines for itself. The linker may keep the loop of another file, whose pointer is null.
#ifdef __CUDACC__
#define RAYSHEAF_DEVICE __device__
#else
#define RAYSHEAF_DEVICE
#endif

// Marks functions that only few items of a loop call. Kernels call them instead of inlining them,
// which saves registers and code.
#ifdef __CUDA_ARCH__
#define RAYSHEAF_HD_CALLED __host__ __device__ __noinline__
#define RAYSHEAF_ROLLED _Pragma("unroll 1")
#else
#define RAYSHEAF_HD_CALLED RAYSHEAF_HD
#define RAYSHEAF_ROLLED
#endif
