// The rays of a query: in place, or packed from their parts by the threads that use them.
#pragma once

#include "exec/executor.h"
#include "rays/ray_source.h"
#include "raysheaf/types.h"

namespace raysheaf {

/// Thrown by a thread that finds an invalid ray, which need not be the first.
struct WrongRay {};

class QueryRays final : public RaySource {
 public:
  /// `check`: `take` validates the rays.
  QueryRays(View<const Ray> rays, bool check) : RaySource(rays.size), rays_(rays), check_(check) {}
  /// Throws `Error` (kInvalidArgument) if there are rays without origins or directions.
  QueryRays(const RayParts& parts, bool check);

  [[nodiscard]] bool is_packed() const { return is_packed_; }
  /// All of them; only if they are stored as `Ray`.
  [[nodiscard]] View<const Ray> rays() const { return rays_; }

  [[nodiscard]] View<const Ray> peek(std::size_t begin, std::size_t end, Ray* room) const override;
  /// Throws `WrongRay`.
  [[nodiscard]] View<const Ray> take(std::size_t begin, std::size_t end, Ray* room) const override;
  /// Throws `Error` (kInvalidData) naming the first invalid ray and its field; there must be one.
  [[noreturn]] void throw_first_fault() const;

 private:
  View<const Ray> rays_;
  RayParts parts_{0, {}, {}};
  bool is_packed_ = true, check_;
};

}  // namespace raysheaf
