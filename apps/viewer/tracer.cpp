#include "tracer.h"

#include <sys/resource.h>
#include <unistd.h>

#include <new>
#include <system_error>

#include "raysheaf/error.h"
#include "raysheaf/io.h"
#include "tracer_work.h"

namespace raysheaf::viewer {
namespace {

/// An image in motion that takes longer than this is given up for a newer one.
constexpr double kPatienceMs = 400;
/// The same for the smallest images, which are not shown otherwise.
constexpr double kLongPatienceMs = 5000;
/// The lowest priority: Linux then gives the interface's threads some seventy times as much time.
constexpr int kNice = 19;

/// The sentence for the user about any failure.
template <class Body>
std::string sentence_of(const Body& body) {
  try {
    body();
  } catch (const Error& error) {
    return error.what();
  } catch (const std::bad_alloc&) {
    return "there is not enough memory";
  } catch (const std::exception& error) {
    return std::string("an internal error: ") + error.what();
  }
  return "";
}

template <class Value>
std::optional<Value> taken(std::optional<Value>& value) {
  std::optional<Value> result;
  result.swap(value);
  return result;
}

}  // namespace

void give_way() {
  // On Linux this sets only the calling thread; threads inherit it from those that start them. If
  // it fails, only the responsiveness suffers.
  (void)setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), kNice);
}

Tracer::Tracer(TracerOptions options) : options_(std::move(options)) {
  thread_ = std::thread([this] { run(); });
}

Tracer::~Tracer() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  wake_.notify_all();
  thread_.join();
  if (saver_.joinable()) saver_.join();
}

std::uint64_t Tracer::load(const std::string& path) {
  std::uint64_t number = 0;
  {
    const std::lock_guard lock(mutex_);
    number = ++last_number_;
    load_ = {number, path, {}, {}, {}};
  }
  wake_.notify_all();
  return number;
}

std::uint64_t Tracer::submit(ViewRequest request) {
  std::uint64_t number = 0;
  {
    const std::lock_guard lock(mutex_);
    number = request.number = ++last_number_;
    request_ = std::move(request);
  }
  wake_.notify_all();
  return number;
}

std::uint64_t Tracer::ask(BundleQuestion question) {
  std::uint64_t number = 0;
  {
    const std::lock_guard lock(mutex_);
    number = question.number = ++last_number_;
    question_ = std::move(question);
  }
  wake_.notify_all();
  return number;
}

void Tracer::drop() {
  const std::lock_guard lock(mutex_);
  request_.reset();
  again_.reset();
  dropped_ = works_;
}

void Tracer::save(SaveOrder order) {
  {
    const std::lock_guard lock(mutex_);
    save_ = std::move(order);
  }
  wake_.notify_all();
}

std::shared_ptr<const Picture> Tracer::take_picture() {
  const std::lock_guard lock(mutex_);
  return std::exchange(picture_, nullptr);
}
std::optional<LoadedScene> Tracer::take_scene() {
  const std::lock_guard lock(mutex_);
  if (scenes_.empty()) return std::nullopt;
  std::optional<LoadedScene> first = std::move(scenes_.front());
  scenes_.pop_front();
  return first;
}
std::shared_ptr<const PreviewMesh> Tracer::take_mesh() {
  const std::lock_guard lock(mutex_);
  return std::exchange(mesh_, nullptr);
}
std::optional<BundleAnswer> Tracer::take_answer() {
  const std::lock_guard lock(mutex_);
  return taken(answer_);
}
std::optional<std::string> Tracer::take_saved() {
  const std::lock_guard lock(mutex_);
  return taken(saved_);
}

bool Tracer::busy() const {
  const std::lock_guard lock(mutex_);
  return works_ || something_waits();
}
bool Tracer::saving() const {
  const std::lock_guard lock(mutex_);
  return saves_ || save_ || saved_;
}

bool Tracer::something_waits() const {
  return load_ || request_ || question_ || again_ || (save_ && !saves_);
}

bool Tracer::unwanted(const ViewRequest& running, double running_ms) const {
  const std::lock_guard lock(mutex_);
  if (stop_ || load_ || dropped_) return true;
  if (running.refine) return request_ || question_ || (save_ && !saves_);
  return request_ && running_ms > (running.is_smallest ? kLongPatienceMs : kPatienceMs);
}

void Tracer::publish(std::shared_ptr<const Picture> picture) {
  {
    const std::lock_guard lock(mutex_);
    picture_ = std::move(picture);
  }
  options_.notify();
}

void Tracer::do_load(LoadedScene loaded, Work& work) {
  const Watch watch;
  loaded.error = sentence_of([&] {
    std::unique_ptr<Animation> animation = options_.load(loaded.path);
    validate(animation->scene());
    work.pictures.show(std::move(animation));
    work.forget_bundles();
    loaded.facts = work.pictures.facts();
    if (loaded.facts->name.empty()) loaded.facts->name = loaded.path;
    loaded.mesh = work.pictures.mesh();
    loaded.facts->load_ms = watch.ms();
  });
  {
    const std::lock_guard lock(mutex_);
    if (loaded.facts) {  // results and running work belong to another scene
      picture_ = nullptr;
      mesh_ = nullptr;
      again_.reset();
    }
    scenes_.push_back(std::move(loaded));
  }
  options_.notify();
}

