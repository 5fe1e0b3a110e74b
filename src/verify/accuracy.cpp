// The ray-triangle test beside exact arithmetic.
//
// With L the largest coordinate of a corner as seen from the ray's origin and u = 2^-24, two things
// are promised (docs/verify.md; geom/ray_end.h has the derivation):
//   1. the two disagree about a hit only where the ray passes an edge at less than sqrt(2) gamma(6)
//   L
//      across its dominant axis, or where the ray's origin is less than sqrt(3) gamma(34) L from
//      the triangle. (The line's points at both t are within gamma(34) L of it on every axis, and
//      so is all between them: where one t is negative and the other is not, the origin.)
//   2. of a hit, the point of the ray at t and the point of the triangle with weights u and v
//   differ
//      by at most 64 u L on every axis.
#include <algorithm>
#include <cmath>

#include "base/float.h"
#include "scene/flatten_body.h"
#include "verify/exact.h"
#include "verify/round.h"
#include "verify/soup.h"

namespace raysheaf::checks {
namespace {

using Wide = long double;
constexpr float kNone = std::numeric_limits<float>::infinity();
constexpr std::uint32_t kOrdinary = 2000, kAdversarial = 2000, kMostTriangles = 100;
constexpr Wide kFar = std::numeric_limits<Wide>::infinity();
constexpr Wide kPointBound = 64;  ///< in roundings of L
enum Place : std::size_t { kOrdinaryT, kOrdinaryU, kOrdinaryV, kT, kU, kV, kPoints, kPlaces };

using Corners = std::array<Vec3, 3>;

/// Everything as seen from the ray's origin.
struct Seen {
  Wide corner[3][3];  ///< [corner][axis]
  Wide direction[3];
  Wide size = 0;  ///< L
  int axis = 0;   ///< the dominant one

  Seen(const Ray& ray, const Corners& corners) {
    for (int k = 0; k < 3; ++k) {
      direction[k] = Wide{component(ray.direction, k)};
      if (std::fabs(direction[k]) > std::fabs(direction[axis])) axis = k;
      for (int i = 0; i < 3; ++i) {
        corner[i][k] = Wide{component(corners[i], k)} - Wide{component(ray.origin, k)};
        size = std::max(size, std::fabs(corner[i][k]));
      }
    }
  }

  /// A corner, moved along the ray into the plane across the dominant axis.
  [[nodiscard]] std::array<Wide, 2> sheared(int i) const {
    const Wide depth = corner[i][axis] / direction[axis];
    const int x = (axis + 1) % 3, y = (axis + 2) % 3;
    return {corner[i][x] - depth * direction[x], corner[i][y] - depth * direction[y]};
  }

  /// How far the ray passes from the nearest edge, in that plane.
  [[nodiscard]] Wide distance_to_edges() const {
    Wide least = kFar;
    for (int i = 0; i < 3; ++i) {
      const auto a = sheared(i), b = sheared((i + 1) % 3);
      const Wide x = b[0] - a[0], y = b[1] - a[1], length2 = x * x + y * y;
      const Wide s =
          length2 > 0 ? std::clamp(-(a[0] * x + a[1] * y) / length2, Wide{0}, Wide{1}) : 0;
      least = std::min(least, std::hypot(a[0] + s * x, a[1] + s * y));
    }
    return least;
  }

  /// Of the ray's origin from the triangle: from its plane where the nearest point is inside, from
  /// an edge where not.
  [[nodiscard]] Wide distance_to_triangle() const {
    const Wide(&a)[3] = corner[0];
    Wide e[3], f[3], ee = 0, ef = 0, ff = 0, ae = 0, af = 0, least = kFar;
    for (int k = 0; k < 3; ++k) {
      e[k] = corner[1][k] - a[k], f[k] = corner[2][k] - a[k];
      ee += e[k] * e[k], ef += e[k] * f[k], ff += f[k] * f[k], ae -= a[k] * e[k], af -= a[k] * f[k];
    }
    const Wide det = ee * ff - ef * ef;
    const Wide u = (ff * ae - ef * af) / det, v = (ee * af - ef * ae) / det;
    if (u >= 0 && v >= 0 && u + v <= 1)
      least = std::hypot(a[0] + u * e[0] + v * f[0], a[1] + u * e[1] + v * f[1],
                         a[2] + u * e[2] + v * f[2]);
    for (int i = 0; i < 3; ++i) least = std::min(least, distance_to_edge(i));
    return least;
  }

  /// Of the ray's origin from an edge, in space.
  [[nodiscard]] Wide distance_to_edge(int i) const {
    const Wide(&a)[3] = corner[i], (&b)[3] = corner[(i + 1) % 3];
    Wide along = 0, length2 = 0;
    for (int k = 0; k < 3; ++k) {
      along -= a[k] * (b[k] - a[k]);
      length2 += (b[k] - a[k]) * (b[k] - a[k]);
    }
    const Wide s = length2 > 0 ? std::clamp(along / length2, Wide{0}, Wide{1}) : 0;
    return std::hypot(a[0] + s * (b[0] - a[0]), a[1] + s * (b[1] - a[1]), a[2] + s * (b[2] - a[2]));
  }

