// Code that each hardening option affects; built with all of them in every build.
#include <cstdio>
#include <cstring>
#include <vector>

int main(int argc, char** argv) {
  char word[16];
  std::strcpy(word, argc > 1 ? argv[1] : "guarded");
  const std::vector<char> letters(word, word + sizeof word);
  return std::puts(word) < 0 || letters[static_cast<std::size_t>(argc)] == '!' ? 1 : 0;
}
