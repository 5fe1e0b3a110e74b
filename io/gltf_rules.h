// What a field of glTF must look like, as a table. A path's "[]" stands for each element of an
// array of objects.
#pragma once

#include <string>

#include "io/json_value.h"
#include "io/utf8.h"

namespace raysheaf::io {

enum class JsonKind {
  kArray,      ///< an array
  kObject,     ///< an object
  kString,     ///< a string
  kBool,       ///< true or false
  kNumber,     ///< a number within the range of float
  kPart,       ///< one from 0 to 1
  kAmount,     ///< one that is not negative
  kNumbers,    ///< an array of `count` numbers; of any length where `count` is 0
  kAmounts,    ///< the same of numbers that are not negative
  kSize,       ///< an integer from 0 to 2^53
  kPositive,   ///< an integer from 1 to 2^53
  kInt,        ///< an integer of 32 bits
  kIndex,      ///< an integer below the length of the root's array `target`
  kIndices,    ///< an array of such
  kIndexMap,   ///< an object whose members are such
  kIndexMaps,  ///< an array of such objects
  kStrings     ///< an array of strings
};

struct JsonRule {
  const char* path;
  JsonKind kind;
  bool required = false;
  int count = 0;
  const char* target = "";
};

/// Throws `Error` at the first field of `root` that breaks a rule.
void check_rules(const JsonValue& root);

/// The same of one of the root's animations, which `check_rules` leaves out. The error's place
/// begins at the animation.
void check_animation(const JsonValue& root, const JsonValue& animation);

}  // namespace raysheaf::io
