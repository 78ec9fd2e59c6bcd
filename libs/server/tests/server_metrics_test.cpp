#include "metrics/server_metrics.hpp"

#include <gmock/gmock.h>
#include <httplib.h>
#include <unistd.h>

#include <future>

#include "metier/base/queue.hpp"
#include "metier/device/shared_value.hpp"
#include "metier/opcua_skill/server_executor.hpp"

namespace metier::server {
namespace {

using namespace std::chrono_literals;
using device::SafetyState;
using ::testing::HasSubstr;

/// An arm that is as safe as the test says.
class SafeArm final : public device::Arm {
public:
    void become(SafetyState safety) {
        device::ArmState state;
        state.position = device::JointArray(1);
        state.safety = safety;
        state_.write(state);
    }
    const device::ArmInfo& info() const noexcept override { return info_; }
    device::ArmState state() const noexcept override { return state_.read(); }
    device::Safety safety() const override { return {}; }
    Result<void> attach(std::shared_ptr<device::SetPointSource> /*source*/) override {
        return fail(Errc::not_supported, "it does not move");
    }
    void stop() noexcept override {}
    Result<void> resetFault() override { return {}; }
    device::Registration onSafetyChange(SafetyCallback /*callback*/) override { return {}; }

private:
    device::ArmInfo info_{"UR5", {"one"}, 8ms};
    device::SharedValue<device::ArmState> state_;
};

class WatchedServer : public ::testing::Test {
protected:
    WatchedServer() {
        arm_.become(SafetyState::normal);
        auto started =
            ServerMetrics::start(config(), {.server = *server_, .control = control_, .arm = &arm_});
        EXPECT_TRUE(started) << started.error().message;
        metrics_ = std::move(*started);
    }
    ~WatchedServer() override { server_->stop(); }

    cell::ServerConfig config() const {
        cell::ServerConfig config;
        config.name = "ur5";
        config.metrics = cell::HttpAddress{address_, 9464};
        return config;
    }
    httplib::Result get(const char* path) const {
        httplib::Client client(address_, 9464);
        client.set_read_timeout(30);
        return client.Get(path);
    }
    /// The first answer with that status and that text in it, within a minute. A machine that is
    /// busy may also hold up the server's thread: that is another text.
    std::string awaitHealth(int status, const std::string& text = "") const {
        const auto deadline = std::chrono::steady_clock::now() + 60s;
        Queue<int> nothing(1);
        while (std::chrono::steady_clock::now() < deadline) {
            const auto answer = get("/healthz");
            if (answer && answer->status == status &&
                answer->body.find(text) != std::string::npos) {
                return answer->body;
            }
            static_cast<void>(nothing.popUntil(std::chrono::steady_clock::now() + 50ms));
        }
        return "never";
    }

    const std::string address_ = "127.67." + std::to_string((::getpid() >> 8) % 256) + "." +
                                 std::to_string(::getpid() % 254 + 1);
    SystemClock clock_;
    SafeArm arm_;
    std::unique_ptr<opcua::Server> server_ = std::move(*opcua::Server::create([] {
        opcua::ServerOptions options;
        options.port = 0;
        return options;
    }()));
    skill::Control control_{std::make_shared<opcua_skill::ServerExecutor>(*server_), clock_};
    std::unique_ptr<ServerMetrics> metrics_;
};

TEST_F(WatchedServer, IsNotWellBeforeItServes) {
    EXPECT_NE(awaitHealth(503, "ur5: the server is not started yet"), "never");
    ASSERT_TRUE(server_->start());
    EXPECT_EQ(awaitHealth(200), "ok\n");
}

TEST_F(WatchedServer, IsNotWellWhileItsThreadHangsAndTellsItsFiguresAllTheSame) {
    ASSERT_TRUE(server_->start());
    EXPECT_EQ(awaitHealth(200), "ok\n");
    std::promise<void> go_on;
    std::promise<void> begun;
    server_->post([&begun, wait = go_on.get_future().share()] {
        begun.set_value();
        wait.wait();
    });
    begun.get_future().wait();
    server_->post([] {});
    EXPECT_NE(awaitHealth(503, "ur5: the server's thread has not worked for"), "never");
    const auto page = get("/metrics");
    ASSERT_TRUE(page);
    EXPECT_EQ(page->status, 200);
    EXPECT_THAT(page->body, HasSubstr("metier_server_silence_seconds "));
    EXPECT_THAT(page->body, HasSubstr("metier_queue_length{queue=\"server_thread\"} 1\n"));
    go_on.set_value();
    EXPECT_EQ(awaitHealth(200), "ok\n");
}

TEST_F(WatchedServer, IsNotWellWithoutItsDevice) {
    ASSERT_TRUE(server_->start());
    arm_.become(SafetyState::disconnected);
    EXPECT_NE(awaitHealth(503, "ur5: the controller of UR5 is not connected"), "never");
    EXPECT_THAT(get("/metrics")->body,
                HasSubstr("metier_device_state{device=\"UR5\",state=\"disconnected\"} 1"));
    arm_.become(SafetyState::protective_stop);
    EXPECT_EQ(awaitHealth(200), "ok\n") << "the server does what it is for";
}

TEST_F(WatchedServer, RefusesAnAddressThatIsTaken) {
    const auto second = ServerMetrics::start(config(), {.server = *server_, .control = control_});
    ASSERT_FALSE(second);
    EXPECT_EQ(second.error().code, Errc::resource_unavailable);
}

}  // namespace
}  // namespace metier::server
