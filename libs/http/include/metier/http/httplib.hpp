#pragma once

#include <httplib.h>

// _res is a macro of <resolv.h> and a name in Eigen.
#undef _res
