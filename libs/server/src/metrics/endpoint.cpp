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

Result<std::unique_ptr<MetricsEndpoint>> MetricsEndpoint::start(Options options) {
    std::unique_ptr<MetricsEndpoint> made(new MetricsEndpoint);
    made->http_ = std::make_unique<http::HttpServer>(limits());
    auto& server = *made->http_;
    server.Get("/metrics", [metrics = std::move(options.metrics)](
                               const httplib::Request& /*request*/, httplib::Response& to) {
        to.set_content(metrics(), TextPage::kContentType);
    });
    server.Get("/healthz", [health = std::move(options.health)](const httplib::Request& /*request*/,
                                                                httplib::Response& to) {
        const auto now = health();
        to.status = now.good ? kGood : kBad;
        to.set_content(now.text + "\n", "text/plain; charset=utf-8");
    });
    const auto port = server.serve(options.address, options.port);
    if (!port) {
        return fail(Errc::resource_unavailable, "metrics: " + port.error().message);
    }
    made->port_ = *port;
    return made;
}

MetricsEndpoint::MetricsEndpoint() = default;

MetricsEndpoint::~MetricsEndpoint() {
    http_->end();
}

}  // namespace metier::server
