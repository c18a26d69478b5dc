#pragma once

/// Marks what other modules may call. The engine's build defines it; elsewhere it is nothing.
#ifndef PACINIANCORE_API
#define PACINIANCORE_API
#endif
