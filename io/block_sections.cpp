// Blocks as bytes: a few counts, then one array after the other.
#include <algorithm>
#include <numeric>

#include "io/block_format.h"
#include "io/refuse.h"
#include "raysheaf/block_file.h"

namespace raysheaf::io {
namespace {

struct GeometryHead {
  std::uint32_t triangles, vertices, parts;
  std::uint32_t runs;   ///< number of runs of consecutive ids; 0: each id is stored
  std::uint32_t sides;  ///< 0, 1, or one per triangle
  std::uint32_t reserved;
};
struct IdRun {
  std::uint32_t first, count;
};
/// A flag in a part's byte says that it has second texture coordinates: these follow the parts, as
/// many as `uvs`. The colours come last and fill the rest of the section.
struct ShadingHead {
  std::uint32_t normals, uvs, materials, parts;
};
using Corners16 = std::array<std::uint16_t, 3>;
static_assert(sizeof(GeometryHead) == 24 && sizeof(ShadingHead) == 16 && sizeof(IdRun) == 8);
static_assert(sizeof(BlockPart) == 16 && sizeof(Corners16) == 6 && sizeof(Vec3) == 12);

class Writer {
 public:
  template <class T>
  void put(const T& value) {
    put(&value, 1);
  }
  template <class T>
  void put(const std::vector<T>& values) {
    put(values.data(), values.size());
  }
  [[nodiscard]] Bytes take() { return std::move(bytes_); }

 private:
  template <class T>
  void put(const T* values, std::size_t count) {
    const std::size_t at = bytes_.size();
    bytes_.resize(at + count * sizeof(T));
    if (count != 0) std::memcpy(bytes_.data() + at, values, count * sizeof(T));
  }
  Bytes bytes_;
};

/// Takes arrays from the front. The caller has checked that the section holds them.
class Reader {
 public:
  explicit Reader(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}
  template <class T>
  T take() {
    T value;
    std::memcpy(&value, next(sizeof(T)), sizeof(T));
    return value;
  }
  template <class T>
  void take(std::size_t count, std::vector<T>* out) {
    out->resize(count);
    if (count != 0) std::memcpy(out->data(), next(count * sizeof(T)), count * sizeof(T));
  }
  [[nodiscard]] std::size_t left() const { return bytes_.size(); }

 private:
  const std::uint8_t* next(std::size_t size) {
    if (size > bytes_.size()) refuse("its section ends too early");
    const std::uint8_t* at = bytes_.data();
    bytes_ = bytes_.subspan(size);
    return at;
  }
  std::span<const std::uint8_t> bytes_;
};

std::vector<IdRun> runs_of(const std::vector<std::uint32_t>& ids) {
  std::vector<IdRun> runs;
  for (const std::uint32_t id : ids) {
    if (runs.empty() || id != runs.back().first + runs.back().count)
      runs.push_back({id, 1});
    else
      ++runs.back().count;
  }
  return runs;
}

void expand(const std::vector<IdRun>& runs, std::size_t count, std::vector<std::uint32_t>* ids) {
  ids->clear();
  ids->reserve(count);
  for (const IdRun& run : runs) {
    if (run.count > count - ids->size()) refuse("its runs of ids are longer than its triangles");
    for (std::uint32_t i = 0; i < run.count; ++i) ids->push_back(run.first + i);
  }
  if (ids->size() != count) refuse("its runs of ids are shorter than its triangles");
}

void check_most(std::uint32_t count, std::uint32_t most, const char* what) {
  if (count > most)
    refuse("it says that it has " + std::to_string(count) + " " + what + ", more than " +
           std::to_string(most));
}

void check_size(std::uint64_t expected, std::size_t there) {
  if (expected != there)
    refuse("its counts need " + std::to_string(expected) + " bytes, but its section has " +
           std::to_string(there));
}

}  // namespace

Bytes encode_geometry(const TriangleBlock& block) {
  std::vector<IdRun> runs = runs_of(block.prim_ids);
  if (2 * runs.size() >= block.prim_ids.size()) runs.clear();
  const auto size = [](const auto& v) { return static_cast<std::uint32_t>(v.size()); };
  std::vector<Corners16> corners(block.triangles.size());
  for (std::size_t i = 0; i < corners.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k)
      corners[i][k] = static_cast<std::uint16_t>(block.triangles[i][k]);
  }
  Writer out;
  out.put(GeometryHead{size(block.triangles), size(block.positions), size(block.parts), size(runs),
                       size(block.sides), 0});
  out.put(block.parts);
  if (runs.empty())
    out.put(block.prim_ids);
  else
    out.put(runs);
  out.put(block.positions);
  out.put(corners);
  out.put(block.sides);
  return out.take();
}

