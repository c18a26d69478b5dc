#ifndef _WIN32

#include <fcntl.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <limits>

#include "system.h"

namespace pacinian::client {

namespace {

Secret read_all(int file, std::size_t longest, std::string& content) {
  content.resize(longest + 1);
  std::size_t filled = 0;
  while (filled < content.size()) {
    const ssize_t got = ::read(file, &content[filled], content.size() - filled);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return Secret::unreadable;
    if (got == 0) break;
    filled += static_cast<std::size_t>(got);
  }
  content.resize(filled);
  return Secret::good;
}

}  // namespace

Secret read_secret(const std::string& path, std::size_t longest, std::string& content,
                   std::string& why) {
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (file < 0 && errno == ENOENT) return Secret::absent;
  struct stat status = {};
  Secret found = file < 0 || ::fstat(file, &status) != 0 ? Secret::unreadable : Secret::good;
  if (found == Secret::good) found = read_all(file, longest, content);
  if (found == Secret::unreadable)
    why = std::strerror(errno);
#ifndef __ANDROID__  // keeps programs' files apart, and says of all in shared storage that their group may read them
  else if (status.st_mode & (S_IRWXG | S_IRWXO))
    found = Secret::shared;
  else if (status.st_uid != ::getuid() && status.st_uid != 0)
    found = Secret::foreign;
#endif
  if (file >= 0) ::close(file);
  return found;
}

bool runs(std::int64_t pid) {
#ifdef __ANDROID__
  return pid > 0;  // on another machine
#endif
  if (pid <= 0 || pid > std::numeric_limits<pid_t>::max()) return false;
  return ::kill(static_cast<pid_t>(pid), 0) == 0 || errno == EPERM;
}

std::ifstream open_file(const std::string& path) { return std::ifstream(path, std::ios::binary); }

std::string read_variable(const std::string& name) {
  const char* value = std::getenv(name.c_str());
  return value ? value : "";
}

std::vector<std::string> runtime_folders() {
#ifdef __APPLE__
  return {read_variable("HOME") + "/Library/Caches/TemporaryItems/pacinian"};
#else
  const std::string user = std::to_string(::geteuid()), given = read_variable("XDG_RUNTIME_DIR");
  const std::string temporary = read_variable("TMPDIR");
  std::vector<std::string> folders;
  if (!given.empty()) folders.push_back(given + "/pacinian");
  folders.push_back("/run/user/" + user + "/pacinian");
  folders.push_back((temporary.empty() ? "/tmp" : temporary) + "/runtime-" + user + "/pacinian");
  return folders;
#endif
}

}  // namespace pacinian::client

#endif
