#include "metier/metrics/endpoint.hpp"

#include <fmt/format.h>
#include <httplib.h>

#include <atomic>
#include <thread>
#include <utility>

#include "metier/metrics/text_page.hpp"

namespace metier::metrics {
namespace {

constexpr std::size_t kThreads = 2;
constexpr std::time_t kPatience = 2;  // with a client [s]
constexpr int kGood = 200;
constexpr int kBad = 503;

/// The library's own options let a second server share the port.
void keepPort(socket_t socket) {
    const int yes = 1;
    static_cast<void>(setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof(yes)));
}

}  // namespace

class Endpoint::Server {
public:
    explicit Server(Options options) : options_(std::move(options)) {
        http_.set_socket_options(keepPort);
        http_.set_keep_alive_max_count(1);
        http_.set_read_timeout(kPatience);
        http_.set_write_timeout(kPatience);
        http_.set_payload_max_length(0);
        // NOLINTNEXTLINE(cppcoreguidelines-owning-memory): the library deletes it
        http_.new_task_queue = [] { return new httplib::ThreadPool(kThreads); };
        http_.Get("/metrics", [this](const httplib::Request& /*request*/, httplib::Response& to) {
            to.set_content(options_.metrics(), TextPage::kContentType);
        });
        http_.Get("/healthz", [this](const httplib::Request& /*request*/, httplib::Response& to) {
            const auto health = options_.health();
            to.status = health.good ? kGood : kBad;
            to.set_content(health.text + "\n", "text/plain; charset=utf-8");
        });
    }

    ~Server() {
        if (thread_.joinable()) {
            http_.stop();
        }
    }
    Server(const Server&) = delete;
    Server& operator=(const Server&) = delete;

    Result<void> start() {
        const bool any = options_.port == 0;
        const int port = any ? http_.bind_to_any_port(options_.address)
                         : http_.bind_to_port(options_.address, options_.port) ? options_.port
                                                                               : -1;
        if (port <= 0) {
            return fail(Errc::resource_unavailable,
                        fmt::format("metrics: cannot listen on {}, port {}", options_.address,
                                    options_.port));
        }
        port_ = static_cast<std::uint16_t>(port);
        thread_ = std::jthread([this] {
            http_.listen_after_bind();
            ended_ = true;
        });
        while (!http_.is_running() && !ended_) {
            std::this_thread::yield();  // before it runs it could not be stopped
        }
        return {};
    }

    std::uint16_t port() const noexcept { return port_; }

private:
    const Options options_;
    httplib::Server http_;
    std::uint16_t port_ = 0;
    std::atomic<bool> ended_{false};
    std::jthread thread_;
};

Result<std::unique_ptr<Endpoint>> Endpoint::start(Options options) {
    auto server = std::make_unique<Server>(std::move(options));
    if (auto started = server->start(); !started) {
        return fail(started.error());
    }
    return std::unique_ptr<Endpoint>(new Endpoint(std::move(server)));
}

Endpoint::Endpoint(std::unique_ptr<Server> server) : server_(std::move(server)) {}
Endpoint::~Endpoint() = default;

std::uint16_t Endpoint::port() const noexcept {
    return server_->port();
}

}  // namespace metier::metrics
