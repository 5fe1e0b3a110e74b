#include "render/frame/surface_fetcher.h"

#include <hwy/cache_control.h>

#include <algorithm>
#include <bit>

#include "intersect/triangle_body.h"
#include "scene/material_of.h"

namespace raysheaf {
namespace {

/// Calls `body(lane)` for each lane of `lanes`, ascending.
template <class Body>
void for_each_lane(LaneBits lanes, const Body& body) {
  for (; lanes != 0; lanes &= lanes - 1) body(static_cast<std::size_t>(std::countr_zero(lanes)));
}

template <std::size_t kAxes>
Vec3 at(const SurfaceColumn (&columns)[kAxes], std::size_t lane) {
  static_assert(kAxes == 3);
  return {columns[0][lane], columns[1][lane], columns[2][lane]};
}

void put(Vec3 a, std::size_t lane, SurfaceColumn (&columns)[3]) {
  columns[0][lane] = a.x;
  columns[1][lane] = a.y;
  columns[2][lane] = a.z;
}

MaterialLook look_of(const Material& material, std::uint32_t index) {
  MaterialLook look;
  look.placed = placed_material(material);
  look.is_plain = is_plain(look.placed);
  look.plain.material = index;
  set_material(look.placed, {}, &look.plain);
  return look;
}

}  // namespace

std::vector<MaterialLook> material_looks(const SceneDescription& scene) {
  const auto is_vast = [&](const PlacedTexture& slot) {
    if (slot.texture >= scene.textures.size()) return false;
    const Image& image = scene.images[scene.textures[slot.texture].image];
    return std::uint64_t{image.width} * image.height > kMostColumnTexels;
  };
  std::vector<MaterialLook> looks;
  looks.reserve(scene.materials.size() + 1);
  for (const Material& material : scene.materials)
    looks.push_back(look_of(material, static_cast<std::uint32_t>(looks.size())));
  looks.push_back(look_of(material_or_default(scene, kInvalidId), kInvalidId));
  for (MaterialLook& look : looks) {
    const PlacedMaterial& m = look.placed;
    const auto is_odd = [&](const PlacedTexture& slot) {
      return is_vast(slot) || (slot.second_uvs && slot.texture != kInvalidId);
    };
    look.is_odd = is_bumpy(m) || is_odd(m.base_color_texture) ||
                  is_odd(m.metallic_roughness_texture) || is_odd(m.emission_texture);
  }
  return looks;
}

void SurfaceFetcher::hold_mesh(std::uint32_t mesh) {
  mesh_number_ = mesh;
  placed_ = &scene_.meshes[mesh];
  run_ = &scene_.placed.runs()[mesh];
  if (scene_.stands) corners_ = InstanceCorners(scene_.placed.instances()[mesh]);
  mesh_ = &scene_.description->meshes[placed_->geom_id];
  map_ = normal_map(scene_.description->instances[placed_->inst_id].to_world);
}

/// Prefetches what `gather` reads of each triangle: its mesh's number, then its vertices' numbers,
/// then its vertices.
void SurfaceFetcher::prefetch(View<const Fragment> fragments) const {
  std::uint32_t triangles[kFetchedTogether];
  TriangleAt at[kFetchedTogether];
  const std::array<std::uint32_t, 3>* vertices[kFetchedTogether];
  std::size_t count = 0;
  for (const Fragment& f : fragments) {
    if (f.triangle == kInvalidId || (count > 0 && f.triangle == triangles[count - 1])) continue;
    triangles[count++] = f.triangle;
    if (source_.met == nullptr) hwy::Prefetch(&scene_.mesh_of_triangle[f.triangle]);
  }
  const View<const TriangleRun> runs = scene_.placed.runs();
  for (std::size_t i = 0; i < count; ++i) {
    at[i] = source_.at(triangles[i]);
    vertices[i] = runs[at[i].mesh].triangles + at[i].prim;
    hwy::Prefetch(vertices[i]);
  }
  for (std::size_t i = 0; i < count; ++i) {
    const PlacedInstance& instance = scene_.placed.instances()[at[i].mesh];
    const Vec3* const positions =
        scene_.stands ? instance.positions.data : runs[at[i].mesh].positions;
    for (const std::uint32_t vertex : *vertices[i]) hwy::Prefetch(positions + vertex);
  }
}

void SurfaceFetcher::gather_triangle(std::uint32_t triangle, std::size_t lane, Block* block) {
  Block& b = *block;
  const LaneBits bit = 1u << lane;
  const auto [number, prim_id] = source_.at(triangle);
  if (number != mesh_number_) hold_mesh(number);
  const Mesh& mesh = *mesh_;
  const std::array<Vec3, 3> corners = scene_.stands ? corners_(prim_id) : run_->corners(prim_id);
  for (std::size_t k = 0; k < 3; ++k) put(corners[k], lane, b.columns.corner[k]);
  const std::uint32_t material = material_of(mesh, prim_id);
  const MaterialLook& look = looks_[std::min<std::size_t>(material, looks_.size - 1)];
  b.look[lane] = &look;
  b.used |= bit;
  const bool has_uvs = !mesh.uvs.empty();
  if (!mesh.colors.empty() || (has_uvs && look.is_odd) || material != look.plain.material) {
    b.odd |= bit;
    return;
  }
  if (placed_->mirrored) b.mirrored |= bit;
  const auto& vertices = mesh.triangles[prim_id];
  if (!mesh.normals.empty()) {
    for (std::size_t k = 0; k < 3; ++k) put(mesh.normals[vertices[k]], lane, b.columns.normal[k]);
    if (b.instance_count == 0 || b.instances[b.instance_count - 1].mesh != number)
      b.instances[b.instance_count++] = {0, number, map_};
    b.instances[b.instance_count - 1].lanes |= bit;
  }
  if (!has_uvs || look.is_plain) return;
  b.textured |= bit;
  for (std::size_t k = 0; k < 3; ++k) {
    b.columns.uv[k][0][lane] = mesh.uvs[vertices[k]].x;
    b.columns.uv[k][1][lane] = mesh.uvs[vertices[k]].y;
  }
}

void SurfaceFetcher::gather(Arrival arrival, Block* block) {
  Block& b = *block;
  b.used = b.mirrored = b.textured = b.front = b.odd = 0;
  b.instance_count = 0;
  for (std::size_t lane = 0; lane < b.fragments.size; ++lane) {
    const Ray& ray = b.rays[lane];
    const Fragment& f = b.fragments[lane];
    put(ray.origin, lane, b.columns.origin);
    put(ray.direction, lane, b.columns.direction);
    b.columns.t_min[lane] = ray.t_min;
    b.columns.t_max[lane] = ray.t_max;
    if (arrival == Arrival::kTraced) put(f.incoming, lane, b.columns.incoming);
    if (f.triangle != kInvalidId) gather_triangle(f.triangle, lane, block);
  }
}

void SurfaceFetcher::settle_incoming(Block* block) {
  Block& b = *block;
  const LaneBits right = find_incoming(&b.columns);
  for (std::size_t lane = 0; lane < b.fragments.size; ++lane) {
    Vec3& incoming = b.fragments[lane].incoming;
    if ((right >> lane & 1) != 0) {
      incoming = at(b.columns.incoming, lane);
    } else {
      incoming = normalized(b.rays[lane].direction);
      put(incoming, lane, b.columns.incoming);
    }
  }
}

/// Computes weights one by one for lanes that see their triangle edge-on, or whose ray passes just
/// outside it.
void SurfaceFetcher::settle_weights(Arrival arrival, Block* block) {
  Block& b = *block;
  for_each_lane(b.used & ~find_weights(&b.columns), [&](std::size_t lane) {
    const Vec3 p = at(b.columns.corner[0], lane), q = at(b.columns.corner[1], lane);
    const Vec3 r = at(b.columns.corner[2], lane);
    Vec2 weights;
    if (arrival == Arrival::kSeen) {
      weights = clamped_barycentrics(b.rays[lane], p, q, r);
    } else {
      TriangleHit where{};
      intersect_triangle(make_ray_setup(b.rays[lane]), p, q, r, &where);
      weights = {where.u, where.v};
    }
    b.columns.u[lane] = weights.x;
    b.columns.v[lane] = weights.y;
  });
}

namespace {

/// Calls `body(look, lanes)` for each material of the lanes.
template <class Body>
void for_each_look(LaneBits lanes, const MaterialLook* const* looks, const Body& body) {
  while (lanes != 0) {
    const MaterialLook* const look = looks[std::countr_zero(lanes)];
    LaneBits same = 0;
    for_each_lane(lanes,
                  [&](std::size_t lane) { same |= (looks[lane] == look ? 1u : 0u) << lane; });
    lanes &= ~same;
    body(*look, same);
  }
}

}  // namespace

void SurfaceFetcher::place(Block* block) {
  Block& b = *block;
  b.odd |=
      b.used & ~place_surfaces(b.instances, b.instance_count, b.mirrored, &b.columns, &b.front);
  b.textured &= ~b.odd;
  const TextureTable table = textures_.table();
  for_each_look(b.textured, b.look, [&](const MaterialLook& look, LaneBits /*lanes*/) {
    const PlacedTexture& slot = look.placed.base_color_texture;
    if (slot.texture < table.textures.size) prefetch_colors(table, slot, b.columns);
  });
}

void SurfaceFetcher::color(Block* block) {
  Block& b = *block;
  const TextureTable table = textures_.table();
  for_each_look(b.textured, b.look, [&](const MaterialLook& look, LaneBits lanes) {
    const auto look_up = [&](const PlacedTexture& slot, const float* decode,
                             Vec3 TextureColors::*color) {
      const bool has_texture = slot.texture < table.textures.size;
      if (has_texture) look_up_colors(table, slot, decode, &b.columns);
      for_each_lane(lanes, [&](std::size_t lane) {
        b.colors[lane].*color = has_texture ? at(b.columns.color, lane) : Vec3{1, 1, 1};
      });
    };
    const PlacedMaterial& m = look.placed;
    look_up(m.base_color_texture, table.from_srgb, &TextureColors::base);
    if (m.unlit) return;
    look_up(m.metallic_roughness_texture, table.as_is, &TextureColors::rough_metal);
    look_up(m.emission_texture, table.from_srgb, &TextureColors::emission);
  });
}

void SurfaceFetcher::give(Block* block) {
  const Block& b = *block;
  for_each_lane(b.used & ~b.odd, [&](std::size_t lane) {
    Surface& surface = b.fragments[lane].surface;
    surface = b.look[lane]->plain;
    if ((b.textured >> lane & 1) != 0) set_material(b.look[lane]->placed, b.colors[lane], &surface);
    surface.position = at(b.columns.position, lane);
    surface.geometric_normal = at(b.columns.geometric, lane);
    surface.normal = at(b.columns.shading, lane);
    surface.clearance = b.columns.clearance[lane];
    surface.front = (b.front >> lane & 1) != 0;
  });
  for_each_lane(b.odd, [&](std::size_t lane) {
    Fragment& f = b.fragments[lane];
    reader_.hold(scene_, source_.at(f.triangle));
    f.surface = reader_.at(b.columns.u[lane], b.columns.v[lane], f.incoming);
  });
}

void SurfaceFetcher::fetch(View<const Ray> rays, Arrival arrival, View<Fragment> fragments) {
  prefetch({fragments.data, fragments.size});
  std::size_t used = 0;
  for (std::size_t first = 0; first < fragments.size; first += kSurfaceLanes) {
    Block& block = blocks_[used++];
    const std::size_t count = std::min(kSurfaceLanes, fragments.size - first);
    block.rays = rays.slice(first, count);
    block.fragments = fragments.slice(first, count);
    gather(arrival, &block);
    if (arrival == Arrival::kSeen) settle_incoming(&block);
    if (block.used == 0) continue;
    settle_weights(arrival, &block);
    place(&block);
  }
  for (std::size_t i = 0; i < used; ++i) {
    color(&blocks_[i]);
    give(&blocks_[i]);
  }
}

}  // namespace raysheaf
