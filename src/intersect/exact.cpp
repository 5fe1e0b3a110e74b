#include "intersect/exact.h"

#include <cmath>

namespace raysheaf::checks {
namespace {

/// A sum of at most `kMost` binary64 numbers that do not overlap, by ascending magnitude, without
/// zeros.
template <std::size_t kMost>
struct Expansion {
  std::array<double, kMost> parts;
  std::size_t count = 0;

  /// Shewchuk's Grow-Expansion, with Knuth's exact sum: x + y = sum + rest.
  void add(double x) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const double y = parts[i], sum = x + y, y_part = sum - x, x_part = sum - y_part;
      const double rest = (x - x_part) + (y - y_part);
      if (rest != 0) parts[kept++] = rest;
      x = sum;
    }
    count = kept;
    if (x != 0) parts[count++] = x;
  }

  [[nodiscard]] double value() const {
    double total = 0;
    for (std::size_t i = 0; i < count; ++i) total += parts[i];
    return total;
  }
};

template <std::size_t N, std::size_t M>
Expansion<N + M> difference(const Expansion<N>& e, const Expansion<M>& f) {
  Expansion<N + M> result;
  for (std::size_t i = 0; i < e.count; ++i) result.add(e.parts[i]);
  for (std::size_t i = 0; i < f.count; ++i) result.add(-f.parts[i]);
  return result;
}

template <std::size_t N, std::size_t M>
Expansion<2 * N * M> product(const Expansion<N>& e, const Expansion<M>& f) {
  Expansion<2 * N * M> result;
  for (std::size_t i = 0; i < e.count; ++i)
    for (std::size_t j = 0; j < f.count; ++j) {
      const double high = e.parts[i] * f.parts[j];
      result.add(std::fma(e.parts[i], f.parts[j], -high));
      result.add(high);
    }
  return result;
}

struct ExactVector {
  Expansion<2> x, y, z;
  explicit ExactVector(const Row& r)
      : x(between(r.to.x, r.from.x)), y(between(r.to.y, r.from.y)), z(between(r.to.z, r.from.z)) {}

 private:
  static Expansion<2> between(float to, float from) {
    Expansion<2> result;
    result.add(double{to});
    result.add(-double{from});
    return result;
  }
};

double by_expansions(const Rows& rows) {
  const ExactVector a(rows[0]), b(rows[1]), c(rows[2]);
  const auto yz = difference(product(b.y, c.z), product(b.z, c.y));
  const auto zx = difference(product(b.z, c.x), product(b.x, c.z));
  const auto xy = difference(product(b.x, c.y), product(b.y, c.x));
  Expansion<192> total;
  for (const Expansion<64>& term : {product(a.x, yz), product(a.y, zx), product(a.z, xy)})
    for (std::size_t i = 0; i < term.count; ++i) total.add(term.parts[i]);
  return total.value();
}

struct RoundedVector {
  double x, y, z;
  explicit RoundedVector(const Row& r)
      : x(double{r.to.x} - double{r.from.x}),
        y(double{r.to.y} - double{r.from.y}),
        z(double{r.to.z} - double{r.from.z}) {}
};

struct Rounded {
  double value, error;  ///< the exact value is at most `error` away

  explicit Rounded(const Rows& rows) {
    const RoundedVector a(rows[0]), b(rows[1]), c(rows[2]);
    const double yz = b.y * c.z, zy = b.z * c.y, zx = b.z * c.x, xz = b.x * c.z, xy = b.x * c.y,
                 yx = b.y * c.x;
    value = a.x * (yz - zy) + a.y * (zx - xz) + a.z * (xy - yx);
    const double magnitude = std::fabs(a.x) * (std::fabs(yz) + std::fabs(zy)) +
                             std::fabs(a.y) * (std::fabs(zx) + std::fabs(xz)) +
                             std::fabs(a.z) * (std::fabs(xy) + std::fabs(yx));
    // A term passes through three differences of coordinates, two products, a difference and two
    // sums: 8 roundings of at most 2^-53. `magnitude` and its product here have as many roundings,
    // which are far less than the remaining 2 of 10.
    error = magnitude * (10 * 0x1p-53);
  }
};

}  // namespace

double determinant(const Rows& rows) {
  const Rounded rounded(rows);
  if (std::fabs(rounded.value) * 0x1p-40 >= rounded.error) return rounded.value;
  return by_expansions(rows);
}

int sign_of_determinant(const Rows& rows) {
  const Rounded rounded(rows);
  const double value =
      std::fabs(rounded.value) > rounded.error ? rounded.value : by_expansions(rows);
  return value > 0 ? 1 : value < 0 ? -1 : 0;
}

namespace {

/// The rows of the edge functions opposite a, b and c.
std::array<Rows, 3> edge_rows(const Ray& ray, Vec3 a, Vec3 b, Vec3 c) {
  const Row d{ray.direction, {}}, oa{a, ray.origin}, ob{b, ray.origin}, oc{c, ray.origin};
  return {Rows{d, ob, oc}, Rows{d, oc, oa}, Rows{d, oa, ob}};
}

/// The sign that the nonzero edge functions share, which is that of their sum, det. 0 if two are
/// opposite, and if all are zero: the line then lies in the triangle's plane, or the triangle has
/// no area.
int shared_sign(int w, int u, int v) {
  const bool some_positive = w > 0 || u > 0 || v > 0, some_negative = w < 0 || u < 0 || v < 0;
  return static_cast<int>(some_positive) - static_cast<int>(some_negative);
}

}  // namespace

bool meets_exactly(const Ray& ray, Vec3 a, Vec3 b, Vec3 c) {
  const std::array<Rows, 3> rows = edge_rows(ray, a, b, c);
  const int w = sign_of_determinant(rows[0]), u = sign_of_determinant(rows[1]);
  if (w * u < 0) return false;
  const int side = shared_sign(w, u, sign_of_determinant(rows[2]));
  if (side == 0) return false;
  const Row oa{a, ray.origin}, ob{b, ray.origin}, oc{c, ray.origin};
  return side * sign_of_determinant({oa, ob, oc}) >= 0;
}

}  // namespace raysheaf::checks

namespace raysheaf {

ExactAnswer exact_answer(const Ray& ray, Vec3 a, Vec3 b, Vec3 c) {
  using checks::determinant, checks::Row;
  ExactAnswer answer;
  const double det = determinant({Row{ray.direction, {}}, Row{b, a}, Row{c, a}});
  if (det == 0) return answer;
  const auto rows = checks::edge_rows(ray, a, b, c);
  const double w = determinant(rows[0]), u = determinant(rows[1]), v = determinant(rows[2]);
  const auto agrees = [det](double weight) { return det > 0 ? weight >= 0 : weight <= 0; };
  answer.meets = agrees(u) && agrees(v) && agrees(w);
  answer.front = det < 0;
  const double t = determinant({Row{a, ray.origin}, Row{b, ray.origin}, Row{c, ray.origin}});
  answer.t = t / det + 0.0;  // not -0
  answer.u = u / det + 0.0;
  answer.v = v / det + 0.0;
  return answer;
}

}  // namespace raysheaf
