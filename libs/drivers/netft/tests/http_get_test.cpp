#include "http_get.hpp"

#include <gmock/gmock.h>

#include "web_page.hpp"

namespace metier::netft_driver::testing {
namespace {

using namespace std::chrono_literals;
using ::testing::HasSubstr;

Result<std::string> get(const std::string& answer) {
    WebPage page({{"/page.xml", answer}});
    return httpGet("127.0.0.1", page.port(), "/page.xml", in(5s));
}

TEST(HttpGet, GivesTheBody) {
    EXPECT_EQ(get(ok("<a/>")), "<a/>");
    EXPECT_EQ(get("HTTP/1.1 200 OK\r\ncontent-length:  3\r\n\r\nabcdef"), "abc");
    EXPECT_EQ(get(ok("")), "");
}

TEST(HttpGet, DoesNotWaitForTheEndOfAConnectionThatStaysOpen) {
    auto listener = link::TcpListener::listen("127.0.0.1", 0).value();
    std::jthread server([&] {
        auto link = listener.accept(in(5s)).value();
        const std::string answer = "HTTP/1.1 200 OK\r\nContent-Length: 2\r\n\r\nhi";
        static_cast<void>(link.send(std::as_bytes(std::span(answer)), in(5s)));
        std::array<std::byte, 256> buffer{};
        while (link.receive(buffer, in(5s))) {
        }
    });
    EXPECT_EQ(httpGet("127.0.0.1", listener.port(), "/", in(4s)), "hi");
}

TEST(HttpGet, TellsAPageThatIsNotThere) {
    WebPage page({});
    const auto got = httpGet("127.0.0.1", page.port(), "/netftapi2.xml", in(5s));
    ASSERT_FALSE(got);
    EXPECT_EQ(got.error().code, Errc::not_found);
    EXPECT_THAT(got.error().message, HasSubstr("/netftapi2.xml: HTTP status 404"));
}

TEST(HttpGet, RefusesWhatIsNoAnswer) {
    EXPECT_EQ(get("").error().code, Errc::invalid_argument);
    EXPECT_EQ(get("SSH-2.0-x\r\n\r\n").error().code, Errc::invalid_argument);
    EXPECT_EQ(get("HTTP/1.0 200 OK\r\n").error().code, Errc::invalid_argument);
    EXPECT_EQ(get("HTTP/1.0 OK\r\n\r\n").error().code, Errc::invalid_argument);
    EXPECT_EQ(get("HTTP/1.0\r\n\r\n").error().code, Errc::invalid_argument);
}

TEST(HttpGet, RefusesAnAnswerThatIsCutOrTooLarge) {
    EXPECT_THAT(get("HTTP/1.0 200 OK\r\nContent-Length: 10\r\n\r\nabc").error().message,
                HasSubstr("3 of 10 bytes"));
    EXPECT_THAT(get(ok(std::string(70'000, 'x'))).error().message, HasSubstr("over 65536 bytes"));
    EXPECT_THAT(get("HTTP/1.0 200 OK\r\nX: " + std::string(70'000, 'x')).error().message,
                HasSubstr("over 65536 bytes"));
    EXPECT_THAT(get("HTTP/1.0 200 OK\r\nContent-Length: 65537\r\n\r\n").error().message,
                HasSubstr("over 65536 bytes"));
    EXPECT_EQ(get(ok(std::string(65'536, 'x'))).value().size(), 65'536U);
}

TEST(HttpGet, GivesUpAtItsDeadline) {
    auto listener = link::TcpListener::listen("127.0.0.1", 0).value();
    const auto got = httpGet("127.0.0.1", listener.port(), "/", in(30ms));
    ASSERT_FALSE(got);
    EXPECT_EQ(got.error().code, Errc::timeout);
}

TEST(HttpGet, TellsThatNobodyListens) {
    EXPECT_EQ(httpGet("127.0.0.1", 1, "/", in(5s)).error().code, Errc::connection_lost);
}

}  // namespace
}  // namespace metier::netft_driver::testing
