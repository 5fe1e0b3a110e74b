#include "render/film.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <sstream>
#include <vector>

#include "apps/support/values.h"
#include "raysheaf/error.h"
#include "raysheaf/io.h"

extern char** environ;

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
          output.starts_with('/') ? output : "./" + output};
}

/// The path of ffmpeg. Throws `Error` (kUnsupported, place `output`) if it is not installed.
std::string find_ffmpeg(const std::string& output) {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path == nullptr ? "" : path);
  for (std::string folder; std::getline(folders, folder, ':');) {
    std::string program = (folder.empty() ? "." : folder) + "/ffmpeg";
    if (access(program.c_str(), X_OK) == 0) return program;
  }
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
  int wait();

  std::string path_, unfinished_;
  int pipe_ = -1;
  int process_ = -1;
};

FfmpegFilm::FfmpegFilm(const std::string& ffmpeg, std::string path, std::uint32_t width,
                       std::uint32_t height, double fps)
    : path_(std::move(path)), unfinished_(path_ + ".part" + std::to_string(getpid())) {
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0)
    throw Error(ErrorCode::kIo,
                std::string("cannot make a pipe to ffmpeg: ") + std::strerror(errno), path_);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, ends[0], STDIN_FILENO);
  // An interrupt is meant for this program: ffmpeg ends when the pipe is closed.
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
  std::vector<std::string> words = arguments(ffmpeg, unfinished_, width, height, fps);
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  const int failed =
      posix_spawn(&process_, ffmpeg.c_str(), &actions, &attributes, argv.data(), environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  close(ends[0]);
  pipe_ = ends[1];
  if (failed != 0) {
    process_ = -1;
    fail(std::string("ffmpeg cannot be started: ") + std::strerror(failed));
  }
}

FfmpegFilm::~FfmpegFilm() {
  static_cast<void>(wait());
  std::error_code ignored;
  std::filesystem::remove(unfinished_, ignored);
}

int FfmpegFilm::wait() {
  if (pipe_ >= 0) close(pipe_);
  pipe_ = -1;
  if (process_ < 0) return -1;
  int status = 0;
  while (waitpid(process_, &status, 0) < 0 && errno == EINTR) {
  }
  process_ = -1;
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

void FfmpegFilm::fail(const std::string& sentence) {
  static_cast<void>(wait());
  std::error_code ignored;
  std::filesystem::remove(unfinished_, ignored);
  throw Error(ErrorCode::kIo, sentence, path_);
}

void FfmpegFilm::add(const Image& picture) {
  const std::uint8_t* bytes = picture.rgba.data();
  for (std::size_t left = picture.rgba.size(); left > 0;) {
    const ssize_t written = write(pipe_, bytes, left);
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail("ffmpeg stopped reading images");
    bytes += written;
    left -= static_cast<std::size_t>(written);
  }
}

void FfmpegFilm::finish() {
  const int status = wait();
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
