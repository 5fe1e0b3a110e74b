#include "exec/cuda/sort_pairs-inl.h"

namespace raysheaf {

void CudaDevice::sort_pairs(const char* stage, SortColumns<std::uint32_t>* columns, BitRange bits) {
  sort(stage, columns, bits);
}

}  // namespace raysheaf
