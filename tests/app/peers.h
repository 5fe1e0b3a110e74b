// Whether `bench compare` finds a peer on this machine.
#pragma once

#include "lab/commands/compare/embree_library.h"
#include "raysheaf/error.h"

namespace raysheaf::test {

inline bool has_peer() {
  try {
    return !app::find_embree().empty();
  } catch (const Error&) {
    return false;
  }
}

}  // namespace raysheaf::test
