#include "common/log_bridge.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <array>
#include <cstdarg>
#include <cstdio>
#include <string_view>
#include <utility>

#include "common/guard.hpp"
#include "metier/opcua/text.hpp"

namespace metier::opcua {

namespace {

/// Level for the log. The stack's level info is about single sessions and channels: debug for us.
spdlog::level::level_enum levelOf(UA_LogLevel level) noexcept {
    if (level >= UA_LOGLEVEL_ERROR) {
        return spdlog::level::err;
    }
    if (level == UA_LOGLEVEL_WARNING) {
        return spdlog::level::warn;
    }
    return level == UA_LOGLEVEL_INFO ? spdlog::level::debug : spdlog::level::trace;
}

/// The stack links a Subscription's diagnostics to the Server's as if the client had asked for it.
/// No client may add references, so that link is missing, as intended: not worth a warning.
bool isIntended(std::string_view format) noexcept {
    return format.find("Creating the subscription diagnostics object failed") !=
           std::string_view::npos;
}

void write(void* context, UA_LogLevel level, UA_LogCategory /*category*/, const char* format,
           va_list arguments) noexcept {
    auto& target = static_cast<LogBridge*>(context)->target();
    const auto our_level = isIntended(format) ? spdlog::level::debug : levelOf(level);
    if (!target.should_log(our_level)) {
        return;
    }
    guarded([&] {
        std::array<char, 1024> text{};
        std::vsnprintf(text.data(), text.size(), format, arguments);
        std::replace(text.begin(), text.end(), '\t', ' ');  // the stack's columns
        target.log(our_level, "{}", sanitise(text.data()));
    });
}

}  // namespace

LogBridge::LogBridge(std::shared_ptr<spdlog::logger> target)
    : target_(target ? std::move(target) : spdlog::default_logger()) {
    handle_.log = write;
    handle_.context = this;
}

}  // namespace metier::opcua
