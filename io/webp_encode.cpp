// The container of animated WebP (Google, "WebP Container Specification"; RFC 9649):
//
//   RIFF size "WEBP" { VP8X: flags, size of the canvas } { ANIM: colour, loops } { ANMF ... } ...
//
// Each ANMF chunk has the place and the duration of a frame, then the chunks of its image, as a
// file of a single image has them.
#include "raysheaf/io.h"

#ifdef RAYSHEAF_HAS_WEBP
#include <webp/encode.h>
#endif

#include <algorithm>
#include <cmath>
#include <memory>
#include <span>

#include "io/file.h"
#include "raysheaf/error.h"

namespace raysheaf {
namespace {

using io::Bytes;

constexpr std::uint32_t kMostWebpSide = 16383, kChunkHead = 8, kFileHead = 12, kFrameHead = 16;
constexpr std::uint64_t kMostWebpBytes = 0xfffffff0;

void put_little(Bytes& out, std::uint64_t value, std::uint32_t bytes) {
  for (std::uint32_t i = 0; i < bytes; ++i)
    out.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
}

void put_name(Bytes& out, const char* name) {
  out.insert(out.end(), name, name + 4);
}

std::uint64_t little_at(std::span<const std::uint8_t> bytes, std::size_t at) {
  std::uint64_t value = 0;
  for (std::size_t i = 4; i-- > 0;) value = value << 8 | bytes[at + i];
  return value;
}

/// The chunks of an encoded image without VP8X, which a frame does not have.
std::span<const std::uint8_t> image_chunks(std::span<const std::uint8_t> file) {
  std::span<const std::uint8_t> rest = file.subspan(kFileHead);
  if (rest[3] == 'X') rest = rest.subspan(kChunkHead + little_at(rest, 4));
  return rest;
}

#ifdef RAYSHEAF_HAS_WEBP
constexpr bool kWritesWebp = true;

Bytes encode_webp(const Image& image) {
  constexpr float kQuality = 90;
  std::uint8_t* encoded = nullptr;
  const int width = static_cast<int>(image.width), height = static_cast<int>(image.height);
  const std::size_t size =
      WebPEncodeRGBA(image.rgba.data(), width, height, 4 * width, kQuality, &encoded);
  const std::unique_ptr<std::uint8_t, decltype(&WebPFree)> owner(encoded, WebPFree);
  if (size <= kFileHead)
    throw Error(ErrorCode::kOutOfMemory, "there is not enough memory to compress the image");
  return {encoded, encoded + size};
}
#else
constexpr bool kWritesWebp = false;

Bytes encode_webp(const Image&) {
  return {};
}
#endif

bool has_transparent_pixel(const Image& image) {
  for (std::size_t i = 3; i < image.rgba.size(); i += 4)
    if (image.rgba[i] != 255) return true;
  return false;
}

}  // namespace

AnimatedWebp::AnimatedWebp(std::uint32_t width, std::uint32_t height, double fps)
    : width_(width), height_(height), fps_(fps) {
  if (!kWritesWebp)
    throw Error(ErrorCode::kUnsupported, "this build has no libwebp, which writes WebP");
  if (width == 0 || height == 0 || !(fps > 0 && std::isfinite(fps)))
    throw Error(ErrorCode::kInvalidArgument,
                "an animation needs at least one pixel and frames per second above 0");
  if (std::max(width, height) > kMostWebpSide)
    throw Error(ErrorCode::kUnsupported, "a WebP has at most 16383 pixels a side");
}

void AnimatedWebp::add(const Image& frame) {
  if (frame.width != width_ || frame.height != height_ ||
      frame.rgba.size() != std::size_t{4} * width_ * height_)
    throw Error(ErrorCode::kInvalidArgument, "all frames of an animation have the same size");
  const Bytes file = encode_webp(frame);
  const std::span<const std::uint8_t> image = image_chunks(file);
  if (frames_.size() + image.size() > kMostWebpBytes)
    throw Error(ErrorCode::kUnsupported, "the animation is larger than 4 GiB, the most of a WebP");
  // Durations are whole milliseconds: rounding each end, not each duration, keeps the pace.
  const auto end_ms = [&](std::uint64_t count) {
    return std::llround(1000.0 * static_cast<double>(count) / fps_);
  };
  const auto duration =
      static_cast<std::uint64_t>(std::min(end_ms(count_ + 1) - end_ms(count_), 0xffffffLL));
  put_name(frames_, "ANMF");
  put_little(frames_, kFrameHead + image.size(), 4);
  put_little(frames_, 0, 3);  // x / 2
  put_little(frames_, 0, 3);  // y / 2
  put_little(frames_, width_ - 1, 3);
  put_little(frames_, height_ - 1, 3);
  put_little(frames_, duration, 3);
  put_little(frames_, 2, 1);  // replaces the frame before instead of blending with it
  frames_.insert(frames_.end(), image.begin(), image.end());
  has_alpha_ = has_alpha_ || has_transparent_pixel(frame);
  ++count_;
}

void AnimatedWebp::write(const std::string& path) const {
  if (count_ == 0)
    throw Error(ErrorCode::kInvalidArgument, "an animation needs at least one frame", path);
  constexpr std::uint32_t kCanvas = 10, kLoops = 6, kAnimated = 0x02, kAlpha = 0x10;
  Bytes file;
  file.reserve(frames_.size() + 64);
  put_name(file, "RIFF");
  put_little(file, 4 + 2 * kChunkHead + kCanvas + kLoops + frames_.size(), 4);
  put_name(file, "WEBP");
  put_name(file, "VP8X");
  put_little(file, kCanvas, 4);
  put_little(file, kAnimated | (has_alpha_ ? kAlpha : 0), 4);
  put_little(file, width_ - 1, 3);
  put_little(file, height_ - 1, 3);
  put_name(file, "ANIM");
  put_little(file, kLoops, 4);
  put_little(file, 0, 4);  // background, which viewers ignore
  put_little(file, 0, 2);  // repeats for ever
  file.insert(file.end(), frames_.begin(), frames_.end());
  io::write_file(path, file);
}

}  // namespace raysheaf
