// The points of a query: packed from their rows where they are used.
#pragma once

#include "nearest/nearest.h"
#include "raysheaf/points.h"

namespace raysheaf {

/// Thrown where a thread takes a wrong point, of which there may be more before it.
struct WrongPoint {};

class QueryPoints final : public PointSource {
 public:
  /// Throws `Error` (kInvalidArgument) where there are points without coordinates, and
  /// (kUnsupported) where there are too many.
  QueryPoints(const PointParts& parts, bool check);
  [[nodiscard]] const PointParts& parts() const { return parts_; }
  [[nodiscard]] bool is_checked() const { return check_; }
  /// Reads the host's memory. Throws `WrongPoint`.
  void take(std::size_t begin, std::size_t end, QueryPoint* out) const override;
  /// Throws `Error` (kInvalidData) that names the first wrong point; there is one.
  [[noreturn]] void throw_first_fault() const;

 private:
  void pack(std::size_t begin, std::size_t end, QueryPoint* out) const;

  PointParts parts_;
  bool check_;
};

}  // namespace raysheaf
