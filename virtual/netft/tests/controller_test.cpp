#include <fmt/format.h>
#include <gmock/gmock.h>
#include <poll.h>
#include <unistd.h>

#include <array>
#include <asio/buffer.hpp>
#include <asio/ip/udp.hpp>
#include <chrono>
#include <initializer_list>
#include <string>
#include <utility>

#include "metier/link/tcp_link.hpp"
#include "metier/virtual_controller/testing/running_controller.hpp"

namespace metier::virtual_controller {
ControllerType netftController();
}  // namespace metier::virtual_controller

namespace metier::virtual_netft {
namespace {

using namespace std::chrono_literals;
using asio::ip::udp;
using ::testing::HasSubstr;
using virtual_controller::testing::RunningController;
using Bytes = std::vector<unsigned char>;

/// A client that knows of the sensor what its manual says.
class Client {
public:
    explicit Client(RunningController& controller, const std::string& address = "127.0.0.1")
        : sensor_(asio::ip::make_address(address), controller.state()["port"]) {}

    void request(int command, unsigned char count = 0) {
        const std::array<unsigned char, 8> bytes{0x12, 0x34, 0, static_cast<unsigned char>(command),
                                                 0,    0,    0, count};
        socket_.send_to(asio::buffer(bytes), sensor_);
    }
    /// The next datagram; empty if none comes.
    Bytes next(std::chrono::milliseconds longest = 5s) {
        pollfd waiting{socket_.native_handle(), POLLIN, 0};
        if (poll(&waiting, 1, static_cast<int>(longest.count())) != 1) {
            return {};
        }
        Bytes datagram(2048);
        datagram.resize(socket_.receive(asio::buffer(datagram)));
        return datagram;
    }

private:
    asio::io_context context_;
    udp::socket socket_{context_, udp::endpoint(asio::ip::make_address("127.0.0.1"), 0)};
    udp::endpoint sensor_;
};

std::uint32_t word(const Bytes& datagram, std::size_t index) {
    std::uint32_t value = 0;
    for (std::size_t i = 4 * index; i < 4 * index + 4; ++i) {
        value = value << 8U | datagram.at(i);
    }
    return value;
}

double force(const Bytes& datagram) {
    return static_cast<std::int32_t>(word(datagram, 3)) / 1e6;
}

/// An address that no other process has, for ports that are not free ones.
std::string ownAddress() {
    const int process = getpid();
    return fmt::format("127.{}.{}.{}", 64 + process / 65'536 % 64, process / 256 % 256,
                       process % 256);
}

class NetFt : public ::testing::Test {
protected:
    RunningController controller_{virtual_controller::netftController(),
                                  {.settings = {{"port", 0.0}}}};
    /// Waits until the sensor serves this client, "" for none.
    bool serves(const std::string& client) {
        return controller_.waitUntil([&](const auto& state) { return state["client"] == client; });
    }
    /// Waits until the sensor has made so many cycles, at 1000 Hz.
    bool cycles(std::uint64_t count) {
        std::uint64_t begin = 0;
        controller_.inTurn([&](auto&, auto& world) { begin = world.reports; });
        return controller_.waitUntil([&](const auto&) {
            std::uint64_t now = 0;
            controller_.inTurn([&](auto&, auto& world) { now = world.reports; });
            return now >= begin + count;
        });
    }

