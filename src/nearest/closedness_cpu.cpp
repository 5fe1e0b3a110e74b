#include <bit>
#include <mutex>

#include "nearest/inside.h"

namespace raysheaf {
namespace {

/// W. Stafford's variant 13 of the finaliser of MurmurHash3, which is one to one.
std::uint64_t mixed(std::uint64_t x) {
  x = (x ^ x >> 30) * 0xbf58476d1ce4e5b9u;
  x = (x ^ x >> 27) * 0x94d049bb133111ebu;
  return x ^ x >> 31;
}

std::uint64_t hash_of(Vec3 p) {
  const auto bits = [](float x) { return std::uint64_t{std::bit_cast<std::uint32_t>(x + 0.0f)}; };
  return mixed(mixed(bits(p.x) | bits(p.y) << 32) + bits(p.z));
}

/// The sum over a surface's edges: the hash of each, with a sign for its direction.
struct EdgeSums {
  std::uint64_t winding = 0, uses = 0;

  void add(std::uint64_t a, std::uint64_t b) {
    if (a == b) return;
    const std::uint64_t edge = mixed((a < b ? a : b) * 0x9e3779b97f4a7c15u + (a < b ? b : a));
    winding += a < b ? edge : std::uint64_t{0} - edge;
    uses ^= edge;
  }
};

}  // namespace

Closedness closedness_of(const Executor& executor, const TriangleSource& source) {
  EdgeSums all;
  std::mutex mutex;
  executor.for_each_block(source.count, kCopyGrain, [&](std::size_t begin, std::size_t end) {
    EdgeSums sums;
    source.for_each_part(static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(end),
                         [&](const TriangleRun& run, std::uint32_t first, std::uint32_t stop) {
                           for (std::uint32_t i = first; i < stop; ++i) {
                             const std::array<Vec3, 3> t = run.corners(i);
                             const std::uint64_t a = hash_of(t[0]), b = hash_of(t[1]),
                                                 c = hash_of(t[2]);
                             sums.add(a, b);
                             sums.add(b, c);
                             sums.add(c, a);
                           }
                         });
    const std::lock_guard lock(mutex);
    all.winding += sums.winding;
    all.uses ^= sums.uses;
  });
  return {all.winding == 0, all.uses == 0};
}

}  // namespace raysheaf
