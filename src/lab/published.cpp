// Sources. Totals, the tests at the top of `rah`, and every count of CORNELL's shadow rays: tables
// 1 to 4, and the authors' own log, which agrees with them to the count. Hits of `rah` in OFFICE
// and SPONZA: the tables, in units of ten thousand. `crsh` in SPONZA: one mesh, so that its tests
// at the top are those of `rah`. `crsh` in OFFICE: half of the total is level 1, 43 % the final
// tests, and 92.5 % of the tests at the top hit, each to half a percent. Times: the log.
#include "raysheaf/published.h"

namespace raysheaf {
namespace {

constexpr PublishedCount exact(std::uint64_t count) {
  return {count, false};
}
constexpr PublishedCount about(std::uint64_t count) {
  return {count, true};
}
constexpr PublishedCount kUnknown{};

/// The tests of a level are eight times the hits of the one above.
std::vector<PublishedLevel> two_levels(std::uint64_t top_tests, std::uint64_t top_hits,
                                       std::uint64_t leaf_hits) {
  return {{2, exact(top_tests), about(top_hits)}, {1, about(8 * top_hits), about(leaf_hits)}};
}

PublishedTable table(std::string_view scene, Method method, RayKind kind, std::uint64_t rays,
                     std::uint64_t triangles, std::uint64_t total,
                     std::vector<PublishedLevel> levels = {}) {
  PublishedTable t;
  t.scene = scene;
  t.method = method;
  t.kind = kind;
  t.bounces = kind == RayKind::kReflection ? 2 : 1;
  t.rays = rays;
  t.triangles = triangles;
  t.total = total;
  t.levels = std::move(levels);
  return t;
}

std::vector<PublishedTable> office() {
  constexpr std::uint64_t kRays = 251'546, kTriangles = 36'308;
  const auto shadow = [](Method method, std::uint64_t total,
                         std::vector<PublishedLevel> levels = {}) {
    return table("office", method, RayKind::kShadow, kRays, kTriangles, total, std::move(levels));
  };
  return {shadow(Method::kBrute, kRays * kTriangles),
          shadow(Method::kRah, 469'683'524, two_levels(142'726'748, 25'250'000, 15'620'000)),
          shadow(Method::kCrsh, 170'070'948,
                 {{2, about(11'490'000), about(10'630'000)},
                  {1, about(85'040'000), about(9'140'000)}})};
}

std::vector<PublishedTable> sponza() {
  constexpr std::uint64_t kRays = 256'713, kTriangles = 66'450;
  const auto shadow = [](Method method, std::uint64_t total,
                         std::vector<PublishedLevel> levels = {}) {
    return table("sponza", method, RayKind::kShadow, kRays, kTriangles, total, std::move(levels));
  };
  return {shadow(Method::kBrute, kRays * kTriangles),
          shadow(Method::kRah, 632'408'864, two_levels(266'597'400, 32'690'000, 13'040'000)),
          shadow(Method::kCrsh, 405'619'896, {{2, exact(266'597'400), kUnknown}})};
}

std::vector<PublishedTable> cornell_shadow() {
  constexpr std::uint64_t kRays = 242'015, kTriangles = 792;
  const auto shadow = [](Method method, std::uint64_t total,
                         std::vector<PublishedLevel> levels = {}) {
    return table("cornell", method, RayKind::kShadow, kRays, kTriangles, total, std::move(levels));
  };
  PublishedTable rah =
      shadow(Method::kRah, 20'655'416,
             {{2, exact(2'995'344), exact(645'954)}, {1, exact(5'167'632), exact(1'561'555)}});
  rah.times_ms = {0.625 + 0.275, std::nullopt, 2.055, 12.33, 13.53};
  PublishedTable crsh =
      shadow(Method::kCrsh, 14'284'296,
             {{2, exact(750'384), exact(296'987)}, {1, exact(2'375'896), exact(1'394'752)}});
  crsh.times_ms = {0.712 + 0.477, 0.665 + 0.825 + 2.953, 2.355, std::nullopt, std::nullopt};
  return {shadow(Method::kBrute, kRays * kTriangles), rah, crsh};
}

std::vector<PublishedTable> cornell_reflection() {
  constexpr std::uint64_t kRays = 524'288, kTriangles = 792;
  const auto reflection = [](Method method, std::uint64_t total,
                             std::vector<PublishedLevel> levels = {}) {
    return table("cornell", method, RayKind::kReflection, kRays, kTriangles, total,
                 std::move(levels));
  };
  return {reflection(Method::kBrute, kRays * kTriangles),
          reflection(Method::kRah, 52'214'232, {{2, exact(6'488'064), kUnknown}}),
          reflection(Method::kCrsh, 39'293'896)};
}

std::vector<PublishedTable> all_tables() {
  std::vector<PublishedTable> all;
  for (const auto& part : {office(), cornell_shadow(), cornell_reflection(), sponza()})
    all.insert(all.end(), part.begin(), part.end());
  return all;
}

}  // namespace

const std::vector<PublishedTable>& published_tables() {
  static const std::vector<PublishedTable> all = all_tables();
  return all;
}

const PublishedTable* published_table(std::string_view scene, Method method, RayKind kind) {
  for (const PublishedTable& t : published_tables())
    if (t.scene == scene && t.method == method && t.kind == kind) return &t;
  return nullptr;
}

}  // namespace raysheaf
