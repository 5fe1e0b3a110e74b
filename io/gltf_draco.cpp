#include "io/gltf_draco.h"

#include <limits>
#include <map>
#include <string_view>
#include <utility>

#include "io/gltf_json.h"
#include "io/gltf_rules.h"
#include "io/refuse.h"

#ifdef RAYSHEAF_HAS_DRACO
#include <draco/compression/entropy/symbol_decoding.h>
#include <draco/compression/mesh/mesh_edgebreaker_decoder.h>
#include <draco/compression/mesh/mesh_sequential_decoder.h>
#include <draco/core/varint_decoding.h>
#endif

namespace raysheaf::io {
namespace {

/// Draco's arithmetic coder compresses repetitions to almost nothing, so no file is too small for a
/// given count. These limits allow a plane of this many triangles in any file, and more in
/// proportion to the bytes.
constexpr std::size_t kMostTriangles = std::size_t{1} << 20, kMostOfAByte = 16;
constexpr int kTriangles = 4;

/// The view and attribute that fill an accessor; attribute -1 stands for the indices.
using Filling = std::pair<std::size_t, std::int64_t>;

class PackingChecker {
 public:
  explicit PackingChecker(const JsonValue& root)
      : root_(root), is_filled_(root.items("accessors").size(), false) {}

  void check(const JsonValue& primitive, const std::string& place) {
    const JsonValue* const packing = draco_packing(primitive);
    if (packing == nullptr) return;
    here_ = place + ".extensions." + kDraco;
    if (primitive.get("mode", kTriangles) != kTriangles)
      refuse("compressed strips, lines and points are not read", place + ".mode",
             ErrorCode::kUnsupported);
    if (!primitive.contains("indices")) refuse("is missing", place + ".indices");
    const auto view = packing->at("bufferView").get<std::size_t>();
    const auto bytes = root_.at("bufferViews").at(view).at("byteLength").get<std::size_t>();
    most_corners_ = 3 * (kMostTriangles + kMostOfAByte * bytes);
    fill(primitive.at("indices").get<std::size_t>(), {view, -1});
    const auto attributes = packing->at("attributes").members();
    if (attributes.empty()) refuse("is empty", here_ + ".attributes");
    for (const JsonMember& member : attributes) {
      const std::string field = here_ + ".attributes." + printable(std::string(member.name));
      if (!member.value.is_integer() || member.value.get<double>() < 0 ||
          member.value.get<double>() > std::numeric_limits<std::uint32_t>::max())
        refuse("is not an integer of 32 bits", field);
      const JsonValue* accessor = primitive.at("attributes").find(member.name);
      if (accessor == nullptr) refuse("is not an attribute of the primitive", field);
      fill(accessor->get<std::size_t>(), {view, member.value.get<std::int64_t>()});
    }
  }
  [[nodiscard]] std::vector<bool> take() { return std::move(is_filled_); }

 private:
  void fill(std::size_t accessor, const Filling& filling) {
    const std::string place = element("accessors", accessor);
    if (filling_.try_emplace(accessor, filling).first->second != filling)
      refuse("is of " + place + ", which another compressed primitive or attribute fills already",
             here_, ErrorCode::kUnsupported);
    const auto count = root_.at("accessors").at(accessor).at("count").get<std::size_t>();
    if (count > most_corners_)
      refuse("is " + std::to_string(count) + ", too many for the compressed bytes",
             place + ".count", ErrorCode::kOutOfMemory);
    is_filled_[accessor] = true;
  }

  const JsonValue& root_;
  std::vector<bool> is_filled_;
  std::map<std::size_t, Filling> filling_;
  std::string here_;
  std::size_t most_corners_ = 0;
};

}  // namespace

bool unpacks_draco() {
#ifdef RAYSHEAF_HAS_DRACO
  return true;
#else
  return false;
#endif
}

const JsonValue* draco_packing(const JsonValue& primitive) {
  return unpacks_draco() ? extension(primitive, kDraco) : nullptr;
}

std::vector<bool> check_draco(const JsonValue& root) {
  PackingChecker checker(root);
  const auto meshes = root.items("meshes");
  for (std::size_t m = 0; m < meshes.size(); ++m) {
    const auto primitives = meshes[m].items("primitives");
    for (std::size_t p = 0; p < primitives.size(); ++p)
      checker.check(primitives[p], element("meshes", m) + "." + element("primitives", p));
  }
  return checker.take();
}

#ifdef RAYSHEAF_HAS_DRACO
namespace {

/// The most bytes that a point may have in all attributes: sixteen VEC4 of floats.
constexpr std::size_t kMostOfAPoint = 256;

/// The counts that a primitive's accessors declare.
struct Counts {
  std::size_t triangles = 0, points = 0;
};

struct BadPrediction {};

/// Whether the number of texture coordinate orientations after the attribute's values at `at` does
/// not exceed the number of values. Draco would decode 2^31 of them, which takes seconds.
bool has_few_orientations(draco::DecoderBuffer at, std::uint32_t count, int components) {
  const std::uint32_t numbers = count * static_cast<std::uint32_t>(components);
  std::uint8_t is_coded = 0, width = 0;
  if (!at.Decode(&is_coded)) return false;
  if (is_coded != 0) {
    std::vector<std::uint32_t> symbols(numbers);
    if (!draco::DecodeSymbols(numbers, components, &at, symbols.data())) return false;
  } else if (!at.Decode(&width) || at.remaining_size() < std::int64_t{width} * numbers) {
    return false;
  } else {
    at.Advance(std::int64_t{width} * numbers);
  }
  std::uint32_t orientations = 0;
  return at.Decode(&orientations) && orientations <= count;
}

/// Draco's decoders allocate whatever a file claims. These subclasses compare the claims with the
/// accessors first and stop if they differ.
template <class Decoder>
class CheckedDecoder final : public Decoder {
 public:
  explicit CheckedDecoder(const Counts& counts) : counts_(counts) {}

