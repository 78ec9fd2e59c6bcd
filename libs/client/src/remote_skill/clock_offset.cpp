#include "remote_skill/clock_offset.hpp"

#include <chrono>
#include <optional>

namespace metier::client {

using composition::ClockOffset;
using std::chrono::duration_cast;
using std::chrono::nanoseconds;

namespace {

constexpr int kQuestions = 10;
const opcua::NodeId kCurrentTime(0, 2258U);  // Server/ServerStatus/CurrentTime

Result<ClockOffset> ask(opcua::Client& client) {
    const auto sent = std::chrono::steady_clock::now();
    const auto sent_utc = std::chrono::system_clock::now();
    const auto answer = client.read(kCurrentTime);
    const auto half = duration_cast<nanoseconds>(std::chrono::steady_clock::now() - sent) / 2;
    if (!answer) {
        return fail(answer.error().code, answer.error().message);
    }
    const auto time = answer->as<UtcTime>();
    if (!time) {
        return fail(Errc::type_mismatch, "ServerStatus/CurrentTime is not a UtcTime");
    }
    return ClockOffset{duration_cast<nanoseconds>(*time - sent_utc) - half, half};
}

}  // namespace

Result<ClockOffset> clockOffsetOf(opcua::Client& client) {
    std::optional<ClockOffset> best;
    for (int i = 0; i < kQuestions; ++i) {
        METIER_ASSIGN(auto offset, ask(client));
        if (!best || offset.uncertainty < best->uncertainty) {
            best = offset;
        }
    }
    return *best;
}

}  // namespace metier::client