void Tracer::do_save(SaveOrder order, Work& work) {
  if (saver_.joinable()) saver_.join();
  auto copy = std::make_shared<SceneDescription>();
  const std::string failed = sentence_of([&] {
    if (!work.pictures.has_scene())
      throw Error(ErrorCode::kWrongState, "no scene is loaded whose image could be saved",
                  order.path);
    order.exposure = work.pictures.kept_exposure(order.request);
    *copy = work.pictures.posed_copy(order.request);
  });
  {
    const std::lock_guard lock(mutex_);
    saves_ = failed.empty();
    if (!failed.empty()) saved_ = failed;
  }
  if (failed.empty()) {
    try {
      saver_ = std::thread([this, copy, order] { write_copy(std::move(*copy), order); });
    } catch (const std::system_error&) {
      write_copy(std::move(*copy), order);  // no thread is available
    }
  }
  options_.notify();
}

void Tracer::write_copy(SceneDescription scene, const SaveOrder& order) {
  std::string sentence = sentence_of([&] {
    PictureMaker maker;
    ViewRequest request = order.request;
    request.refine = true;
    request.settings.split = false;
    request.settings.light = 1;  // the copy is already lit
    request.settings.headlight = false;
    request.time_s = 0;  // and has its pose
    request.clip = 0;
    maker.show(animate(std::move(scene)));
    if (order.exposure) maker.fix_exposure(*order.exposure);
    std::shared_ptr<Picture> picture;
    const auto stopped = [this](double) {
      const std::lock_guard lock(mutex_);
      return stop_;
    };
    if (!maker.make(request, stopped,
                    [&](std::shared_ptr<Picture> made) { picture = std::move(made); }))
      throw Error(ErrorCode::kCancelled, "the image was not saved", order.path);
    write_png(picture->sides[0].image, order.path);
  });
  if (sentence.empty()) sentence = "wrote " + order.path;
  {
    const std::lock_guard lock(mutex_);
    saved_ = std::move(sentence);
    saves_ = false;
  }
  wake_.notify_all();
  options_.notify();
}

void Tracer::do_trace(const ViewRequest& request, Work& work) {
  if (!work.pictures.has_scene()) return;
  const Watch watch;
  bool whole = true;
  const std::string failed = sentence_of([&] {
    if (request.refine) {
      if (auto mesh = work.pictures.new_mesh(request)) {
        const std::lock_guard lock(mutex_);
        mesh_ = std::move(mesh);
      }
    }
    whole = work.pictures.make(
        request, [&](double) { return unwanted(request, watch.ms()); },
        [this](std::shared_ptr<Picture> made) { publish(std::move(made)); });
  });
  if (whole && failed.empty()) return;
  if (failed.empty()) {
    const std::lock_guard lock(mutex_);
    if (dropped_) return;
    if (request.refine) {
      // A question or an order came in between: the same request again, unless there is a newer
      // one.
      if (!request_) again_ = request;
      return;
    }
  }
  auto picture = std::make_shared<Picture>();
  picture->request = request;
  picture->size = request.size;
  picture->trace_ms = watch.ms();
  picture->given_up = failed.empty();
  picture->error = failed;
  publish(std::move(picture));
}

void Tracer::do_answer(const BundleQuestion& question, Work& work) {
  BundleAnswer answer{question, {}, {}};
  answer.error = sentence_of([&] { answer.bundle = work.bundle(question); });
  {
    const std::lock_guard lock(mutex_);
    answer_ = std::move(answer);
  }
  options_.notify();
}

/// The most urgent waiting item; call it under the lock.
void Tracer::next(Work& work, std::unique_lock<std::mutex>& lock) {
  const auto without_lock = [&](const auto& body) {
    lock.unlock();
    body();
    lock.lock();
  };
  if (auto wanted = taken(load_)) {
    without_lock([&] { do_load(*std::move(wanted), work); });
  } else if (const auto request = taken(request_)) {
    again_.reset();
    dropped_ = false;
    without_lock([&] { do_trace(*request, work); });
  } else if (const auto question = taken(question_)) {
    without_lock([&] { do_answer(*question, work); });
  } else if (save_ && !saves_) {
    const auto order = taken(save_);
    saves_ = true;
    without_lock([&] { do_save(*order, work); });
  } else if (const auto unfinished = taken(again_)) {
    dropped_ = false;
    without_lock([&] { do_trace(*unfinished, work); });
  }
}

void Tracer::run() {
  give_way();
  Work work;
  std::unique_lock lock(mutex_);
  for (;;) {
    works_ = false;
    wake_.wait(lock, [this] { return stop_ || something_waits(); });
    if (stop_) return;
    works_ = true;
    next(work, lock);
  }
}

}  // namespace raysheaf::viewer
