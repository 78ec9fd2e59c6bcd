#include "metrics/endpoint.hpp"

#include <gmock/gmock.h>

#include <array>
#include <atomic>
#include <chrono>
#include <future>
#include <span>
#include <string>

#include "metier/http/httplib.hpp"
#include "metier/link/tcp_link.hpp"

namespace metier::server {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

class ServedFigures : public testing::Test {
protected:
    MetricsEndpoint::Options options() {
        MetricsEndpoint::Options options;
        options.metrics = [] { return std::string("# TYPE a gauge\na 1\n"); };
        options.health = [this] {
            return good_ ? ServerHealth{true, "ok"} : ServerHealth{false, "ur5: not connected"};
        };
        return options;
    }
    httplib::Client client() const { return httplib::Client("127.0.0.1", endpoint_->port()); }

    std::atomic<bool> good_{true};
    std::unique_ptr<MetricsEndpoint> endpoint_ = std::move(*MetricsEndpoint::start(options()));
};

TEST_F(ServedFigures, AreThereForPrometheus) {
    const auto answer = client().Get("/metrics");
    ASSERT_TRUE(answer);
    EXPECT_EQ(answer->status, 200);
    EXPECT_EQ(answer->get_header_value("Content-Type"), "text/plain; version=0.0.4; charset=utf-8");
    EXPECT_EQ(answer->body, "# TYPE a gauge\na 1\n");
}

TEST_F(ServedFigures, TellHealthByStatusAndWords) {
    const auto good = client().Get("/healthz");
    ASSERT_TRUE(good);
    EXPECT_EQ(good->status, 200);
    EXPECT_EQ(good->body, "ok\n");
    good_ = false;
    const auto bad = client().Get("/healthz");
    ASSERT_TRUE(bad);
    EXPECT_EQ(bad->status, 503);
    EXPECT_EQ(bad->body, "ur5: not connected\n");
}

TEST_F(ServedFigures, AreAllThatIsServed) {
    EXPECT_EQ(client().Get("/")->status, 404);
    EXPECT_EQ(client().Get("/metrics/more")->status, 404);
    EXPECT_NE(client().Post("/metrics", "a=1", "text/plain")->status, 200);
}

TEST_F(ServedFigures, HaveAPortThatNobodyShares) {
    auto second = options();
    second.port = endpoint_->port();
    const auto refused = MetricsEndpoint::start(std::move(second));
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, Errc::resource_unavailable);
    EXPECT_THAT(refused.error().message, HasSubstr(std::to_string(endpoint_->port())));
}

TEST_F(ServedFigures, EndWhileSomebodyAsksWithoutEnd) {
    const auto deadline = std::chrono::steady_clock::now() + 30s;
    auto slow = link::TcpLink::connect("127.0.0.1", endpoint_->port(), deadline).value();
    std::promise<void> begun;
    // A line of the head for ever, until the connection is cut.
    const auto talking = std::async(std::launch::async, [&] {
        const std::string first = "GET /metrics HTTP/1.1\r\nHost: 127.0.0.1\r\n";
        auto sent = slow.send(std::as_bytes(std::span(first)), deadline);
        begun.set_value();
        std::array<std::byte, 1> byte{};
        while (sent && std::chrono::steady_clock::now() < deadline) {
            const std::string line = "X-More: 1\r\n";
            sent = slow.send(std::as_bytes(std::span(line)), deadline);
            const auto soon = std::chrono::steady_clock::now() + 100ms;
            const auto told = slow.receive(byte, soon);
            if (!told && told.error().code != Errc::timeout) {
                break;
            }
        }
        return std::chrono::steady_clock::now() < deadline;
    });
    begun.get_future().wait();
    endpoint_.reset();
    EXPECT_LT(std::chrono::steady_clock::now(), deadline);
}

TEST_F(ServedFigures, EndWithTheirEndpoint) {
    const auto port = endpoint_->port();
    endpoint_.reset();
    EXPECT_FALSE(httplib::Client("127.0.0.1", port).Get("/metrics"));
}

}  // namespace
}  // namespace metier::server
