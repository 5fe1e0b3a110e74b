// Large memory that is allocated and freed for every image or batch.
#pragma once

namespace raysheaf {

/// While a keeper exists, freed blocks of 64 KiB or more (raysheaf/large_vector.h) are kept for
/// reuse: touching fresh pages takes a seventh of a frame's time. The unused blocks never exceed
/// the memory that was in use at one time. Destroying any keeper frees all unused blocks.
class LargeMemoryKeeper {
 public:
  LargeMemoryKeeper();
  ~LargeMemoryKeeper();
  LargeMemoryKeeper(const LargeMemoryKeeper&) = delete;
  LargeMemoryKeeper& operator=(const LargeMemoryKeeper&) = delete;
};

}  // namespace raysheaf
