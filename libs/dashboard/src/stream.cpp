#include "stream.hpp"

#include <fmt/format.h>

#include <chrono>
#include <utility>

namespace metier::dashboard {
namespace {

/// Period of the check whether a peer to which nothing is sent is still there.
constexpr std::chrono::milliseconds kLook{200};

/// Sends what waits. \return false: the stream is over
bool sendWaiting(Outbox& outbox, httplib::DataSink& sink) {
    const auto messages = outbox.take(std::chrono::steady_clock::now() + kLook);
    if (outbox.isClosed() || !sink.is_writable()) {
        return false;
    }
    std::string bytes;
    for (const auto& message : messages) {
        bytes += *message;
    }
    if (!bytes.empty()) {
        sink.write(bytes.data(), bytes.size());
    }
    return true;
}

}  // namespace

Result<void> Streams::begin(const std::string& tab, httplib::Response& response,
                            Listener listener) {
    if (++open_ > limits_.tabs) {
        --open_;
        return fail(Errc::resource_unavailable,
                    fmt::format("{} tabs are open, and no more can be; close one", limits_.tabs));
    }
    auto outbox = board_.openTab(tab, limits_.waiting_bytes);
    response.set_header("Cache-Control", "no-store");
    response.set_header("X-Accel-Buffering", "no");  // a proxy is not to hold it back
    response.set_chunked_content_provider(
        "text/event-stream",
        [outbox, may_listen = std::move(listener.may_listen)](std::size_t /*offset*/,
                                                              httplib::DataSink& sink) {
            return may_listen() && sendWaiting(*outbox, sink);
        },
        [this, tab, on_end = std::move(listener.on_end)](bool /*success*/) {
            board_.closeTab(tab);
            on_end();
            --open_;
        });
    return {};
}

}  // namespace metier::dashboard
