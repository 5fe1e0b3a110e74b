// Fields of JSON that is read by hand; what is wrong with one in a sentence.
#pragma once

#include <string>

#include "io/json_value.h"
#include "raysheaf/types.h"

namespace raysheaf::io {

// Each throws `Error` (kInvalidData) whose place is the field.
void require_object(const JsonValue& value, const std::string& place);
/// `place` is the object's; empty at the root.
[[nodiscard]] const JsonValue& member_of(const JsonValue& object, const char* name,
                                         const std::string& place);
/// Within the range of float.
[[nodiscard]] double number_of(const JsonValue& value, const std::string& place);
[[nodiscard]] Vec3 vector_of(const JsonValue& value, const std::string& place);

}  // namespace raysheaf::io
