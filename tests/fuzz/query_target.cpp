// Random programs that use a scene: meshes are added, changed and removed, instances move, also in
// time, and are in worlds, and batches of rays are each queried in several ways. Some calls are
// invalid; they must throw an `Error` and change nothing.
#include <bit>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <optional>
#include <string>

#include "fuzz/targets.h"
#include "raysheaf/error.h"
#include "raysheaf/level_choice.h"
#include "raysheaf/query.h"

namespace raysheaf::fuzz {
namespace {

constexpr std::size_t kMostTriangles = 64, kMostRays = 64, kMostCalls = 40;

[[noreturn]] void wrong(const std::string& what) {
  std::fprintf(stderr, "%s\n", what.c_str());
  std::abort();
}

/// Numbers from the input; zeros after its end.
class Reader {
 public:
  explicit Reader(Input input) : input_(input) {}
  [[nodiscard]] bool is_empty() const { return at_ >= input_.size(); }
  std::uint8_t byte() { return is_empty() ? 0 : input_[at_++]; }
  std::uint32_t below(std::uint32_t n) { return byte() % n; }
  /// Mostly small numbers, sometimes any float.
  float number() {
    const std::uint8_t first = byte();
    if (first < 240) return (static_cast<float>(first) - 120) / 8;
    std::uint32_t bits = 0;
    for (int i = 0; i < 4; ++i) bits = bits << 8 | byte();
    return std::bit_cast<float>(bits);
  }
  Vec3 vector() {
    const float x = number(), y = number();
    return {x, y, number()};
  }

 private:
  Input input_;
  std::size_t at_ = 0;
};

bool same(const Hit& a, const Hit& b) {
  return std::memcmp(&a, &b, sizeof a) == 0;
}

class Program {
 public:
  explicit Program(Input input) : in_(input) {}

  void run() {
    for (std::size_t call = 0; call < kMostCalls && !in_.is_empty(); ++call) {
      const std::size_t meshes = scene_.mesh_count(), instances = scene_.instance_count();
      try {
        step();
      } catch (const Error& error) {
        if (error.code() == ErrorCode::kInternal) wrong(error.what());
        if (scene_.mesh_count() != meshes || scene_.instance_count() != instances)
          wrong(std::string("a call that failed changed the scene: ") + error.what());
      }
    }
  }

 private:
  std::vector<Vec3> corners() {
    std::vector<Vec3> all(3 * in_.below(kMostTriangles / 4));
    for (Vec3& p : all) p = in_.vector();
    if (in_.below(16) == 0 && !all.empty()) all.pop_back();
    return all;
  }
  Affine transform() {
    Affine a;
    if (in_.below(2) == 0) return a;
    for (auto& row : a.m)
      for (float& x : row) x = in_.number();
    return a;
  }
  /// Mostly the id of an existing mesh.
  MeshId mesh() {
    const std::vector<MeshId> all = scene_.meshes();
    const std::uint32_t which = in_.byte();
    return all.empty() || which > 240 ? which : all[which % all.size()];
  }
  InstanceId instance() {
    const std::vector<InstanceId> all =
        scene_.mesh_count() == 0 ? std::vector<InstanceId>{} : scene_.instances(scene_.meshes()[0]);
    const std::uint32_t which = in_.byte();
    return all.empty() || which > 240 ? which : all[which % all.size()];
  }

  WorldId world() { return in_.below(4) == 0 ? kAllWorlds : in_.below(3); }
  std::vector<Affine> transforms(std::size_t count) {
    std::vector<Affine> all(count);
    for (Affine& one : all) one = transform();
    return all;
  }

  void step() {
    const std::uint8_t what = in_.byte();
    if (what >= 240) return place(what % 4);
    switch (what % 12) {
      case 0:
      case 1:
        scene_.add_soup(corners(), {.transform = transform(), .mask = in_.byte()});
        break;
      case 2:
        scene_.replace_soup(mesh(), corners());
        break;
      case 3: {
        const MeshId id = mesh();
        std::vector<Vec3> moved(scene_.vertex_count(id));
        for (Vec3& p : moved) p = in_.vector();
        scene_.update(id, moved);
        break;
      }
      case 4:
        scene_.remove(mesh());
        break;
      case 5:
        if (scene_.instance_count() < 64) scene_.instance(mesh(), transform(), in_.byte());
        break;
      case 6:
        scene_.remove_instance(instance());
        break;
      case 7:
        scene_.set_transform(instance(), transform());
        break;
      case 8:
        scene_.set_mask(instance(), in_.byte());
        break;
      case 9: {
        std::vector<Triangle> triangles(in_.below(kMostTriangles / 4));
        std::vector<Vec3> positions(1 + in_.below(32));
        for (Vec3& p : positions) p = in_.vector();
        for (Triangle& t : triangles) t = {in_.below(33), in_.below(33), in_.below(33)};
        scene_.add(positions, triangles);
        break;
      }
      default:
        ask();
    }
  }

