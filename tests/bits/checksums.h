// Checksums of results, and the file of those that every machine must get (tests/golden/bits.txt).
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "raysheaf/types.h"

namespace raysheaf::test {

/// FNV-1a with 64 bits, of numbers as little-endian bytes. All NaN are one number: which bits an
/// operation gives them is the processor's choice.
class Checksum {
 public:
  void add(float x);
  void add(double x);
  template <class T>
  requires std::is_integral_v<T> || std::is_enum_v<T>
  void add(T x) {
    for (std::size_t i = 0; i < sizeof(T); ++i)
      add_byte(static_cast<std::uint8_t>(static_cast<std::uint64_t>(x) >> (8 * i)));
  }
  void add(std::string_view text);
  void add(const Vec2& v) { add_all(v.x, v.y); }
  void add(const Vec3& v) { add_all(v.x, v.y, v.z); }
  void add(const Vec4& v) { add_all(v.x, v.y, v.z, v.w); }
  void add(const Ray& r) { add_all(r.origin, r.t_min, r.direction, r.t_max); }
  void add(const Hit& h) { add_all(h.t, h.u, h.v, h.prim_id, h.geom_id, h.inst_id); }
  void add(const Affine& a) { add(a.m); }
  template <class T, std::size_t n>
  void add(const std::array<T, n>& values) {
    for (const T& value : values) add(value);
  }
  template <class T>
  void add(const std::vector<T>& values) {
    add(std::span<const T>(values));
  }
  template <class T>
  void add(std::span<const T> values) {
    add(static_cast<std::uint64_t>(values.size()));
    for (const T& value : values) add(value);
  }
  template <class... All>
  void add_all(const All&... all) {
    (add(all), ...);
  }

  /// Sixteen hexadecimal digits.
  [[nodiscard]] std::string text() const;

 private:
  void add_byte(std::uint8_t byte) { sum_ = (sum_ ^ byte) * 0x100000001b3u; }

  std::uint64_t sum_ = 0xcbf29ce484222325u;
};

template <class... All>
[[nodiscard]] Checksum checksum_of(const All&... all) {
  Checksum sum;
  sum.add_all(all...);
  return sum;
}

/// Fails unless the file has this checksum under this name. RAYSHEAF_UPDATE_GOLDEN=1 in the
/// environment writes it into the file instead.
void expect_bits(const std::string& name, const Checksum& sum);

}  // namespace raysheaf::test
