// Large memory that comes and goes with every picture, every batch.
#pragma once

namespace raysheaf {

/// While there is one, blocks of 64 KiB or more that are given back (raysheaf/large_vector.h)
/// stay to be taken again: fresh pages of a frame cost a seventh of it. What stays unused is never
/// more than what was in use at once; each one that goes gives all of it back.
class LargeMemoryKeeper {
 public:
  LargeMemoryKeeper();
  ~LargeMemoryKeeper();
  LargeMemoryKeeper(const LargeMemoryKeeper&) = delete;
  LargeMemoryKeeper& operator=(const LargeMemoryKeeper&) = delete;
};

}  // namespace raysheaf
