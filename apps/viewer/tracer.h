// Traces pictures beside the interface: a thread of its own, the latest wish first.
//
//   interface                      tracer's thread (of lower priority, as all that it starts)
//   load(path)      ─────────►     the scene
//   submit(request) ─────────►     a picture; where the camera stands, sample after sample
//   ask(question)   ─────────►     the bundle under the cursor
//        ◄───────── take_...()     notify()
//
// Nothing here waits: what was submitted before and has not begun is dropped; a refinement that
// runs is given up for any newer request, a single picture where it has taken kPatienceMs.
#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "picture.h"
#include "raysheaf/animation.h"
#include "raysheaf/lab.h"

namespace raysheaf::viewer {

/// Whose bundle, of a picture of `size`.
struct BundleQuestion {
  std::uint64_t number = 0;
  Camera camera;
  MethodChoice choice;
  LabRays rays = LabRays::kShadow;
  Size size;
  std::uint32_t x = 0, y = 0;
  std::uint32_t threads = 0;
  double time_s = 0;
  std::uint32_t clip = 0;
};

struct BundleAnswer {
  BundleQuestion question;
  std::optional<RayBundle> bundle;
  std::string error;
};

/// A whole picture into a file, while the rest goes on.
struct SaveOrder {
  ViewRequest request;  ///< size and samples are the file's
  std::string path;
};

struct LoadedScene {
  std::uint64_t number = 0;
  std::string path;
  std::optional<SceneFacts> facts;  ///< none: the scene that was there stays
  std::string error;
};

struct TracerOptions {
  std::function<std::unique_ptr<Animation>(const std::string&)> load;
  std::function<void()> notify;  ///< something can be taken; from another thread
};

class Tracer {
 public:
  explicit Tracer(TracerOptions options);
  /// Gives up what runs.
  ~Tracer();
  Tracer(const Tracer&) = delete;
  Tracer& operator=(const Tracer&) = delete;

  /// The number that the request got, as all of these: one that is dropped has no answer.
  std::uint64_t load(const std::string& path);
  std::uint64_t submit(ViewRequest request);
  std::uint64_t ask(BundleQuestion question);
  void save(SaveOrder order);

  /// What is new since the last call; none where nothing is.
  [[nodiscard]] std::shared_ptr<const Picture> take_picture();
  [[nodiscard]] std::optional<LoadedScene> take_scene();
  [[nodiscard]] std::optional<BundleAnswer> take_answer();
  /// What became of a file that was to be saved, in a sentence.
  [[nodiscard]] std::optional<std::string> take_saved();

  /// Whether anything runs or waits.
  [[nodiscard]] bool busy() const;
  /// From `save` until what became of it was taken.
  [[nodiscard]] bool saving() const;

 private:
  class Work;  ///< what the thread owns: the scene, its pictures so far, its laboratory

  void run();
  [[nodiscard]] bool something_waits() const;
  /// Whether what runs should be given up.
  [[nodiscard]] bool unwanted(bool refining, double running_ms) const;
  void publish(std::shared_ptr<const Picture> picture);
  void next(Work& work, std::unique_lock<std::mutex>& lock);
  void do_trace(const ViewRequest& request, Work& work);
  void do_answer(const BundleQuestion& question, Work& work);
  void do_load(LoadedScene loaded, Work& work);
  void do_save(const SaveOrder& order, Work& work);
  void write_copy(SceneDescription scene, const SaveOrder& order);

  const TracerOptions options_;
  mutable std::mutex mutex_;
  std::condition_variable wake_;
  bool stop_ = false, works_ = false, saves_ = false;
  std::uint64_t last_number_ = 0;
  std::optional<LoadedScene> load_;  ///< that is asked for
  std::optional<ViewRequest> request_, again_;
  std::optional<BundleQuestion> question_;
  std::optional<SaveOrder> save_;
  std::shared_ptr<const Picture> picture_;
  std::deque<LoadedScene> scenes_;
  std::optional<BundleAnswer> answer_;
  std::optional<std::string> saved_;
  std::thread saver_;
  std::thread thread_;  ///< the last one: it begins when all else is there
};

/// The calling thread, and all that it starts from now on, gives way to others.
void give_way();

}  // namespace raysheaf::viewer
