#pragma once

#include <cstdio>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

/// Reads the file of ZMTP's byte vectors, which explains its own format.
namespace script {

struct Step {
  int line;
  std::string what, rest;
};

struct Case {
  std::string name;
  std::vector<Step> steps;
};

using Words = std::map<std::string, std::string>;

inline std::string read_hexadecimal(const std::string& digits) {
  std::string made;
  for (std::size_t i = 0; i + 1 < digits.size(); i += 2)
    made += static_cast<char>(std::stoi(digits.substr(i, 2), nullptr, 16));
  return made;
}

/// Reads a word between spaces: text in quotes, a name in braces, or digits with an optional repeat count.
inline std::string read_word(const std::string& word, const Words& known) {
  if (word.front() == '\'') return word.substr(1, word.size() - 2);
  if (word.front() == '{') return known.at(word.substr(1, word.size() - 2));
  const std::size_t star = word.find('*');
  if (star == word.npos) return read_hexadecimal(word);
  std::string made;
  for (int i = std::stoi(word); i > 0; --i) made += read_hexadecimal(word.substr(star + 1));
  return made;
}

/// Splits a text at spaces outside quotes.
inline std::vector<std::string> split(const std::string& text) {
  std::vector<std::string> words(1);
  bool is_quoted = false;
  for (const char letter : text) {
    is_quoted = is_quoted != (letter == '\'');
    if (letter == ' ' && !is_quoted)
      words.emplace_back();
    else
      words.back() += letter;
  }
  return words;
}

inline std::string read_bytes(const std::string& text, const Words& known) {
  std::string made;
  for (const std::string& word : split(text))
    if (!word.empty()) made += read_word(word, known);
  return made;
}

/// Reads all cases of a file, with bytes in place of their words.
inline std::vector<Case> read(const std::string& path) {
  std::vector<Case> cases;
  Words known;
  std::ifstream file(path);
  int number = 0;
  for (std::string line; std::getline(file, line);) {
    ++number;
    if (line.empty() || line[0] == '#') continue;
    const std::size_t space = std::min(line.find(' '), line.size());
    const std::string what = line.substr(0, space), rest = line.substr(std::min(space + 1, line.size()));
    if (what == "let") {
      const std::size_t end = rest.find(' ');
      known[rest.substr(0, end)] = read_bytes(rest.substr(end), known);
    } else if (what == "case") {
      cases.push_back({rest, {}});
    } else {
      const bool has_bytes = what == "gives" || what == "says" || what == "sends" || what == "reads";
      cases.back().steps.push_back({number, what, has_bytes ? read_bytes(rest, known) : rest});
    }
  }
  return cases;
}

}  // namespace script
