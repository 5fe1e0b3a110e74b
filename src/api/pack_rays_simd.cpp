// Compiled once for each SIMD target and chosen at run time (Google Highway).
#include <algorithm>
#include <cstring>
#include <limits>

#include "api/query_check.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "api/pack_rays_simd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace raysheaf::HWY_NAMESPACE {
namespace {
namespace hn = hwy::HWY_NAMESPACE;

constexpr std::size_t kFloatsPerRay = 8;
static_assert(sizeof(Ray) == kFloatsPerRay * sizeof(float));

template <class Number>
const Number* row_of(const NumberRows& rows, std::size_t i) {
  return static_cast<const Number*>(rows.data) + static_cast<std::ptrdiff_t>(i) * rows.row_stride;
}

/// Writes the three numbers of rows [begin, end) and `limit` as four consecutive floats of `out`,
/// with a stride of eight floats.
template <class Number>
void copy_triples(const NumberRows& rows, std::size_t begin, std::size_t end, float limit,
                  float* out) {
  for (; begin < end; ++begin, out += kFloatsPerRay) {
    const Number* const from = row_of<Number>(rows, begin);
    for (std::ptrdiff_t k = 0; k < 3; ++k)
      out[k] = static_cast<float>(from[k * rows.column_stride]);
    out[3] = limit;
  }
}

#if HWY_TARGET != HWY_SCALAR
HWY_INLINE hn::Vec<hn::Full128<float>> four(const float* from) {
  return hn::LoadU(hn::Full128<float>(), from);
}
HWY_INLINE hn::Vec<hn::Full128<float>> four(const double* from) {
  const hn::Full128<float> d;
#if HWY_MAX_BYTES >= 32
  return hn::DemoteTo(d, hn::LoadU(hn::FixedTag<double, 4>(), from));
#else
  const hn::Full128<double> dd;
  const hn::Half<hn::Full128<float>> half;
  return hn::Combine(d, hn::DemoteTo(half, hn::LoadU(dd, from + 2)),
                     hn::DemoteTo(half, hn::LoadU(dd, from)));
#endif
}

/// The same for contiguous rows. Reads four numbers at a time, so row `end` must exist.
template <class Number>
void copy_tight(const NumberRows& rows, std::size_t begin, std::size_t end, float limit,
                float* out) {
  const hn::Full128<float> d;
  const Number* from = row_of<Number>(rows, begin);
  const auto last = hn::Set(d, limit);
  const auto three = hn::FirstN(d, 3);
  for (; begin < end; ++begin, from += rows.row_stride, out += kFloatsPerRay)
    hn::StoreU(hn::IfThenElse(three, four(from), last), d, out);
}
#endif

template <class Number>
void copy_some_triples(const NumberRows& rows, std::size_t begin, std::size_t end,
                       [[maybe_unused]] bool more_follow, float limit, float* out) {
#if HWY_TARGET != HWY_SCALAR
  if (rows.column_stride == 1 && rows.row_stride >= 1 && begin < end) {
    const std::size_t last = more_follow ? end : end - 1;
    copy_tight<Number>(rows, begin, last, limit, out);
    out += kFloatsPerRay * (last - begin);
    begin = last;
  }
#endif
  copy_triples<Number>(rows, begin, end, limit, out);
}

void copy_triples(const NumberRows& rows, std::size_t begin, std::size_t end, bool more_follow,
                  float limit, float* out) {
  if (rows.is_double)
    copy_some_triples<double>(rows, begin, end, more_follow, limit, out);
  else
    copy_some_triples<float>(rows, begin, end, more_follow, limit, out);
}

template <class Number>
void copy_limits(const NumberRows& rows, std::size_t begin, std::size_t end, float* out) {
  for (; begin < end; ++begin, out += kFloatsPerRay)
    *out = static_cast<float>(*row_of<Number>(rows, begin));
}

void copy_limits(const NumberRows& rows, std::size_t begin, std::size_t end, float* out) {
  if (rows.is_double)
    copy_limits<double>(rows, begin, end, out);
  else
    copy_limits<float>(rows, begin, end, out);
}

/// Whether all rays of a block have the same limit.
bool is_one(const NumberRows& rows) {
  return rows.data == nullptr || rows.row_stride == 0;
}
float first_of(const NumberRows& rows, float otherwise) {
  if (rows.data != nullptr) copy_limits(rows, 0, 1, &otherwise);
  return otherwise;
}

/// Rays of one block.
void pack_block(const RayParts& parts, std::size_t begin, std::size_t end, Ray* out) {
  constexpr std::size_t kStep = 512;  // rays that stay in the first-level cache while their parts
                                      // are written
  const float t_min = first_of(parts.t_min, 0);
  const float t_max = first_of(parts.t_max, std::numeric_limits<float>::infinity());
  for (; begin < end; begin += kStep, out += kStep) {
    const std::size_t stop = std::min(end, begin + kStep);
    const bool more_follow = stop < parts.count;
    float* const numbers = &out->origin.x;
    // Individual limits are written after the triples, which overwrite their places.
    copy_triples(parts.origins, begin, stop, more_follow, t_min, numbers);
    copy_triples(parts.directions, begin, stop, more_follow, t_max, numbers + 4);
    if (!is_one(parts.t_min)) copy_limits(parts.t_min, begin, stop, numbers + 3);
    if (!is_one(parts.t_max)) copy_limits(parts.t_max, begin, stop, numbers + 7);
  }
}

NumberRows rows_of_block(NumberRows rows, std::size_t block) {
  const std::ptrdiff_t skipped = static_cast<std::ptrdiff_t>(block) * rows.block_stride;
  if (rows.data == nullptr) return rows;
  rows.data = rows.is_double
                  ? static_cast<const void*>(static_cast<const double*>(rows.data) + skipped)
                  : static_cast<const void*>(static_cast<const float*>(rows.data) + skipped);
  return rows;
}

void PackRays(const RayParts& parts, std::size_t begin, std::size_t end, Ray* out) {
  if (begin == end) return;
  if (parts.block == 0) return pack_block(parts, begin, end, out);
  while (begin < end) {
    const std::size_t block = begin / parts.block, first = block * parts.block;
    const std::size_t stop = std::min(end, first + parts.block);
    const auto of = [&](const NumberRows& rows) { return rows_of_block(rows, block); };
    const RayParts one(std::min(parts.block, parts.count - first), of(parts.origins),
                       of(parts.directions), of(parts.t_min), of(parts.t_max));
    pack_block(one, begin - first, stop - first, out);
    out += stop - begin;
    begin = stop;
  }
}

}  // namespace
}  // namespace raysheaf::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace raysheaf {

HWY_EXPORT(PackRays);

void pack_rays(const RayParts& parts, std::size_t begin, std::size_t end, Ray* out) {
  HWY_DYNAMIC_DISPATCH(PackRays)(parts, begin, end, out);
}

}  // namespace raysheaf
#endif  // HWY_ONCE