  /// Draco calls this when it has read an attribute's prediction method, the byte before the last.
  const draco::MeshAttributeIndicesEncodingData* GetAttributeEncodingData(int id) const override {
    const draco::MeshAttributeIndicesEncodingData* data = Decoder::GetAttributeEncodingData(id);
    if (data == nullptr) return data;
    const draco::DecoderBuffer& at = *const_cast<CheckedDecoder*>(this)->buffer();
    const auto method = static_cast<draco::PredictionSchemeMethod>(at.data_head()[-2]);
    const auto count =
        static_cast<std::uint32_t>(data->encoded_attribute_value_index_to_corner_map.size());
    const bool fits =
        method == draco::MESH_PREDICTION_TEX_COORDS_PORTABLE
            ? has_few_orientations(at, count, this->point_cloud()->attribute(id)->num_components())
            : method != draco::MESH_PREDICTION_TEX_COORDS_DEPRECATED;
    if (!fits) throw BadPrediction();
    return data;
  }

 protected:
  bool DecodeConnectivity() override {
    draco::DecoderBuffer ahead = *this->buffer();
    std::uint32_t first = 0, second = 0;
    if (!draco::DecodeVarint(&first, &ahead) || !draco::DecodeVarint(&second, &ahead)) return false;
    // Edgebreaker stores the number of vertices first; each has at least one point.
    constexpr bool kSequential = std::is_same_v<Decoder, draco::MeshSequentialDecoder>;
    const std::uint32_t triangles = kSequential ? first : second;
    const std::uint32_t points = kSequential ? second : first;
    return triangles == counts_.triangles && points <= counts_.points &&
           Decoder::DecodeConnectivity() && this->point_cloud()->num_points() == counts_.points;
  }
  bool DecodeAllAttributes() override {
    std::size_t bytes = 0;
    for (int i = 0; i < this->point_cloud()->num_attributes(); ++i) {
      const draco::PointAttribute& attribute = *this->point_cloud()->attribute(i);
      // No accessor holds booleans, and Draco would read any byte as one.
      if (attribute.data_type() == draco::DT_BOOL) return false;
      bytes += static_cast<std::size_t>(attribute.num_components()) *
               static_cast<std::size_t>(draco::DataTypeLength(attribute.data_type()));
    }
    return bytes <= kMostOfAPoint && Decoder::DecodeAllAttributes();
  }

 private:
  Counts counts_;
};

template <class Decoder>
bool decode_by(const Counts& counts, draco::DecoderBuffer* buffer, draco::Mesh* mesh) {
  CheckedDecoder<Decoder> decoder(counts);
  try {
    return decoder.Decode(draco::DecoderOptions(), buffer, mesh).ok();
  } catch (const BadPrediction&) {
    return false;
  }
}

bool decode(std::span<const std::uint8_t> packed, const Counts& counts, draco::Mesh* mesh) {
  draco::DecoderBuffer buffer;
  buffer.Init(reinterpret_cast<const char*>(packed.data()), packed.size());
  draco::DecoderBuffer ahead = buffer;
  draco::DracoHeader header;
  if (!draco::PointCloudDecoder::DecodeHeader(&ahead, &header).ok() ||
      header.encoder_type != draco::TRIANGULAR_MESH || header.version_major != 2 ||
      header.version_minor != 2)  // the only version that the extension allows
    return false;
  if (header.encoder_method == draco::MESH_SEQUENTIAL_ENCODING)
    return decode_by<draco::MeshSequentialDecoder>(counts, &buffer, mesh);
  return decode_by<draco::MeshEdgebreakerDecoder>(counts, &buffer, mesh);
}

template <class T>
bool copy_indices(const draco::Mesh& mesh, T* to) {
  for (std::uint32_t i = 0; i < mesh.num_faces(); ++i) {
    for (const draco::PointIndex& point : mesh.face(draco::FaceIndex(i))) {
      *to = static_cast<T>(point.value());
      if (static_cast<std::uint32_t>(*to++) != point.value()) return false;
    }
  }
  return true;
}

template <class T>
bool copy_attribute(const draco::PointAttribute& from, std::uint32_t points, T* to) {
  const std::int8_t width = static_cast<std::int8_t>(from.num_components());
  for (std::uint32_t i = 0; i < points; ++i, to += width) {
    if (!from.ConvertValue<T>(from.mapped_index(draco::PointIndex(i)), width, to)) return false;
  }
  return true;
}

/// Calls `copy` with the bytes as values of the component type.
template <class Copy>
bool copy_as(int type, Bytes* bytes, const Copy& copy) {
  switch (type) {
    case kGltfByte:
      return copy(reinterpret_cast<std::int8_t*>(bytes->data()));
    case kGltfUnsignedByte:
      return copy(reinterpret_cast<std::uint8_t*>(bytes->data()));
    case kGltfShort:
      return copy(reinterpret_cast<std::int16_t*>(bytes->data()));
    case kGltfUnsignedShort:
      return copy(reinterpret_cast<std::uint16_t*>(bytes->data()));
    case kGltfUnsignedInt:
      return copy(reinterpret_cast<std::uint32_t*>(bytes->data()));
    default:
      return copy(reinterpret_cast<float*>(bytes->data()));
  }
}

class Unpacker {
 public:
  Unpacker(std::span<const GltfAccessor> accessors, const std::string& place)
      : accessors_(accessors), here_(place + ".extensions." + kDraco) {}

