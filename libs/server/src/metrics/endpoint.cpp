#include "metrics/endpoint.hpp"

#include <chrono>
#include <utility>

#include "metier/http/http_server.hpp"
#include "metrics/text_page.hpp"

namespace metier::server {
namespace {

using namespace std::chrono_literals;

constexpr int kGood = 200;
constexpr int kBad = 503;

http::HttpLimits limits() {
    http::HttpLimits limits;
    limits.connections = 8;
    limits.tabs = 0;
    limits.body_bytes = 0;
    limits.request_time = 2s;
    limits.send_time = 2s;
    return limits;
}

}  // namespace

class MetricsEndpoint::Server {
public:
    explicit Server(Options options) : options_(std::move(options)) {
        http_.Get("/metrics", [this](const httplib::Request& /*request*/, httplib::Response& to) {
            to.set_content(options_.metrics(), TextPage::kContentType);
        });
        http_.Get("/healthz", [this](const httplib::Request& /*request*/, httplib::Response& to) {
            const auto health = options_.health();
            to.status = health.good ? kGood : kBad;
            to.set_content(health.text + "\n", "text/plain; charset=utf-8");
        });
    }

    ~Server() { http_.end(); }
    Server(const Server&) = delete;
    Server& operator=(const Server&) = delete;

    Result<void> start() {
        const auto port = http_.serve(options_.address, options_.port);
        if (!port) {
            return fail(Errc::resource_unavailable, "metrics: " + port.error().message);
        }
        port_ = *port;
        return {};
    }

    std::uint16_t port() const noexcept { return port_; }

private:
    const Options options_;
    http::HttpServer http_{limits()};
    std::uint16_t port_ = 0;
};

Result<std::unique_ptr<MetricsEndpoint>> MetricsEndpoint::start(Options options) {
    auto server = std::make_unique<Server>(std::move(options));
    METIER_TRY(server->start());
    return std::unique_ptr<MetricsEndpoint>(new MetricsEndpoint(std::move(server)));
}

MetricsEndpoint::MetricsEndpoint(std::unique_ptr<Server> server) : server_(std::move(server)) {}
MetricsEndpoint::~MetricsEndpoint() = default;

std::uint16_t MetricsEndpoint::port() const noexcept {
    return server_->port();
}

}  // namespace metier::server
