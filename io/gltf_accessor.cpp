#include "io/gltf_accessor.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "raysheaf/error.h"

namespace raysheaf::io {
namespace {

template <class T>
T load(const unsigned char* bytes) {
  T value;
  std::memcpy(&value, bytes, sizeof value);
  return value;
}

/// One component; a normalised integer as glTF 2.0, section 3.6.2.2 has it.
float component(const unsigned char* p, int type, bool normalized) {
  switch (type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE: {
      const float x = load<std::int8_t>(p);
      return normalized ? std::max(x / 127.0f, -1.0f) : x;
    }
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE: {
      const float x = load<std::uint8_t>(p);
      return normalized ? x / 255.0f : x;
    }
    case TINYGLTF_COMPONENT_TYPE_SHORT: {
      const float x = load<std::int16_t>(p);
      return normalized ? std::max(x / 32767.0f, -1.0f) : x;
    }
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT: {
      const float x = load<std::uint16_t>(p);
      return normalized ? x / 65535.0f : x;
    }
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT: {
      const auto x = static_cast<double>(load<std::uint32_t>(p));
      return static_cast<float>(normalized ? x / 4294967295.0 : x);
    }
    default:
      return load<float>(p);
  }
}

std::uint32_t unsigned_component(const unsigned char* p, int type) {
  if (type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE) return *p;
  if (type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT) return load<std::uint16_t>(p);
  return load<std::uint32_t>(p);
}

std::size_t component_bytes(int type) {
  return static_cast<std::size_t>(
      tinygltf::GetComponentSizeInBytes(static_cast<std::uint32_t>(type)));
}

/// Where the bytes of a view begin, `offset` into it.
const unsigned char* bytes_of(const tinygltf::Model& model, int view, std::size_t offset) {
  const tinygltf::BufferView& v = model.bufferViews[static_cast<std::size_t>(view)];
  return model.buffers[static_cast<std::size_t>(v.buffer)].data.data() + v.byteOffset + offset;
}

}  // namespace

const tinygltf::Accessor& AccessorReader::charge(int index, const std::string& place) {
  const tinygltf::Accessor& accessor = model_.accessors[static_cast<std::size_t>(index)];
  if (accessor.count > budget_) {
    throw Error(ErrorCode::kOutOfMemory,
                "the meshes have far more elements than the file has bytes", place);
  }
  budget_ -= accessor.count;
  return accessor;
}

void AccessorReader::apply_sparse(const tinygltf::Accessor& accessor, std::size_t components,
                                  const std::string& place, std::vector<float>& values) const {
  const auto& sparse = accessor.sparse;
  const int index_type = sparse.indices.componentType;
  const std::size_t index_bytes = component_bytes(index_type);
  const std::size_t size = component_bytes(accessor.componentType);
  const unsigned char* index = bytes_of(model_, sparse.indices.bufferView,
                                        static_cast<std::size_t>(sparse.indices.byteOffset));
  const unsigned char* value = bytes_of(model_, sparse.values.bufferView,
                                        static_cast<std::size_t>(sparse.values.byteOffset));
  for (int i = 0; i < sparse.count; ++i, index += index_bytes) {
    const std::size_t target = unsigned_component(index, index_type);
    if (target >= accessor.count) {
      throw Error(ErrorCode::kInvalidData,
                  "sparse index " + std::to_string(i) + " is " + std::to_string(target) +
                      ", but the accessor has " + std::to_string(accessor.count) + " elements",
                  place);
    }
    for (std::size_t c = 0; c < components; ++c, value += size) {
      values[target * components + c] =
          component(value, accessor.componentType, accessor.normalized);
    }
  }
}

std::vector<float> AccessorReader::floats(int index, int components, const std::string& place) {
  const tinygltf::Accessor& accessor = charge(index, place);
  const int there = tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(accessor.type));
  if (there != components || accessor.type == TINYGLTF_TYPE_MAT2) {
    throw Error(ErrorCode::kInvalidData,
                "must have " + std::to_string(components) + " numbers an element, not " +
                    std::to_string(there),
                place);
  }
  const auto width = static_cast<std::size_t>(components);
  std::vector<float> values(accessor.count * width, 0.0f);
  const std::size_t size = component_bytes(accessor.componentType);
  if (accessor.bufferView >= 0) {
    const auto& view = model_.bufferViews[static_cast<std::size_t>(accessor.bufferView)];
    const std::size_t stride = view.byteStride == 0 ? size * width : view.byteStride;
    const unsigned char* element = bytes_of(model_, accessor.bufferView, accessor.byteOffset);
    for (std::size_t i = 0; i < accessor.count; ++i, element += stride) {
      for (std::size_t c = 0; c < width; ++c) {
        values[i * width + c] =
            component(element + c * size, accessor.componentType, accessor.normalized);
      }
    }
  }
  if (accessor.sparse.isSparse) apply_sparse(accessor, width, place, values);
  return values;
}

std::vector<float> AccessorReader::attribute(int index, int components, std::size_t vertex_count,
                                             const std::string& place) {
  if (count(index) != vertex_count) {
    throw Error(ErrorCode::kInvalidData,
                "has " + std::to_string(count(index)) + " elements, but POSITION " +
                    std::to_string(vertex_count),
                place);
  }
  std::vector<float> values = floats(index, components, place);
  check_finite(values, static_cast<std::size_t>(components), place);
  return values;
}

std::vector<std::uint32_t> AccessorReader::indices(int index, const std::string& place) {
  const tinygltf::Accessor& accessor = charge(index, place);
  const int type = accessor.componentType;
  const bool is_unsigned = type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE ||
                           type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT ||
                           type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
  if (!is_unsigned || accessor.type != TINYGLTF_TYPE_SCALAR || accessor.normalized) {
    throw Error(ErrorCode::kInvalidData, "indices must be plain unsigned integers", place);
  }
  if (accessor.sparse.isSparse) {
    throw Error(ErrorCode::kUnsupported, "sparse indices are not read", place);
  }
  const auto& view = model_.bufferViews[static_cast<std::size_t>(accessor.bufferView)];
  const std::size_t stride = view.byteStride == 0 ? component_bytes(type) : view.byteStride;
  const unsigned char* element = bytes_of(model_, accessor.bufferView, accessor.byteOffset);
  std::vector<std::uint32_t> values(accessor.count);
  for (std::uint32_t& value : values) {
    value = unsigned_component(element, type);
    element += stride;
  }
  return values;
}

void check_finite(const std::vector<float>& values, std::size_t width, const std::string& place) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (std::isfinite(values[i])) continue;
    throw Error(ErrorCode::kInvalidData, "is not finite",
                place + "[" + std::to_string(i / width) + "]");
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
