#include "render/film.h"

#include <fmt/format.h>

#include <cstring>
#include <filesystem>
#include <vector>

#include "apps/support/values.h"
#include "raysheaf/error.h"
#include "raysheaf/io.h"
#include "system/child.h"
#include "system/process.h"

namespace raysheaf::app {
namespace {

/// The input of ffmpeg from the pipe, and its output, whose sides are made even, as video codecs
/// require. A name that begins with "-" or "pipe:" still names a file.
std::vector<std::string> arguments(const std::string& ffmpeg, const std::string& output,
                                   std::uint32_t width, std::uint32_t height, double fps) {
  return {ffmpeg,
          "-y",
          "-loglevel",
          "error",
          "-f",
          "rawvideo",
          "-pix_fmt",
          "rgba",
          "-s",
          fmt::format("{}x{}", width, height),
          "-r",
          fmt::format("{}", fps),
          "-i",
          "-",
          "-an",
          "-vf",
          "pad=ceil(iw/2)*2:ceil(ih/2)*2",
          "-pix_fmt",
          "yuv420p",
          "-movflags",
          "+faststart",
          "-f",
          "mp4",
          std::filesystem::path(output).is_absolute() ? output : "./" + output};
}

/// The path of ffmpeg. Throws `Error` (kUnsupported, place `output`) if it is not installed.
std::string find_ffmpeg(const std::string& output) {
  std::string program = system::find_program("ffmpeg");
  if (!program.empty()) return program;
  throw Error(ErrorCode::kUnsupported,
              "MP4 is made by ffmpeg, which is not installed; -o film.webp and -o frame_%04d.png "
              "do not need "
              "it",
              output);
}

/// It is written next to its name and renamed at the end.
class FfmpegFilm final : public Film {
 public:
  FfmpegFilm(const std::string& ffmpeg, std::string path, std::uint32_t width, std::uint32_t height,
             double fps);
  FfmpegFilm(const FfmpegFilm&) = delete;
  FfmpegFilm& operator=(const FfmpegFilm&) = delete;
  ~FfmpegFilm() override;

  void add(const Image& picture) override;
  void finish() override;

 private:
  [[noreturn]] void fail(const std::string& sentence);

  std::string path_, unfinished_;
  system::Child ffmpeg_;
};

FfmpegFilm::FfmpegFilm(const std::string& ffmpeg, std::string path, std::uint32_t width,
                       std::uint32_t height, double fps)
    : path_(std::move(path)),
      unfinished_(path_ + ".part" + std::to_string(system::process_number())),
      ffmpeg_(arguments(ffmpeg, unfinished_, width, height, fps), system::Child::Input::kPipe) {
  if (ffmpeg_.failure() != 0)
    fail(std::string("ffmpeg cannot be started: ") + std::strerror(ffmpeg_.failure()));
}

FfmpegFilm::~FfmpegFilm() {
  ffmpeg_.wait();
  std::error_code ignored;
  std::filesystem::remove(unfinished_, ignored);
}

void FfmpegFilm::fail(const std::string& sentence) {
  ffmpeg_.wait();
  std::error_code ignored;
  std::filesystem::remove(unfinished_, ignored);
  throw Error(ErrorCode::kIo, sentence, path_);
}

void FfmpegFilm::add(const Image& picture) {
  if (!ffmpeg_.write(picture.rgba)) fail("ffmpeg stopped reading images");
}

void FfmpegFilm::finish() {
  const int status = ffmpeg_.wait();
  if (status != 0) fail(fmt::format("ffmpeg failed with status {}", status));
  std::error_code failed;
  const std::filesystem::file_status old = std::filesystem::status(path_, failed);
  if (std::filesystem::exists(old))
    std::filesystem::permissions(unfinished_, old.permissions(), failed);
  std::filesystem::rename(unfinished_, path_, failed);
  if (failed) fail("cannot have this name: " + failed.message());
}

class WebpFilm final : public Film {
 public:
  WebpFilm(std::string path, std::uint32_t width, std::uint32_t height, double fps)
      : path_(std::move(path)), film_(width, height, fps) {}

  void add(const Image& picture) override { film_.add(picture); }
  void finish() override { film_.write(path_); }

 private:
  std::string path_;
  AnimatedWebp film_;
};

}  // namespace

bool is_film_name(const std::string& path) {
  return has_ending(path, ".mp4") || has_ending(path, ".webp");
}

std::unique_ptr<Film> make_film(const std::string& name, std::string path, std::uint32_t width,
                                std::uint32_t height, double fps) {
  if (has_ending(name, ".mp4"))
    return std::make_unique<FfmpegFilm>(find_ffmpeg(name), std::move(path), width, height, fps);
  try {
    return std::make_unique<WebpFilm>(std::move(path), width, height, fps);
  } catch (const Error& error) {
    throw Error(error.code(), error.sentence(), name);
  }
}

}  // namespace raysheaf::app
