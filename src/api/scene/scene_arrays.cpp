#include "api/scene/scene_arrays.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <utility>

#include "raysheaf/error.h"
#include "scene/transform_points.h"

namespace raysheaf {
namespace {

constexpr std::size_t kMostItems = 0x7fffffff;

// The loops below have no branches, so that the compiler vectorizes them; a second pass locates an
// error.

bool check_coordinates(const float* in, std::size_t count) {
  std::uint32_t wrong = 0;
  for (std::size_t i = 0; i < count; ++i) wrong |= std::fabs(in[i]) <= kLargestCoordinate ? 0u : 1u;
  return wrong == 0;
}

bool check_indices(const std::uint32_t* in, std::size_t count, std::uint32_t limit) {
  std::uint32_t wrong = 0;
  for (std::size_t i = 0; i < count; ++i) wrong |= in[i] < limit ? 0u : 1u;
  return wrong == 0;
}

/// Copies by `copied(item)`, and validates the copy by `check(out, count)` while it is in the
/// first-level cache, because another thread may write to `in` at any time.
template <class Item, class Copied, class Check>
bool copy_checked(const Item* in, std::size_t count, Item* out, const Copied& copied,
                  const Check& check) {
  constexpr std::size_t kAtOnce = 2048;
  bool good = true;
  for (std::size_t begin = 0; begin < count; begin += kAtOnce) {
    const std::size_t end = std::min(count, begin + kAtOnce);
    for (std::size_t i = begin; i < end; ++i) out[i] = copied(in[i]);
    std::atomic_signal_fence(std::memory_order_seq_cst);  // prevents the compiler from reading `in`
                                                          // again
    good = check(out + begin, end - begin) && good;
  }
  return good;
}

/// Adding 0 turns -0 into +0, as the identity transform does (base/vec.h).
bool copy_coordinates(const float* in, std::size_t count, float* out) {
  return copy_checked(
      in, count, out, [](float x) { return x + 0.0f; }, check_coordinates);
}

bool copy_indices(const std::uint32_t* in, std::size_t count, std::uint32_t limit,
                  std::uint32_t* out) {
  return copy_checked(
      in, count, out, [](std::uint32_t index) { return index; },
      [&](const std::uint32_t* some, std::size_t n) { return check_indices(some, n, limit); });
}

/// Whether `body(begin, end)` returns true for all blocks of [0, count).
template <class Body>
bool all_blocks(const Executor& executor, std::size_t count, const Body& body) {
  std::atomic<bool> good{true};
  executor.for_each_block(count, kCopyGrain, [&](std::size_t begin, std::size_t end) {
    if (!body(begin, end)) good.store(false, std::memory_order_relaxed);
  });
  return good;
}

std::string element(const std::string& place, const char* field, std::size_t i) {
  return place + "." + field + "[" + std::to_string(i) + "]";
}

[[noreturn]] void throw_changed(const std::string& place, const char* field) {
  throw Error(ErrorCode::kInvalidData, "the array changed while it was read", place + "." + field);
}

/// The first of `items` that is not `right`. If the owner is writing to the array, it may have
/// become valid.
template <class Item, class Right>
std::size_t first_wrong(View<const Item> items, const std::string& place, const char* field,
                        const Right& right) {
  for (std::size_t i = 0; i < items.size; ++i)
    if (!right(items[i])) return i;
  throw_changed(place, field);
}

bool is_right(const Vec3& position) {
  return check_coordinates(&position.x, 3);
}

/// Whether the corners that triangles use are valid. Indices out of range are reported elsewhere.
bool are_right(const Executor& executor, View<const Vec3> positions,
               View<const Triangle> triangles) {
  return all_blocks(executor, triangles.size, [&](std::size_t begin, std::size_t end) {
    for (const Triangle& triangle : triangles.slice(begin, end - begin))
      for (const std::size_t corner : triangle)
        if (corner < positions.size && !is_right(positions[corner])) return false;
    return true;
  });
}

/// The first invalid corner; `triangles` = null for a soup.
std::size_t first_wrong_corner(View<const Vec3> positions, const View<const Triangle>* triangles,
                               const std::string& place) {
  if (triangles == nullptr) return first_wrong(positions, place, "positions", is_right);
  std::size_t first = positions.size;
  for (const Triangle& triangle : *triangles)
    for (const std::size_t corner : triangle)
      if (corner < first && !is_right(positions[corner])) first = corner;
  if (first == positions.size) throw_changed(place, "positions");
  return first;
}

[[noreturn]] void throw_bad_position(View<const Vec3> positions,
                                     const View<const Triangle>* triangles,
                                     const std::string& place) {
  const std::size_t i = first_wrong_corner(positions, triangles, place);
  const Vec3 p = positions[i];
  const bool finite = std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
  throw Error(ErrorCode::kInvalidData,
              finite ? "the vertex is farther out than 1e18" : "the vertex is not finite",
              element(place, "positions", i));
}

[[noreturn]] void throw_bad_triangle(View<const Triangle> triangles, std::size_t vertex_count,
                                     const std::string& place) {
  const auto limit = static_cast<std::uint32_t>(vertex_count);
  const auto right = [limit](const Triangle& t) { return check_indices(t.data(), 3, limit); };
  const std::size_t i = first_wrong(triangles, place, "triangles", right);
  const Triangle wrong = triangles[i];
  std::size_t k = 0;
  while (k < 2 && wrong[k] < limit) ++k;
  throw Error(ErrorCode::kInvalidData,
              "index " + std::to_string(k) + " is " + std::to_string(wrong[k]) +
                  ", but the mesh has " + std::to_string(vertex_count) + " vertices",
              element(place, "triangles", i));
}

void check_count(std::size_t count, const std::string& place, const char* what) {
  if (count > kMostItems)
    throw Error(ErrorCode::kUnsupported,
                std::to_string(count) + " " + what + " are more than 2^31 - 1", place);
}

}  // namespace

void MeshArrays::set(const Executor& executor, View<const Vec3> positions,
                     const View<const Triangle>* triangles, const std::string& place) {
  check_count(positions.size, place, "vertices");
  if (triangles != nullptr) check_count(triangles->size, place, "triangles");
  if (triangles == nullptr && positions.size % 3 != 0)
    throw Error(ErrorCode::kInvalidArgument,
                std::to_string(positions.size) + " vertices are not a multiple of three",
                place + ".positions");
  View<const Triangle> taken;
  if (triangles != nullptr) taken = take_triangles(executor, *triangles, positions.size, place);
  times_ = take_times(executor, {&positions, 1}, triangles != nullptr ? &taken : nullptr, place);

  soup_ = triangles == nullptr;
  triangles_ = soup_ ? View<const Triangle>() : *triangles;
  if (storage_ == Storage::kShare) return;
  std::swap(own_positions_, next_positions_);
  if (soup_) return;
  std::swap(own_triangles_, next_triangles_);
  triangles_ = own_triangles_;
}

void MeshArrays::move(const Executor& executor, View<const View<const Vec3>> times,
                      const std::string& place) {
  for (const View<const Vec3> positions : times)
    if (positions.size != this->positions().size)
      throw Error(ErrorCode::kInvalidArgument,
                  std::to_string(positions.size) + " vertices are given, but the mesh has " +
                      std::to_string(this->positions().size),
                  place + ".positions");
  times_ = take_times(executor, times, soup_ ? nullptr : &triangles_, place);
  if (storage_ == Storage::kCopy) std::swap(own_positions_, next_positions_);
}

MeshArrays::Times MeshArrays::take_times(const Executor& executor,
                                         View<const View<const Vec3>> times,
                                         const View<const Triangle>* triangles,
                                         const std::string& place) {
  Times taken(times.begin(), times.end());
  const std::size_t each = taken.front().size;
  const bool copy = storage_ == Storage::kCopy;
  if (copy) next_positions_.resize_uninitialized(times.size * each);
  for (std::size_t k = 0; k < times.size; ++k) {
    Vec3* const to = copy ? next_positions_.data() + k * each : nullptr;
    if (copy) taken[k] = {to, each};
    const bool good = all_blocks(executor, each, [&](std::size_t begin, std::size_t end) {
      const float* in = &times[k][begin].x;
      const std::size_t floats = 3 * (end - begin);
      return copy ? copy_coordinates(in, floats, &to[begin].x) : check_coordinates(in, floats);
    });
    if (good || (triangles != nullptr && are_right(executor, taken[k], *triangles))) continue;
    throw_bad_position(taken[k], triangles, times.size == 1 ? place : element(place, "times", k));
  }
  return taken;
}

View<const Triangle> MeshArrays::take_triangles(const Executor& executor,
                                                View<const Triangle> triangles,
                                                std::size_t vertex_count,
                                                const std::string& place) {
  const bool copy = storage_ == Storage::kCopy;
  const auto limit = static_cast<std::uint32_t>(vertex_count);
  if (copy) next_triangles_.resize_uninitialized(triangles.size);
  const bool good = all_blocks(executor, triangles.size, [&](std::size_t begin, std::size_t end) {
    const std::uint32_t* in = triangles[begin].data();
    const std::size_t indices = 3 * (end - begin);
    return copy ? copy_indices(in, indices, limit, next_triangles_[begin].data())
                : check_indices(in, indices, limit);
  });
  const View<const Triangle> taken = copy ? View<const Triangle>(next_triangles_) : triangles;
  if (!good) throw_bad_triangle(taken, vertex_count, place);
  return taken;
}

std::size_t MeshArrays::memory_bytes() const {
  return own_positions_.capacity_bytes() + next_positions_.capacity_bytes() +
         own_triangles_.capacity_bytes() + next_triangles_.capacity_bytes();
}

}  // namespace raysheaf
