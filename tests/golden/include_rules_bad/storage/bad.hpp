#pragma once
#include <lmdb.h>           // refused
#include "engine/grid.hpp"  // refused
#  include "storage/page_key.hpp"
