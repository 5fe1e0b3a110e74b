// Compiled once for each SIMD target and chosen at run time (Google Highway).
#include <atomic>
#include <cmath>
#include <string>

#include "api/query_check.h"
#include "geom/ray_fault.h"
#include "raysheaf/error.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "api/query_check_simd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace raysheaf::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// Whether the first `count` rays are valid, as far as they fill vectors; `done` returns how many
/// were tested.
///
/// A ray is two quads of floats, x y z t: origin and t_min, direction and t_max. They are loaded
/// field by field, with origins in the even lanes and directions in the odd ones.
bool CheckRays(const Ray* rays, std::size_t count, std::size_t* done) {
  const hn::ScalableTag<float> d;
  const std::size_t step = hn::Lanes(d) / 2;
  *done = 0;
  if (hn::Lanes(d) < 2) return true;
  const auto largest = hn::Set(d, std::numeric_limits<float>::max());
  const auto zero = hn::Zero(d);
  const auto t_max_lanes = hn::Ne(hn::OddEven(hn::Set(d, 1.0f), zero), zero);
  auto wrong = hn::Ne(zero, zero);
  std::size_t i = 0;
  for (; i + step <= count; i += step) {
    auto x = zero, y = zero, z = zero, t = zero;
    hn::LoadInterleaved4(d, &rays[i].origin.x, x, y, z, t);
    x = hn::Abs(x), y = hn::Abs(y), z = hn::Abs(z);
    const auto finite =
        hn::And(hn::And(hn::Le(x, largest), hn::Le(y, largest)), hn::Le(z, largest));
    const auto somewhere = hn::Ne(hn::Max(hn::Max(x, y), z), zero);
    const auto ordered = hn::And(hn::Ge(t, zero), hn::Ge(t, hn::DupEven(t)));
    const auto right = hn::And(hn::And(finite, ordered), hn::Or(somewhere, hn::Not(t_max_lanes)));
    wrong = hn::Or(wrong, hn::Not(right));
  }
  *done = i;
  return hn::AllFalse(d, wrong);
}

}  // namespace raysheaf::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace raysheaf {
namespace {

HWY_EXPORT(CheckRays);

/// Items per task: 256 KiB.
constexpr std::size_t kGrain = 8192;

}  // namespace

bool are_right(View<const Ray> rays) {
  std::size_t i = 0;
  if (!HWY_DYNAMIC_DISPATCH(CheckRays)(rays.data, rays.size, &i)) return false;
  for (; i < rays.size; ++i)
    if (fault_of(rays[i]).field != nullptr) return false;
  return true;
}

void throw_fault(View<const Ray> rays, std::size_t first) {
  for (std::size_t i = 0; i < rays.size; ++i) {
    const RayFault fault = fault_of(rays[i]);
    if (fault.field != nullptr)
      throw Error(ErrorCode::kInvalidData, fault.sentence,
                  "rays[" + std::to_string(first + i) + "]." + fault.field);
  }
}

void check_rays(const Executor& executor, View<const Ray> rays) {
  std::atomic<bool> good{true};
  executor.for_each_block(rays.size, kGrain, [&](std::size_t begin, std::size_t end) {
    if (!are_right(rays.slice(begin, end - begin))) good.store(false, std::memory_order_relaxed);
  });
  if (!good) throw_fault(rays, 0);
}

}  // namespace raysheaf
#endif  // HWY_ONCE
