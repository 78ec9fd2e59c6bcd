#pragma once

#include <chrono>
#include <cstddef>

namespace metier::http {

/// What peers may ask of a server.
struct HttpLimits {
    std::size_t connections = 256;                   ///< at the same time, streams among them
    std::size_t tabs = 128;                          ///< streams at the same time
    std::size_t head_bytes = 16'384;                 ///< request line and header fields
    std::size_t body_bytes = 262'144;                ///< of one request
    std::size_t waiting_bytes = 2'097'152;           ///< owed to one stream; then it is cut
    std::chrono::milliseconds request_time{10'000};  ///< for one request to arrive
    std::chrono::milliseconds idle_time{15'000};     ///< between two requests of a connection
    std::chrono::milliseconds send_time{5'000};      ///< without progress; then it is cut
};

}  // namespace metier::http
