// The rays of a query: as they lie in memory, or packed from their parts where they are used.
#pragma once

#include "exec/executor.h"
#include "rays/ray_source.h"
#include "raysheaf/ray_parts.h"

namespace raysheaf {

/// Thrown where a thread takes a wrong ray, of which there may be more before it.
struct WrongRay {};

class QueryRays final : public RaySource {
 public:
  /// `check`: `take` looks the rays over.
  QueryRays(View<const Ray> rays, bool check) : RaySource(rays.size), rays_(rays), check_(check) {}
  /// Throws `Error` (kInvalidArgument) where there are rays without origins or directions.
  QueryRays(const RayParts& parts, bool check);

  [[nodiscard]] bool is_packed() const { return is_packed_; }
  [[nodiscard]] bool is_in_place() const override { return is_packed_; }
  /// All of them; only where they are packed.
  [[nodiscard]] View<const Ray> rays() const { return rays_; }

  [[nodiscard]] View<const Ray> peek(std::size_t begin, std::size_t end, Ray* room) const override;
  /// Throws `WrongRay`.
  [[nodiscard]] View<const Ray> take(std::size_t begin, std::size_t end, Ray* room) const override;
  /// Throws `Error` (kInvalidData) that names the first wrong ray and its field; there is one.
  [[noreturn]] void throw_first_fault() const;

 private:
  View<const Ray> rays_;
  RayParts parts_{0, {}, {}};
  bool is_packed_ = true, check_;
};

}  // namespace raysheaf
