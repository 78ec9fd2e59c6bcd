#pragma once

#include <string>
#include <string_view>

#include "metier/virtual_netft/sensor.hpp"

namespace metier::virtual_netft {

/// The whole HTTP answer to a request: the sensor's configuration as /netftapi2.xml and its
/// calibration as /netftcalapi.xml; 404 for other pages, 405 for all but GET, 400 for what is none.
/// \param request at least its first line
std::string answerWeb(std::string_view request, std::string_view product,
                      const Calibration& calibration);

}  // namespace metier::virtual_netft
