#include <GeographicLib/Geodesic.hpp>
