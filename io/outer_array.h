// Arrays that may be larger than memory. They lie in unnamed files and keep some pages in memory.
// Pages are read and written rather than mapped, so that the memory of the process stays
// bounded. Errors name the file: kIo.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

namespace raysheaf::io {

/// An unnamed file in the same folder as `neighbour`. It disappears when the program ends.
class OuterFile {
 public:
  explicit OuterFile(const std::string& neighbour);
  OuterFile(const OuterFile&) = delete;
  OuterFile& operator=(const OuterFile&) = delete;
  ~OuterFile();

  void write(std::uint64_t offset, std::span<const std::uint8_t> bytes);
  /// Fills `out`; the range must have been written before.
  void read(std::uint64_t offset, std::span<std::uint8_t> out) const;

 private:
  std::string place_;
  int file_ = -1;
};

/// A page cache with pages of equal size. Each page has one possible slot, determined by its
/// number.
class OuterPages {
 public:
  OuterPages(const std::string& neighbour, std::size_t page_bytes, std::size_t held)
      : file_(neighbour), page_bytes_(page_bytes), places_(std::max<std::size_t>(held, 1)) {}

  /// The pointer is valid until the next call. A new page is appended to the file.
  [[nodiscard]] std::uint8_t* page(std::uint64_t number, bool changes) {
    Place& place = places_[number % places_.size()];
    if (place.number != number) load(number, &place);
    place.changed = place.changed || changes;
    return place.bytes.data();
  }
  /// Writes all changed pages and empties the cache.
  void rest();

 private:
  static constexpr std::uint64_t kNone = ~std::uint64_t{0};
  struct Place {
    std::uint64_t number = kNone;
    bool changed = false;
    std::vector<std::uint8_t> bytes;
  };
  void load(std::uint64_t number, Place* place);
  void save(Place* place);

  OuterFile file_;
  std::size_t page_bytes_;
  std::vector<Place> places_;
  std::uint64_t count_ = 0;  // pages that have a place in the file
};

/// Keeps about `held` elements in memory. Elements are read and written by value.
template <class T>
class OuterArray {
  static_assert(std::is_trivially_copyable_v<T>);

 public:
  OuterArray(const std::string& neighbour, std::size_t held)
      : pages_(neighbour, kPerPage * sizeof(T), held / kPerPage) {}

  [[nodiscard]] std::uint64_t size() const { return size_; }
  [[nodiscard]] T operator[](std::uint64_t i) {
    T value;
    std::memcpy(static_cast<void*>(&value), at(i, false), sizeof value);
    return value;
  }
  void set(std::uint64_t i, const T& value) { std::memcpy(at(i, true), &value, sizeof value); }
  void push_back(const T& value) { set(size_++, value); }
  void resize(std::uint64_t size, const T& value) {
    while (size_ < size) push_back(value);
  }
  void rest() { pages_.rest(); }

 private:
  static constexpr std::size_t kPerPage = 512;

  [[nodiscard]] std::uint8_t* at(std::uint64_t i, bool changes) {
    return pages_.page(i / kPerPage, changes) + i % kPerPage * sizeof(T);
  }

  OuterPages pages_;
  std::uint64_t size_ = 0;
};

}  // namespace raysheaf::io
