#pragma once

/// Marks what other modules may call. Unreal's build defines it as DLLEXPORT or DLLIMPORT. Elsewhere it is empty.
#ifndef PACINIANCORE_API
#define PACINIANCORE_API
#endif

// Both macros are of the engine's header HAL/Platform.h, which the core does not include. Equal definitions may meet.
#ifdef _WIN32
#ifndef DLLEXPORT
#define DLLEXPORT __declspec(dllexport)
#endif
#ifndef DLLIMPORT
#define DLLIMPORT __declspec(dllimport)
#endif
#else
#ifndef DLLEXPORT
#define DLLEXPORT __attribute__((visibility("default")))
#endif
#ifndef DLLIMPORT
#define DLLIMPORT __attribute__((visibility("default")))
#endif
#endif
