// Finds Embree on the machine and loads it.
#pragma once

#include <string>
#include <vector>

#include "lab/commands/compare/embree_api.h"

namespace raysheaf::app {

/// A library that is loaded, and stays loaded until the process ends.
struct EmbreeLibrary {
  std::string file;
  embree::Api api;
};

/// The files that RAYSHEAF_EMBREE names, separated by colons. Without that variable, Embree 4 and
/// Embree 3 where each is found: as a library of the system, or, for Embree 4, in the Python wheel
/// `embreex` of the active virtual environment, of the user or of the system.
///
/// Throws `Error` (kIo) for a file of RAYSHEAF_EMBREE that is not Embree, and (kUnsupported) if
/// no Embree is found.
[[nodiscard]] std::vector<EmbreeLibrary> find_embree();

}  // namespace raysheaf::app
