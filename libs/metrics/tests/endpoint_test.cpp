#include "metier/metrics/endpoint.hpp"

#include <gmock/gmock.h>
#include <httplib.h>

#include <atomic>
#include <string>

namespace metier::metrics {
namespace {

using testing::HasSubstr;

class ServedFigures : public testing::Test {
protected:
    Endpoint::Options options() {
        Endpoint::Options options;
        options.metrics = [] { return std::string("# TYPE a gauge\na 1\n"); };
        options.health = [this] {
            return good_ ? Health{true, "ok"} : Health{false, "ur5: not connected"};
        };
        return options;
    }
    httplib::Client client() const { return httplib::Client("127.0.0.1", endpoint_->port()); }

    std::atomic<bool> good_{true};
    std::unique_ptr<Endpoint> endpoint_ = std::move(*Endpoint::start(options()));
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
    const auto refused = Endpoint::start(std::move(second));
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, Errc::resource_unavailable);
    EXPECT_THAT(refused.error().message, HasSubstr(std::to_string(endpoint_->port())));
}

TEST_F(ServedFigures, EndWithTheirEndpoint) {
    const auto port = endpoint_->port();
    endpoint_.reset();
    EXPECT_FALSE(httplib::Client("127.0.0.1", port).Get("/metrics"));
}

}  // namespace
}  // namespace metier::metrics
