#include "poll_until.hpp"

#include <poll.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <system_error>

namespace metier::link {

Result<void> pollUntil(int descriptor, short events, SteadyTime deadline, const std::string& name) {
    using std::chrono::milliseconds;
    constexpr milliseconds kLongestPoll(60'000);  // only a bound for the argument of poll()
    for (;;) {
        const auto left =
            std::chrono::ceil<milliseconds>(deadline - std::chrono::steady_clock::now());
        const auto wait = std::clamp(left, milliseconds(0), kLongestPoll);
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
