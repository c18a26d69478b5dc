#pragma once

#include <cstddef>
#include <cstdint>
#include <fstream>
#include <string>
#include <vector>

namespace pacinian::client {

/// The result of reading a file with secrets. `shared` and `foreign` do not occur on Windows.
enum class Secret : std::uint8_t { good, absent, unreadable, shared, foreign };

/// Reads at most `longest` bytes of a file that only its user may read.
Secret read_secret(const std::string& path, std::size_t longest, std::string& content, std::string& why);

/// Opens a file for reading. path: in UTF-8, also on Windows.
std::ifstream open_file(const std::string& path);

/// Returns the value of an environment variable, in UTF-8; empty if there is none.
std::string read_variable(const std::string& name);

/// Returns whether a process with this number exists.
bool runs(std::int64_t pid);

/// Returns the user's folders for files of running programs, the likeliest first. Which of them a server uses depends
/// on their permissions.
std::vector<std::string> runtime_folders();

}  // namespace pacinian::client
