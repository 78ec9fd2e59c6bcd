// The parts of a virtual world, as its control port reports them, or does not.
#include "world_watch.hpp"

#include <gmock/gmock.h>

#include <chrono>
#include <functional>
#include <future>
#include <optional>
#include <span>
#include <string>

#include "metier/base/clock.hpp"
#include "shown_tab.hpp"

namespace metier::dashboard {
namespace {

using namespace std::chrono_literals;
using nlohmann::json;

SteadyTime inTime() {
    return std::chrono::steady_clock::now() + 30s;
}

/// A world whose answers a test gives by hand.
class WorldByHand {
public:
    std::uint16_t port() const { return listener_->port(); }
    void accept() { link_ = listener_->accept(inTime()).value(); }
    /// Waits for a question; false if the peer ended the connection.
    bool awaitQuestion() {
        std::string line;
        while (!line.ends_with('\n')) {
            std::array<char, 1> byte{};
            if (!link_->receive(std::as_writable_bytes(std::span(byte)), inTime())) {
                return false;
            }
            line += byte[0];
        }
        EXPECT_EQ(json::parse(line), json::parse(R"({"state": true})"));
        return true;
    }
    /// The peer may have ended the connection meanwhile.
    void send(const std::string& bytes) {
        static_cast<void>(link_->send(std::as_bytes(std::span(bytes)), inTime()));
    }
    void answer(const std::string& parts) {
        EXPECT_TRUE(awaitQuestion());
        send(R"({"parts":)" + parts + "}\n");
    }
    void hangUp() { link_.reset(); }
    /// Whoever waits for an answer waits no longer.
    void end() {
        hangUp();
        listener_.reset();
    }

private:
    std::optional<link::TcpListener> listener_ = link::TcpListener::listen("127.0.0.1", 0).value();
    std::optional<link::TcpLink> link_;
};

std::string cubeAt(double x, const std::string& holder = "") {
    return json{
        {"cube", {{"pose", {x, 0, 0, 0, 0, 0}}, {"size", {0.05, 0.05, 0.05}}, {"held_by", holder}}}}
        .dump();
}

class WatchedWorld : public ::testing::Test {
protected:
    /// \param answer that the watch waits for; by itself a test has no need of haste
    explicit WatchedWorld(std::chrono::milliseconds answer = 30s)
        : watch_({"127.0.0.1", world_.port()}, board_, answer) {
        watch_.show(true);
    }
    ~WatchedWorld() override { world_.end(); }
    /// The parts of the board once they are as wanted.
    json awaitParts(const std::function<bool(const json&)>& wanted) {
        for (;;) {
            const auto parts = board_.cell().at("world").at("parts");
            if (wanted(parts)) {
                return parts;
            }
            if (tab_.await("cell", [](const json&) { return true; }).is_null()) {
                return nullptr;
            }
        }
    }

