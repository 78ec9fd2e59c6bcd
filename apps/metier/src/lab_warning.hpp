#pragma once

#include <spdlog/spdlog.h>

#include <string>

#include "security.hpp"

namespace metier::app {

/// Warns in the log that a server has no security; nothing unless this is an insecure lab.
inline void warnOfLab(const std::string& server, const std::string& url) {
    if (isInsecureLab()) {
        spdlog::warn("INSECURE LAB: {} at {} has no encryption and lets anonymous users in", server,
                     url);
    }
}

}  // namespace metier::app
