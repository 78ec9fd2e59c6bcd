#include <gmock/gmock.h>

#include <array>
#include <chrono>
#include <optional>
#include <string>

#include "metier/link/tcp_link.hpp"
#include "metier/virtual_controller/testing/running_controller.hpp"
#include "payload.hpp"
#include "session.hpp"

namespace metier::virtual_controller {
ControllerType wsg50Controller();
}  // namespace metier::virtual_controller

namespace metier::virtual_wsg50 {
namespace {

using namespace std::chrono_literals;
using virtual_controller::testing::RunningController;

SteadyTime in(std::chrono::milliseconds time) {
    return std::chrono::steady_clock::now() + time;
}

/// A client as they are written for the real gripper.
class Client {
public:
    explicit Client(RunningController& controller)
        : link_(link::TcpLink::connect("127.0.0.1", controller.state()["port"], in(5s)).value()) {}

    void send(std::uint8_t id, const PayloadWriter& written = {}) {
        ASSERT_TRUE(link_.send(encode(id, written.bytes()), in(5s)));
    }
    /// The next frame, whatever it is.
    std::optional<Frame> next(std::chrono::milliseconds longest = 5s) {
        auto frame = reader_.next();
        while (!frame) {
            std::array<std::byte, 512> buffer{};
            const auto count = link_.receive(buffer, in(longest));
            if (!count) {
                return std::nullopt;
            }
            reader_.feed(std::span(buffer).first(*count));
            frame = reader_.next();
        }
        return frame;
    }
    /// Status of the next frame with this id; others are skipped.
    int awaitReply(std::uint8_t id) {
        while (auto frame = next()) {
            if (frame->id == id) {
                payload = frame->payload;
                return PayloadReader(payload).u16();
            }
        }
        return -1;
    }
    int command(std::uint8_t id, const PayloadWriter& written = {}) {
        send(id, written);
        return awaitReply(id);
    }
    bool closed() {
        while (true) {
            std::array<std::byte, 512> buffer{};
            if (const auto count = link_.receive(buffer, in(5s)); !count) {
                return count.error().code == Errc::connection_lost;
            }
        }
    }

