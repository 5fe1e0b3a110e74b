#include "raysheaf/method.h"

#include <string>

#include "raysheaf/error.h"

namespace raysheaf {
namespace {

template <class Value>
struct Named {
  Value value;
  const char* name;
};

constexpr Named<Method> kMethods[]{{Method::kBrute, "brute"},
                                   {Method::kRah, "rah"},
                                   {Method::kCrsh, "crsh"},
                                   {Method::kGl10, "gl10"},
                                   {Method::kDual, "dual"}};
constexpr Named<BundleBound> kBounds[]{{BundleBound::kSphereCone, "sphere-cone"},
                                       {BundleBound::kFiniteCone, "finite-cone"},
                                       {BundleBound::kShaft, "shaft"},
                                       {BundleBound::kFrustum, "frustum"},
                                       {BundleBound::kShaftAndCone, "shaft-cone"}};

template <class List, class Value>
const char* name_in(const List& list, Value value) {
  for (const auto& entry : list)
    if (entry.value == value) return entry.name;
  return "unknown";
}

template <class Value>
Value value_of(const Named<Value>& entry) {
  return entry.value;
}
RayKey value_of(const RayKeyEntry& entry) {
  return entry.key;
}

template <class List>
auto value_in(const List& list, const char* what, std::string_view name) {
  std::string names;
  for (const auto& entry : list) {
    if (name == entry.name) return value_of(entry);
    names += (names.empty() ? "" : ", ") + std::string(entry.name);
  }
  throw Error(
      ErrorCode::kInvalidArgument,
      "there is no " + std::string(what) + " \"" + std::string(name) + "\"; there are " + names,
      what);
}

}  // namespace

const char* to_string(Method method) {
  return name_in(kMethods, method);
}
const char* to_string(RayKey key) {
  return key < RayKey::kCount ? entry_of(key).name : "unknown";
}
const char* to_string(BundleBound bound) {
  return name_in(kBounds, bound);
}

Method method_from_string(std::string_view name) {
  return value_in(kMethods, "method", name);
}
RayKey key_from_string(std::string_view name) {
  return value_in(kRayKeys, "key", name);
}
BundleBound bound_from_string(std::string_view name) {
  return value_in(kBounds, "bound", name);
}

MethodSettings method_settings(const MethodChoice& choice) {
  const Method method = choice.method;
  const bool sorted = method == Method::kCrsh || method == Method::kGl10;
  MethodSettings settings;
  if (method == Method::kBrute) settings.traversal = Traversal::kBruteForce;
  if (method == Method::kGl10) settings.traversal = Traversal::kPackets;
  if (method == Method::kDual) settings.traversal = Traversal::kDual;
  settings.key = choice.key.value_or(sorted ? RayKey::kCrsh : RayKey::kRaster);
  settings.key_bits = choice.key_bits;
  settings.bound = choice.bound.value_or(settings.bound);
  settings.mesh_culling = choice.mesh_culling.value_or(method == Method::kCrsh);
  settings.levels = choice.levels;
  settings.branching = choice.branching;
  return settings;
}

MethodSettings method_settings(Method method) {
  return method_settings(MethodChoice{method});
}

}  // namespace raysheaf
