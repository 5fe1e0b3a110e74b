#include "verify/exact.h"

#include <cmath>
#include <limits>
#include <vector>

namespace raysheaf::checks {
namespace {

/// A sum of binary64 numbers that do not overlap, by ascending magnitude, without zeros.
using Expansion = std::vector<double>;

/// x + y = *sum + *rest, exactly (Knuth).
void two_sum(double x, double y, double* sum, double* rest) {
  *sum = x + y;
  const double y_part = *sum - x, x_part = *sum - y_part;
  *rest = (x - x_part) + (y - y_part);
}

void add(double x, Expansion* e) {
  std::size_t kept = 0;
  for (const double part : *e) {
    double rest;
    two_sum(x, part, &x, &rest);
    if (rest != 0) (*e)[kept++] = rest;
  }
  e->resize(kept);
  if (x != 0) e->push_back(x);
}

Expansion sum(Expansion e, const Expansion& f) {
  for (const double part : f) add(part, &e);
  return e;
}

Expansion product(const Expansion& e, const Expansion& f) {
  Expansion result;
  for (const double x : e)
    for (const double y : f) {
      const double high = x * y;
      add(std::fma(x, y, -high), &result);
      add(high, &result);
    }
  return result;
}

Expansion negated(Expansion e) {
  for (double& part : e) part = -part;
  return e;
}

Expansion difference(float x, float y) {
  return sum({static_cast<double>(x)}, {-static_cast<double>(y)});
}

double value(const Expansion& e) {
  double total = 0;
  for (const double part : e) total += part;
  return total;
}

struct ExactVector {
  Expansion x, y, z;
  explicit ExactVector(const Row& r)
      : x(difference(r.to.x, r.from.x)),
        y(difference(r.to.y, r.from.y)),
        z(difference(r.to.z, r.from.z)) {}
};

double by_expansions(const Rows& rows) {
  const ExactVector a(rows[0]), b(rows[1]), c(rows[2]);
  const auto minor = [](const Expansion& e, const Expansion& f, const Expansion& g,
                        const Expansion& h) { return sum(product(e, f), negated(product(g, h))); };
  Expansion total = product(a.x, minor(b.y, c.z, b.z, c.y));
  total = sum(std::move(total), product(a.y, minor(b.z, c.x, b.x, c.z)));
  total = sum(std::move(total), product(a.z, minor(b.x, c.y, b.y, c.x)));
  return value(total);
}

using Wide = long double;

struct WideVector {
  Wide x, y, z;
  explicit WideVector(const Row& r)
      : x(Wide{r.to.x} - Wide{r.from.x}),
        y(Wide{r.to.y} - Wide{r.from.y}),
        z(Wide{r.to.z} - Wide{r.from.z}) {}
};

}  // namespace

double determinant(const Rows& rows) {
  const WideVector a(rows[0]), b(rows[1]), c(rows[2]);
  const Wide yz = b.y * c.z, zy = b.z * c.y, zx = b.z * c.x, xz = b.x * c.z, xy = b.x * c.y,
             yx = b.y * c.x;
  const Wide result = a.x * (yz - zy) + a.y * (zx - xz) + a.z * (xy - yx);
  const Wide magnitude = std::fabs(a.x) * (std::fabs(yz) + std::fabs(zy)) +
                         std::fabs(a.y) * (std::fabs(zx) + std::fabs(xz)) +
                         std::fabs(a.z) * (std::fabs(xy) + std::fabs(yx));
  // Three differences, two products, a difference and two sums: 9 roundings, each of half an
  // epsilon, with a little room.
  const Wide error = magnitude * (8 * std::numeric_limits<Wide>::epsilon());
  if (std::fabs(result) * 0x1p-40l >= error) return static_cast<double>(result);
  return by_expansions(rows);
}

}  // namespace raysheaf::checks

namespace raysheaf {

ExactAnswer exact_answer(const Ray& ray, Vec3 a, Vec3 b, Vec3 c) {
  using checks::determinant, checks::Row;
  const Row direction{ray.direction, {0, 0, 0}};
  const auto seen = [&](Vec3 p) { return Row{p, ray.origin}; };
  ExactAnswer answer;
  const double det = determinant({direction, Row{b, a}, Row{c, a}});
  if (det == 0) return answer;
  const double w = determinant({direction, seen(b), seen(c)});
  const double u = determinant({direction, seen(c), seen(a)});
  const double v = determinant({direction, seen(a), seen(b)});
  const auto agrees = [det](double weight) { return det > 0 ? weight >= 0 : weight <= 0; };
  answer.meets = agrees(u) && agrees(v) && agrees(w);
  answer.t = determinant({seen(a), seen(b), seen(c)}) / det;
  answer.u = u / det;
  answer.v = v / det;
  return answer;
}

}  // namespace raysheaf
