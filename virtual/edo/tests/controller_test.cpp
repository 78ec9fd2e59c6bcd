#include "metier/virtual_controller/controller.hpp"

#include <gmock/gmock.h>

#include <array>
#include <asio/connect.hpp>
#include <asio/ip/tcp.hpp>
#include <asio/post.hpp>
#include <asio/read.hpp>
#include <asio/write.hpp>
#include <chrono>
#include <future>
#include <thread>

#include "message_types.hpp"
#include "rig.hpp"

namespace metier::virtual_controller {
ControllerType edoController();
}

namespace metier::virtual_edo {
namespace {

using namespace std::chrono_literals;
using asio::ip::tcp;
using testing::HasSubstr;
using virtual_controller::Controller;
using virtual_controller::ControllerRequest;

class EmptyWorld final : public virtual_controller::WorldLink {
public:
    void report(const virtual_controller::WorldReport& report) override { newest = report; }
    const virtual_controller::WorldEffect& effect() const override { return effect_; }

    virtual_controller::WorldReport newest;

private:
    virtual_controller::WorldEffect effect_;
};

using Values = std::map<std::string, cell::Settings::Value>;

Result<std::unique_ptr<Controller>> startEdo(asio::io_context& context, EmptyWorld& world,
                                             virtual_controller::LinkFaults& faults,
                                             const Values& settings) {
    return virtual_controller::edoController().start(
        ControllerRequest{.context = context,
                          .name = "edo",
                          .address = "127.0.0.1",
                          .settings = cell::Settings("test", settings),
                          .model = &edoModel(),
                          .faults = faults,
                          .world = world});
}

/// A controller on a thread of its own, ten times as fast as life.
class Controlled {
public:
    explicit Controlled(Values settings = {}) {
        settings.emplace("port", 0.0);
        settings.emplace("time_scale", 10.0);
        controller_ = startEdo(context_, world, faults, settings).value();
        port = controller_->state()["port"].get<std::uint16_t>();
        thread_ = std::jthread([this] { context_.run(); });
    }
    Controlled(const Controlled&) = delete;
    Controlled& operator=(const Controlled&) = delete;
    ~Controlled() { context_.stop(); }

    /// Runs on the controller's thread.
    template <typename Action>
    auto inTurn(Action action) {
        std::packaged_task<std::invoke_result_t<Action, Controller&>()> task(
            [&] { return action(*controller_); });
        asio::post(context_, [&] { task(); });
        return task.get_future().get();
    }

    virtual_controller::LinkFaults faults;
    EmptyWorld world;
    std::uint16_t port = 0;

private:
    asio::io_context context_;
    std::unique_ptr<Controller> controller_;
    std::jthread thread_;
};

/// A client of its own making over a real socket; every read ends after 5 s.
class SocketClient {
public:
    explicit SocketClient(std::uint16_t port) : socket_(context_) {
        socket_.connect(tcp::endpoint(asio::ip::make_address("127.0.0.1"), port));
        write(
            "GET / HTTP/1.1\r\nHost: edo\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
            "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Version: 13\r\n"
            "Sec-WebSocket-Extensions: permessage-deflate\r\n\r\n");
        while (incoming_.find("\r\n\r\n") == std::string::npos && readSome()) {
        }
        response = incoming_.substr(0, incoming_.find("\r\n\r\n"));
        incoming_.erase(0, response.size() + 4);
    }

    void write(const std::string& bytes) { asio::write(socket_, asio::buffer(bytes)); }
    void say(const Json& message) {
        const std::string text = message.dump();
        std::string frame = "\x81";
        frame += static_cast<char>(0xFE);
        frame += static_cast<char>(text.size() >> 8);
        frame += static_cast<char>(text.size() & 0xFF);
        frame.append(4, '\0');  // a mask that changes nothing
        write(frame + text);
    }
    void subscribe(const std::string& topic) { say({{"op", "subscribe"}, {"topic", topic}}); }
    void publish(const std::string& topic, const Json& message) {
        say({{"op", "publish"}, {"topic", topic}, {"msg", message}});
    }
    /// The next message; null when the connection has ended.
    Json next() {
        while (true) {
            if (incoming_.size() >= 2) {
                std::size_t length = static_cast<std::uint8_t>(incoming_[1]);
                std::size_t header = 2;
                if (length == 126 && incoming_.size() >= 4) {
                    length =
                        static_cast<std::size_t>(static_cast<std::uint8_t>(incoming_[2])) * 256 +
                        static_cast<std::uint8_t>(incoming_[3]);
                    header = 4;
                }
                if (length != 126 && incoming_.size() >= header + length) {
                    const auto text = incoming_.substr(header, length);
                    const bool is_text = incoming_[0] == '\x81';
                    incoming_.erase(0, header + length);
                    return is_text ? Json::parse(text) : Json(nullptr);
                }
            }
            if (!readSome()) {
                return nullptr;
            }
        }
    }
    /// The next message of a topic that fulfils a condition; null at the end.
    template <typename Condition>
    Json await(const std::string& topic, Condition condition) {
        for (Json message = next(); !message.is_null(); message = next()) {
            if (message["op"] == "publish" && message["topic"] == topic &&
                condition(message["msg"])) {
                return message["msg"];
            }
        }
        return nullptr;
    }
    bool awaitState(int state) {
        return !await("/machine_state", [&](const Json& msg) {
                    return msg["current_state"] == state;
                }).is_null();
    }

