// Reads the JSON that describes a sequence of files.
#pragma once

#include <string>

#include "io/file.h"
#include "raysheaf/animation.h"

namespace raysheaf::io {

/// docs/animation.md lists the fields. File names are relative to the JSON file, and must stay in
/// its folder unless external files are allowed. Throws `Error` whose place is the field.
[[nodiscard]] SequenceFiles read_sequence_json(const Bytes& file, const SceneFile& from);

}  // namespace raysheaf::io
