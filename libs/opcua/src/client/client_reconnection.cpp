#include "client/client_reconnection.hpp"

#include <algorithm>

namespace metier::opcua {

ReconnectSchedule::ReconnectSchedule(const ReconnectOptions& options) : options_(options) {}

void ReconnectSchedule::begin(SteadyTime now) {
    began_ = now;
    pause_ = options_.shortest_pause;
    schedule(now);
}

void ReconnectSchedule::failed(SteadyTime now) {
    pause_ = std::min(2 * pause_, options_.longest_pause);
    schedule(now);
}

void ReconnectSchedule::schedule(SteadyTime now) {
    const auto part = std::uniform_real_distribution<double>(0.0, options_.jitter)(random_);
    next_ = now + std::chrono::duration_cast<SteadyTime::duration>((1.0 - part) * pause_);
}

bool ReconnectSchedule::expired(SteadyTime now) const {
    return options_.give_up_after && now - began_ >= *options_.give_up_after;
}

NamespaceMove::NamespaceMove(const std::vector<std::string>& before,
                             const std::vector<std::string>& after) {
    for (const auto& uri : before) {
        const auto found = std::find(after.begin(), after.end(), uri);
        now_.push_back(found == after.end()
                           ? std::nullopt
                           : std::optional(static_cast<std::uint16_t>(found - after.begin())));
    }
    // Namespace 1 is the server's own; its URI may differ from run to run.
    if (now_.size() > 1 && !now_[1]) {
        now_[1] = std::uint16_t{1};
    }
}

std::optional<std::uint16_t> NamespaceMove::operator()(std::uint16_t before) const {
    return before < now_.size() ? now_[before] : std::optional(before);
}

}  // namespace metier::opcua
