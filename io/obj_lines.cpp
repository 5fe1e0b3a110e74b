#include "io/obj_lines.h"

#include <algorithm>
#include <charconv>

namespace raysheaf::io {
namespace {

/// The kind of a line, by its first word: it determines the meaning of '#' and of a backslash at
/// the end.
enum class LineKind { kNone, kComment, kNames, kNumbers };

bool has_names(std::string_view keyword) {
  constexpr std::string_view kNamed[] = {"g",      "o",      "usemtl",     "mtllib",
                                         "usemap", "maplib", "shadow_obj", "trace_obj"};
  return std::find(std::begin(kNamed), std::end(kNamed), keyword) != std::end(kNamed);
}

/// `part` is a piece of a line; a backslash at its end is ignored. Names of files, groups and
/// materials may contain '#' and backslashes; in other lines '#' begins a comment.
LineKind kind_of(std::string_view part) {
  const bool cut = part.ends_with('\\');
  if (cut) part.remove_suffix(1);
  const std::string keyword = in_lower_case(take_word(part));
  if (keyword.empty()) return LineKind::kNone;
  if (keyword.starts_with('#')) return LineKind::kComment;
  const bool whole = !cut || !part.empty();
  return whole && has_names(keyword) ? LineKind::kNames : LineKind::kNumbers;
}

/// Whether the line of this kind, whose last piece is `part`, continues on the next line. Comments
/// do not. A name may end with a backslash, as folders do on Windows: in such lines only a separate
/// backslash continues the line.
bool goes_on(LineKind kind, std::string_view part) {
  if (!part.ends_with('\\') || kind == LineKind::kComment) return false;
  if (kind == LineKind::kNumbers) return without_comment(part).size() == part.size();
  return kind != LineKind::kNames || part.ends_with(" \\") || part.ends_with("\t\\");
}

}  // namespace

bool ObjLines::next() {
  if (text_.empty()) return false;
  current_.clear();
  line_ = next_line_;
  LineKind kind = LineKind::kNone;
  for (bool more = true; more && !text_.empty();) {
    const std::string_view part = take_line(text_);
    ++next_line_;
    if (kind == LineKind::kNone) kind = kind_of(part);
    current_ += part;
    more = goes_on(kind, part);
    if (more) current_.back() = ' ';
  }
  std::replace(current_.begin(), current_.end(), '\0', ' ');
  rest_ = current_;
  if (kind == LineKind::kComment) rest_ = {};
  if (kind != LineKind::kNames) rest_ = without_comment(rest_);
  keyword_ = in_lower_case(take_word(rest_));
  return true;
}

bool read_reference(std::string_view word, ObjReference* reference) {
  reference->fill(kNoIndex);
  for (std::size_t part = 0; part < 3 && !word.empty(); ++part) {
    const std::size_t size = std::min(word.find('/'), word.size());
    std::string_view index = word.substr(0, size);
    word.remove_prefix(std::min(size + 1, word.size()));
    if (index.empty() && part > 0) continue;
    if (index.starts_with('+')) index.remove_prefix(1);
    std::int64_t value = 0;
    const char* const end = index.data() + index.size();
    const auto [stop, error] = std::from_chars(index.data(), end, value);
    if (stop != end || error == std::errc::invalid_argument) return false;
    // An index of so many digits is out of range, whatever it is.
    if (error == std::errc::result_out_of_range) value = index[0] == '-' ? -INT64_MAX : INT64_MAX;
    (*reference)[part] = value;
  }
  return word.empty() && (*reference)[0] != kNoIndex;
}

}  // namespace raysheaf::io
