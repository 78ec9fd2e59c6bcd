#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "metier/base/error.hpp"

namespace metier::http {
class HttpServer;
}  // namespace metier::http

namespace metier::server {

/// Whether a server does what it is for, and in words why not.
struct ServerHealth {
    bool good = true;
    std::string text{};
};

/// An HTTP server of its own threads with `/metrics` and `/healthz`.
///
/// It has no log-in and no encryption: everybody who reaches the address can read the figures. A
/// client has two seconds for its request; eight may be connected at the same time.
/// Threading: one thread makes and ends it; that does not wait for any client's request.
class MetricsEndpoint {
public:
    struct Options {
        std::string address = "127.0.0.1";  ///< IPv4 or IPv6 address to listen on
        std::uint16_t port = 0;             ///< 0: a free one
        /// The page for Prometheus. On threads of the endpoint, several at the same time; must not
        /// wait.
        std::function<std::string()> metrics{};
        /// 200 if good, 503 if not, with the text. As `metrics`.
        std::function<ServerHealth()> health{};
    };

    /// Errors: resource_unavailable (the address cannot be listened on).
    static Result<std::unique_ptr<MetricsEndpoint>> start(Options options);
    ~MetricsEndpoint();
    MetricsEndpoint(const MetricsEndpoint&) = delete;
    MetricsEndpoint& operator=(const MetricsEndpoint&) = delete;

    std::uint16_t port() const noexcept { return port_; }

private:
    MetricsEndpoint();

    std::unique_ptr<http::HttpServer> http_;
    std::uint16_t port_ = 0;
};

}  // namespace metier::server
