// Reads fields of JSON with error messages that name the field.
#pragma once

#include <string>

#include "io/json_value.h"
#include "raysheaf/types.h"

namespace raysheaf::io {

// Each of these throws `Error` (kInvalidData) whose place is the field.
void require_object(const JsonValue& value, const std::string& place);
/// `place` is that of the object; empty for the root.
[[nodiscard]] const JsonValue& member_of(const JsonValue& object, const char* name,
                                         const std::string& place);
/// A number within the range of float.
[[nodiscard]] double number_of(const JsonValue& value, const std::string& place);
[[nodiscard]] Vec3 vector_of(const JsonValue& value, const std::string& place);

}  // namespace raysheaf::io
