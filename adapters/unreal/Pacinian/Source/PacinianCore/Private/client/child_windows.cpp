#ifdef _WIN32

#include <utility>

#include "child.h"
#include "wide_text.h"

namespace pacinian::client {

namespace {

/// Quotes a word for CommandLineToArgvW, where backslashes count only before quotes.
std::wstring quote(const std::wstring& word) {
  std::wstring quoted = L"\"";
  std::size_t slashes = 0;
  for (const wchar_t c : word) {
    if (c == L'"') quoted.append(slashes + 1, L'\\');
    slashes = c == L'\\' ? slashes + 1 : 0;
    quoted += c;
  }
  return quoted.append(slashes, L'\\') + L'"';
}

HANDLE open_inheritable(const std::wstring& path, DWORD access, DWORD creation) {
  SECURITY_ATTRIBUTES inherited = {sizeof inherited, nullptr, TRUE};
  return ::CreateFileW(path.c_str(), access, FILE_SHARE_READ | FILE_SHARE_WRITE, &inherited, creation,
                       FILE_ATTRIBUTE_NORMAL, nullptr);
}

}  // namespace

struct Child::Handles {
  HANDLE process, input;
};

Child::Child(std::unique_ptr<Handles> handles) : handles_(std::move(handles)) {}

Child::~Child() {
  close_input();
  ::CloseHandle(handles_->process);
}

std::unique_ptr<Child> Child::start(const std::vector<std::string>& command, const std::string& log,
                                    std::string& problem) {
  std::wstring line;
  for (const std::string& word : command) line += (line.empty() ? L"" : L" ") + quote(widen(word));
  HANDLE output = open_inheritable(L"NUL", GENERIC_WRITE, OPEN_EXISTING);
  HANDLE errors = log.empty() ? output : open_inheritable(widen(log), GENERIC_WRITE, CREATE_ALWAYS);
  if (errors == INVALID_HANDLE_VALUE) {
    problem = describe_log_failure(log, "error " + std::to_string(::GetLastError()));
    ::CloseHandle(output);
    return nullptr;
  }
  SECURITY_ATTRIBUTES inherited = {sizeof inherited, nullptr, TRUE};
  HANDLE read = nullptr, write = nullptr;
  if (!::CreatePipe(&read, &write, &inherited, 0)) {
    problem = describe_program_failure(command[0], "error " + std::to_string(::GetLastError()));
    if (!log.empty()) ::CloseHandle(errors);
    ::CloseHandle(output);
    return nullptr;
  }
  ::SetHandleInformation(write, HANDLE_FLAG_INHERIT, 0);  // the pipe closes when this program ends
  HANDLE passed[] = {read, output, errors};
  const SIZE_T count = log.empty() ? 2 : 3;
  // The child inherits only these handles, whatever else the game has opened.
  SIZE_T size = 0;
  ::InitializeProcThreadAttributeList(nullptr, 1, 0, &size);
  std::vector<unsigned char> room(size);
  STARTUPINFOEXW start = {};
  start.StartupInfo.cb = sizeof start;
  start.StartupInfo.dwFlags = STARTF_USESTDHANDLES;
  start.StartupInfo.hStdInput = read;
  start.StartupInfo.hStdOutput = output;
  start.StartupInfo.hStdError = errors;
  start.lpAttributeList = reinterpret_cast<LPPROC_THREAD_ATTRIBUTE_LIST>(room.data());
  PROCESS_INFORMATION made = {};
  const bool prepared = ::InitializeProcThreadAttributeList(start.lpAttributeList, 1, 0, &size) != 0;
  const bool started =
      prepared &&
      ::UpdateProcThreadAttribute(start.lpAttributeList, 0, PROC_THREAD_ATTRIBUTE_HANDLE_LIST, passed,
                                  count * sizeof(HANDLE), nullptr, nullptr) &&
      ::CreateProcessW(nullptr, &line[0], nullptr, nullptr, TRUE, CREATE_NO_WINDOW | EXTENDED_STARTUPINFO_PRESENT,
                       nullptr, nullptr, &start.StartupInfo, &made);
  const DWORD error = ::GetLastError();
  if (prepared) ::DeleteProcThreadAttributeList(start.lpAttributeList);
  if (!log.empty()) ::CloseHandle(errors);
  ::CloseHandle(output);
  ::CloseHandle(read);
  if (started) {
    ::CloseHandle(made.hThread);
    return std::unique_ptr<Child>(new Child(std::make_unique<Handles>(Handles{made.hProcess, write})));
  }
  ::CloseHandle(write);
  return problem = describe_program_failure(command[0], "error " + std::to_string(error)), nullptr;
}

bool Child::runs() {
  if (ended_ || ::WaitForSingleObject(handles_->process, 0) == WAIT_TIMEOUT) return !ended_;
  DWORD code = 0;
  ended_ = true;
  code_ = ::GetExitCodeProcess(handles_->process, &code) ? static_cast<int>(code) : -1;
  return false;
}

void Child::close_input() {
  if (handles_->input) ::CloseHandle(std::exchange(handles_->input, nullptr));
}

void Child::kill() {
  if (runs()) ::TerminateProcess(handles_->process, 1);
}

}  // namespace pacinian::client

#endif