  /// Instances in worlds and in time.
  void place(std::uint32_t what) {
    switch (what) {
      case 0:
        if (scene_.instance_count() < 64) {
          const MeshId id = mesh();
          const std::vector<Affine> all = transforms(in_.below(5));
          std::vector<WorldId> worlds(all.size());
          for (WorldId& one : worlds) one = world();
          scene_.instances(id, all, worlds, in_.byte());
        }
        break;
      case 1: {
        std::vector<InstanceId> ids(in_.below(4));
        for (InstanceId& id : ids) id = instance();
        const std::size_t each = in_.below(5);
        scene_.set_transforms(ids, transforms(ids.size() * each), each);
        break;
      }
      case 2:
        scene_.set_world(instance(), world());
        break;
      default:
        choose_levels(scene_, in_.below(2) == 0 ? std::nullopt : std::optional(in_.below(2) == 0));
    }
  }

  Ray ray() {
    Ray ray{in_.vector(), 0, in_.vector()};
    if (in_.below(3) == 0) ray.t_min = in_.number();
    if (in_.below(3) == 0) ray.t_max = in_.number();
    return ray;
  }

  void ask() {
    if (in_.below(32) != 0) scene_.commit();
    std::vector<Ray> rays(in_.below(kMostRays));
    for (Ray& r : rays) r = ray();
    if (in_.below(2) == 0)
      for (Ray& r : rays) r.origin = rays[0].origin;
    QueryOptions options;
    options.mask = in_.below(3) == 0 ? in_.byte() : 0xffffffff;
    const std::vector<Hit> closest = closest_hit(scene_, rays, options);
    compare(rays, options);
    // Takes nothing of the input, so that programs that were found stay what they are.
    std::vector<std::uint32_t> masks;
    std::vector<TriangleId> skip;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      masks.push_back(static_cast<std::uint32_t>(i % 4 == 0 ? 0xff : 37 * i));
      skip.push_back(i % 3 == 0 ? TriangleId{} : triangle_of(closest[i]));
    }
    options.sides = static_cast<Sides>(rays.size() % 3);
    if (rays.size() % 2 == 0) options.ray_masks = masks;
    options.skip = skip;
    compare(rays, options);
    std::vector<WorldId> worlds;
    std::vector<float> times;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      worlds.push_back(i % 5 == 0 ? kAllWorlds : static_cast<WorldId>(i % 4));
      times.push_back(static_cast<float>(i % 9) / 8);
    }
    options.ray_worlds = worlds;
    if (rays.size() % 3 != 0) compare(rays, options);
    options.ray_times = times;
    compare(rays, options);
    options.ray_worlds = {};
    if (rays.size() % 3 == 0) compare(rays, options);
  }

  void compare(const std::vector<Ray>& rays, const QueryOptions& options) {
    QueryOptions brute = options;
    brute.method = QueryMethod::kBrute;
    const std::vector<Hit> closest = closest_hit(scene_, rays, options);
    const std::vector<std::uint8_t> any = any_hit(scene_, rays, options);
    const HitRows rows = all_hits(scene_, rays, options), right = all_hits(scene_, rays, brute);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      if (rows[i].size() != right[i].size()) wrong("all_hits differs from brute force");
      for (std::size_t k = 0; k < right[i].size(); ++k)
        if (!same(rows[i][k], right[i][k])) wrong("a hit of all_hits differs from brute force");
      if (!same(closest[i], right[i].empty() ? Hit{} : right[i].front()))
        wrong("closest_hit differs from brute force");
      if (any[i] != (right[i].empty() ? 0 : 1)) wrong("any_hit differs from brute force");
    }
  }

  Reader in_;
  Scene scene_{Context({.threads = 1})};
};

}  // namespace

void run_query(Input input) {
  Program(input).run();
}

}  // namespace raysheaf::fuzz
