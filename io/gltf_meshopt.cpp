#include "io/gltf_meshopt.h"

#include <string_view>

#include "io/gltf_rules.h"
#include "io/refuse.h"

#ifdef RAYSHEAF_HAS_MESHOPT
#include <meshoptimizer.h>
#endif

namespace raysheaf::io {
namespace {

/// The largest compression ratio: sixteen zeros take two bits.
constexpr std::size_t kMostOfAByte = 64;

struct Packing {
  std::string_view mode, filter;
  std::size_t count = 0, stride = 0;
};

Packing packing_of(const JsonValue& json) {
  return {json.at("mode").get<std::string_view>(), json.get("filter", std::string_view("NONE")),
          json.at("count").get<std::size_t>(), json.at("byteStride").get<std::size_t>()};
}

bool is_stride_of(const Packing& p) {
  if (p.mode != "ATTRIBUTES") return p.stride == 2 || p.stride == 4;
  if (p.filter == "OCTAHEDRAL" || p.filter == "COLOR") return p.stride == 4 || p.stride == 8;
  if (p.filter == "QUATERNION") return p.stride == 8;
  return p.stride % 4 == 0 && p.stride <= 256;
}

void check_kinds(const Packing& p, bool is_khr, const std::string& place) {
  const bool is_color = is_khr && p.filter == "COLOR";
  const auto none = [&](std::string_view what, const char* field) {
    refuse("is \"" + printable(std::string(what)) + "\", which is not defined", place + field);
  };
  const bool attributes = p.mode == "ATTRIBUTES";
  if (!attributes && p.mode != "TRIANGLES" && p.mode != "INDICES") none(p.mode, ".mode");
  const bool filters =
      p.filter == "OCTAHEDRAL" || p.filter == "QUATERNION" || p.filter == "EXPONENTIAL" || is_color;
  if (p.filter != "NONE" && !(attributes && filters)) none(p.filter, ".filter");
  if (!is_stride_of(p))
    refuse("is " + std::to_string(p.stride) + ", which this mode and filter do not allow",
           place + ".byteStride");
  if (p.mode == "TRIANGLES" && p.count % 3 != 0)
    refuse("is " + std::to_string(p.count) + ", which is not a number of triangle corners",
           place + ".count");
}

}  // namespace

bool unpacks_meshopt() {
#ifdef RAYSHEAF_HAS_MESHOPT
  return true;
#else
  return false;
#endif
}

MeshoptPacking meshopt_packing(const JsonValue& view) {
  const JsonValue* extensions = view.find("extensions");
  if (extensions == nullptr || !unpacks_meshopt()) return {};
  for (const char* name : {kKhrMeshopt, kMeshopt}) {
    if (const JsonValue* json = extensions->find(name)) return {json, name};
  }
  return {};
}

void check_meshopt(const JsonValue& root, const JsonValue& view, const std::string& place) {
  const MeshoptPacking packing = meshopt_packing(view);
  const JsonValue& json = *packing.json;
  const std::string here = place + ".extensions." + packing.name;
  const auto number = json.at("buffer").get<std::size_t>();
  const JsonValue& buffer = root.at("buffers").at(number);
  const auto there = buffer.at("byteLength").get<std::size_t>();
  const auto offset = json.get("byteOffset", std::size_t{0});
  const auto packed = json.at("byteLength").get<std::size_t>();
  if (offset + packed > there)
    refuse("byteOffset + byteLength is " + std::to_string(offset + packed) + ", but " +
               element("buffers", number) + " has " + std::to_string(there) + " bytes",
           here);
  const Packing p = packing_of(json);
  check_kinds(p, packing.name == kKhrMeshopt, here);
  const auto length = view.at("byteLength").get<std::size_t>();
  if (length / p.stride != p.count || length % p.stride != 0)
    refuse(std::to_string(p.count) + " elements of " + std::to_string(p.stride) +
               " bytes are not the " + std::to_string(length) + " bytes of the view",
           here);
  if (length / kMostOfAByte > packed)
    refuse("is " + std::to_string(packed) + ", too few to hold the " + std::to_string(length) +
               " bytes of the view",
           here + ".byteLength");
}

#ifdef RAYSHEAF_HAS_MESHOPT
namespace {

/// Throws if this build's meshoptimizer is too old for the codec's version.
void check_versions(const Packing& p, std::span<const std::uint8_t> packed,
                    const std::string& place) {
  const auto needs = [&](const char* what, const char* version) {
    refuse(std::string(what) + " needs meshoptimizer " + version + " or newer; this build has " +
               std::to_string(MESHOPTIMIZER_VERSION / 1000) + "." +
               std::to_string(MESHOPTIMIZER_VERSION / 10 % 100),
           place, ErrorCode::kUnsupported);
  };
  constexpr std::uint8_t kVertexFormat1 = 0xa1;
  const bool is_new = p.mode == "ATTRIBUTES" && !packed.empty() && packed[0] == kVertexFormat1;
  if (is_new && MESHOPTIMIZER_VERSION < 230) needs("version 1 of packed attributes", "0.23");
  if (p.filter == "COLOR" && MESHOPTIMIZER_VERSION < 250) needs("the filter COLOR", "0.25");
}

}  // namespace

Bytes unpack_meshopt(const MeshoptPacking& packing, std::span<const std::uint8_t> packed,
                     const std::string& place) {
  const Packing p = packing_of(*packing.json);
  const std::string here = place + ".extensions." + packing.name;
  check_versions(p, packed, here);
  Bytes bytes(p.count * p.stride);
  using Decode = int (*)(void*, std::size_t, std::size_t, const unsigned char*, std::size_t);
  const Decode vertices = meshopt_decodeVertexBuffer, triangles = meshopt_decodeIndexBuffer,
               indices = meshopt_decodeIndexSequence;
  const Decode decode = p.mode == "ATTRIBUTES"  ? vertices
                        : p.mode == "TRIANGLES" ? triangles
                                                : indices;
  if (decode(bytes.data(), p.count, p.stride, packed.data(), packed.size()) != 0)
    refuse("the compressed bytes are damaged", here);
  if (p.filter == "OCTAHEDRAL") meshopt_decodeFilterOct(bytes.data(), p.count, p.stride);
  if (p.filter == "QUATERNION") meshopt_decodeFilterQuat(bytes.data(), p.count, p.stride);
  if (p.filter == "EXPONENTIAL") meshopt_decodeFilterExp(bytes.data(), p.count, p.stride);
#if MESHOPTIMIZER_VERSION >= 250
  if (p.filter == "COLOR") meshopt_decodeFilterColor(bytes.data(), p.count, p.stride);
#endif
  return bytes;
}
#else
Bytes unpack_meshopt(const MeshoptPacking& /*packing*/, std::span<const std::uint8_t> /*packed*/,
                     const std::string& place) {
  refuse("this build has no meshoptimizer", place, ErrorCode::kUnsupported);
}
#endif

}  // namespace raysheaf::io
