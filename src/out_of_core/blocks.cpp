// Validation of blocks of any source.
#include <algorithm>
#include <string>

#include "base/vec.h"
#include "out_of_core/block_body.h"
#include "raysheaf/cameras.h"
#include "raysheaf/error.h"
#include "raysheaf/stream.h"
#include "scene/flat_scene.h"
#include "scene/subject.h"

namespace raysheaf {
namespace {

[[noreturn]] void refuse(const std::string& sentence, const std::string& place) {
  throw Error(ErrorCode::kInvalidData, sentence, place);
}

std::string element(const char* field, std::size_t i) {
  return std::string(field) + "[" + std::to_string(i) + "]";
}

void check_count(std::size_t count, std::size_t least, std::size_t most, const char* field) {
  if (count < least || count > most)
    refuse("a block must have from " + std::to_string(least) + " to " + std::to_string(most) +
               " of them, not " + std::to_string(count),
           field);
}

/// Empty, one for all, or one each.
void check_column(std::size_t count, std::size_t each, const char* field) {
  if (count > 1 && count != each)
    refuse("there are " + std::to_string(count) + " for " + std::to_string(each) + " triangles",
           field);
}

void check_positions(const TriangleBlock& block) {
  for (std::size_t i = 0; i < block.positions.size(); ++i) {
    const Vec3 p = block.positions[i];
    if (!(max_component(abs(p)) <= kLargestCoordinate) || !is_finite(p))
      refuse("the vertex is not finite, or farther out than 1e18", element("positions", i));
  }
}

void check_indices(const TriangleBlock& block) {
  const std::size_t vertices = block.positions.size();
  for (std::size_t i = 0; i < block.triangles.size(); ++i) {
    const auto& t = block.triangles[i];
    if (std::max({t[0], t[1], t[2]}) >= vertices)
      refuse("a corner is not among the block's " + std::to_string(vertices) + " vertices",
             element("triangles", i));
  }
}

void check_order(const TriangleBlock& block) {
  std::size_t next = 0;
  for (std::size_t p = 0; p < block.parts.size(); ++p) {
    const BlockPart& part = block.parts[p];
    if (part.first != next || part.count == 0 || part.count > block.triangles.size() - next)
      refuse("the part does not begin where the previous one ends, or has no or too many triangles",
             element("parts", p));
    next += part.count;
    if (p > 0) {
      const BlockPart& last = block.parts[p - 1];
      if (last.geom_id > part.geom_id ||
          (last.geom_id == part.geom_id && last.inst_id >= part.inst_id))
        refuse("the part's ids are not greater than those of the previous part",
               element("parts", p));
    }
    for (std::size_t i = part.first + std::size_t{1}; i < next; ++i) {
      if (block.prim_ids[i - 1] >= block.prim_ids[i])
        refuse("the id is not greater than the previous one", element("prim_ids", i));
    }
  }
  if (next != block.triangles.size())
    refuse("the parts cover " + std::to_string(next) + " of " +
               std::to_string(block.triangles.size()) + " triangles",
           "parts");
}

void check_vertex_column(std::size_t count, std::size_t vertices, const char* field) {
  if (count != 0 && count != vertices)
    refuse("there are " + std::to_string(count) + " for " + std::to_string(vertices) + " vertices",
           field);
}

void check_coordinates(const std::vector<Vec2>& uvs, const char* field) {
  for (std::size_t i = 0; i < uvs.size(); ++i) {
    if (!is_finite({uvs[i].x, uvs[i].y, 0}))
      refuse("the coordinate is not finite", element(field, i));
  }
}

void check_part_column(const std::vector<std::uint8_t>& column, std::size_t parts, bool there,
                       const char* field) {
  if (column.size() != parts)
    refuse(
        "there are " + std::to_string(column.size()) + " for " + std::to_string(parts) + " parts",
        field);
  if (!there && std::any_of(column.begin(), column.end(), [](std::uint8_t x) { return x != 0; }))
    refuse("a part has an attribute that the block does not have", field);
}

}  // namespace

void validate(const TriangleBlock& block) {
  check_count(block.positions.size(), 0, kBlockVertices, "positions");
  check_count(block.triangles.size(), 1, kBlockTriangles, "triangles");
  if (block.prim_ids.size() != block.triangles.size())
    refuse("there are " + std::to_string(block.prim_ids.size()) + " for " +
               std::to_string(block.triangles.size()) + " triangles",
           "prim_ids");
  check_column(block.sides.size(), block.triangles.size(), "sides");
  check_positions(block);
  check_indices(block);
  check_order(block);
}

void validate(const TriangleBlock& block, const BlockShading& shading) {
  check_vertex_column(shading.normals.size(), block.positions.size(), "normals");
  check_vertex_column(shading.uvs.size(), block.positions.size(), "uvs");
  check_vertex_column(shading.second_uvs.size(), block.positions.size(), "second_uvs");
  check_vertex_column(shading.colors.size(), block.positions.size(), "colors");
  check_column(shading.materials.size(), block.triangles.size(), "materials");
  check_part_column(shading.has_normals, block.parts.size(), !shading.normals.empty(),
                    "has_normals");
  check_part_column(shading.has_uvs, block.parts.size(), !shading.uvs.empty(), "has_uvs");
  if (!shading.has_colors.empty())
    check_part_column(shading.has_colors, block.parts.size(), !shading.colors.empty(),
                      "has_colors");
  if (!shading.has_second_uvs.empty())
    check_part_column(shading.has_second_uvs, block.parts.size(), !shading.second_uvs.empty(),
                      "has_second_uvs");
  for (std::size_t i = 0; i < shading.has_second_uvs.size(); ++i) {
    if (shading.has_second_uvs[i] != 0 && shading.has_uvs[i] == 0)
      refuse("the part has second texture coordinates, but no first ones",
             element("has_second_uvs", i));
  }
  for (std::size_t i = 0; i < shading.normals.size(); ++i) {
    if (!is_finite(shading.normals[i])) refuse("the normal is not finite", element("normals", i));
  }
  check_coordinates(shading.uvs, "uvs");
  check_coordinates(shading.second_uvs, "second_uvs");
  for (std::size_t i = 0; i < shading.colors.size(); ++i) {
    if (!is_finite(shading.colors[i]) || min_component(shading.colors[i]) < 0)
      refuse("the colour is negative or not finite", element("colors", i));
  }
}

Box bounds_of(const TriangleBlock& block) {
  Box box;
  for (const Vec3 p : block.positions) {
    box.min = min(box.min, p);
    box.max = max(box.max, p);
  }
  // Adding 0 turns -0 into +0, so that a union does not depend on the order of its parts.
  box.min += {0, 0, 0};
  box.max += {0, 0, 0};
  return box;
}

Box world_bounds(const GeometrySource& source) {
  Box box;
  for (const BlockInfo& block : source.blocks()) {
    box.min = min(box.min, block.bounds.min);
    box.max = max(box.max, block.bounds.max);
  }
  return box;
}

Camera framing_camera(const GeometrySource& source, const Viewpoint& viewpoint) {
  ViewFit fit(viewpoint);
  for (const BlockInfo& block : source.blocks()) fit.add(block.bounds);
  return fit.camera();
}

bool shows(const Camera& camera, const GeometrySource& source) {
  Sighting sighting(camera);
  for (const BlockInfo& block : source.blocks())
    for (const std::array<Vec3, 4>& face : faces_of(block.bounds)) sighting.add(face);
  return sighting.suffices();
}

bool precedes(const Hit& a, const Hit& b) {
  return comes_before(a, b);
}

void BlockList::add(const TriangleBlock& block, const BlockShading& shading) {
  validate(block);
  validate(block, shading);
  BlockInfo info;
  info.bounds = bounds_of(block);
  info.triangles = static_cast<std::uint32_t>(block.triangles.size());
  info.geometry_bytes = 12 * (block.positions.size() + block.triangles.size()) +
                        4 * block.prim_ids.size() + 16 * block.parts.size() + block.sides.size();
  info.shading_bytes = 12 * shading.normals.size() + 8 * shading.uvs.size() +
                       8 * shading.second_uvs.size() + 12 * shading.colors.size() +
                       4 * shading.materials.size() + 2 * shading.has_normals.size() +
                       shading.has_second_uvs.size() + shading.has_colors.size();
  infos_.push_back(info);
  blocks_.push_back(block);
  shading_.push_back(shading);
}

}  // namespace raysheaf
