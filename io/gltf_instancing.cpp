// Reads many instances of a node's mesh from EXT_mesh_gpu_instancing.
#include <string>
#include <vector>

#include "io/gltf.h"
#include "io/gltf_json.h"
#include "io/refuse.h"

namespace raysheaf::io {
namespace {

constexpr const char* kInstancing = "EXT_mesh_gpu_instancing";

}  // namespace

std::vector<RigNode> instances_of_node(const JsonValue& node, std::size_t index,
                                       AccessorReader& accessors) {
  const JsonValue* instancing = extension(node, kInstancing);
  if (instancing == nullptr) return {};
  const std::string place = element("nodes", index) + ".extensions." + kInstancing + ".attributes";
  const JsonValue& attributes = instancing->at("attributes");
  if (attributes.members().empty()) refuse("has no attribute", place);
  const std::size_t count = accessors.count(attributes.members()[0].value.get<int>());
  for (const JsonMember& attribute : attributes.members()) {
    const std::size_t other = accessors.count(attribute.value.get<int>());
    if (other != count)
      refuse("has " + std::to_string(other) + " elements, but " +
                 printable(std::string(attributes.members()[0].name)) + " has " +
                 std::to_string(count),
             place + "." + printable(std::string(attribute.name)));
  }
  accessors.charge(count, sizeof(RigNode), place);
  std::vector<RigNode> instances(count);
  // Calls `take(instance, numbers)` for each instance.
  const auto each = [&](const char* name, int components, const auto& take) {
    const JsonValue* accessor = attributes.find(name);
    if (accessor == nullptr) return;
    std::size_t i = 0;
    accessors.each_vertex(accessor->get<int>(), components, count, place + "." + name,
                          [&](const float* numbers) { take(instances[i++], numbers); });
  };
  each("TRANSLATION", 3, [](RigNode& to, const float* v) { to.translation = {v[0], v[1], v[2]}; });
  each("SCALE", 3, [](RigNode& to, const float* v) { to.scale = {v[0], v[1], v[2]}; });
  each("ROTATION", 4, [&](RigNode& to, const float* v) {
    to.rotation = {v[0], v[1], v[2], v[3]};
    if (v[0] == 0 && v[1] == 0 && v[2] == 0 && v[3] == 0)
      refuse("has no length",
             element(place + ".ROTATION", static_cast<std::size_t>(&to - instances.data())));
  });
  return instances;
}

}  // namespace raysheaf::io
