#pragma once

#include <httplib.h>

// A macro of <resolv.h>, which is also a name in Eigen.
#undef _res
