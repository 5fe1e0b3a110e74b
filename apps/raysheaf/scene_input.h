// "-" or a pipe as SCENE: the scene is read from standard input or from the pipe.
#pragma once

#include <string>

#include "raysheaf/error.h"

namespace raysheaf::app {

/// Keeps what standard input or a pipe contains in a file during its lifetime.
class SceneInput {
 public:
  /// If `scene` is "-" or a pipe, reads all of it and replaces `scene` by the name of the file,
  /// whose ending matches the content. Throws `Error` (place "standard input" or the pipe):
  /// kInvalidData if the input is empty or has an unknown format, kIo if it cannot be kept.
  explicit SceneInput(std::string* scene);
  ~SceneInput();
  SceneInput(const SceneInput&) = delete;
  SceneInput& operator=(const SceneInput&) = delete;

  /// Runs `work`, whose errors then name the input instead of the file.
  template <class Work>
  void naming(const Work& work) const {
    try {
      work();
    } catch (const Error& error) {
      if (folder_.empty()) throw;
      throw named(error);
    }
  }

 private:
  [[nodiscard]] Error named(const Error& error) const;

  std::string name_, folder_, file_;  ///< empty if the scene has a name
};

}  // namespace raysheaf::app