    std::string response;

private:
    bool readSome() {
        std::array<char, 4096> part{};
        std::size_t count = 0;
        bool failed = false;
        socket_.async_read_some(asio::buffer(part),
                                [&](const asio::error_code& error, std::size_t n) {
                                    failed = static_cast<bool>(error);
                                    count = n;
                                });
        context_.restart();
        context_.run_for(5s);
        if (!context_.stopped()) {
            socket_.close();
            context_.run();
        }
        incoming_.append(part.data(), count);
        return !failed;
    }

    asio::io_context context_;
    tcp::socket socket_;
    std::string incoming_;
};

TEST(Controller, StartsUpOverARealSocketAndMoves) {
    Controlled edo({{"ready", false}});
    SocketClient client(edo.port);
    EXPECT_THAT(client.response, HasSubstr("101 Switching Protocols"));
    EXPECT_THAT(client.response, Not(HasSubstr("deflate")));
    client.subscribe("/machine_state");
    client.subscribe("/machine_movement_ack");
    EXPECT_TRUE(client.awaitState(0));
    client.publish("/bridge_init", {{"mode", 0}, {"joints_mask", 127}, {"reduction_factor", 0.0}});
    EXPECT_TRUE(client.awaitState(6));
    client.publish("/bridge_jnt_reset", {{"joints_mask", 127}, {"disengage_steps", 2000}});
    EXPECT_TRUE(client.awaitState(1));
    client.publish("/bridge_jnt_calib", {{"joints_mask", 127}});
    EXPECT_TRUE(client.awaitState(2));
    client.publish(
        "/bridge_move",
        {{"move_command", 77},
         {"move_type", 74},
         {"ovr", 100},
         {"target",
          {{"data_type", 74}, {"joints_mask", 63}, {"joints_data", {5, 5, 5, 5, 5, 5}}}}});
    EXPECT_FALSE(
        client.await("/machine_movement_ack", [](const Json& ack) { return ack["type"] == 2; })
            .is_null());
    const auto joints = edo.inTurn([](Controller& c) { return c.state()["joint_position"]; });
    EXPECT_NEAR(joints[0].get<double>(), 5 * kDegree, 0.01);
}

TEST(Controller, ServesTwoClientsAndForgetsWhoLeft) {
    Controlled edo;
    SocketClient first(edo.port);
    {
        SocketClient second(edo.port);
        second.subscribe("/usb_jnt_state");
        EXPECT_FALSE(second.next().is_null());
        EXPECT_EQ(edo.inTurn([](Controller& c) { return c.state()["clients"].get<int>(); }), 2);
    }
    first.subscribe("/machine_state");
    EXPECT_TRUE(first.awaitState(2));
    for (int i = 0;
         i < 1000 && edo.inTurn([](Controller& c) { return c.state()["clients"].get<int>(); }) != 1;
         ++i) {
        first.next();
    }
    EXPECT_EQ(edo.inTurn([](Controller& c) { return c.state()["clients"].get<int>(); }), 1);
}

TEST(Controller, BreaksEveryConnectionAtARestartAndBeginsAnew) {
    Controlled edo;
    SocketClient client(edo.port);
    client.subscribe("/machine_state");
    EXPECT_TRUE(client.awaitState(2));
    edo.inTurn([](Controller& c) { return c.inject({"brake", ""}).has_value(); });
    EXPECT_TRUE(client.awaitState(6));
    edo.inTurn([](Controller& c) {
        c.restart();
        return true;
    });
    while (!client.next().is_null()) {
    }
    SocketClient again(edo.port);
    again.subscribe("/machine_state");
    EXPECT_TRUE(again.awaitState(2));
}

TEST(Controller, ClosesTheConnectionOfAClientThatBreaksTheProtocol) {
    Controlled edo;
    SocketClient client(edo.port);
    client.write("\x81\x05Hello");
    EXPECT_TRUE(client.next().is_null());
    SocketClient other(edo.port);
    other.subscribe("/machine_state");
    EXPECT_TRUE(other.awaitState(2));
}

TEST(Controller, ReportsFlangeAndJawsToTheWorld) {
    Controlled edo;
    SocketClient client(edo.port);
    client.subscribe("/machine_state");
    EXPECT_TRUE(client.awaitState(2));
    const auto report = edo.inTurn([&](Controller&) { return edo.world.newest; });
    EXPECT_GT(report.time, 0.0);
    ASSERT_TRUE(report.base_from_flange);
    EXPECT_NEAR(report.jaw_width.value(), 0.0, 1e-9);
}

TEST(Controller, ServesKinematicsOnlyIfItIsSetTo) {
    for (const bool wanted : {false, true}) {
        Controlled edo({{"kinematics_services", wanted}});
        SocketClient client(edo.port);
        client.say({{"op", "call_service"}, {"service", "/algo_direct_kinematics_srv"}});
        Json answer = client.next();
        while (!answer.is_null() && answer["op"] != "service_response") {
            answer = client.next();
        }
        EXPECT_EQ(answer["result"], wanted);
    }
}

TEST(Controller, RefusesSettingsThatAreWrong) {
    asio::io_context context;
    EmptyWorld world;
    virtual_controller::LinkFaults faults;
    const auto started = startEdo(
        context, world, faults, {{"software", std::string("9.9")}, {"axes", 5.0}, {"speed", 1.0}});
    ASSERT_FALSE(started);
    EXPECT_EQ(started.error().code, Errc::invalid_argument);
    EXPECT_THAT(started.error().message, HasSubstr("2.4.0"));
    EXPECT_THAT(started.error().message, HasSubstr("speed"));
    EXPECT_THAT(started.error().message, HasSubstr("axes"));
}

}  // namespace
}  // namespace metier::virtual_edo
