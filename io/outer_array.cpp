#include "io/outer_array.h"

#include <cerrno>

#include "io/file.h"
#include "io/file_parts.h"
#include "system/files.h"

namespace raysheaf::io {

OuterFile::OuterFile(const std::string& neighbour)
    : place_(temporary_name(neighbour)), file_(system::make_scratch_file(place_)) {
  if (file_ < 0) throw system_error("written", place_, errno);
}

OuterFile::~OuterFile() {
  static_cast<void>(system::close_file(file_));
}

void OuterFile::write(std::uint64_t offset, std::span<const std::uint8_t> bytes) {
  write_at(file_, offset, bytes, place_);
}

void OuterFile::read(std::uint64_t offset, std::span<std::uint8_t> out) const {
  read_at(file_, offset, out, place_);
}

void OuterPages::load(std::uint64_t number, Place* place) {
  save(place);
  place->number = kNone;
  place->bytes.resize(page_bytes_);
  if (number < count_)
    file_.read(number * page_bytes_, place->bytes);
  else
    count_ = number + 1;
  place->number = number;
}

void OuterPages::save(Place* place) {
  if (place->changed) file_.write(place->number * page_bytes_, place->bytes);
  place->changed = false;
}

void OuterPages::rest() {
  for (Place& place : places_) {
    save(&place);
    place = Place{};
  }
}

}  // namespace raysheaf::io
