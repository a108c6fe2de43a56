#include "talus/failure.hpp"

namespace talus {

std::string_view to_string(Cause cause) {
  switch (cause) {
    case Cause::invalid_argument: return "invalid argument";
    case Cause::not_found: return "not found";
    case Cause::corrupt: return "corrupt";
    case Cause::unsupported: return "unsupported";
    case Cause::full: return "disk full";
    case Cause::io: return "i/o";
    case Cause::cancelled: return "cancelled";
    case Cause::too_large: return "too large";
    case Cause::out_of_memory: return "out of memory";
  }
  return "unknown cause";  // a number of a later version, from the C interface
}

}  // namespace talus
