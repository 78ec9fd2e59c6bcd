#include "dashboard.hpp"

#include <gmock/gmock.h>

#include <chrono>
#include <future>

#include "wire_bytes.hpp"

namespace metier::ur_driver::dashboard {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

SteadyTime soon() {
    return std::chrono::steady_clock::now() + 5s;
}

StreamBuffer bufferOf(const std::string& text) {
    StreamBuffer buffer(4096);
    const auto bytes = WireBytes().text(text).bytes();
    std::copy(bytes.begin(), bytes.end(), buffer.space().begin());
    buffer.filled(bytes.size());
    return buffer;
}

TEST(DashboardLine, IsTakenOnceItIsComplete) {
    auto buffer = bufferOf("Powering on\r\nfal");
    EXPECT_EQ(takeLine(buffer).value(), "Powering on");
    EXPECT_EQ(takeLine(buffer).value(), std::nullopt);
}

TEST(DashboardLine, MayBeEmptyAndHasNoControlCharacters) {
    auto buffer = bufferOf(
        "\na\x1b"
        "b\n");
    EXPECT_EQ(takeLine(buffer).value(), "");
    EXPECT_EQ(takeLine(buffer).value(), "a b");
}

TEST(DashboardLine, ThatNeverEndsIsRefused) {
    auto buffer = bufferOf(std::string(1025, 'x'));
    EXPECT_FALSE(takeLine(buffer));
}

TEST(DashboardLine, MayHaveAThousandCharactersAndSome) {
    auto buffer = bufferOf(std::string(1024, 'x') + "\n");
    EXPECT_TRUE(takeLine(buffer).value());
}

TEST(DashboardFlag, IsTrueOrFalse) {
    EXPECT_EQ(parseFlag("true"), true);
    EXPECT_EQ(parseFlag("false"), false);
    EXPECT_EQ(parseFlag("could not understand").error().code, Errc::device_fault);
}

/// A server with a script: sends `greeting`, then `reply` to whatever comes.
class DashboardTest : public testing::Test {
protected:
    void serve(const std::string& greeting, const std::string& reply) {
        server_ = std::async(std::launch::async, [this, greeting, reply] {
            auto link = listener_.accept(soon());
            std::string heard;
            if (!link || !link->send(std::as_bytes(std::span(greeting)), soon())) {
                return heard;
            }
            std::array<std::byte, 256> chunk{};
            if (const auto count = link->receive(chunk, soon())) {
                heard.assign(reinterpret_cast<const char*>(chunk.data()), *count);
                (void)link->send(std::as_bytes(std::span(reply)), soon());
            }
            (void)link->receive(chunk, soon());  // until the client leaves
            return heard;
        });
    }
    Result<Client> connect() { return Client::connect("127.0.0.1", listener_.port(), soon()); }

    link::TcpListener listener_ = link::TcpListener::listen("127.0.0.1", 0).value();
    std::future<std::string> server_;
    static constexpr const char* kGreeting = "Connected: Universal Robots Dashboard Server\n";
};

TEST_F(DashboardTest, SendsALineAndTakesTheReply) {
    serve(kGreeting, "Brake releasing\n");
    {
        auto client = connect();
        ASSERT_TRUE(client) << client.error().message;
        EXPECT_TRUE(client->command("brake release", "Brake releasing", soon()));
    }
    EXPECT_EQ(server_.get(), "brake release\n");
}

TEST_F(DashboardTest, TellsAnotherReply) {
    serve(kGreeting, "Failed to execute: brake release\n");
    auto client = connect();
    ASSERT_TRUE(client);
    const auto done = client->command("brake release", "Brake releasing", soon());
    ASSERT_FALSE(done);
    EXPECT_EQ(done.error().code, Errc::device_fault);
    EXPECT_THAT(done.error().message,
                HasSubstr("\"brake release\" was answered with \"Failed to execute"));
}

TEST_F(DashboardTest, TellsThatTheReplyDoesNotCome) {
    serve(kGreeting, "");
    auto client = connect();
    ASSERT_TRUE(client);
    const auto done = client->command("stop", "Stopped", std::chrono::steady_clock::now() + 50ms);
    ASSERT_FALSE(done);
    EXPECT_EQ(done.error().code, Errc::timeout);
}

TEST_F(DashboardTest, RefusesALineWithoutEnd) {
    serve(std::string(2000, 'x'), "");
    const auto client = connect();
    ASSERT_FALSE(client);
    EXPECT_THAT(client.error().message, HasSubstr("127.0.0.1:"));
    EXPECT_THAT(client.error().message, HasSubstr("a line of more than 1024 characters"));
}

TEST_F(DashboardTest, RefusesSomeoneElse) {
    serve("220 mail server\n", "");
    EXPECT_THAT(connect().error().message, HasSubstr("no dashboard server: \"220 mail"));
}

TEST_F(DashboardTest, DoesNotWaitForEver) {
    serve("", "");
    const auto client =
        Client::connect("127.0.0.1", listener_.port(), std::chrono::steady_clock::now() + 50ms);
    ASSERT_FALSE(client);
    EXPECT_EQ(client.error().code, Errc::timeout);
}

}  // namespace
}  // namespace metier::ur_driver::dashboard
