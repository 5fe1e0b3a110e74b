// JSON text into values; what is wrong with it in a sentence.
#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>

#include "raysheaf/types.h"

namespace raysheaf::io {

inline constexpr int kMaxJsonDepth = 64;

/// Throws `Error` (kInvalidData, place `JSON`) where it is not JSON, or nested too deep.
[[nodiscard]] nlohmann::json parse_json(std::span<const std::uint8_t> text);

// Of what is read by hand; each throws `Error` (kInvalidData) whose place is the field.
void require_object(const nlohmann::json& value, const std::string& place);
/// `place` is the object's; empty at the root.
[[nodiscard]] const nlohmann::json& member_of(const nlohmann::json& object, const char* name,
                                              const std::string& place);
/// Within the range of float.
[[nodiscard]] double number_of(const nlohmann::json& value, const std::string& place);
[[nodiscard]] Vec3 vector_of(const nlohmann::json& value, const std::string& place);

}  // namespace raysheaf::io
