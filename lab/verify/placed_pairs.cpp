#include "lab/verify/placed_pairs.h"

#include <algorithm>
#include <cmath>

#include "lab/verify/maps.h"
#include "lab/verify/soup.h"
#include "scene/placing.h"

namespace raysheaf::checks {
namespace {

/// In whole numbers, where those of the triangle may be, or of its size.
Vec3 some_translation(float size, Random* random) {
  switch (random->below(4)) {
    case 0:
      return {};
    case 1: {
      const Vec3 by = random->in_box(9);
      return {std::round(by.x), std::round(by.y), std::round(by.z)};
    }
    case 2:
      return random->in_box(2) * size;
    default: {
      const float far = size * random->magnitude(0, 5);
      return random->direction() * far;
    }
  }
}

std::vector<Affine> some_motion(float size, bool moves, Random* random) {
  const auto stand = [&] {
    const Vec3 by = some_translation(size, random);
    return compose(translation(by), some_map(random));
  };
  std::vector<Affine> transforms{stand()};
  if (!moves || random->one_in(5)) return transforms;
  for (std::uint32_t more = 1 + random->below(3); more > 0; --more) {
    Affine next = transforms.back();
    if (random->one_in(2)) next = compose(translation(random->in_box(1) * (0.1f * size)), next);
    transforms.push_back(random->one_in(2) ? stand() : next);
  }
  return transforms;
}

/// The ray of the pair where the transform takes it, or one at a point of the placed triangle.
Ray some_ray(const Ray& ray, const Affine& map, const std::array<Vec3, 3>& corners,
             Random* random) {
  Ray seen = ray;
  if (random->one_in(4)) {
    const Vec3 corner = corners[random->below(3)];
    const float far = max_component(abs(corners[1] - corners[0])) * random->magnitude(-3, 6);
    seen.origin = corner + random->in_box(far);
  } else {
    seen.origin = placed(map, ray.origin);
    seen.direction = transform_vector(map, ray.direction);
    if (random->one_in(2) && is_legal(seen)) return seen;
  }
  seen.direction = point_of(corners, random) - seen.origin;
  return seen;
}

bool may_enter(const PlacedPair& pair) {
  Box box;
  for (const Vec3 p : pair.mesh) box.min = min(box.min, p), box.max = max(box.max, p);
  return make_placing(pair.transforms.front(), box).may_enter;
}

}  // namespace

PlacedPair make_placed_pair(bool moves, Random* random) {
  const std::span<const PairFamily> families = pair_families();
  for (;;) {
    const PairFamily& family = families[random->below(static_cast<std::uint32_t>(families.size()))];
    const RayAndTriangle pair = family.make(random);
    PlacedPair made{family.name, pair.corners, {}, 0, pair, false};
    float size = 0;
    for (const Vec3 p : made.mesh) size = std::max(size, max_component(abs(p)));
    made.transforms = some_motion(size, moves, random);
    if (moves) made.time = some_time(random);
    if (!surely_stays(std::array{Affine()}, size) || !surely_stays(made.transforms, size)) continue;
    if (!moves && !may_enter(made)) continue;
    const Affine map = mixed_at(made.transforms, made.time);
    made.mirrored = is_mirrored(map);
    for (Vec3& p : made.seen.corners) p = placed(map, p);
    made.seen.ray = some_ray(pair.ray, map, made.seen.corners, random);
    if (is_legal(made.seen.ray)) return made;
  }
}

}  // namespace raysheaf::checks
