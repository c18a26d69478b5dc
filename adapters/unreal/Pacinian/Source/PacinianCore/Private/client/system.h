#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace pacinian::client {

/// How a file of secrets was found: `shared` and `foreign` are never told on Windows.
enum class Secret : std::uint8_t { good, absent, unreadable, shared, foreign };

/// At most `longest` bytes of a file that only its user may read.
Secret read_secret(const std::string& path, std::size_t longest, std::string& content, std::string& why);

/// Whether there is a process of that number.
bool runs(std::int64_t pid);

/// The user's folders for files of running programs, the likeliest first: which of them a server takes depends on
/// their permissions.
std::vector<std::string> runtime_folders();

}  // namespace pacinian::client
