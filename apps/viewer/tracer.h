// Traces images in a separate thread, next to the interface, the latest request first.
//
//   interface                      tracer's thread (of lower priority, as all that it starts)
//   load(path)      ─────────►     the scene
//   submit(request) ─────────►     a picture; where the camera stands, sample after sample
//   ask(question)   ─────────►     the bundle under the cursor
//   drop()          ─────────►     gives up images, so that OpenGL has the cores
//        ◄───────── take_...()     notify()
//
// No call waits: a submitted request that has not begun is dropped for a newer one; a refinement
// that runs is given up for any newer request, a single image only if it has taken kPatienceMs.
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
#include "preview_mesh.h"
#include "raysheaf/animation.h"
#include "raysheaf/lab.h"

namespace raysheaf::viewer {

/// The pixel whose bundle is requested, in an image of `size`.
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

/// Renders a whole image into a file, while the interface continues.
struct SaveOrder {
  ViewRequest request;  ///< size and samples are those of the file
  std::string path;
  std::optional<float> exposure;  ///< that of the window; none: automatic
};

struct LoadedScene {
  std::uint64_t number = 0;
  std::string path;
  std::optional<SceneFacts> facts;  ///< empty: the previous scene stays
  std::shared_ptr<const PreviewMesh> mesh;
  std::string error;
};

struct TracerOptions {
  std::function<std::unique_ptr<Animation>(const std::string&)> load;
  std::function<void()> notify;  ///< called from another thread when a result can be taken
};

class Tracer {
 public:
  explicit Tracer(TracerOptions options);
  /// Gives up the running work.
  ~Tracer();
  Tracer(const Tracer&) = delete;
  Tracer& operator=(const Tracer&) = delete;

  /// Returns the number of the request. A request that is dropped has no result.
  std::uint64_t load(const std::string& path);
  std::uint64_t submit(ViewRequest request);
  std::uint64_t ask(BundleQuestion question);
  /// Gives up the image that is traced, and forgets the one that waits.
  void drop();
  void save(SaveOrder order);

  /// Returns the results since the last call, if there are any.
  [[nodiscard]] std::shared_ptr<const Picture> take_picture();
  [[nodiscard]] std::optional<LoadedScene> take_scene();
  /// The triangles of a moving scene, whenever it has come to rest at another time.
  [[nodiscard]] std::shared_ptr<const PreviewMesh> take_mesh();
  [[nodiscard]] std::optional<BundleAnswer> take_answer();
  /// The outcome of saving a file, as a sentence.
  [[nodiscard]] std::optional<std::string> take_saved();

  /// Whether any work runs or waits.
  [[nodiscard]] bool busy() const;
  /// True from `save` until its outcome was taken.
  [[nodiscard]] bool saving() const;

 private:
  class Work;  ///< the data of the thread: the scene, its images so far, its laboratory

  void run();
  [[nodiscard]] bool something_waits() const;
  /// Whether to give up the running work.
  [[nodiscard]] bool unwanted(const ViewRequest& running, double running_ms) const;
  void publish(std::shared_ptr<const Picture> picture);
  void next(Work& work, std::unique_lock<std::mutex>& lock);
  void do_trace(const ViewRequest& request, Work& work);
  void do_answer(const BundleQuestion& question, Work& work);
  void do_load(LoadedScene loaded, Work& work);
  void do_save(SaveOrder order, Work& work);
  void write_copy(SceneDescription scene, const SaveOrder& order);

  const TracerOptions options_;
  mutable std::mutex mutex_;
  std::condition_variable wake_;
  bool stop_ = false, works_ = false, saves_ = false;
  bool dropped_ = false;  ///< the image that is traced
  std::uint64_t last_number_ = 0;
  std::optional<LoadedScene> load_;  ///< the requested scene
  std::optional<ViewRequest> request_, again_;
  std::optional<BundleQuestion> question_;
  std::optional<SaveOrder> save_;
  std::shared_ptr<const Picture> picture_;
  std::deque<LoadedScene> scenes_;
  std::shared_ptr<const PreviewMesh> mesh_;
  std::optional<BundleAnswer> answer_;
  std::optional<std::string> saved_;
  std::thread saver_;
  std::thread thread_;  ///< last member: it starts when all others exist
};

/// Lowers the priority of the calling thread, and of all threads that it starts from now on.
void give_way();

}  // namespace raysheaf::viewer
