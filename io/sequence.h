// Sequences of files: what the JSON that describes one says.
#pragma once

#include <string>

#include "io/file.h"
#include "raysheaf/animation.h"

namespace raysheaf::io {

/// docs/animation.md lists the fields. Names of files are relative to that of the JSON, and stay in
/// its folder unless external files are allowed. Throws `Error` whose place is the field.
[[nodiscard]] SequenceFiles read_sequence_json(const Bytes& file, const SceneFile& from);

}  // namespace raysheaf::io