void decode_geometry(std::span<const std::uint8_t> bytes, TriangleBlock* block) {
  Reader in(bytes);
  const auto head = in.take<GeometryHead>();
  check_most(head.triangles, kBlockTriangles, "triangles");
  check_most(head.vertices, kBlockVertices, "vertices");
  check_most(head.parts, head.triangles, "parts");
  check_most(head.runs, head.triangles, "runs of ids");
  check_most(head.sides, head.triangles, "sides");
  const std::uint64_t ids = head.runs == 0 ? 4ull * head.triangles : 8ull * head.runs;
  check_size(sizeof head + 16ull * head.parts + ids + 12ull * head.vertices +
                 6ull * head.triangles + head.sides,
             bytes.size());
  in.take(head.parts, &block->parts);
  if (head.runs == 0) {
    in.take(head.triangles, &block->prim_ids);
  } else {
    std::vector<IdRun> runs;
    in.take(head.runs, &runs);
    expand(runs, head.triangles, &block->prim_ids);
  }
  in.take(head.vertices, &block->positions);
  std::vector<Corners16> corners;
  in.take(head.triangles, &corners);
  block->triangles.resize(head.triangles);
  for (std::size_t i = 0; i < corners.size(); ++i)
    block->triangles[i] = {corners[i][0], corners[i][1], corners[i][2]};
  in.take(head.sides, &block->sides);
}

Bytes encode_shading(const BlockShading& shading) {
  const auto size = [](const auto& v) { return static_cast<std::uint32_t>(v.size()); };
  std::vector<std::uint8_t> has(shading.has_normals.size());
  for (std::size_t i = 0; i < has.size(); ++i)
    has[i] = static_cast<std::uint8_t>(
        shading.has_normals[i] | shading.has_uvs[i] << 1 |
        (shading.has_colors.empty() ? 0 : shading.has_colors[i] << 2) |
        (shading.has_second_uvs.empty() ? 0 : shading.has_second_uvs[i] << 3));
  Writer out;
  out.put(
      ShadingHead{size(shading.normals), size(shading.uvs), size(shading.materials), size(has)});
  out.put(shading.normals);
  out.put(shading.uvs);
  out.put(shading.materials);
  out.put(has);
  out.put(shading.second_uvs);
  out.put(shading.colors);
  return out.take();
}

void decode_shading(std::span<const std::uint8_t> bytes, BlockShading* shading) {
  Reader in(bytes);
  const auto head = in.take<ShadingHead>();
  check_most(head.normals, kBlockVertices, "normals");
  check_most(head.uvs, kBlockVertices, "texture coordinates");
  check_most(head.materials, kBlockTriangles, "materials");
  check_most(head.parts, kBlockTriangles, "parts");
  const std::uint64_t before_parts =
      sizeof head + 12ull * head.normals + 8ull * head.uvs + 4ull * head.materials;
  if (bytes.size() < before_parts + head.parts) check_size(before_parts + head.parts, bytes.size());
  const auto parts = bytes.subspan(before_parts, head.parts);
  const bool has_second_uvs =
      std::any_of(parts.begin(), parts.end(), [](std::uint8_t has) { return (has & 8) != 0; });
  const std::uint32_t second_uvs = has_second_uvs ? head.uvs : 0;
  const std::uint64_t known = before_parts + head.parts + 8ull * second_uvs;
  const std::uint64_t colors = bytes.size() > known ? (bytes.size() - known) / sizeof(Vec3) : 0;
  check_most(static_cast<std::uint32_t>(colors), kBlockVertices, "colours");
  check_size(known + sizeof(Vec3) * colors, bytes.size());
  in.take(head.normals, &shading->normals);
  in.take(head.uvs, &shading->uvs);
  in.take(head.materials, &shading->materials);
  in.take(head.parts, &shading->has_normals);
  in.take(second_uvs, &shading->second_uvs);
  in.take(colors, &shading->colors);
  shading->has_uvs.resize(head.parts);
  shading->has_colors.resize(colors != 0 ? head.parts : 0);
  shading->has_second_uvs.resize(has_second_uvs ? head.parts : 0);
  for (std::size_t i = 0; i < head.parts; ++i) {
    const std::uint8_t has = shading->has_normals[i];
    const bool second_alone = (has & 8) != 0 && (has & 2) == 0;
    if (has > 15 || (colors == 0 && (has & 4) != 0) || second_alone)
      refuse("a part's flags are invalid");
    shading->has_uvs[i] = has >> 1 & 1;
    if (colors != 0) shading->has_colors[i] = has >> 2 & 1;
    if (has_second_uvs) shading->has_second_uvs[i] = has >> 3;
    shading->has_normals[i] = has & 1;
  }
}

}  // namespace raysheaf::io