    std::vector<std::byte> payload;

private:
    link::TcpLink link_;
    FrameReader reader_;
};

PayloadWriter update(int flags, std::uint16_t period) {
    return PayloadWriter().u8(static_cast<std::uint8_t>(flags)).u16(period);
}
PayloadWriter floats(double first, double second) {
    return PayloadWriter().f32(first).f32(second);
}

class WsgController : public ::testing::Test {
protected:
    RunningController controller_{virtual_controller::wsg50Controller(),
                                  {.settings = {{"port", 0.0}, {"homing_speed", 0.4}}}};
};

// As the client of the Robotics Library: acknowledges, asks for automatic updates of all values,
// waits for two replies to homing and positioning, for one to grasping, then reads frames as they
// come.
TEST_F(WsgController, ServesAClientThatReliesOnAutomaticUpdates) {
    controller_.setEffect({.wrench = {}, .part_width = 0.030});
    Client client(controller_);
    EXPECT_EQ(client.command(0x24, PayloadWriter().text("ack")), 0);
    for (const auto id : std::to_array<std::uint8_t>({0x40, 0x41, 0x43, 0x44})) {
        EXPECT_EQ(client.command(id, update(1, 10)), 0);
    }
    EXPECT_EQ(client.command(0x45, update(3, 10)), 0);
    EXPECT_EQ(client.command(0x20, PayloadWriter().u8(0)), 26);
    EXPECT_EQ(client.awaitReply(0x20), 0);
    EXPECT_EQ(client.command(0x21, PayloadWriter().u8(0).f32(60).f32(400)), 26);
    EXPECT_EQ(client.awaitReply(0x21), 0);
    EXPECT_EQ(client.command(0x32, PayloadWriter().f32(20)), 0);
    EXPECT_EQ(client.command(0x25, floats(30, 200)), 26);
    EXPECT_EQ(client.awaitReply(0x25), 0);
    EXPECT_EQ(client.awaitReply(0x45), 0);
    EXPECT_EQ(client.awaitReply(0x41), 0);
    EXPECT_EQ(client.payload.at(2), std::byte{4});
    EXPECT_TRUE(controller_.report().gripping);
    EXPECT_NEAR(*controller_.report().jaw_width, 0.030, 1e-6);
    EXPECT_EQ(client.command(0x26, floats(60, 400)), 26);
    EXPECT_EQ(client.awaitReply(0x26), 0);
    EXPECT_FALSE(controller_.report().gripping);
    EXPECT_EQ(client.command(0x07), 0);
}

// As the ROS driver of nalt: every value asked for one by one, no automatic updates; any frame with
// another id would end it.
TEST_F(WsgController, ServesAClientThatPolls) {
    ASSERT_TRUE(controller_.inject("part", "30"));
    Client client(controller_);
    const auto strictly = [&](std::uint8_t id, const PayloadWriter& payload, int status) {
        client.send(id, payload);
        const auto frame = client.next();
        ASSERT_TRUE(frame);
        EXPECT_EQ(frame->id, id);
        EXPECT_EQ(PayloadReader(frame->payload).u16(), status);
    };
    strictly(0x24, PayloadWriter().text("ack"), 0);
    strictly(0x20, PayloadWriter().u8(0), 26);
    EXPECT_EQ(PayloadReader(client.next()->payload).u16(), 0);
    strictly(0x30, PayloadWriter().f32(3000), 0);
    strictly(0x32, PayloadWriter().f32(40), 0);
    strictly(0x25, floats(30, 400), 26);
    EXPECT_EQ(PayloadReader(client.next()->payload).u16(), 0);
    for (const auto id : std::to_array<std::uint8_t>({0x40, 0x41, 0x43, 0x44, 0x45, 0x31, 0x33})) {
        const bool with_flags = id >= 0x40;
        strictly(id, with_flags ? update(0, 0) : PayloadWriter(), 0);
    }
    strictly(0x26, floats(60, 400), 26);
    EXPECT_EQ(PayloadReader(client.next()->payload).u16(), 0);
}

TEST_F(WsgController, StopsFastWhenItsClientGoesWithoutAWord) {
    { Client client(controller_); }
    EXPECT_TRUE(controller_.waitUntil([](const auto& state) { return state["fault"] == true; }));
    Client next(controller_);
    EXPECT_EQ(next.command(0x20, PayloadWriter().u8(0)), 16);
    EXPECT_EQ(next.command(0x24, PayloadWriter().text("ack")), 0);
    EXPECT_EQ(next.command(0x20, PayloadWriter().u8(0)), 26);
}

TEST_F(WsgController, IsCalmWhenItsClientTakesLeave) {
    {
        Client client(controller_);
        EXPECT_EQ(client.command(0x07), 0);
    }
    EXPECT_TRUE(controller_.waitUntil([](const auto& state) { return state["client"] == ""; }));
    EXPECT_EQ(controller_.state()["fault"], false);
}

TEST_F(WsgController, HasOneClientOnly) {
    Client first(controller_);
    EXPECT_EQ(first.command(0x06), 0);
    Client second(controller_);
    EXPECT_TRUE(second.closed());
    EXPECT_EQ(first.command(0x06), 0);
}

TEST_F(WsgController, LosesAPartThatSlipsOut) {
    controller_.setEffect({.wrench = {}, .part_width = 0.030});
    Client client(controller_);
    client.command(0x20, PayloadWriter().u8(0));
    EXPECT_EQ(client.awaitReply(0x20), 0);
    client.command(0x25, floats(30, 400));
    EXPECT_EQ(client.awaitReply(0x25), 0);
    ASSERT_TRUE(controller_.inject("lost-part"));
    EXPECT_TRUE(controller_.waitUntil(
        [](const auto& state) { return state["grasping_state"] == "part lost"; }));
}

TEST_F(WsgController, LosesAPartUntilThereIsAnotherOne) {
    controller_.setEffect({.wrench = {}, .part_width = 0.040});
    Client client(controller_);
    client.command(0x20, PayloadWriter().u8(0));
    ASSERT_EQ(client.awaitReply(0x20), 0);
    const auto graspsAPart = [&client] {
        client.command(0x25, floats(40, 400));
        return client.awaitReply(0x25) == 0;
    };
    ASSERT_TRUE(controller_.inject("lost-part"));
    EXPECT_FALSE(graspsAPart()) << "the world still has the part that slipped out";
    client.command(0x26, floats(110, 400));
    EXPECT_EQ(client.awaitReply(0x26), 0);
    ASSERT_TRUE(controller_.inject("part", "41"));
    EXPECT_TRUE(graspsAPart());
}

TEST_F(WsgController, SendsItsNextClientNoUpdatesThatTheOneBeforeAskedFor) {
    {
        Client client(controller_);
        EXPECT_EQ(client.command(0x43, update(1, 2)), 0);
        EXPECT_EQ(client.command(0x07), 0);
    }
    ASSERT_TRUE(controller_.waitUntil([](const auto& state) { return state["client"] == ""; }));
    Client next(controller_);
    EXPECT_FALSE(next.next(30ms));
}

TEST_F(WsgController, KeepsATagOf64BytesAndRefusesALongerOne) {
    Client client(controller_);
    const std::string tag(64, 't');
    EXPECT_EQ(client.command(0x51, PayloadWriter().text(tag)), 0);
    EXPECT_EQ(client.command(0x51, PayloadWriter().text(tag + 't')), 12);
    EXPECT_EQ(client.command(0x52), 0);
    EXPECT_EQ(client.payload.size(), 2 + 64U);
}

TEST_F(WsgController, IsBlockedWhereItIsToldTo) {
    ASSERT_TRUE(controller_.inject("block", "70"));
    Client client(controller_);
    client.command(0x20, PayloadWriter().u8(0));
    EXPECT_EQ(client.awaitReply(0x20), 29);
}

TEST_F(WsgController, NeedsAReferenceAgainAfterARestart) {
    Client client(controller_);
    client.command(0x20, PayloadWriter().u8(0));
    EXPECT_EQ(client.awaitReply(0x20), 0);
    controller_.inTurn([](auto& controller, auto&) { controller.restart(); });
    EXPECT_TRUE(client.closed());
    const auto state = controller_.state();
    EXPECT_EQ(state["referenced"], false);
    EXPECT_EQ(state["fault"], false);
}

TEST_F(WsgController, RefusesInjectionsThatItDoesNotKnow) {
    EXPECT_EQ(controller_.inject("earthquake").error().code, Errc::not_found);
    EXPECT_EQ(controller_.inject("part", "wide").error().code, Errc::invalid_argument);
    EXPECT_EQ(controller_.inject("block", "111").error().code, Errc::invalid_argument);
}

TEST(WsgControllerStart, IsCalmWhenItsClientGoesIfItIsSetSo) {
    RunningController controller(virtual_controller::wsg50Controller(),
                                 {.settings = {{"port", 0.0}, {"fast_stop_on_disconnect", false}}});
    {
        Client client(controller);
        EXPECT_EQ(client.command(0x06), 0);
    }
    EXPECT_TRUE(controller.waitUntil([](const auto& state) { return state["client"] == ""; }));
    EXPECT_EQ(controller.state()["fault"], false);
}

TEST(WsgControllerStart, RefusesSettingsThatItDoesNotKnow) {
    EXPECT_THROW(RunningController(virtual_controller::wsg50Controller(),
                                   {.settings = {{"port", 0.0}, {"colour", std::string("red")}}}),
                 std::runtime_error);
}

}  // namespace
}  // namespace metier::virtual_wsg50
