#pragma once

/// Marks what other modules may call. The engine's build defines it; elsewhere it is empty.
#ifndef PACINIANCORE_API
#define PACINIANCORE_API
#endif