    Client client_{controller_};
};

TEST_F(NetFt, StreamsRecordsOfTheWorldsWrench) {
    controller_.setEffect({.wrench = {{1.5, 0.0, 0.0}, {0.0, 0.0, 0.0}}, .part_width = {}});
    client_.request(2);
    std::uint32_t ft_sequence = 0;
    for (std::uint32_t expected = 1; expected <= 20; ++expected) {
        const auto record = client_.next();
        ASSERT_EQ(record.size(), 36U);
        EXPECT_EQ(word(record, 0), expected);
        EXPECT_EQ(word(record, 2), 0U);
        if (expected > 1) {
            EXPECT_EQ(word(record, 1) - ft_sequence, 7U);
        }
        ft_sequence = word(record, 1);
        EXPECT_NEAR(force(record), 1.5, 1e-6);
    }
}

TEST_F(NetFt, CountsFromTheBeginningAtEveryStart) {
    client_.request(2);
    for (int i = 0; i < 10; ++i) {
        ASSERT_FALSE(client_.next().empty());
    }
    client_.request(2);
    std::uint32_t before = 10;
    auto now = word(client_.next(), 0);
    for (int i = 0; i < 2'000 && now > before; ++i) {
        before = std::exchange(now, word(client_.next(), 0));
    }
    EXPECT_EQ(now, 1U);
}

TEST_F(NetFt, SendsAsManyRecordsAsItIsAskedFor) {
    client_.request(2, 3);
    for (int i = 0; i < 3; ++i) {
        EXPECT_EQ(client_.next().size(), 36U);
    }
    EXPECT_TRUE(client_.next(30ms).empty());
}

TEST_F(NetFt, SendsSeveralRecordsAtOnceInTheBufferedMode) {
    client_.request(3, 7);
    EXPECT_EQ(client_.next().size(), 5 * 36U);
    EXPECT_EQ(client_.next().size(), 2 * 36U);
}

TEST_F(NetFt, TakesTheStartOfSeveralSensorsForOneOfItsOwn) {
    client_.request(4, 2);
    EXPECT_EQ(client_.next().size(), 36U);
    EXPECT_EQ(word(client_.next(), 0), 2U);
}

TEST_F(NetFt, ServesWhoeverAskedLast) {
    client_.request(2);
    ASSERT_FALSE(client_.next().empty());
    Client second(controller_);
    second.request(2);
    ASSERT_FALSE(second.next().empty());
    while (!client_.next(30ms).empty()) {
    }
    EXPECT_FALSE(second.next().empty());
    second.request(0);
    EXPECT_TRUE(serves(""));
}

TEST_F(NetFt, IsZeroAfterABias) {
    ASSERT_TRUE(controller_.inject("wrench", "5 0 0 0 0 0"));
    client_.request(2);
    while (force(client_.next()) < 4.9) {
    }
    client_.request(0x42);
    auto value = 5.0;
    for (int i = 0; i < 500 && value > 0.1; ++i) {
        value = force(client_.next());
    }
    EXPECT_NEAR(value, 0.0, 1e-6);
}

TEST_F(NetFt, TellsItsStatusAndForgetsAWarningWhenTheLatchIsReset) {
    ASSERT_TRUE(controller_.inject("saturation"));
    client_.request(2, 1);
    EXPECT_EQ(word(client_.next(), 2), 0x80020000U);
    ASSERT_TRUE(controller_.inject("warning"));
    client_.request(2, 1);
    EXPECT_EQ(word(client_.next(), 2), 0x80010000U);
    client_.request(0x41);
    client_.request(2, 2);
    client_.next();
    EXPECT_EQ(word(client_.next(), 2), 0U);
    ASSERT_TRUE(controller_.inject("status", "0x80000200"));
    client_.request(2, 1);
    EXPECT_EQ(word(client_.next(), 2), 0x80000200U);
}

TEST_F(NetFt, LosesRecordsWhenToldTo) {
    ASSERT_TRUE(controller_.inject("lose", "5"));
    client_.request(2);
    EXPECT_EQ(word(client_.next(), 0), 6U);
}

TEST_F(NetFt, LosesRecordsOutOfADatagram) {
    ASSERT_TRUE(controller_.inject("lose", "7"));
    client_.request(3, 10);
    const auto datagram = client_.next();
    ASSERT_EQ(datagram.size(), 3 * 36U) << "the first datagram is lost, and two of the second";
    EXPECT_EQ(word(datagram, 0), 8U);
}

TEST_F(NetFt, IsSilentWhileTheCableIsCut) {
    client_.request(2);
    ASSERT_FALSE(client_.next().empty());
    controller_.faults.cut = true;
    ASSERT_TRUE(cycles(31));
    std::uint32_t last = 1;  // record that came before
    for (auto record = client_.next(0ms); !record.empty(); record = client_.next(0ms)) {
        last = word(record, 0);
    }
    controller_.faults.cut = false;
    EXPECT_GE(word(client_.next(), 0), last + 30U);
}

TEST_F(NetFt, SendsLaterByTheDelayAndGarbles) {
    controller_.faults.delay_ms = 60;
    controller_.faults.garble = 1;
    const auto begin = std::chrono::steady_clock::now();
    client_.request(2, 2);
    const auto garbled = client_.next();
    EXPECT_GE(std::chrono::steady_clock::now() - begin, 60ms);
    EXPECT_NE(word(garbled, 4), 0U);
    EXPECT_EQ(word(client_.next(), 4), 0U);
}

TEST_F(NetFt, ForgetsItsClientAtARestart) {
    client_.request(2);
    ASSERT_FALSE(client_.next().empty());
    controller_.inTurn([](auto& controller, auto&) { controller.restart(); });
    EXPECT_EQ(controller_.state()["client"], "");
}

TEST_F(NetFt, RefusesInjectionsThatItDoesNotKnow) {
    EXPECT_EQ(controller_.inject("earthquake").error().code, Errc::not_found);
    EXPECT_EQ(controller_.inject("status", "xyz").error().code, Errc::invalid_argument);
    EXPECT_EQ(controller_.inject("wrench", "1 2 3").error().code, Errc::invalid_argument);
    EXPECT_EQ(controller_.inject("lose", "-1").error().code, Errc::invalid_argument);
}

TEST(NetFtStart, RefusesUnitsThatItDoesNotKnow) {
    EXPECT_THROW(RunningController(virtual_controller::netftController(),
                                   {.settings = {{"port", 0.0}, {"force_unit", "stone"}}}),
                 std::runtime_error);
}

TEST(NetFtStart, StreamsAtTheRateItIsGiven) {
    RunningController controller(virtual_controller::netftController(),
                                 {.settings = {{"port", 0.0}, {"rate", 7000.0}}});
    Client client(controller);
    client.request(2);
    const auto first = word(client.next(), 1);
    const auto second = word(client.next(), 1);
    EXPECT_EQ(second - first, 1U);
}

TEST(NetFtStart, TakesTheNextRateThatIsAPartOfTheSamples) {
    RunningController controller(virtual_controller::netftController(),
                                 {.settings = {{"port", 0.0}, {"rate", 150.0}}});
    EXPECT_EQ(controller.state()["rate"], 152) << "7000 / 46";
}

/// A sensor with web pages on port 8080 of an address of its own.
class NetFtWeb : public ::testing::Test {
protected:
    /// A connection to the web port.
    class Browser {
    public:
        explicit Browser(const std::string& address)
            : link_(link::TcpLink::connect(address, 8080, deadline_).value()) {}
        void send(std::string_view text) {
            ASSERT_TRUE(link_.send(std::as_bytes(std::span(text)), deadline_));
        }
        /// All that comes until the sensor ends the connection.
        std::string rest() {
            std::string answer;
            std::array<char, 512> buffer{};
            while (const auto count =
                       link_.receive(std::as_writable_bytes(std::span(buffer)), deadline_)) {
                answer.append(buffer.data(), *count);
            }
            return answer;
        }

