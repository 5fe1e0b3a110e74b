// The types and ranges of glTF fields, as a table. In a path, "[]" stands for each element of an
// array of objects.
#pragma once

#include <string>

#include "io/json_value.h"
#include "io/utf8.h"

namespace raysheaf::io {

enum class JsonKind {
  kArray,
  kObject,
  kString,
  kBool,
  kNumber,     ///< a number within the range of float
  kPart,       ///< a number from 0 to 1
  kAmount,     ///< a non-negative number
  kNumbers,    ///< an array of `count` numbers; of any length if `count` is 0
  kAmounts,    ///< an array of `count` non-negative numbers
  kSize,       ///< an integer from 0 to 2^53
  kPositive,   ///< an integer from 1 to 2^53
  kInt,        ///< an integer of 32 bits
  kIndex,      ///< an integer below the length of the root's array `target`
  kIndices,    ///< an array of `kIndex`
  kIndexMap,   ///< an object whose members are `kIndex`
  kIndexMaps,  ///< an array of `kIndexMap`
  kStrings
};

struct JsonRule {
  const char* path;
  JsonKind kind;
  bool required = false;
  int count = 0;
  const char* target = "";
};

/// Throws `Error` at the first field of `root` that violates a rule.
void check_rules(const JsonValue& root);

/// Checks one of the root's animations, which `check_rules` does not. The error's place is relative
/// to the animation.
void check_animation(const JsonValue& root, const JsonValue& animation);

}  // namespace raysheaf::io
