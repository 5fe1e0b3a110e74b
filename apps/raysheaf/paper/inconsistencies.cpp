#include <fmt/format.h>

#include "paper/findings.h"
#include "paper/sheets.h"

namespace raysheaf::app {
namespace {

/// Tests of `rah` at the top level, with two levels of branching 8.
std::uint64_t top_tests(std::uint64_t rays, std::uint64_t triangles) {
  const std::uint64_t leaves = (rays + 7) / 8;
  return (leaves + 7) / 8 * triangles;
}

}  // namespace

std::string inconsistencies() {
  constexpr std::uint64_t kSaidRays = 184'717, kSaidTriangles = 790;
  const PublishedTable& cornell = *published_table("cornell", Method::kRah, RayKind::kShadow);
  return fmt::format(
      "## Where the paper disagrees with itself\n\n"
      "| Where | What it says | What holds |\n|---|---|---|\n"
      "| CORNELL, shadow rays | {} | {}: only with this number are `rah`'s tests at the top {}, as "
      "in its table "
      "and in the authors' log; the number in the text would make {} |\n"
      "| CORNELL, triangles | {} | {}: six cubes of 12 triangles and a sphere of 720 |\n"
      "| Headings of tables 2 and 3 | OFFICE | CORNELL, by their counts |\n"
      "| Equation 1 | divides by a vector | divide by its length, unless it is 0; only if the "
      "direction lies outside the cone |\n"
      "| Equation 6 | a cosine of a sum of vectors | an angle: half the angle between the axes, "
      "plus the larger of the two spreads |\n"
      "| Equation 9 | an unsigned length along the axis | a signed one, for spreads below 90 "
      "degrees; "
      "beyond these, everything is accepted |\n",
      shown_count(kSaidRays), shown_count(cornell.rays),
      shown_count(top_tests(cornell.rays, cornell.triangles)),
      shown_count(top_tests(kSaidRays, cornell.triangles)), kSaidTriangles, cornell.triangles);
}

}  // namespace raysheaf::app
