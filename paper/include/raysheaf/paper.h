// The methods of the paper and those that it compares with: a library of its own, raysheaf::paper.
#pragma once

namespace raysheaf {

/// Gives the methods `kRah`, `kCrsh` and `kGl10` to this process's renderers, which refuse them
/// before. A program that renders by them links raysheaf::paper and calls this once. Thread-safe; a
/// second call changes nothing.
void use_paper_methods();

}  // namespace raysheaf