    const SystemClock clock_;
    Board board_{{{"name", "test"}, {"world", json::object()}}, clock_};
    ShownTab tab_{board_};
    WorldByHand world_;
    WorldWatch watch_;
};

const auto kOne = [](const json& parts) { return parts.size() == 1; };
const auto kNone = [](const json& parts) { return parts.empty(); };

TEST_F(WatchedWorld, IsShownWithItsPartsUntilTheyAreGone) {
    world_.accept();
    world_.answer(cubeAt(0.1234567891, "ur5"));
    const auto part = awaitParts(kOne).at(0);
    EXPECT_EQ(part.at("name"), "cube");
    EXPECT_EQ(part.at("pose").at(0), 0.123457) << "rounded";
    EXPECT_EQ(part.at("size"), json::array({0.05, 0.05, 0.05}));
    EXPECT_EQ(part.at("held_by"), "ur5");
    world_.answer("{}");
    EXPECT_EQ(awaitParts(kNone), json::array());
}

TEST_F(WatchedWorld, IsAskedAgainOverTheSameConnection) {
    world_.accept();
    world_.answer(cubeAt(1));
    for (int i = 2; i < 10; ++i) {
        world_.answer(cubeAt(i));
    }
    ASSERT_TRUE(world_.awaitQuestion());  // the answer before was taken
    board_.tick();
    const auto live = tab_.await("live", [](const json&) { return true; });
    EXPECT_EQ(live.at("parts").at("cube").at(0), 9);
    EXPECT_TRUE(awaitParts(kOne).at(0).at("held_by").is_null());
}

TEST_F(WatchedWorld, MayAnswerInPieces) {
    world_.accept();
    ASSERT_TRUE(world_.awaitQuestion());
    const auto line = R"({"parts":)" + cubeAt(1) + "}\n";
    for (const char byte : line) {
        world_.send(std::string(1, byte));
    }
    EXPECT_EQ(awaitParts(kOne).at(0).at("pose").at(0), 1);
}

TEST_F(WatchedWorld, IsConnectedToAnewAfterAnAnswerThatIsNone) {
    for (const std::string nonsense :
         {"HTTP/1.1 400 Bad Request\r\n\r\n", "{}\n", "[]\n", "{\"parts\":7}\n",
          "{\"parts\":{\"cube\":{\"pose\":\"here\",\"size\":[],\"held_by\":\"\"}}}\n",
          "{\"parts\":{\"cube\":{\"pose\":[],\"size\":[]}}}\n"}) {
        world_.accept();
        ASSERT_TRUE(world_.awaitQuestion());
        world_.send(nonsense);
        EXPECT_FALSE(world_.awaitQuestion()) << nonsense;
    }
    world_.accept();
    world_.answer(cubeAt(1));
    awaitParts(kOne);
}

TEST_F(WatchedWorld, IsConnectedToAnewAfterItHungUp) {
    world_.accept();
    world_.answer(cubeAt(1));
    awaitParts(kOne);
    ASSERT_TRUE(world_.awaitQuestion());
    world_.send(R"({"parts":)");  // half an answer, which is not the begin of the next
    world_.hangUp();
    world_.accept();
    world_.answer("{}");
    awaitParts(kNone);
}

TEST_F(WatchedWorld, IsGivenUpIfItSendsWithoutAnEnd) {
    world_.accept();
    ASSERT_TRUE(world_.awaitQuestion());
    for (int i = 0; i < 11; ++i) {
        world_.send(std::string(100'000, ' '));
    }
    EXPECT_FALSE(world_.awaitQuestion()) << "the connection was ended";
}

class SilentWorld : public WatchedWorld {
protected:
    SilentWorld() : WatchedWorld(1s) {}
};

TEST_F(SilentWorld, IsGivenUpIfItDoesNotAnswer) {
    world_.accept();
    ASSERT_TRUE(world_.awaitQuestion());
    EXPECT_FALSE(world_.awaitQuestion()) << "a second later";
    world_.accept();  // it is connected to anew
    EXPECT_TRUE(world_.awaitQuestion());
}

TEST_F(WatchedWorld, IsNotAskedWhileNobodyLooks) {
    world_.accept();
    world_.answer(cubeAt(1));
    awaitParts(kOne);
    ASSERT_TRUE(world_.awaitQuestion());
    watch_.show(false);
    world_.send(R"({"parts":)" + cubeAt(2) + "}\n");
    auto asked = std::async(std::launch::async, [this] { return world_.awaitQuestion(); });
    EXPECT_EQ(asked.wait_for(1s), std::future_status::timeout);
    watch_.show(true);
    EXPECT_TRUE(asked.get());
}

TEST(UnwatchedWorld, IsAskedOnceForWhatItHas) {
    const SystemClock clock;
    Board board({{"name", "test"}, {"world", json::object()}}, clock);
    ShownTab tab(board);
    WorldByHand world;
    const WorldWatch watch({"127.0.0.1", world.port()}, board, 30s);
    world.accept();
    world.answer(cubeAt(1));
    tab.await("cell", [](const json&) { return true; });
    EXPECT_EQ(board.cell().at("world").at("parts").size(), 1U);
}

TEST(UnwatchedWorld, HoldsUpNobodyWhenItIsAway) {
    const SystemClock clock;
    Board board({{"name", "test"}, {"world", json::object()}}, clock);
    WorldWatch watch({"127.0.0.1", 1}, board);  // no port that a test beside this one may get
    watch.show(true);
    watch.show(false);
}

}  // namespace
}  // namespace metier::dashboard
