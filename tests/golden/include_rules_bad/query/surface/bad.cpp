#include "query/selection/threshold.hpp"
#include "engine/error/voids.hpp"
#include "query/database.hpp"         // refused
#include "query/verify/verify.hpp"    // refused
