#ifdef _WIN32

#define WIN32_LEAN_AND_MEAN
#define NOMINMAX
#include <windows.h>

#include <cstdio>
#include <cstdlib>

#include "system.h"

namespace pacinian::client {

Secret read_secret(const std::string& path, std::size_t longest, std::string& content,
                   std::string& why) {
  std::FILE* file = nullptr;
  const errno_t error = ::fopen_s(&file, path.c_str(), "rb");
  if (error == ENOENT) return Secret::absent;
  if (error != 0) {
    why = "error " + std::to_string(error);
    return Secret::unreadable;
  }
  content.resize(longest + 1);
  content.resize(std::fread(&content[0], 1, content.size(), file));
  std::fclose(file);
  return Secret::good;
}

bool runs(std::int64_t pid) {
  const HANDLE process =
      ::OpenProcess(PROCESS_QUERY_LIMITED_INFORMATION, FALSE, static_cast<DWORD>(pid));
  if (!process) return ::GetLastError() == ERROR_ACCESS_DENIED;
  DWORD code = 0;
  const bool running = ::GetExitCodeProcess(process, &code) && code == STILL_ACTIVE;
  ::CloseHandle(process);
  return running;
}

std::vector<std::string> runtime_folders() {
  char* local = nullptr;
  std::size_t size = 0;
  std::string folder;
  if (::_dupenv_s(&local, &size, "LOCALAPPDATA") == 0 && local) folder = local;
  std::free(local);
  return {folder + "\\Temp\\pacinian\\pacinian"};
}

}  // namespace pacinian::client

#endif