  std::vector<DracoValues> unpack(const JsonValue& primitive,
                                  std::span<const std::uint8_t> packed) {
    const auto indices = primitive.at("indices").get<std::size_t>();
    const auto attributes = draco_packing(primitive)->at("attributes").members();
    const JsonValue& named = primitive.at("attributes");
    const auto accessor_of = [&](const JsonMember& attribute) {
      return named.at(attribute.name).get<std::size_t>();
    };
    if (accessors_[indices].components != 1) refuse("must have scalar elements", place_of(indices));
    const Counts counts{accessors_[indices].count / 3,
                        accessors_[accessor_of(attributes[0])].count};
    if (!decode(packed, counts, &mesh_) || 3 * counts.triangles != accessors_[indices].count)
      refuse("the packed bytes are damaged, or not the " + std::to_string(counts.triangles) +
                 " triangles of " + std::to_string(counts.points) + " vertices that " +
                 place_of(indices) + " and " + place_of(accessor_of(attributes[0])) + " have",
             here_);
    add(indices, [&](auto* to) { return copy_indices(mesh_, to); });
    for (const JsonMember& attribute : attributes) add(attribute, accessor_of(attribute));
    return std::move(values_);
  }

 private:
  [[nodiscard]] static std::string place_of(std::size_t accessor) {
    return element("accessors", accessor);
  }
  void add(const JsonMember& attribute, std::size_t accessor) {
    const draco::PointAttribute* const from =
        mesh_.GetAttributeByUniqueId(attribute.value.get<std::uint32_t>());
    const std::string place = here_ + ".attributes." + printable(std::string(attribute.name));
    if (from == nullptr) refuse("is not among the compressed attributes", place);
    if (from->num_components() != accessors_[accessor].components ||
        mesh_.num_points() != accessors_[accessor].count)
      refuse("has " + std::to_string(mesh_.num_points()) + " elements of " +
                 std::to_string(from->num_components()) + " numbers, but " + place_of(accessor) +
                 " " + std::to_string(accessors_[accessor].count) + " of " +
                 std::to_string(accessors_[accessor].components),
             place);
    add(accessor, [&](auto* to) { return copy_attribute(*from, mesh_.num_points(), to); });
  }
  template <class Copy>
  void add(std::size_t number, const Copy& copy) {
    const GltfAccessor& accessor = accessors_[number];
    Bytes bytes(accessor.count * accessor.components * component_bytes(accessor.component_type));
    if (!copy_as(accessor.component_type, &bytes, copy))
      refuse("the packed numbers are not of its type", place_of(number) + ".componentType");
    values_.push_back({number, std::move(bytes)});
  }

  std::span<const GltfAccessor> accessors_;
  std::string here_;
  draco::Mesh mesh_;
  std::vector<DracoValues> values_;
};

}  // namespace

std::vector<DracoValues> unpack_draco(const JsonValue& primitive,
                                      std::span<const GltfAccessor> accessors,
                                      std::span<const std::uint8_t> packed,
                                      const std::string& place) {
  return Unpacker(accessors, place).unpack(primitive, packed);
}
#else
std::vector<DracoValues> unpack_draco(const JsonValue& /*primitive*/,
                                      std::span<const GltfAccessor> /*accessors*/,
                                      std::span<const std::uint8_t> /*packed*/,
                                      const std::string& place) {
  refuse("this build has no Draco", place, ErrorCode::kUnsupported);
}
#endif

}  // namespace raysheaf::io