  /// Between the ray's point and the triangle's, on the axis where they differ most.
  [[nodiscard]] Wide distance_of_points(const TriangleHit& hit) const {
    const Wide u = hit.u, v = hit.v, w = 1 - u - v;
    Wide most = 0;
    for (int k = 0; k < 3; ++k) {
      const Wide on_triangle = w * corner[0][k] + u * corner[1][k] + v * corner[2][k];
      most = std::max(most, std::fabs(Wide{hit.t} * direction[k] - on_triangle));
    }
    return most;
  }
};

/// In spacings of floats at the right value.
double error_in_ulps(float value, double right) {
  const float near = std::fabs(static_cast<float>(right));
  const float spacing = std::max(std::nextafter(near, kNone) - near, 0x1p-149f);
  return std::fabs(static_cast<double>(value) - right) / static_cast<double>(spacing);
}

class Judge {
 public:
  Judge(const Subject& subject, Tally* tally, std::vector<ErrorHistogram>* errors)
      : subject_(subject), tally_(tally), errors_(*errors) {}

  void look_at(const Ray& ray, const Corners& t, bool ordinary) {
    if (has_no_area(t[0], t[1], t[2])) return;
    tally_->tried(1);
    const ExactAnswer exact = exact_answer(ray, t[0], t[1], t[2]);
    const Seen seen(ray, t);
    TriangleHit hit{};
    const bool met = subject_.intersect(make_ray_setup(ray), t[0], t[1], t[2], &hit);
    if (met != (exact.meets && exact.t >= 0)) {
      if (!is_excused(seen)) fail(met ? "a hit that is none" : "a hit is missed", ray, t);
      return;
    }
    if (met) measure(ray, t, seen, exact, hit, ordinary);
  }

 private:
  static bool is_excused(const Seen& seen) {
    if (seen.distance_to_edges() <= std::sqrt(Wide{2}) * Wide{gamma(6)} * seen.size) return true;
    return seen.distance_to_triangle() <= std::sqrt(Wide{3}) * Wide{gamma(34)} * seen.size;
  }

  void measure(const Ray& ray, const Corners& t, const Seen& seen, const ExactAnswer& exact,
               const TriangleHit& hit, bool ordinary) {
    const std::size_t first = ordinary ? kOrdinaryT : kT;
    constexpr double kUnit = static_cast<double>(kUnitRoundoff);
    errors_[first].add(error_in_ulps(hit.t, exact.t));
    errors_[first + 1].add(std::fabs(double{hit.u} - exact.u) / kUnit);
    errors_[first + 2].add(std::fabs(double{hit.v} - exact.v) / kUnit);
    const Wide apart = seen.distance_of_points(hit) / (Wide{kUnitRoundoff} * seen.size);
    errors_[kPoints].add(static_cast<double>(apart));
    if (!(apart <= kPointBound))
      fail("t, u and v are " + std::to_string(static_cast<double>(apart)) + " roundings apart", ray,
           t);
  }

  void fail(const std::string& what, const Ray& ray, const Corners& t) {
    tally_->fail("the ray-triangle test: " + what + ": " + text_of(ray) + ", triangle " +
                 text_of(t[0]) + ", " + text_of(t[1]) + ", " + text_of(t[2]));
  }

  const Subject& subject_;
  Tally* tally_;
  std::vector<ErrorHistogram>& errors_;
};

/// Seen at more than 6 degrees, neither small nor thin, from a few of its sizes away.
void look_at_ordinary(Random* random, Judge* judge) {
  const Corners t{random->in_box(3), random->in_box(3), random->in_box(3)};
  const Vec3 normal = cross(t[1] - t[0], t[2] - t[0]);
  const Vec3 origin = random->in_box(10),
             aim = lerp(lerp(t[0], t[1], random->unit()), t[2], random->unit());
  const Ray ray{origin, 0, normalized(aim - origin) * random->between(0.1f, 4), kNone};
  const float facing = std::fabs(dot(normalized(normal), normalized(ray.direction)));
  if (facing < 0.1f || length(normal) < 1 || length(aim - origin) < 0.5f) return;
  judge->look_at(ray, t, true);
}

}  // namespace

std::vector<ErrorHistogram> empty_histograms() {
  std::vector<ErrorHistogram> all(kPlaces);
  const char* const names[kPlaces] = {"t, ordinary",
                                      "u, ordinary",
                                      "v, ordinary",
                                      "t, adversarial",
                                      "u, adversarial",
                                      "v, adversarial",
                                      "ray's point from triangle's point"};
  for (std::size_t i = 0; i < kPlaces; ++i) {
    all[i].what = names[i];
    all[i].unit = i == kPoints ? "2^-24 L" : i % 3 == 0 ? "ulp" : "2^-24";
  }
  return all;
}

void check_accuracy(const Subject& subject, std::uint64_t seed, Tally* tally,
                    std::vector<ErrorHistogram>* errors) {
  Random random(seed);
  Judge judge(subject, tally, errors);
  for (std::uint32_t i = 0; i < kOrdinary; ++i) look_at_ordinary(&random, &judge);
  const Soup soup = make_soup(kMostTriangles, {1e-18f, 1e15f, 1e6f}, &random);
  for (std::uint32_t i = 0; i < kAdversarial; ++i) {
    Ray ray = make_rays(soup, 1, &random).front();
    ray.t_min = 0, ray.t_max = kNone;
    const Corners t = soup.some_triangle(&random);
    if (random.one_in(2)) {  // at it, rather than at another one
      const Vec3 aim =
          random.one_in(2) ? t[0] : lerp(lerp(t[0], t[1], random.unit()), t[2], random.unit());
      if (max_component(abs(aim - ray.origin)) > 0) ray.direction = aim - ray.origin;
    }
    judge.look_at(ray, t, false);
  }
}

}  // namespace raysheaf::checks
