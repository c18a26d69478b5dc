#ifdef _WIN32

#include <cstdio>
#include <cstdlib>

#include "system.h"
#include "wide_text.h"

namespace pacinian::client {

Secret read_secret(const std::string& path, std::size_t longest, std::string& content,
                   std::string& why) {
  std::FILE* file = nullptr;
  const errno_t error = ::_wfopen_s(&file, widen(path).c_str(), L"rb");
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

std::ifstream open_file(const std::string& path) { return std::ifstream(widen(path).c_str(), std::ios::binary); }

std::string read_variable(const std::string& name) {
  wchar_t* wide = nullptr;
  std::size_t size = 0;
  std::string value;
  if (::_wdupenv_s(&wide, &size, widen(name).c_str()) == 0 && wide) value = narrow(wide);
  std::free(wide);
  return value;
}

std::vector<std::string> runtime_folders() {
  return {read_variable("LOCALAPPDATA") + "\\Temp\\pacinian\\pacinian"};
}

}  // namespace pacinian::client

#endif
