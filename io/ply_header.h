// The header of a PLY file: its elements and their properties.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace raysheaf::io {

enum class PlyFormat { kAscii, kLittleEndian, kBigEndian };
enum class PlyType { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat32, kFloat64 };

struct PlyProperty {
  std::string name;
  PlyType type = PlyType::kFloat32;
  bool is_list = false;
  PlyType count_type = PlyType::kUint8;
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;

  /// The index of the property, or -1.
  [[nodiscard]] int find(std::string_view property) const;
};

struct PlyHeader {
  PlyFormat format = PlyFormat::kAscii;
  std::vector<PlyElement> elements;
  std::vector<std::string> textures;  ///< the names on "comment TextureFile" lines
  std::size_t bytes = 0;              ///< where the body begins

  /// The first element of this name, or null.
  [[nodiscard]] const PlyElement* find(std::string_view element) const;
};

/// Throws `Error` for a file with points but no faces, before the points are read.
void check_faces(const PlyHeader& header);

[[nodiscard]] std::size_t size_of(PlyType type);

/// The largest size of a header.
inline constexpr std::size_t kMaxPlyHeaderBytes = std::size_t{1} << 20;

/// `file` holds the first bytes of a file of `file_bytes`: all of them, or at least
/// `kMaxPlyHeaderBytes` + 1. Throws `Error` that names the line. Refuses counts that the rest of
/// the file cannot hold, before anything is allocated for them.
[[nodiscard]] PlyHeader read_ply_header(std::span<const std::uint8_t> file,
                                        std::uint64_t file_bytes);

}  // namespace raysheaf::io
