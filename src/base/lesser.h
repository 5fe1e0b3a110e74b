// The less and the greater of two numbers: one instruction of a device each, where `min` and `max`
// of vectors (base/vec.h) are two. Which of 0 and -0, or of a number and NaN, is returned
// depends on the machine: for numbers that are only compared, and for rays that NaN does not reach.
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
