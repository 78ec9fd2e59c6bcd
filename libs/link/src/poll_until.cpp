#include "poll_until.hpp"

#include <poll.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <system_error>

namespace metier::link {
namespace {

// Longest wait of one poll(); only a bound for its argument.
constexpr auto kLongestPoll = std::chrono::milliseconds(60'000);

}  // namespace

Result<void> pollUntil(int descriptor, short events, SteadyTime deadline, const std::string& name) {
    for (;;) {
        const auto left = std::chrono::ceil<std::chrono::milliseconds>(
            deadline - std::chrono::steady_clock::now());
        const auto wait =
            std::clamp(left, std::chrono::milliseconds(0), std::chrono::milliseconds(kLongestPoll));
        pollfd request{descriptor, events, 0};
        const int ready = ::poll(&request, 1, static_cast<int>(wait.count()));
        if (ready > 0) {
            return {};
        }
        if (ready == 0 && left <= kLongestPoll) {
            return fail(Errc::timeout, name + ": no answer in time");
        }
        if (ready < 0 && errno != EINTR) {
            return fail(Errc::connection_lost,
                        name + ": " + std::generic_category().message(errno));
        }
    }
}

}  // namespace metier::link
