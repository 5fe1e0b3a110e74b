// The rays or points of a query: in place, or packed by the threads that use them.
#pragma once

#include <algorithm>
#include <iterator>
#include <string>

#include "api/query_check.h"
#include "exec/source.h"
#include "nearest/point.h"
#include "raysheaf/points.h"

namespace raysheaf {

/// Thrown by a thread that finds an invalid ray or point, which need not be the first.
struct InvalidItem {};

template <class Item>
class QueryBatch : public Source<Item> {
 public:
  using Element = Item;

  /// Throws `InvalidItem`.
  [[nodiscard]] View<const Item> take(std::size_t begin, std::size_t end, Item* room) const final {
    const View<const Item> some = this->peek(begin, end, room);
    if (check_ && !are_right(some)) throw InvalidItem();
    return some;
  }
  /// Throws `Error` (kInvalidData) naming the first invalid item and its field; there must be one.
  [[noreturn]] void throw_first_fault() const {
    Item room[64];
    for (std::size_t begin = 0; begin < this->size(); begin += std::size(room))
      throw_fault(this->peek(begin, std::min(this->size(), begin + std::size(room)), room), begin);
    throw Error(ErrorCode::kInvalidData,
                std::string("the ") + name_ + " changed while they were read", name_);
  }

  /// The word for the items in errors.
  [[nodiscard]] const char* name() const { return name_; }
  [[nodiscard]] bool is_checked() const { return check_; }

 protected:
  /// Throws `Error` (kUnsupported) if there are too many. `check`: `take` validates the items.
  QueryBatch(std::size_t size, const char* name, bool check)
      : Source<Item>(size), name_(name), check_(check) {
    if (size > kMostItems)
      throw Error(ErrorCode::kUnsupported,
                  std::to_string(size) + " " + name + " are more than 2^31 - 1", name);
  }

 private:
  const char* name_;
  bool check_;
};

class QueryRays final : public QueryBatch<Ray> {
 public:
  /// Throws `Error` (kInvalidArgument) if there are rays without origins or directions.
  QueryRays(const RayParts& parts, bool check);

  [[nodiscard]] View<const Ray> peek(std::size_t begin, std::size_t end, Ray* room) const override;
  /// The array that may be in a device's memory; null for parts, which are in the host's.
  [[nodiscard]] const void* data() const { return parts_.list; }
  /// All of them; only if they are stored as `Ray`.
  [[nodiscard]] View<const Ray> rays() const { return {parts_.list, size()}; }

 private:
  RayParts parts_;
};

class QueryPoints final : public QueryBatch<QueryPoint> {
 public:
  /// Throws `Error` (kInvalidArgument) if there are points without coordinates.
  QueryPoints(const PointParts& parts, bool check);

  /// Reads the host's memory.
  [[nodiscard]] View<const QueryPoint> peek(std::size_t begin, std::size_t end,
                                            QueryPoint* room) const override;
  /// The array that may be in a device's memory.
  [[nodiscard]] const void* data() const { return parts_.points.data; }
  [[nodiscard]] const PointParts& parts() const { return parts_; }

 private:
  PointParts parts_;
};

}  // namespace raysheaf
