#include <gmock/gmock.h>

#include <array>
#include <asio/ip/tcp.hpp>
#include <bit>
#include <chrono>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "iiwa_model.hpp"
#include "metier/link/tcp_link.hpp"
#include "metier/virtual_controller/testing/running_controller.hpp"

namespace metier::virtual_controller {
ControllerType iiwaController();
}  // namespace metier::virtual_controller

namespace metier::virtual_iiwa {
namespace {

using namespace std::chrono_literals;
using virtual_controller::testing::RunningController;

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

SteadyTime in(std::chrono::milliseconds time) {
    return std::chrono::steady_clock::now() + time;
}

/// A PC as they are written for the real cabinet: listens, sends eight floats, gets thirty-eight.
class Pc {
public:
    Pc() : listener_(link::TcpListener::listen("127.0.0.1", 0).value()) {}

    double port() const { return listener_.port(); }
    void accept() { link_ = listener_.accept(in(10s)).value(); }
    bool isDialled(std::chrono::milliseconds longest) {
        return listener_.accept(in(longest)).has_value();
    }
    void sendRaw(std::span<const std::byte> bytes) { ASSERT_TRUE(link_->send(bytes, in(5s))); }
    void send(std::initializer_list<float> numbers) {
        std::array<std::byte, 32> bytes{};
        std::size_t at = 0;
        for (const float number : numbers) {
            const auto bits = std::bit_cast<std::uint32_t>(number);
            for (int shift = 24; shift >= 0; shift -= 8) {
                bytes.at(at++) =
                    static_cast<std::byte>(bits >> static_cast<unsigned>(shift) & 0xFFU);
            }
        }
        sendRaw(bytes);
    }
    bool receive(std::chrono::milliseconds longest = 10s) {
        std::array<std::byte, 152> bytes{};
        if (!link_->receiveAll(bytes, in(longest))) {
            return false;
        }
        for (std::size_t i = 0; i < state.size(); ++i) {
            std::uint32_t bits = 0;
            for (std::size_t byte = 4 * i; byte < 4 * i + 4; ++byte) {
                bits = bits << 8U | std::to_integer<std::uint32_t>(bytes.at(byte));
            }
            state.at(i) = std::bit_cast<float>(bits);
        }
        return true;
    }
    /// Status of the answer; -1 if there is none.
    float command(std::initializer_list<float> numbers) {
        send(numbers);
        return receive() ? state[0] : -1.0F;
    }
    bool pollUntilStanding() {
        for (int polls = 0; polls < 20'000; ++polls) {
            if (command({0}) != 0.0F) {
                return false;
            }
            if (state[37] == 0.0F) {
                return true;
            }
        }
        return false;
    }
    bool closed() {
        std::array<std::byte, 1> byte{};
        const auto count = link_->receive(byte, in(10s));
        return !count && count.error().code == Errc::connection_lost;
    }
    void hangUp() { link_.reset(); }

    std::array<float, 38> state{};

private:
    link::TcpListener listener_;
    std::optional<link::TcpLink> link_;
};

class IiwaTest : public ::testing::Test {
protected:
    RunningController cabinet(std::map<std::string, cell::Settings::Value> settings = {}) {
        settings.insert({{"pc_port", pc_.port()}, {"redial_delay", 0.02}});
        return {virtual_controller::iiwaController(),
                {.settings = std::move(settings), .model = &iiwaModel()}};
    }
    static float home(std::size_t axis) { return static_cast<float>(iiwaModel().home()[axis]); }

