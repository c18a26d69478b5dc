#pragma once

#include <string>

#include "zmtp/windows_headers.h"

namespace pacinian::client {

/// Converts UTF-8 to UTF-16, in which Windows takes paths of any language.
inline std::wstring widen(const std::string& text) {
  const int size = static_cast<int>(text.size());
  std::wstring wide(static_cast<std::size_t>(::MultiByteToWideChar(CP_UTF8, 0, text.data(), size, nullptr, 0)), L'\0');
  ::MultiByteToWideChar(CP_UTF8, 0, text.data(), size, &wide[0], static_cast<int>(wide.size()));
  return wide;
}

/// Converts UTF-16 to UTF-8.
inline std::string narrow(const std::wstring& wide) {
  const int size = static_cast<int>(wide.size());
  std::string text(static_cast<std::size_t>(::WideCharToMultiByte(CP_UTF8, 0, wide.data(), size, nullptr, 0, nullptr, nullptr)), '\0');
  ::WideCharToMultiByte(CP_UTF8, 0, wide.data(), size, &text[0], static_cast<int>(text.size()), nullptr, nullptr);
  return text;
}

}  // namespace pacinian::client
