// A lidar in one query, while a robot arm moves: each ray has a time, and meets the arm where it is
// then. One call moves all links.
#include <raysheaf/query.h>

#include <cmath>
#include <cstdio>
#include <numbers>
#include <vector>

namespace {

using raysheaf::Affine;
using raysheaf::InstanceId;
using raysheaf::MeshId;
using raysheaf::Ray;
using raysheaf::Scene;
using raysheaf::Triangle;
using raysheaf::Vec3;

constexpr int kLinks = 3;
constexpr int kMoments = 33;   // transforms of a link during the sweep
constexpr float kLength = 2;   // of a link, along x from its joint
constexpr float kTurn = 0.8f;  // radians by which the first joint turns during the sweep
constexpr int kColumns = 720, kRings = 16;

/// The link in its own frame: a box from its joint to the next one.
MeshId add_link(Scene* scene) {
  constexpr float kThick = 0.1f;
  std::vector<Vec3> corners;
  for (int i = 0; i < 8; ++i)
    corners.push_back({(i & 1) != 0 ? kLength : 0.0f, (i & 2) != 0 ? kThick : -kThick,
                       (i & 4) != 0 ? kThick : -kThick});
  const std::vector<Triangle> sides{{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6},
                                    {0, 1, 5}, {0, 5, 4}, {2, 6, 7}, {2, 7, 3},
                                    {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return scene->add(corners, sides, {.place = false});
}

/// Forward kinematics: where the links are at a time from 0 to 1. The first joint turns, the others
/// are bent and hold still.
std::vector<Affine> places(float time) {
  std::vector<Affine> links;
  float x = 0, y = 0, angle = kTurn * time;
  for (int link = 0; link < kLinks; ++link) {
    Affine place;
    place.m[0][0] = place.m[1][1] = std::cos(angle);
    place.m[1][0] = std::sin(angle);
    place.m[0][1] = -place.m[1][0];
    place.m[0][3] = x;
    place.m[1][3] = y;
    links.push_back(place);
    x += kLength * std::cos(angle);
    y += kLength * std::sin(angle);
    angle += 0.5f;
  }
  return links;
}

/// The rays of a sweep from above the first joint, column by column, and the time of each.
void make_sweep(std::vector<Ray>* rays, std::vector<float>* times) {
  for (int column = 0; column < kColumns; ++column) {
    const float time = static_cast<float>(column) / kColumns;
    const float azimuth = 2 * std::numbers::pi_v<float> * time;
    for (int ring = 0; ring < kRings; ++ring) {
      const float elevation = -0.1f - 0.05f * static_cast<float>(ring);
      const float flat = std::cos(elevation);
      rays->push_back({{-1, -1, 1.5f},
                       0,
                       {flat * std::cos(azimuth), flat * std::sin(azimuth), std::sin(elevation)}});
      times->push_back(time);
    }
  }
}

}  // namespace

int main() {
  using namespace raysheaf;
  Scene scene;
  const MeshId link = add_link(&scene);
  std::vector<InstanceId> links;
  for (int i = 0; i < kLinks; ++i) links.push_back(scene.instance(link, Affine{}));

  // The transforms of a link at all moments stand together.
  std::vector<Affine> moments(std::size_t{kLinks} * kMoments);
  for (int moment = 0; moment < kMoments; ++moment) {
    const std::vector<Affine> now = places(static_cast<float>(moment) / (kMoments - 1));
    for (int i = 0; i < kLinks; ++i) moments[std::size_t(i) * kMoments + moment] = now[i];
  }
  scene.set_transforms(links, moments, kMoments);
  scene.commit();

  std::vector<Ray> rays;
  std::vector<float> times;
  make_sweep(&rays, &times);
  QueryOptions options;
  options.ray_times = times;
  const std::vector<Hit> hits = closest_hit(scene, rays, options);

  // The same, column by column: move the arm to where it is then, and ask.
  int met = 0, different = 0;
  for (int column = 0; column < kColumns; ++column) {
    const std::size_t first = std::size_t(column) * kRings;
    for (int i = 0; i < kLinks; ++i) {
      const std::span<const Affine> all(moments);
      scene.set_transform(
          links[i], transform_at(all.subspan(std::size_t(i) * kMoments, kMoments), times[first]));
    }
    scene.commit();
    const std::span<const Ray> some(rays.data() + first, kRings);
    const std::vector<Hit> there = closest_hit(scene, some);
    for (int ring = 0; ring < kRings; ++ring) {
      const Hit& hit = hits[first + ring];
      if (hit.prim_id != kInvalidId) ++met;
      if (hit.t != there[ring].t || hit.inst_id != there[ring].inst_id) ++different;
    }
  }
  std::printf("%d of %d rays met the arm, and %d otherwise than column by column\n", met,
              kColumns * kRings, different);
}