    Pc pc_;
};

// As libiiwa's own client does it: velocity, interface, motion type, force condition, joint move,
// then polling until the motion ended.
TEST_F(IiwaTest, ServesAPcThatSetsUpMovesAndPolls) {
    auto controller = cabinet();
    pc_.accept();
    EXPECT_EQ(pc_.command({201, 0.5F}), 1.0F);
    EXPECT_EQ(pc_.command({302, 31}), 1.0F);
    EXPECT_EQ(pc_.command({303, 21}), 1.0F);
    EXPECT_EQ(pc_.command({211, 15, 15, 15, 5, 5, 5}), 1.0F);
    EXPECT_EQ(pc_.command({102, 0.2F, home(1), home(2), home(3), home(4), home(5), home(6)}), 1.0F);
    EXPECT_EQ(pc_.state[37], 1.0F);
    ASSERT_TRUE(pc_.pollUntilStanding());
    EXPECT_NEAR(pc_.state[1], 0.2F, 1e-6);
    EXPECT_EQ(pc_.state[34], -10.0F);
    EXPECT_EQ(pc_.state[35], 0.0F);
    EXPECT_EQ(pc_.state[36], 1.0F);
}

TEST_F(IiwaTest, StopsWhenTheArmMeetsTheWorld) {
    auto controller = cabinet();
    pc_.accept();
    EXPECT_EQ(pc_.command({211, kNaN, kNaN, 15, 5, 5, 5}), 1.0F);
    EXPECT_EQ(pc_.command({201, 0.3F}), 1.0F);
    EXPECT_EQ(pc_.command({102, 1.0F, kNaN, kNaN, kNaN, kNaN, kNaN, kNaN}), 1.0F);
    controller.setEffect({.wrench = {{0.0, 0.0, -20.0}, {0.0, 0.0, 0.0}}, .part_width = {}});
    ASSERT_TRUE(pc_.pollUntilStanding());
    EXPECT_EQ(pc_.state[35], 1.0F);
    EXPECT_EQ(pc_.state[30], -20.0F);
    EXPECT_LT(pc_.state[1], 0.9F);
    EXPECT_TRUE(controller.report().base_from_flange.has_value());
    EXPECT_GT(controller.report().time, 0.0);
}

TEST_F(IiwaTest, TakesItsTimeToAnswer) {
    auto controller = cabinet({{"answer_delay", 0.010}});
    pc_.accept();
    const auto begin = std::chrono::steady_clock::now();
    for (int i = 0; i < 5; ++i) {
        pc_.command({0});
    }
    EXPECT_GE(std::chrono::steady_clock::now() - begin, 45ms);
}

TEST_F(IiwaTest, AnswersASynchronousMoveWhenItEnded) {
    auto controller = cabinet();
    pc_.accept();
    EXPECT_EQ(pc_.command({305, 52}), 1.0F);
    EXPECT_EQ(pc_.command({102, 0.1F, kNaN, kNaN, kNaN, kNaN, kNaN, kNaN}), 1.0F);
    EXPECT_EQ(pc_.state[37], 0.0F);
    EXPECT_NEAR(pc_.state[1], 0.1F, 1e-6);
}

TEST_F(IiwaTest, EndsOnACommandInTwoParts) {
    auto controller = cabinet();
    pc_.accept();
    pc_.sendRaw(std::array<std::byte, 16>{});
    EXPECT_TRUE(pc_.closed());
    pc_.accept();
    EXPECT_EQ(pc_.command({201, 0.5F}), 1.0F);
}

TEST_F(IiwaTest, TakesCommandsThatWaitOneByOne) {
    auto controller = cabinet();
    pc_.accept();
    pc_.send({201, 0.5F});
    pc_.send({201, 7.0F});
    ASSERT_TRUE(pc_.receive());
    EXPECT_EQ(pc_.state[0], 1.0F);
    ASSERT_TRUE(pc_.receive());
    EXPECT_EQ(pc_.state[34], -11.0F);
}

TEST_F(IiwaTest, EndsOnMoreBytesThanItKeepsWhileItIsBusy) {
    auto controller = cabinet();
    pc_.accept();
    EXPECT_EQ(pc_.command({201, 0.02F}), 1.0F);
    EXPECT_EQ(pc_.command({305, 52}), 1.0F);
    pc_.send({102, 1.0F, kNaN, kNaN, kNaN, kNaN, kNaN, kNaN});
    const auto moves = [](const auto& state) { return state.value("moving", false); };
    ASSERT_TRUE(controller.waitUntil(moves));
    pc_.sendRaw(std::vector<std::byte>(65'536));
    EXPECT_TRUE(controller.waitUntil(moves));
    pc_.sendRaw(std::array<std::byte, 1>{});
    EXPECT_TRUE(pc_.closed());
    EXPECT_TRUE(controller.waitUntil([](const auto& state) { return state["moving"] == false; }));
}

TEST_F(IiwaTest, AnswersASynchronousMoveThatTheEmergencyStopEnded) {
    auto controller = cabinet();
    pc_.accept();
    EXPECT_EQ(pc_.command({201, 0.05F}), 1.0F);
    EXPECT_EQ(pc_.command({305, 52}), 1.0F);
    pc_.send({102, 1.0F, kNaN, kNaN, kNaN, kNaN, kNaN, kNaN});
    ASSERT_TRUE(controller.waitUntil([](const auto& state) { return state["moving"] == true; }));
    ASSERT_TRUE(controller.inject("emergency-stop"));
    ASSERT_TRUE(pc_.receive());
    EXPECT_EQ(pc_.state[0], 0.0F);
    EXPECT_EQ(pc_.state[34], -13.0F);
    EXPECT_EQ(pc_.state[36], 0.0F);
}

TEST_F(IiwaTest, EndsOnANegativeNumberAndOnAWrongJoint) {
    auto controller = cabinet();
    pc_.accept();
    pc_.send({-1});
    EXPECT_TRUE(pc_.closed());
    pc_.accept();
    pc_.send({212, 7, -1, 1});
    EXPECT_TRUE(pc_.closed());
}

TEST_F(IiwaTest, IsSilentInThePeriodicalMode) {
    auto controller = cabinet();
    pc_.accept();
    EXPECT_EQ(pc_.command({301, 12}), 1.0F);
    pc_.send({0});
    EXPECT_FALSE(pc_.receive(50ms));
}

TEST_F(IiwaTest, StopsAndDialsAgainWhenThePcHangsUp) {
    auto controller = cabinet();
    pc_.accept();
    EXPECT_EQ(pc_.command({201, 0.2F}), 1.0F);
    EXPECT_EQ(pc_.command({302, 7}), 0.0F);
    EXPECT_EQ(pc_.command({102, 1.0F, kNaN, kNaN, kNaN, kNaN, kNaN, kNaN}), 1.0F);
    pc_.hangUp();
    EXPECT_TRUE(controller.waitUntil([](const auto& state) { return state["moving"] == false; }));
    pc_.accept();
    EXPECT_EQ(pc_.command({0}), 0.0F);
    EXPECT_LT(pc_.state[1], 0.9F);
    EXPECT_EQ(pc_.state[34], -10.0F) << "a new application has no error";
}

TEST_F(IiwaTest, StaysAwayIfNobodyRestartsTheApplication) {
    auto controller = cabinet({{"redial", false}});
    pc_.accept();
    ASSERT_TRUE(controller.inject("end-application"));
    EXPECT_TRUE(pc_.closed());
    EXPECT_FALSE(pc_.isDialled(100ms));
}

TEST_F(IiwaTest, IsNotReadyWhileTheEmergencyStopIsPressed) {
    auto controller = cabinet();
    pc_.accept();
    EXPECT_EQ(pc_.command({102, 1.0F, kNaN, kNaN, kNaN, kNaN, kNaN, kNaN}), 1.0F);
    ASSERT_TRUE(controller.inject("emergency-stop"));
    ASSERT_TRUE(pc_.pollUntilStanding());
    EXPECT_EQ(pc_.state[36], 0.0F);
    EXPECT_EQ(pc_.command({102, 1.0F, kNaN, kNaN, kNaN, kNaN, kNaN, kNaN}), 0.0F);
    ASSERT_TRUE(controller.inject("release-emergency-stop"));
    EXPECT_EQ(pc_.command({102, 0.1F, kNaN, kNaN, kNaN, kNaN, kNaN, kNaN}), 1.0F);
    EXPECT_EQ(pc_.state[36], 1.0F);
}

TEST_F(IiwaTest, FailsAMotionByAProtectiveStop) {
    auto controller = cabinet();
    pc_.accept();
    EXPECT_EQ(pc_.command({201, 0.05F}), 1.0F);
    EXPECT_EQ(pc_.command({102, 1.0F, kNaN, kNaN, kNaN, kNaN, kNaN, kNaN}), 1.0F);
    ASSERT_TRUE(controller.inject("protective-stop"));
    ASSERT_TRUE(pc_.pollUntilStanding());
    EXPECT_EQ(pc_.state[34], -14.0F);
    EXPECT_EQ(pc_.state[36], 1.0F);
    ASSERT_TRUE(controller.inject("limit"));
    pc_.command({0});
    EXPECT_EQ(pc_.state[36], 0.0F);
    ASSERT_TRUE(controller.inject("ready"));
    for (const auto* mode : {"T1", "T2"}) {
        ASSERT_TRUE(controller.inject("operating-mode", mode));
        pc_.command({0});
        EXPECT_EQ(pc_.state[36], 0.0F);
        ASSERT_TRUE(controller.inject("operating-mode", "AUT"));
        pc_.command({0});
        EXPECT_EQ(pc_.state[36], 1.0F);
    }
    EXPECT_FALSE(controller.inject("operating-mode", "T3"));
    ASSERT_TRUE(controller.inject("not-ready"));
    pc_.command({0});
    EXPECT_EQ(pc_.state[36], 0.0F);
}

TEST_F(IiwaTest, AnswersASynchronousMoveThatAProtectiveStopEnded) {
    auto controller = cabinet();
    pc_.accept();
    EXPECT_EQ(pc_.command({201, 0.05F}), 1.0F);
    EXPECT_EQ(pc_.command({305, 52}), 1.0F);
    pc_.send({102, 1.0F, kNaN, kNaN, kNaN, kNaN, kNaN, kNaN});
    ASSERT_TRUE(controller.waitUntil([](const auto& state) { return state["moving"] == true; }));
    ASSERT_TRUE(controller.inject("protective-stop"));
    ASSERT_TRUE(pc_.receive());
    EXPECT_EQ(pc_.state[0], 0.0F);
    EXPECT_EQ(pc_.state[34], -13.0F);
}

TEST_F(IiwaTest, DialsAgainAfterARestart) {
    auto controller = cabinet();
    pc_.accept();
    EXPECT_EQ(pc_.command({302, 32}), 1.0F);
    controller.inTurn([](auto& machine, auto&) { machine.restart(); });
    EXPECT_TRUE(pc_.closed());
    pc_.accept();
    EXPECT_EQ(pc_.command({0}), 0.0F);
    EXPECT_EQ(controller.state()["servo"], false);
}

TEST_F(IiwaTest, DialsUntilThePcListens) {
    asio::io_context context;
    asio::ip::tcp::acceptor reserved(context);  // so that no other program gets the port
    reserved.open(asio::ip::tcp::v4());
    reserved.set_option(asio::ip::tcp::acceptor::reuse_address(true));
    reserved.bind({asio::ip::make_address("127.0.0.1"), 0});
    const auto port = reserved.local_endpoint().port();
    auto controller = cabinet({{"pc_port", static_cast<double>(port)}});
    EXPECT_TRUE(
        controller.waitUntil([](const auto& state) { return state["last_failure"] != ""; }));
    auto listener = link::TcpListener::listen("127.0.0.1", port).value();
    EXPECT_TRUE(listener.accept(in(5s)));
}

TEST_F(IiwaTest, ObeysTheFaultsOfItsCable) {
    auto controller = cabinet();
    pc_.accept();
    controller.faults.cut = true;
    pc_.send({0});
    EXPECT_FALSE(pc_.receive(50ms));
}

TEST_F(IiwaTest, SpeaksDoublePrecision) {
    auto controller = cabinet({{"double_precision", true}});
    pc_.accept();
    pc_.sendRaw(std::array<std::byte, 64>{});
    ASSERT_TRUE(pc_.receive());
    ASSERT_TRUE(pc_.receive()) << "304 bytes";
}

TEST_F(IiwaTest, NeedsAModel) {
    EXPECT_THROW(RunningController(virtual_controller::iiwaController(), {}), std::runtime_error);
}

TEST_F(IiwaTest, MeasuresWithTheNoiseItIsGiven) {
    auto controller = cabinet({{"force_noise", 2.0}, {"answer_delay", 0.0}});
    pc_.accept();
    double squares = 0.0;
    constexpr int kSamples = 100;
    float last = kNaN;
    for (int samples = 0; samples < kSamples;) {
        ASSERT_EQ(pc_.command({0}), 0.0F);
        EXPECT_EQ(pc_.state[31], 0.0F) << "the torque has none";
        if (std::exchange(last, pc_.state[30]) != pc_.state[30]) {  // another cycle
            squares += static_cast<double>(last) * static_cast<double>(last);
            ++samples;
        }
    }
    EXPECT_GT(std::sqrt(squares / kSamples), 0.5);
    EXPECT_LT(std::sqrt(squares / kSamples), 8.0);
}

TEST_F(IiwaTest, RefusesSettingsThatAreWrong) {
    const std::vector<double> home(iiwaModel().home().begin(), iiwaModel().home().end());
    auto beyond = home;
    beyond[3] = 9.0;
    const auto six = std::vector<double>(6, 0.0);
    for (const auto& [name, value] :
         std::initializer_list<std::pair<const char*, cell::Settings::Value>>{
             {"start_position", beyond},
             {"start_position", six},
             {"answer_delay", 1.1},
             {"redial_delay", 0.0},
             {"pc_address", std::string("the pc")},
             {"pc_prot", 1.0}}) {
        EXPECT_THROW(cabinet({{name, value}}), std::runtime_error) << name;
    }
    EXPECT_NO_THROW(cabinet({{"start_position", home}, {"answer_delay", 1.0}}));
}

TEST_F(IiwaTest, RefusesInjectionsThatItDoesNotKnow) {
    auto controller = cabinet();
    EXPECT_EQ(controller.inject("earthquake").error().code, Errc::not_found);
}

}  // namespace
}  // namespace metier::virtual_iiwa
