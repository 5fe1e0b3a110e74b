// Writes JSON by joining strings: there is no tree, and destructors do not allocate.
#pragma once

#include <cstddef>
#include <initializer_list>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>

namespace raysheaf::io {

/// The text in quotes; bytes that are not valid UTF-8 become U+FFFD.
[[nodiscard]] std::string json_text(std::string_view text);
/// The shortest digits that read back to the same bits; null if the number is not finite.
[[nodiscard]] std::string json_number(double number);

/// A finished JSON value.
class Json {
 public:
  Json(std::string_view text) : text_(json_text(text)) {}
  Json(const std::string& text) : Json(std::string_view(text)) {}
  Json(const char* text) : Json(std::string_view(text)) {}
  Json(std::nullptr_t) : text_("null") {}
  template <class T>
  requires std::is_arithmetic_v<T> Json(T value) {
    if constexpr (std::is_same_v<T, bool>) {
      text_ = value ? "true" : "false";
    } else if constexpr (std::is_integral_v<T>) {
      text_ = std::to_string(value);
    } else {
      text_ = json_number(value);
    }
  }

  [[nodiscard]] const std::string& text() const { return text_; }
  friend bool operator==(const Json&, const Json&) = default;

 private:
  friend class JsonArray;
  friend class JsonObject;
  Json() = default;
  std::string text_;
};

class JsonArray {
 public:
  JsonArray() = default;
  JsonArray(std::initializer_list<Json> items) {
    for (const Json& item : items) add(item);
  }
  void add(const Json& item);
  [[nodiscard]] std::size_t size() const { return count_; }
  operator Json() const;

 private:
  std::string text_;
  std::size_t count_ = 0;
};

class JsonObject {
 public:
  using Member = std::pair<std::string_view, Json>;
  JsonObject() = default;
  JsonObject(std::initializer_list<Member> members) {
    for (const Member& member : members) add(member.first, member.second);
  }
  /// The caller adds each name only once.
  void add(std::string_view name, const Json& value);
  [[nodiscard]] bool empty() const { return text_.empty(); }
  operator Json() const;

 private:
  std::string text_;
};

}  // namespace raysheaf::io
