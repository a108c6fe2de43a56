#include <lmdb.h>
#include <sys/stat.h>
#include <xxhash.h>

#include "storage/good.hpp"
#include "talus/failure.hpp"
