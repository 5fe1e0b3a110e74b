// The vertices and triangles of one mesh, validated when they are set.
#pragma once

#include <string>
#include <vector>

#include "base/buffer.h"
#include "base/view.h"
#include "exec/executor.h"
#include "raysheaf/scene.h"

namespace raysheaf {

class MeshArrays {
 public:
  explicit MeshArrays(Storage storage) : storage_(storage) {}

  /// Copies or shares the arrays; `triangles` = null for a soup. `place` names the mesh in errors.
  /// Vertices that no triangle uses may have any value. Changes nothing if it throws.
  void set(const Executor& executor, View<const Vec3> positions,
           const View<const Triangle>* triangles, const std::string& place);
  /// Sets other positions, the same number, at one or more times.
  void move(const Executor& executor, View<const View<const Vec3>> times, const std::string& place);

  [[nodiscard]] View<const Vec3> positions() const { return times_.front(); }
  /// The positions at each time.
  [[nodiscard]] View<const View<const Vec3>> times() const {
    return View<const View<const Vec3>>(times_);
  }
  [[nodiscard]] bool is_soup() const { return soup_; }
  /// Null for a soup.
  [[nodiscard]] const Triangle* triangles() const { return soup_ ? nullptr : triangles_.data; }
  [[nodiscard]] std::uint32_t triangle_count() const {
    return static_cast<std::uint32_t>(soup_ ? positions().size / 3 : triangles_.size);
  }
  [[nodiscard]] std::size_t memory_bytes() const;

 private:
  using Times = std::vector<View<const Vec3>>;

  /// Returns them as they were validated. `triangles` = null for a soup.
  [[nodiscard]] Times take_times(const Executor& executor, View<const View<const Vec3>> times,
                                 const View<const Triangle>* triangles, const std::string& place);
  /// Returns them as they were validated.
  [[nodiscard]] View<const Triangle> take_triangles(const Executor& executor,
                                                    View<const Triangle> triangles,
                                                    std::size_t vertex_count,
                                                    const std::string& place);

  Storage storage_;
  bool soup_ = false;
  Times times_{{}};
  View<const Triangle> triangles_;
  // Copies are made next to the arrays in use, which stay valid until the new ones are complete.
  Buffer<Vec3> own_positions_, next_positions_;
  Buffer<Triangle> own_triangles_, next_triangles_;
};

}  // namespace raysheaf
