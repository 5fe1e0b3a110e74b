// The lesser and the greater of two numbers, each one instruction on a device; `min` and `max` of
// vectors (base/vec.h) take two. If the arguments are 0 and -0, or one of them is NaN, the result
// depends on the machine. Use them only for numbers that are compared, and for rays without NaN.
#pragma once

#include <cmath>

#include "base/host_device.h"

namespace raysheaf {

RAYSHEAF_HD inline float lesser(float a, float b) {
#ifdef __CUDA_ARCH__
  return fminf(a, b);
#else
  return a < b ? a : b;
#endif
}
RAYSHEAF_HD inline float greater(float a, float b) {
#ifdef __CUDA_ARCH__
  return fmaxf(a, b);
#else
  return a > b ? a : b;
#endif
}

}  // namespace raysheaf
