#include "io/gltf_accessor.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "io/gltf_json.h"
#include "io/outer_mesh.h"
#include "raysheaf/error.h"

namespace raysheaf::io {
namespace {

template <class T>
T load(const std::uint8_t* bytes) {
  T value;
  std::memcpy(&value, bytes, sizeof value);
  return value;
}

/// One component as a float. Normalised integers follow glTF 2.0, section 3.6.2.2.
float component(const std::uint8_t* p, int type, bool normalized) {
  switch (type) {
    case kGltfByte: {
      const float x = load<std::int8_t>(p);
      return normalized ? std::max(x / 127.0f, -1.0f) : x;
    }
    case kGltfUnsignedByte: {
      const float x = load<std::uint8_t>(p);
      return normalized ? x / 255.0f : x;
    }
    case kGltfShort: {
      const float x = load<std::int16_t>(p);
      return normalized ? std::max(x / 32767.0f, -1.0f) : x;
    }
    case kGltfUnsignedShort: {
      const float x = load<std::uint16_t>(p);
      return normalized ? x / 65535.0f : x;
    }
    case kGltfUnsignedInt: {
      const auto x = static_cast<double>(load<std::uint32_t>(p));
      return static_cast<float>(normalized ? x / 4294967295.0 : x);
    }
    default:
      return load<float>(p);
  }
}

std::uint32_t unsigned_component(const std::uint8_t* p, int type) {
  if (type == kGltfUnsignedByte) return *p;
  if (type == kGltfUnsignedShort) return load<std::uint16_t>(p);
  return load<std::uint32_t>(p);
}

}  // namespace

void AccessorReader::charge(std::size_t count, std::size_t bytes_each, const std::string& place) {
  if (bytes_each > 0 && count > budget_ / bytes_each) {
    throw Error(ErrorCode::kOutOfMemory,
                "the meshes would take far more memory than the file has bytes", place);
  }
  budget_ -= count * bytes_each;
}

/// Charges the size of the floats or indices that the accessor's values become.
const GltfAccessor& AccessorReader::charged(int index, const std::string& place) {
  const GltfAccessor& accessor = model_.accessors[static_cast<std::size_t>(index)];
  charge(accessor.count, accessor.components * sizeof(float), place);
  return accessor;
}

void AccessorReader::apply_sparse(const GltfAccessor& accessor, const std::string& place,
                                  std::vector<float>& values) const {
  const GltfSparse& sparse = *accessor.sparse;
  const std::size_t index_bytes = component_bytes(sparse.index_type);
  const std::size_t size = component_bytes(accessor.component_type);
  const std::size_t components = accessor.components;
  Bytes index_scratch, value_scratch;
  const std::uint8_t* index =
      sparse.indices.read(0, sparse.count * index_bytes, index_scratch).data();
  const std::uint8_t* value =
      sparse.values.read(0, sparse.count * components * size, value_scratch).data();
  for (std::size_t i = 0; i < sparse.count; ++i, index += index_bytes) {
    const std::size_t target = unsigned_component(index, sparse.index_type);
    if (target >= accessor.count) {
      throw Error(ErrorCode::kInvalidData,
                  "sparse index " + std::to_string(i) + " is " + std::to_string(target) +
                      ", but the accessor has " + std::to_string(accessor.count) + " elements",
                  place);
    }
    for (std::size_t c = 0; c < components; ++c, value += size) {
      values[target * components + c] =
          component(value, accessor.component_type, accessor.normalized);
    }
  }
}

std::vector<float> AccessorReader::window(const GltfAccessor& accessor, std::size_t first,
                                          std::size_t count, const std::string& place) const {
  const std::size_t width = accessor.components, size = component_bytes(accessor.component_type);
  std::vector<float> values(count * width, 0.0f);
  if (accessor.view >= 0 && count > 0) {
    const GltfView& view = model_.views[static_cast<std::size_t>(accessor.view)];
    const std::size_t stride = view.stride == 0 ? size * width : view.stride;
    Bytes scratch;
    const std::uint8_t* element =
        view.bytes
            .read(accessor.offset + first * stride, (count - 1) * stride + size * width, scratch)
            .data();
    for (std::size_t i = 0; i < count; ++i, element += stride) {
      for (std::size_t c = 0; c < width; ++c) {
        values[i * width + c] =
            component(element + c * size, accessor.component_type, accessor.normalized);
      }
    }
  }
  if (accessor.sparse) apply_sparse(accessor, place, values);
  return values;
}

std::vector<float> AccessorReader::finite_window(const GltfAccessor& accessor, std::size_t first,
                                                 std::size_t count,
                                                 const std::string& place) const {
  std::vector<float> values = window(accessor, first, count, place);
  check_finite(values, accessor.components, place, first);
  return values;
}

const GltfAccessor& AccessorReader::floats_of(int index, int components, const std::string& place) {
  const GltfAccessor& accessor = charged(index, place);
  const auto width = static_cast<std::size_t>(components);
  // Columns of smaller matrices are padded.
  if (accessor.components != width || (accessor.is_matrix && width < 16)) {
    throw Error(ErrorCode::kInvalidData,
                "must have " + std::to_string(components) + " numbers an element, not " +
                    std::to_string(accessor.components),
                place);
  }
  return accessor;
}

std::vector<float> AccessorReader::floats(int index, int components, const std::string& place) {
  const GltfAccessor& accessor = floats_of(index, components, place);
  return window(accessor, 0, accessor.count, place);
}

const GltfAccessor& AccessorReader::attribute_of(int index, int components,
                                                 std::size_t vertex_count,
                                                 const std::string& place) {
  if (count(index) != vertex_count) {
    throw Error(ErrorCode::kInvalidData,
                "has " + std::to_string(count(index)) + " elements, but POSITION " +
                    std::to_string(vertex_count),
                place);
  }
  const GltfAccessor& accessor = floats_of(index, components, place);
  if (accessor.sparse && !accessor.sparse->values.is_held()) throw NeedsWholeFile{};
  return accessor;
}

std::vector<float> AccessorReader::attribute(int index, int components, std::size_t vertex_count,
                                             const std::string& place) {
  return finite_window(attribute_of(index, components, vertex_count, place), 0, vertex_count,
                       place);
}

const GltfAccessor& AccessorReader::indices(int index, const std::string& place) {
  const GltfAccessor& accessor = charged(index, place);
  const int type = accessor.component_type;
  const bool is_unsigned =
      type == kGltfUnsignedByte || type == kGltfUnsignedShort || type == kGltfUnsignedInt;
  if (!is_unsigned || accessor.components != 1 || accessor.normalized) {
    throw Error(ErrorCode::kInvalidData, "indices must be plain unsigned integers", place);
  }
  if (accessor.sparse) {
    throw Error(ErrorCode::kUnsupported, "sparse indices are not read", place);
  }
  return accessor;
}

std::vector<std::uint32_t> AccessorReader::index_window(const GltfAccessor& accessor,
                                                        std::size_t first,
                                                        std::size_t count) const {
  const GltfView& view = model_.views[static_cast<std::size_t>(accessor.view)];
  const std::size_t size = component_bytes(accessor.component_type);
  const std::size_t stride = view.stride == 0 ? size : view.stride;
  Bytes scratch;
  const std::uint8_t* element =
      view.bytes.read(accessor.offset + first * stride, (count - 1) * stride + size, scratch)
          .data();
  std::vector<std::uint32_t> values(count);
  for (std::uint32_t& value : values) {
    value = unsigned_component(element, accessor.component_type);
    element += stride;
  }
  return values;
}

void check_finite(const std::vector<float>& values, std::size_t width, const std::string& place,
                  std::size_t first) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (std::isfinite(values[i])) continue;
    throw Error(ErrorCode::kInvalidData, "is not finite",
                place + "[" + std::to_string(first + i / width) + "]");
  }
}

std::vector<Vec3> as_vec3(const std::vector<float>& values) {
  std::vector<Vec3> result(values.size() / 3);
  for (std::size_t i = 0; i < result.size(); ++i) {
    result[i] = {values[3 * i], values[3 * i + 1], values[3 * i + 2]};
  }
  return result;
}

}  // namespace raysheaf::io
