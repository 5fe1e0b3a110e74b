#include "io/json_text.h"

#include <cmath>
#include <limits>

#include "io/refuse.h"

namespace raysheaf::io {

void require_object(const JsonValue& value, const std::string& place) {
  if (!value.is_object()) refuse("is not an object", place);
}

const JsonValue& member_of(const JsonValue& object, const char* name, const std::string& place) {
  const JsonValue* member = object.find(name);
  if (member == nullptr) refuse("is missing", (place.empty() ? "" : place + ".") + name);
  return *member;
}

double number_of(const JsonValue& value, const std::string& place) {
  if (!value.is_number()) refuse("is not a number", place);
  const auto number = value.get<double>();
  if (!(std::fabs(number) <= double{std::numeric_limits<float>::max()}))
    refuse("is not a number that a float can hold", place);
  return number;
}

Vec3 vector_of(const JsonValue& value, const std::string& place) {
  const auto items = value.items();
  if (items.size() != 3) refuse("is not an array of three numbers", place);
  float numbers[3];
  for (std::size_t i = 0; i < 3; ++i)
    numbers[i] = static_cast<float>(number_of(items[i], element(place, i)));
  return {numbers[0], numbers[1], numbers[2]};
}

}  // namespace raysheaf::io
