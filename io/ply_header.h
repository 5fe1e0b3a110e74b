// The head of a PLY file: what elements there are and what each is made of.
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

  /// Position among the properties, or -1.
  [[nodiscard]] int find(std::string_view property) const;
};

struct PlyHeader {
  PlyFormat format = PlyFormat::kAscii;
  std::vector<PlyElement> elements;
  std::vector<std::string> textures;  ///< what "comment TextureFile" lines name
  std::size_t bytes = 0;              ///< where the body begins

  /// The first element of this name, or null.
  [[nodiscard]] const PlyElement* find(std::string_view element) const;
};

/// Refuses files that hold points and no faces, before these are read. Throws `Error`.
void check_faces(const PlyHeader& header);

[[nodiscard]] std::size_t size_of(PlyType type);

/// A header has no more bytes.
inline constexpr std::size_t kMaxPlyHeaderBytes = std::size_t{1} << 20;

/// `file`: the first bytes of one that has `file_bytes`, at least `kMaxPlyHeaderBytes` and one
/// where there are so many. Throws `Error` that names the line. A count that the rest of the file
/// cannot hold is refused here, before anything is made from it.
[[nodiscard]] PlyHeader read_ply_header(std::span<const std::uint8_t> file,
                                        std::uint64_t file_bytes);

}  // namespace raysheaf::io
