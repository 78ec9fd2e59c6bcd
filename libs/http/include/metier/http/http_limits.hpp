#pragma once

#include <chrono>
#include <cstddef>

namespace metier::http {

/// Limits for the clients of an HTTP server.
struct HttpLimits {
    /// Largest number of connections at the same time, streams among them; a further one is
    /// refused.
    std::size_t connections = 256;
    /// Largest number of streams at the same time.
    std::size_t tabs = 128;
    /// Largest request line with its header fields [byte].
    std::size_t head_bytes = 16'384;
    /// Largest body of one request [byte].
    std::size_t body_bytes = 262'144;
    /// Largest amount that waits to be sent to one stream [byte]; beyond it the stream is cut.
    std::size_t waiting_bytes = 2'097'152;
    /// Longest time in which one request must arrive
    std::chrono::milliseconds request_time{10'000};
    /// Longest pause between two requests of a connection
    std::chrono::milliseconds idle_time{15'000};
    /// Longest time without progress of a sending; then the connection is cut
    std::chrono::milliseconds send_time{5'000};
};

}  // namespace metier::http
