// Extracts the parts of documents that can be checked: commands, options, links, headings.
#pragma once

#include <cctype>
#include <filesystem>
#include <fstream>
#include <regex>
#include <set>
#include <string>
#include <vector>

namespace raysheaf::test {

struct Document {
  std::filesystem::path path;
  std::vector<std::string> prose;                   ///< lines outside fences
  std::vector<std::vector<std::string>> sh_blocks;  ///< lines of each ```sh block
};

/// `sh_blocks` omits a block directly below a line `<!-- not run -->`.
inline Document read_document(const std::filesystem::path& path) {
  Document document;
  document.path = path;
  std::ifstream file(path);
  bool fenced = false, kept = false, skip_next = false;
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with("```")) {
      fenced = !fenced;
      kept = fenced && line == "```sh" && !skip_next;
      if (kept) document.sh_blocks.emplace_back();
      skip_next = false;
    } else if (!fenced) {
      document.prose.push_back(line);
      if (!line.empty()) skip_next = line == "<!-- not run -->";
    } else if (kept) {
      document.sh_blocks.back().push_back(line);
    }
  }
  return document;
}

/// The Markdown files in the root folder, and all under docs/.
inline std::vector<Document> all_documents(const std::filesystem::path& root) {
  std::vector<Document> all;
  const auto add = [&all](const std::filesystem::directory_entry& entry) {
    if (entry.path().extension() == ".md") all.push_back(read_document(entry.path()));
  };
  for (const auto& entry : std::filesystem::directory_iterator(root)) add(entry);
  for (const auto& entry : std::filesystem::recursive_directory_iterator(root / "docs")) add(entry);
  return all;
}

/// The first group of every match of `pattern` in the lines.
inline std::vector<std::string> found_in(const std::vector<std::string>& lines,
                                         const std::string& pattern) {
  const std::regex expression(pattern);
  std::vector<std::string> all;
  for (const std::string& line : lines) {
    for (std::sregex_iterator i(line.begin(), line.end(), expression), end; i != end; ++i) {
      all.push_back((*i)[1]);
    }
  }
  return all;
}

/// The anchors that GitHub makes of headings: lower case, hyphens for blanks, no punctuation.
inline std::set<std::string> anchors(const Document& document) {
  std::set<std::string> all;
  for (const std::string& heading : found_in(document.prose, "^#+ +(.*)$")) {
    std::string anchor;
    for (const char c : heading) {
      const auto byte = static_cast<unsigned char>(c);
      if (c == ' ') anchor += '-';
      if (std::isalnum(byte) != 0 || c == '-' || c == '_' || byte >= 0x80) {
        anchor += static_cast<char>(std::tolower(byte));
      }
    }
    all.insert(anchor);
  }
  return all;
}

}  // namespace raysheaf::test
