#include <gdal.h>
#include <ogr_spatialref.h>

#include "query/export/atomic_file.hpp"
