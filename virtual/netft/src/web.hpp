#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "sensor.hpp"

namespace metier::virtual_netft {

/// What the sensor's pages tell.
struct WebPages {
    std::string_view product{};
    std::string_view address{};  ///< of the sensor
    Calibration calibration{};
    Sensor::Reading reading{};  ///< the last one
    std::array<int, 6> gauge_bias{};
    int rate = 1000;      ///< records [1/s]
    int buffer_size = 5;  ///< records in one datagram of the buffered mode
    bool rdt_enabled = true;
    int filter = 0;  ///< 0: none, to 12
};

/// What a web client can set.
enum class Setting : std::uint8_t { rate, buffer_size, rdt_enabled, filter, gauge_bias };

struct Change {
    Setting setting = Setting::rate;
    int value = 0;
    std::size_t gauge = 0;  ///< of a bias
};

struct WebAnswer {
    std::string text;               ///< the whole HTTP answer
    std::vector<Change> changes{};  ///< that the request asks for; all are within their limits
};

/// Answers a request: the sensor's configuration as /netftapi2.xml and its calibration as
/// /netftcalapi.xml; /comm.cgi and /setting.cgi set what their variables name, all or nothing; 404
/// for other pages, 405 for all but GET, 400 for what is no HTTP and for variables that are unknown
/// or beyond their limits.
/// \param request with its empty line
WebAnswer answerWeb(std::string_view request, const WebPages& pages);

}  // namespace metier::virtual_netft
