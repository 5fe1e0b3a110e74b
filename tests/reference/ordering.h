// Reference implementations for ordering rays: simple and single-threaded.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numeric>
#include <vector>

namespace raysheaf::reference {

using Words = std::vector<std::uint32_t>;

/// out[i] is the sum of in[0] to in[i].
inline Words inclusive_scan(const Words& in) {
  Words out;
  std::uint32_t sum = 0;
  for (std::uint32_t x : in) out.push_back(sum += x);
  return out;
}

/// out[i] is the sum of all elements before in[i].
inline Words exclusive_scan(const Words& in) {
  Words out;
  std::uint32_t sum = 0;
  for (std::uint32_t x : in) {
    out.push_back(sum);
    sum += x;
  }
  return out;
}

/// The slots that contain a ray.
inline Words trim(const std::vector<std::uint8_t>& empty) {
  Words slots;
  for (std::size_t i = 0; i < empty.size(); ++i) {
    if (empty[i] == 0) slots.push_back(static_cast<std::uint32_t>(i));
  }
  return slots;
}

/// A run of equal keys.
struct Run {
  std::uint32_t key, base, size;
  bool operator==(const Run&) const = default;
};

/// The runs of equal neighbours.
inline std::vector<Run> runs(const Words& keys) {
  std::vector<Run> found;
  for (std::size_t i = 0; i < keys.size(); ++i) {
    if (i == 0 || keys[i] != keys[i - 1])
      found.push_back({keys[i], static_cast<std::uint32_t>(i), 0});
    ++found.back().size;
  }
  return found;
}

/// The key's low `bits` bits.
template <class Key>
Key low_bits(Key key, std::uint32_t bits) {
  return bits >= std::numeric_limits<Key>::digits ? key : key & ((Key{1} << bits) - 1);
}

/// The item at each place of the stable order by the low `bits` bits.
template <class Key>
Words stable_order(const std::vector<Key>& keys, std::uint32_t bits) {
  Words order(keys.size());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return low_bits(keys[a], bits) < low_bits(keys[b], bits);
  });
  return order;
}

}  // namespace raysheaf::reference
