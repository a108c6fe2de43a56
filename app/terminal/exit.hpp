#pragma once
// Exit codes.

namespace talus::app {

enum class Exit : int { done = 0, failed = 1, usage = 2, corrupt = 3, full = 4, differs = 5, interrupted = 130 };

}  // namespace talus::app
