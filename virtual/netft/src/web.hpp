#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "sensor.hpp"

namespace metier::virtual_netft {

/// Content of the sensor's pages.
struct WebPages {
    std::string_view product{};
    std::string_view address{};  ///< address of the sensor
    Calibration calibration{};
    Sensor::Reading reading{};  ///< the last one
    std::array<int, 6> gauge_bias{};
    int rate = 1000;      ///< records [1/s]
    int buffer_size = 5;  ///< records in one datagram of the buffered mode
    bool rdt_enabled = true;
    int filter = 0;  ///< 0: none, to 12
};

/// Settings that a web client can change.
enum class Setting : std::uint8_t { rate, buffer_size, rdt_enabled, filter, gauge_bias };

struct Change {
    Setting setting = Setting::rate;
    int value = 0;
    std::size_t gauge = 0;  ///< gauge of a bias
};

struct WebAnswer {
    std::string text;               ///< the whole HTTP answer
    std::vector<Change> changes{};  ///< requested changes; all are within their limits
};

/// Answers a request. /netftapi2.xml is the sensor's configuration, /netftcalapi.xml its
/// calibration; /comm.cgi and /setting.cgi set the values that their variables name, all or none.
/// 404 for other pages, 405 for methods other than GET, 400 for text that is no HTTP and for
/// variables that are unknown or beyond their limits.
/// \param request the request with its empty line
WebAnswer answerWeb(std::string_view request, const WebPages& pages);

}  // namespace metier::virtual_netft
