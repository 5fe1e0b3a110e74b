// A program for the graphics processor.
#pragma once

namespace raysheaf::viewer {

/// Needs the current OpenGL context for its whole lifetime.
class GlProgram {
 public:
  /// Throws `Error` (kInternal) if the driver rejects the program.
  GlProgram(const char* vertex_shader, const char* fragment_shader);
  ~GlProgram();
  GlProgram(const GlProgram&) = delete;
  GlProgram& operator=(const GlProgram&) = delete;

  void use() const;
  /// The place of a uniform; -1, which is ignored, if the program does not need it.
  [[nodiscard]] int at(const char* uniform) const;

 private:
  unsigned program_ = 0;
};

}  // namespace raysheaf::viewer
