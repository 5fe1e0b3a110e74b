#include "io/gltf_meshopt.h"

#include <string_view>

#include "io/gltf_rules.h"
#include "io/refuse.h"

#ifdef RAYSHEAF_HAS_MESHOPT
#include <meshoptimizer.h>
#endif

namespace raysheaf::io {
namespace {

/// The most that a byte unpacks to: sixteen zeros take two bits.
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
  if (p.filter == "OCTAHEDRAL") return p.stride == 4 || p.stride == 8;
  if (p.filter == "QUATERNION") return p.stride == 8;
  return p.stride % 4 == 0 && p.stride <= 256;
}

void check_kinds(const Packing& p, const std::string& place) {
  const auto none = [&](std::string_view what, const char* field) {
    refuse("is \"" + printable(std::string(what)) + "\", which there is not here", place + field);
  };
  const bool attributes = p.mode == "ATTRIBUTES";
  if (!attributes && p.mode != "TRIANGLES" && p.mode != "INDICES") none(p.mode, ".mode");
  const bool filters =
      p.filter == "OCTAHEDRAL" || p.filter == "QUATERNION" || p.filter == "EXPONENTIAL";
  if (p.filter != "NONE" && !(attributes && filters)) none(p.filter, ".filter");
  if (!is_stride_of(p))
    refuse("is " + std::to_string(p.stride) + ", which no element of this mode and filter has",
           place + ".byteStride");
  if (p.mode == "TRIANGLES" && p.count % 3 != 0)
    refuse("is " + std::to_string(p.count) + ", which are no triangles", place + ".count");
}

}  // namespace

bool unpacks_meshopt() {
#ifdef RAYSHEAF_HAS_MESHOPT
  return true;
#else
  return false;
#endif
}

const JsonValue* meshopt_packing(const JsonValue& view) {
  const JsonValue* extensions = view.find("extensions");
  return extensions == nullptr || !unpacks_meshopt() ? nullptr : extensions->find(kMeshopt);
}

void check_meshopt(const JsonValue& root, const JsonValue& view, const std::string& place) {
  const JsonValue& json = *meshopt_packing(view);
  const std::string here = place + ".extensions." + kMeshopt;
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
  check_kinds(p, here);
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
Bytes unpack_meshopt(const JsonValue& packing, std::span<const std::uint8_t> packed,
                     const std::string& place) {
  const Packing p = packing_of(packing);
  Bytes bytes(p.count * p.stride);
  using Decode = int (*)(void*, std::size_t, std::size_t, const unsigned char*, std::size_t);
  const Decode vertices = meshopt_decodeVertexBuffer, triangles = meshopt_decodeIndexBuffer,
               indices = meshopt_decodeIndexSequence;
  const Decode decode = p.mode == "ATTRIBUTES"  ? vertices
                        : p.mode == "TRIANGLES" ? triangles
                                                : indices;
  if (decode(bytes.data(), p.count, p.stride, packed.data(), packed.size()) != 0)
    refuse("the packed bytes are damaged", place + ".extensions." + kMeshopt);
  if (p.filter == "OCTAHEDRAL") meshopt_decodeFilterOct(bytes.data(), p.count, p.stride);
  if (p.filter == "QUATERNION") meshopt_decodeFilterQuat(bytes.data(), p.count, p.stride);
  if (p.filter == "EXPONENTIAL") meshopt_decodeFilterExp(bytes.data(), p.count, p.stride);
  return bytes;
}
#else
Bytes unpack_meshopt(const JsonValue& /*packing*/, std::span<const std::uint8_t> /*packed*/,
                     const std::string& place) {
  refuse("this build has no meshoptimizer", place, ErrorCode::kUnsupported);
}
#endif

}  // namespace raysheaf::io
