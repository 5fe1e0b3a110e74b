#include "lab/verify/world.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <utility>

#include "lab/verify/closed_mesh.h"
#include "lab/verify/maps.h"
#include "lab/verify/whole_meshes.h"
#include "raysheaf/error.h"

namespace raysheaf::checks {
namespace {

constexpr std::uint32_t kMostTriangles = 1500;  ///< of all instances, except for the last one
constexpr std::uint32_t kPartTriangles = 400;
constexpr float kFarthestVertex = 1e18f;
constexpr float kLeastSpread = 3, kMostSpread = 9;  ///< powers of ten: grounds and skies, in sizes
constexpr std::size_t kMostPlaced = 100;            ///< at once
constexpr std::uint32_t kMasks[] = {0xffffffff, 1, 2, 3, 6, 0};

/// A power of two, so that whole-number meshes stay such.
float some_size(Random* random) {
  if (random->one_in(2)) return 1;
  return std::ldexp(1.0f, static_cast<int>(random->below(41)) - 20);
}

Vec3 in_whole_steps(Vec3 p, float step) {
  return Vec3{std::round(p.x), std::round(p.y), std::round(p.z)} * step;
}

/// In whole sizes, so that whole-number meshes stay such.
Vec3 some_offset(float size, Random* random) {
  if (random->one_in(2)) return {};
  const float sizes = random->magnitude(1, 5);
  return in_whole_steps(random->direction() * sizes, size);
}

std::string with_size(const char* kind, float size) {
  char text[64];
  std::snprintf(text, sizeof text, "%s of %.2g", kind, static_cast<double>(size));
  return text;
}

/// Each three positions are a triangle.
std::vector<Triangle> consecutive(std::size_t corners) {
  std::vector<Triangle> triangles;
  for (std::uint32_t i = 0; i + 2 < corners; i += 3) triangles.push_back({i, i + 1, i + 2});
  return triangles;
}

template <class Map>
auto some_key(const Map& map, Random* random) {
  return std::next(map.begin(), random->below(static_cast<std::uint32_t>(map.size())))->first;
}

/// Whether the call throws `Error`.
template <class Call>
bool refuses(const Call& call) {
  try {
    call();
    return false;
  } catch (const Error&) {
    return true;
  }
}

}  // namespace

WorldId some_world(Random* random) {
  constexpr WorldId kWorlds[] = {0, 1, 2, 7, 0xfffffffe, kAllWorlds};
  return kWorlds[random->below(std::size(kWorlds))];
}

World::World(const Context& context, std::uint64_t seed)
    : random_(seed),
      size_(some_size(&random_)),
      offset_(some_offset(size_, &random_)),
      is_whole_(random_.one_in(2)),
      has_worlds_(random_.one_in(2)),
      moves_(random_.one_in(2)),
      scene_(context) {
  add(soup());
  if (random_.one_in(2)) add(random_.one_in(3) ? sky() : ground());
  if (random_.one_in(2)) add(closed());
}

// --- parts -------------------------------------------------------------------------------------

World::Part World::soup() {
  const float ratio = random_.one_in(3) ? random_.magnitude(-6, 6) : 1;
  const bool whole = is_whole_ || random_.one_in(4);
  const Soup from = whole ? make_whole_meshes(kPartTriangles, &random_)
                          : make_soup_at(kPartTriangles, size_ * ratio, offset_, &random_);
  Part part{from.kind, {}, {}, true};
  for (const std::vector<Vec3>& mesh : from.meshes)
    part.positions.insert(part.positions.end(), mesh.begin(), mesh.end());
  if (whole)
    for (Vec3& p : part.positions) p = (p - from.offset) * (0.25f * size_ / from.scale) + offset_;
  if (!whole && ratio != 1) {
    const Vec3 by = random_.in_box(9) * size_;
    if (ratio < 1)
      for (Vec3& p : part.positions) p += by;
  }
  if (random_.one_in(3)) {  // the same with indices, in another order
    part.is_soup = false;
    part.triangles = consecutive(part.positions.size());
    std::reverse(part.triangles.begin(), part.triangles.end());
  }
  return part;
}

World::Part World::closed() {
  ClosedMesh mesh = make_closed_mesh(random_.bits());
  while (mesh.triangles.size() > kPartTriangles) mesh = make_closed_mesh(random_.bits());
  const float ratio = random_.one_in(3) ? random_.magnitude(-3, 3) : 4;
  const Vec3 by = random_.one_in(2) ? Vec3{} : random_.in_box(5) * size_;
  for (Vec3& p : mesh.positions)
    p = (p - mesh.offset) * (size_ * ratio / mesh.extent) + by + offset_;
  return {mesh.kind, std::move(mesh.positions), std::move(mesh.triangles), false};
}

World::Part World::ground() {
  const float spread = random_.magnitude(kLeastSpread, kMostSpread);
  const float half = size_ * spread, height = random_.between(-12, 2) * size_;
  const std::uint32_t cells = random_.one_in(2) ? 1 : 1 + random_.below(4);
  const bool upright = random_.one_in(4);
  Part part{with_size("ground", spread), {}, {}, false};
  for (std::uint32_t i = 0; i <= cells; ++i)
    for (std::uint32_t k = 0; k <= cells; ++k) {
      const auto at = [&](std::uint32_t j) {
        return half * (2 * static_cast<float>(j) / static_cast<float>(cells) - 1);
      };
      const Vec3 p{at(i), height, at(k)};
      part.positions.push_back((upright ? Vec3{p.y, p.z, p.x} : p) + offset_);
    }
  for (std::uint32_t i = 0; i < cells; ++i)
    for (std::uint32_t k = 0; k < cells; ++k) {
      const std::uint32_t a = i * (cells + 1) + k, b = a + cells + 1;
      part.triangles.push_back({a, a + 1, b});
      part.triangles.push_back({a + 1, b + 1, b});
    }
  return part;
}

World::Part World::sky() {
  const float spread = random_.magnitude(kLeastSpread, kMostSpread), half = size_ * spread;
  Part part{with_size("sky", spread), {}, {}, false};
  for (int corner = 0; corner < 8; ++corner)
    part.positions.push_back(Vec3{(corner & 1) != 0 ? half : -half,
                                  (corner & 2) != 0 ? half : -half,
                                  (corner & 4) != 0 ? half : -half} +
                             offset_);
  part.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return part;
}

World::Part World::some_part() {
  switch (random_.below(8)) {
    case 0:
      return ground();
    case 1:
      return sky();
    case 2:
    case 3:
      return closed();
    default:
      return soup();
  }
}

/// Turns or scales about the middle of the scene or the origin, and moves by little or far.
Affine World::some_transform() {
  const Affine map = some_map(&random_);
  const Vec3 middle = random_.one_in(2) ? offset_ : Vec3{};
  const Affine about = compose(translation(middle), compose(map, translation(-middle)));
  if (random_.one_in(4)) return about;
  const Vec3 near = random_.in_box(10);
  const Vec3 by = random_.one_in(2) ? near * size_ : in_whole_steps(near, size_);
  const Affine moved = compose(translation(by), about);
  if (!random_.one_in(8)) return moved;
  const float far = size_ * random_.magnitude(0, 5);
  return compose(translation(random_.direction() * far), moved);
}

std::vector<Affine> World::some_transforms(std::size_t count) {
  std::vector<Affine> transforms{some_transform()};
  while (transforms.size() < count)
    transforms.push_back(random_.one_in(2) ? some_transform() : next_to(transforms.back()));
  return transforms;
}

Affine World::next_to(const Affine& transform) {
  const Vec3 by = random_.direction() * (size_ * 0.1f);
  const Vec3 axis = random_.direction();
  return compose(compose(translation(by), rotation(axis, random_.between(-0.1f, 0.1f))), transform);
}

std::size_t World::some_times() {
  return moves_ && random_.one_in(2) ? 2 + random_.below(3) : 1;
}

// --- the model ---------------------------------------------------------------------------------

MeshId World::some_mesh() {
  return some_key(meshes_, &random_);
}

InstanceId World::some_instance() {
  return some_key(instances_, &random_);
}

std::size_t World::triangle_count() const {
  std::size_t count = 0;
  for (const auto& [id, instance] : instances_)
    count += meshes_.at(instance.mesh).part.triangles.size();
  return count;
}

std::vector<Vec3> World::corners(const Instance& instance, const Affine& transform) const {
  const Part& part = meshes_.at(instance.mesh).part;
  std::vector<Vec3> corners;
  corners.reserve(3 * part.triangles.size());
  for (const Triangle& t : part.triangles)
    for (const std::uint32_t i : t) corners.push_back(placed(transform, part.positions[i]));
  return corners;
}

/// A scene refuses several transforms where any of them may lead too far, but a single one only
/// where it does.
World::Fit World::fit_of(const Instance& instance) const {
  const auto leaves = [](Vec3 p) {
    return !(max_component(abs(p)) <= kFarthestVertex && is_finite(p));
  };
  for (const Affine& transform : instance.transforms)
    if (std::ranges::any_of(corners(instance, transform), leaves)) return Fit::kNone;
  if (instance.transforms.size() == 1) return Fit::kSure;
  float most = 0;
  for (const Vec3 p : meshes_.at(instance.mesh).part.positions)
    most = std::max(most, max_component(abs(p)));
  return surely_stays(instance.transforms, most) ? Fit::kSure : Fit::kUnsure;
}

WorldView World::view(float time) const {
  WorldView view;
  view.soup.scale = size_;
  view.soup.offset = offset_;
  view.is_whole = is_whole_;
  for (const auto& [id, instance] : instances_)
    if (!meshes_.at(instance.mesh).part.triangles.empty())
      view.placed.push_back({id, instance.mesh, instance.mask, instance.world,
                             is_mirrored(mixed_at(instance.transforms, time))});
  std::sort(view.placed.begin(), view.placed.end(), [](const Placed& a, const Placed& b) {
    return std::pair(a.mesh, a.instance) < std::pair(b.mesh, b.instance);
  });
  for (const Placed& placed : view.placed) {
    const Instance& instance = instances_.at(placed.instance);
    view.soup.meshes.push_back(corners(instance, mixed_at(instance.transforms, time)));
    view.soup.kind +=
        (view.soup.kind.empty() ? "triangles: " : ", ") + meshes_.at(placed.mesh).part.kind;
  }
  return view;
}

// --- changes -----------------------------------------------------------------------------------

std::string World::change() {
  changes_.clear();
  fault_.clear();
  struct Change {
    const char* name;
    std::uint32_t weight;
    void (World::*make)();
  };
  static constexpr Change kChanges[] = {{"replace", 2, &World::replace},
                                        {"update", 8, &World::update},
                                        {"remove", 1, &World::remove},
                                        {"instance", 3, &World::place},
                                        {"instances", 2, &World::place_many},
                                        {"remove_instance", 1, &World::remove_instance},
                                        {"set_transform", 4, &World::set_transform},
                                        {"set_transforms", 4, &World::set_transforms},
                                        {"set_mask", 2, &World::set_mask},
                                        {"set_world", 2, &World::set_world},
                                        {"copy", 1, &World::copy},
                                        {"refused", 1, &World::refuse}};
  constexpr std::uint32_t kAdd = 4, kAll = kAdd + 31;
  for (std::uint32_t left = random_.below(4) + 1; left > 0; --left) {
    std::uint32_t at = random_.below(kAll);
    changes_ += changes_.empty() ? "" : ", ";
    if (at < kAdd || meshes_.empty() || instances_.empty()) {
      if (triangle_count() < kMostTriangles) {
        add(some_part());
        changes_ += "add";
        continue;
      }
      at = kAdd + 2 + 8;  // makes room
    }
    at -= kAdd;
    const Change* change = kChanges;
    for (; at >= change->weight; ++change) at -= change->weight;
    (this->*change->make)();
    changes_ += change->name;
  }
  commit();
  return fault_;
}

void World::add(Part part) {
  for (Vec3& p : part.positions) p = clamped(p);
  MeshOptions options;
  options.storage = random_.one_in(3) ? Storage::kShare : Storage::kCopy;
  options.place = !random_.one_in(8);
  if (random_.one_in(3)) options.transform = some_transform();
  if (random_.one_in(3)) options.mask = kMasks[random_.below(std::size(kMasks))];
  options.world = world_of_new();
  // At its final place, which a scene may share.
  WorldMesh& mesh = meshes_[scene_.next_mesh()];
  mesh.part = std::move(part);
  mesh.home = mesh.part.positions;
  const MeshId id = mesh.part.is_soup
                        ? scene_.add_soup(mesh.part.positions, options)
                        : scene_.add(mesh.part.positions, mesh.part.triangles, options);
  if (mesh.part.is_soup) mesh.part.triangles = consecutive(mesh.part.positions.size());
  if (options.place)
    instances_[scene_.instances(id).front()] = {
        id, {options.transform}, options.mask, options.world};
}

void World::replace() {
  const MeshId id = some_mesh();
  WorldMesh& mesh = meshes_.at(id);
  Part part = triangle_count() < kMostTriangles ? some_part() : ground();
  if (random_.one_in(12)) part.positions.clear(), part.triangles.clear();
  for (Vec3& p : part.positions) p = clamped(p);
  std::swap(mesh.part, part);  // the former arrays are read until the scene has the new ones
  mesh.home = mesh.part.positions;
  if (mesh.part.is_soup)
    scene_.replace_soup(id, mesh.part.positions);
  else
    scene_.replace(id, mesh.part.positions, mesh.part.triangles);
  if (mesh.part.is_soup) mesh.part.triangles = consecutive(mesh.part.positions.size());
}

void World::move(std::vector<Vec3>* positions, const std::vector<Vec3>& home) {
  const auto count = static_cast<std::uint32_t>(positions->size());
  const float amount = size_ * random_.magnitude(-7, 0);
  switch (random_.below(9)) {
    case 0:
      *positions = home;
      break;
    case 1:  // one vertex
      (*positions)[random_.below(count)] += random_.in_box(5) * size_;
      break;
    case 2:  // one point
      positions->assign(count, (*positions)[random_.below(count)]);
      break;
    case 3:  // flat
      for (Vec3& p : *positions) p.y = offset_.y;
      break;
    case 4: {  // far away
      const Vec3 by = random_.direction() * (size_ * random_.magnitude(0, 5));
      for (Vec3& p : *positions) p += by;
      break;
    }
    case 5:  // area goes, and comes back with `home`
      for (std::uint32_t i = 1; i < count; ++i)
        if (random_.one_in(4)) (*positions)[i] = (*positions)[i - 1];
      break;
    case 6: {  // of another size
      const float by = random_.magnitude(-3, 3);
      for (Vec3& p : *positions) p = (p - offset_) * by + offset_;
      break;
    }
    default:
      for (Vec3& p : *positions) p += random_.in_box(amount);
  }
  for (Vec3& p : *positions) p = clamped(p);
}

void World::update() {
  const MeshId id = some_mesh();
  WorldMesh& mesh = meshes_.at(id);
  if (!mesh.part.positions.empty()) move(&mesh.part.positions, mesh.home);
  scene_.update(id, mesh.part.positions);
}

void World::remove() {
  const MeshId id = some_mesh();
  scene_.remove(id);
  meshes_.erase(id);
  std::erase_if(instances_, [id](const auto& entry) { return entry.second.mesh == id; });
}

void World::place() {
  if (triangle_count() >= kMostTriangles) return remove_instance();
  const MeshId id = some_mesh();
  const Affine transform = some_transform();
  const std::uint32_t mask = kMasks[random_.below(std::size(kMasks))];
  const WorldId world = world_of_new();
  instances_[scene_.instance(id, transform, mask, world)] = {id, {transform}, mask, world};
}

/// Instances of a small mesh are more than a node has children.
void World::place_many() {
  const std::size_t before = triangle_count();
  const MeshId id = some_mesh();
  const std::size_t each = std::max<std::size_t>(1, meshes_.at(id).part.triangles.size());
  if (before + each > kMostTriangles) return remove_instance();
  const std::size_t most = std::min(kMostPlaced, (kMostTriangles - before) / each);
  const std::size_t count = 1 + random_.below(static_cast<std::uint32_t>(most));
  const std::uint32_t mask = kMasks[random_.below(std::size(kMasks))];
  std::vector<Affine> transforms;
  std::vector<WorldId> worlds;
  for (std::size_t i = 0; i < count; ++i) {
    transforms.push_back(some_transform());
    worlds.push_back(world_of_new());
  }
  InstanceId next = scene_.instances(id, transforms, worlds, mask);
  for (std::size_t i = 0; i < count; ++i)
    instances_[next++] = {id, {transforms[i]}, mask, worlds[i]};
}

WorldId World::world_of_new() {
  return has_worlds_ ? some_world(&random_) : kAllWorlds;
}

void World::remove_instance() {
  if (instances_.empty()) return;
  const InstanceId id = some_instance();
  scene_.remove_instance(id);
  instances_.erase(id);
}

void World::set_transform() {
  if (instances_.empty()) return;
  const InstanceId id = some_instance();
  std::vector<Affine>& transforms = instances_.at(id).transforms;
  transforms = some_transforms(std::min(some_times(), std::size_t{2}));
  if (transforms.size() == 1)
    scene_.set_transform(id, transforms[0]);
  else
    scene_.set_transform(id, transforms[0], transforms[1]);
}

/// Most instances move, by little or anywhere.
void World::set_transforms() {
  const bool is_step = random_.one_in(2);
  const std::size_t each = some_times();
  std::vector<InstanceId> ids;
  std::vector<Affine> all;
  for (auto& [id, instance] : instances_) {
    if (random_.one_in(5)) continue;
    std::vector<Affine> next = some_transforms(each);
    if (is_step) next.front() = next_to(instance.transforms.back());
    ids.push_back(id);
    all.insert(all.end(), next.begin(), next.end());
    instance.transforms = std::move(next);
  }
  scene_.set_transforms(ids, all, each);
}

void World::set_world() {
  if (instances_.empty()) return;
  const InstanceId id = some_instance();
  instances_.at(id).world = world_of_new();
  scene_.set_world(id, instances_.at(id).world);
}

void World::set_mask() {
  if (instances_.empty()) return;
  const InstanceId id = some_instance();
  instances_.at(id).mask = kMasks[random_.below(std::size(kMasks))];
  scene_.set_mask(id, instances_.at(id).mask);
}

/// Goes on with a copy, after the original has lost its meshes.
void World::copy() {
  Scene other = scene_.copy();
  std::swap(scene_, other);
  for (const auto& [id, mesh] : meshes_) other.remove(id);
  other.commit();
}

/// Changes that throw have no effect.
void World::refuse() {
  const MeshId id = some_mesh();
  const WorldMesh& mesh = meshes_.at(id);
  std::vector<Vec3> wrong = mesh.part.positions;
  bool refused = refuses([&] { scene_.remove(scene_.next_mesh()); });
  if (!mesh.part.triangles.empty()) {
    wrong[mesh.part.triangles.front()[0]].y = std::numeric_limits<float>::quiet_NaN();
    refused = refused && refuses([&] { scene_.update(id, wrong); });
  }
  wrong.push_back({});
  refused = refused && refuses([&] { scene_.update(id, wrong); });
  if (!refused) fault_ = "the scene accepts a mesh or positions that it must refuse";
}

/// Transforms that move vertices too far away are refused, and replaced.
void World::commit() {
  std::vector<InstanceId> wrong;
  bool refused = false;
  for (const auto& [id, instance] : instances_) {
    const Fit fit = fit_of(instance);
    if (fit != Fit::kSure) wrong.push_back(id);
    refused = refused || fit == Fit::kNone;
  }
  if (refused && !refuses([&] { scene_.commit(); }))
    fault_ = "the scene accepts vertices beyond 1e18";
  for (const InstanceId id : wrong) {
    instances_.at(id).transforms = {Affine()};
    scene_.set_transform(id, {});
  }
  scene_.commit();
}

}  // namespace raysheaf::checks