    private:
        const SteadyTime deadline_ = std::chrono::steady_clock::now() + 5s;
        link::TcpLink link_;
    };

    std::string get(const std::string& target) const {
        Browser browser(address_);
        browser.send("GET " + target + " HTTP/1.1\r\nHost: sensor\r\n\r\n");
        return browser.rest();
    }

    const std::string address_ = ownAddress();
    RunningController controller_{
        virtual_controller::netftController(),
        {.settings = {{"port", 0.0}, {"http_port", 8080.0}}, .address = address_}};
    Client client_{controller_, address_};
};

TEST_F(NetFtWeb, TellsItsCalibrationAndAddress) {
    const auto page = get("/netftapi2.xml");
    EXPECT_THAT(page, HasSubstr("<cfgcpf>1000000</cfgcpf>"));
    EXPECT_THAT(page, HasSubstr("<netip>" + address_ + "</netip>"));
}

TEST_F(NetFtWeb, AnswersARequestThatComesInParts) {
    Browser browser(address_);
    for (const auto* part : {"GET /netftapi2.xml HT", "TP/1.1\r\n", "\r", "\n"}) {
        EXPECT_EQ(controller_.state()["http_port"], 8080) << "the part before is taken";
        browser.send(part);
    }
    EXPECT_THAT(browser.rest(), HasSubstr("200 OK"));
}

TEST_F(NetFtWeb, AnswersARequestWithoutEndOnceItIsTooLong) {
    Browser browser(address_);
    browser.send("GET /" + std::string(8192 - 5, 'x'));
    controller_.state();
    EXPECT_THAT(get("/netftapi2.xml"), HasSubstr("200 OK")) << "others are served meanwhile";
    browser.send("x");
    EXPECT_THAT(browser.rest(), HasSubstr("400 Bad Request"));
}

TEST_F(NetFtWeb, AnswersOneRequestOfAConnection) {
    Browser browser(address_);
    browser.send(
        "GET /comm.cgi?comrdtbsiz=2 HTTP/1.1\r\n\r\n"
        "GET /comm.cgi?comrdtbsiz=3 HTTP/1.1\r\n\r\n");
    EXPECT_THAT(browser.rest(), ::testing::AllOf(HasSubstr("302"), HasSubstr("close")));
    EXPECT_THAT(get("/netftapi2.xml"), HasSubstr("<comrdtbsiz>2</comrdtbsiz>"));
}

TEST_F(NetFtWeb, KeepsItsSettingsThroughARestartAndForgetsItsBias) {
    get("/comm.cgi?comrdtrate=500&comrdtbsiz=2");
    get("/setting.cgi?setbias0=100");
    ASSERT_THAT(get("/netftapi2.xml"), HasSubstr("<setbias>100;0;0;0;0;0</setbias>"));
    controller_.inTurn([](auto& controller, auto&) { controller.restart(); });
    const auto page = get("/netftapi2.xml");
    EXPECT_THAT(page, HasSubstr("<comrdtrate>500</comrdtrate>"));
    EXPECT_THAT(page, HasSubstr("<comrdtbsiz>2</comrdtbsiz>"));
    EXPECT_THAT(page, HasSubstr("<setbias>0;0;0;0;0;0</setbias>"));
}

TEST_F(NetFtWeb, TellsTheReadingThatIsStreamed) {
    ASSERT_TRUE(controller_.inject("wrench", "5 0 0 0 0 0"));
    ASSERT_TRUE(controller_.inject("status", "80000004"));
    ASSERT_TRUE(controller_.waitUntil([](const auto& state) {
        return state["counts"][0] == 5'000'000 && state["status"] == "80000004";
    }));
    const auto page = get("/netftapi2.xml");
    EXPECT_THAT(page, HasSubstr("<runft>5000000;0;0;0;0;0</runft>"));
    EXPECT_THAT(page, HasSubstr("<runstat>0x80000004</runstat>"));
}

TEST_F(NetFtWeb, SetsRateAndBufferSize) {
    EXPECT_THAT(get("/comm.cgi?comrdtrate=500&comrdtbsiz=2"), HasSubstr("302 Found"));
    EXPECT_THAT(get("/netftapi2.xml"), HasSubstr("<comrdtrate>500</comrdtrate>"));
    client_.request(2);
    const auto first = word(client_.next(), 1);
    EXPECT_EQ(word(client_.next(), 1) - first, 14U) << "of 7000 samples per second";
    client_.request(0);
    ASSERT_TRUE(controller_.waitUntil([](const auto& state) { return state["client"] == ""; }));
    while (!client_.next(0ms).empty()) {
    }
    client_.request(3, 3);
    EXPECT_EQ(client_.next().size(), 2 * 36U);
    EXPECT_EQ(client_.next().size(), 36U);
}

TEST_F(NetFtWeb, ClearsTheBias) {
    const auto counts = [&](std::int32_t wanted) {
        return controller_.waitUntil(
            [wanted](const auto& state) { return state["counts"][0] == wanted; });
    };
    ASSERT_TRUE(controller_.inject("wrench", "5 0 0 0 0 0"));
    ASSERT_TRUE(counts(5'000'000));
    client_.request(0x42);
    ASSERT_TRUE(counts(0));
    EXPECT_THAT(get("/netftapi2.xml"), HasSubstr("<setbias>2521;0;0;0;0;0</setbias>"));
    EXPECT_THAT(get("/setting.cgi?setbias0=0"), HasSubstr("302 Found"));
    EXPECT_TRUE(counts(5'000'000));
}

TEST_F(NetFtWeb, EndsAndRefusesStreamsWhileRdtIsOff) {
    client_.request(2);
    ASSERT_FALSE(client_.next().empty());
    EXPECT_THAT(get("/comm.cgi?comrdte=0"), HasSubstr("302 Found"));
    EXPECT_THAT(get("/netftapi2.xml"), HasSubstr("<comrdte>Disabled</comrdte>"));
    client_.request(2);
    while (!client_.next(30ms).empty()) {
    }
    EXPECT_EQ(controller_.state()["client"], "");
    get("/comm.cgi?comrdte=1");
    client_.request(2);
    EXPECT_FALSE(client_.next().empty());
}

}  // namespace
}  // namespace metier::virtual_netft
