// Compares every method on every SIMD target with the correct answers.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "intersect/intersect_list.h"
#include "lab/verify/round.h"
#include "lab/verify/soup.h"

namespace raysheaf::checks {

/// Triangles, rays, and the hits that every method must report.
struct Problem {
  Soup soup;
  std::vector<Ray> rays;
  HitRows rows;  ///< sorted by (t, geom_id, inst_id, prim_id)

  [[nodiscard]] Hit closest(std::size_t ray) const {
    return rows[ray].empty() ? Hit{} : rows[ray].front();
  }
  /// For methods that number triangles consecutively, in the order of the meshes.
  [[nodiscard]] Hit hit_of(std::uint32_t triangle, float t, float u, float v) const;
};

/// Integer meshes in three of four cases, or a soup of any kind and scale; without rows.
void make_exact_problem(std::uint32_t most_triangles, std::size_t rays, Random* random,
                        Problem* problem);

/// Computes the rows by the library's brute force.
void solve_by_brute_force(const Context& context, Problem* problem);

/// Computes the rows by exact arithmetic, which decides which triangles are hit; t, u and v are
/// those of `subject.intersect`, or of the test if that misses. Adds failures to `tally` if they
/// are wrong.
void solve_exactly(const Subject& subject, Problem* problem, Tally* tally);

/// Compares one way of answering a problem, and reports one difference per call, with the ray, the
/// triangles, the expected and the actual answer.
class Comparison {
 public:
  static constexpr std::size_t kAll = ~std::size_t{0};

  /// `note` is asked for each reported ray, and appended.
  Comparison(const Problem& problem, std::string way, Tally* tally,
             std::function<std::string(std::size_t ray)> note = {})
      : problem_(problem), way_(std::move(way)), tally_(tally), note_(std::move(note)) {}

  void closest(const std::vector<Hit>& hits);
  void any(const std::vector<std::uint8_t>& occluded);
  /// The first `most` of each row.
  void all(const HitRows& rows, const char* question = "all_hits", std::size_t most = kAll);
  void counts(const std::vector<std::uint32_t>& counts);
  /// By number, without u and v.
  void closest(const std::vector<RayHit>& hits);

 private:
  [[nodiscard]] std::string text(const Hit& hit) const;
  void fail(const char* question, std::size_t ray, const Hit& got);
  void fail(const char* question, std::size_t ray, const std::string& got,
            const std::string& expected);

  const Problem& problem_;
  std::string way_;
  Tally* tally_;
  std::function<std::string(std::size_t)> note_;
};

/// "dual on AVX2, 2 threads"
[[nodiscard]] std::string way(const std::string& method, std::int64_t target,
                              std::uint32_t threads);

enum class ThreadCounts : bool { kMost, kAll };

/// Closest hits, any hits and all hits of the library's methods, and closest hits of the renderer's
/// five. Reports the first difference of each. Returns how many answers were compared.
std::uint64_t compare_every_way(const Subject& subject, const Problem& problem, ThreadCounts counts,
                                Random* random, Tally* tally);

}  // namespace raysheaf::checks
