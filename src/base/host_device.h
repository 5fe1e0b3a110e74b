// Marks functions that run on the host and on the device. The one place that asks for __CUDACC__.
#pragma once

#ifdef __CUDACC__
#define RAYSHEAF_HD __host__ __device__
#else
#define RAYSHEAF_HD
#endif
