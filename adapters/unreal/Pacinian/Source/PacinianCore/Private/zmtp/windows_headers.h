#pragma once

// The headers of Windows that the core needs, for the files *_windows.cpp.

#ifndef WIN32_LEAN_AND_MEAN
#define WIN32_LEAN_AND_MEAN
#endif
#ifndef NOMINMAX
#define NOMINMAX
#endif
#ifdef _MSC_VER
#pragma warning(push)
#pragma warning(disable : 4668)  // they test macros that are not defined, which Unreal's build makes an error
#endif
#include <winsock2.h>
#include <windows.h>
#include <ws2tcpip.h>
#ifdef _MSC_VER
#pragma warning(pop)
#endif
