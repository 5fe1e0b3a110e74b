// "-" in the place of SCENE: the scene comes through standard input.
#pragma once

#include <string>

#include "raysheaf/error.h"

namespace raysheaf::app {

/// Keeps what standard input holds in a file, as long as it lives.
class SceneInput {
 public:
  /// Where `scene` is "-", reads all of standard input, and puts the file's name there; the ending
  /// is that of the content's kind. Throws `Error` (place "standard input"): kInvalidData where it
  /// is empty or of no kind that is read, kIo where it cannot be kept.
  explicit SceneInput(std::string* scene);
  ~SceneInput();
  SceneInput(const SceneInput&) = delete;
  SceneInput& operator=(const SceneInput&) = delete;

  /// Runs `work`, whose errors name standard input and not the file.
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

  std::string folder_, file_;  ///< empty where the scene has a name
};

}  // namespace raysheaf::app
