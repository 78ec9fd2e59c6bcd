// Requests as browsers send them, and as nobody should.
#include <gmock/gmock.h>

#include <memory>
#include <string>
#include <vector>

#include "http_bench.hpp"

namespace metier::http {
namespace {

using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::Not;
using testing::RawBrowser;
using ::testing::StartsWith;

constexpr std::size_t kHead = 2'000;
constexpr std::size_t kBody = 5'000;

class Requests : public HttpBench {
protected:
    Requests() : HttpBench({.head_bytes = kHead, .body_bytes = kBody}) { serve(); }
};

TEST_F(Requests, AreAnsweredThoughEachByteComesAlone) {
    RawBrowser browser(port_);
    for (const char byte : closing(post("slowly"))) {
        ASSERT_TRUE(browser.send(std::string(1, byte)));
    }
    EXPECT_THAT(browser.receive(), EndsWith("\r\n\r\n<slowly>"));
}

TEST_F(Requests, ThatComeTogetherAreAnsweredInTheirOrder) {
    const auto answers =
        answerTo(get("/echo/one") + post("two") + get("/echo/three") + closing(get("/echo/four")));
    EXPECT_EQ(count(answers, "HTTP/1.1 200"), 4U) << answers;
    const auto one = answers.find("<one>");
    const auto two = answers.find("<two>");
    const auto three = answers.find("<three>");
    EXPECT_LT(one, two);
    EXPECT_LT(two, three);
    EXPECT_LT(three, answers.find("<four>"));
}

TEST_F(Requests, HaveTheLimitsForEachOfThemAlone) {
    std::string bytes;
    constexpr std::size_t kRequests = 100;
    for (std::size_t i = 1; i < kRequests; ++i) {
        bytes += post(std::string(kBody / 2, 'x'));
    }
    RawBrowser browser(port_);
    browser.send(bytes + closing(get("/echo/last")));
    EXPECT_EQ(count(browser.receive(), "HTTP/1.1 200"), kRequests);
}

TEST_F(Requests, WithALongLineOrManyLinesAreNotHandled) {
    const std::string begin = "GET /echo/x HTTP/1.1\r\nHost: here\r\nX-More: ";
    const auto lineOf = [](std::size_t size) { return std::string(size, 'x') + "\r\n\r\n"; };
    EXPECT_THAT(answerTo(closing(begin + lineOf(kHead / 2))), StartsWith("HTTP/1.1 200"));
    handled_ = 0;
    EXPECT_THAT(answerTo(begin + lineOf(kHead)), Not(HasSubstr("200 OK")));
    std::string lines = "GET /echo/x HTTP/1.1\r\n";
    for (std::size_t i = 0; i < kHead; ++i) {
        lines += "X: y\r\n";
    }
    EXPECT_THAT(answerTo(lines + "\r\n"), Not(HasSubstr("200 OK")));
    EXPECT_THAT(answerTo("GET /echo/" + std::string(kHead, 'x') + " HTTP/1.1\r\n\r\n"),
                Not(HasSubstr("200 OK")));
    EXPECT_EQ(handled_, 0);
}

TEST_F(Requests, WithALongBodyAreRefusedAndEndTheirConnection) {
    EXPECT_THAT(answerTo(closing(post(std::string(kBody, 'x')))), StartsWith("HTTP/1.1 200"));
    handled_ = 0;
    const auto refused = answerTo(post(std::string(kBody + 1, 'x')) + get("/echo/next"));
    EXPECT_THAT(refused, StartsWith("HTTP/1.1 413"));
    EXPECT_EQ(count(refused, "HTTP/1.1"), 1U);
    EXPECT_EQ(handled_, 0);
}

TEST_F(Requests, MayHaveABodyInChunks) {
    const std::string head =
        "POST /echo HTTP/1.1\r\nHost: here\r\nConnection: close\r\n"
        "Transfer-Encoding: chunked\r\n\r\n";
    EXPECT_THAT(answerTo(head + "3\r\nabc\r\n2\r\nde\r\n0\r\n\r\n"), EndsWith("<abcde>"));
    handled_ = 0;
    std::string chunks;
    for (std::size_t sent = 0; sent <= kBody; sent += 0x100) {
        chunks += "100\r\n" + std::string(0x100, 'x') + "\r\n";
    }
    EXPECT_THAT(answerTo(head + chunks + "0\r\n\r\n"), Not(HasSubstr("200 OK")));
    EXPECT_THAT(answerTo(head + "zz\r\nabc\r\n0\r\n\r\n"), Not(HasSubstr("200 OK")));
    EXPECT_THAT(answerTo(head + "-1\r\nabc\r\n0\r\n\r\n"), Not(HasSubstr("200 OK")));
    EXPECT_EQ(handled_, 0);
    EXPECT_TRUE(answers());
}

TEST_F(Requests, OfAMethodWithoutAHandlerAreRefused) {
    for (const std::string method :
         {"PUT", "DELETE", "PATCH", "OPTIONS", "TRACE", "CONNECT", "PRI", "GET"}) {
        const auto answer = answerTo(method +
                                     " /echo HTTP/1.1\r\nHost: here\r\nConnection: close\r\n"
                                     "Content-Length: 0\r\n\r\n");
        EXPECT_THAT(answer, StartsWith("HTTP/1.1 4")) << method;
    }
    EXPECT_EQ(handled_, 0);
}

TEST_F(Requests, OfHeadHaveNoBody) {
    const auto answer =
        answerTo("HEAD /echo/x HTTP/1.1\r\nHost: here\r\nConnection: close\r\n\r\n");
    EXPECT_THAT(answer, StartsWith("HTTP/1.1 200"));
    EXPECT_THAT(answer, EndsWith("\r\n\r\n"));
}

TEST_F(Requests, ThatAreNoHttpAreAnsweredOnce) {
    for (const std::string bytes :
         {"BREW /echo/x HTTP/1.1\r\nHost: here\r\n\r\n", "GET /echo/x\r\nHost: here\r\n\r\n",
          "GET /echo/x HTTP/3.0\r\nHost: here\r\n\r\n", "\r\n\r\n"}) {
        RawBrowser browser(port_);
        browser.send(bytes);
        EXPECT_LE(count(browser.receive(), "HTTP/1.1"), 1U)
            << bytes << ": the rest of it is no beginning of a request";
    }
    EXPECT_EQ(handled_, 0);
    EXPECT_TRUE(answers());
}

// Whoever may choose the body of a request, as another page's program may, must not choose the next
// request by it.
TEST_F(Requests, AreNotFoundInABodyThatNobodyReads) {
    const auto inner = get("/echo/inner");
    const auto length = "Content-Length: " + std::to_string(inner.size()) + "\r\n\r\n";
    for (const std::string line : {"GET /echo/outer", "POST /refused", "HEAD /echo/outer",
                                   "DELETE /nothing", "TRACE /nothing"}) {
        const auto answer = answerTo(line + " HTTP/1.1\r\nHost: here\r\n" + length + inner +
                                     closing(get("/echo/last")));
        EXPECT_EQ(count(answer, "HTTP/1.1"), 2U) << line << answer;
        EXPECT_THAT(answer, Not(HasSubstr("<inner>"))) << line;
        EXPECT_THAT(answer, EndsWith("<last>")) << line << ": the connection goes on";
    }
}

TEST_F(Requests, EndTheirConnectionIfItIsNotCertainWhereTheyEnd) {
    const auto inner = get("/echo/inner");
    const auto length = std::to_string(inner.size());
    for (const std::string head :
         {"GET /echo/outer HTTP/1.1\r\nTransfer-Encoding: chunked\r\n\r\n",
          "POST /refused HTTP/1.1\r\nTransfer-Encoding: chunked\r\n\r\n",
          "POST /echo HTTP/1.1\r\nContent-Length: 0\r\nContent-Length: 9\r\n\r\n",
          "POST /echo HTTP/1.1\r\nContent-Length: +0\r\n\r\n",
          "POST /echo HTTP/1.1\r\nTransfer-Encoding: chunked\r\nContent-Length: 99\r\n\r\n"
          "0\r\n\r\n"}) {
        const auto answer = answerTo(head + inner);
        EXPECT_EQ(count(answer, "HTTP/1.1"), 1U) << head << answer;
        EXPECT_THAT(answer, Not(HasSubstr("<inner>"))) << head;
    }
}

TEST_F(Requests, WithoutALengthHaveNoBody) {
    const auto answers =
        answerTo("POST /echo HTTP/1.1\r\nHost: here\r\n\r\n" + closing(get("/echo/last")));
    EXPECT_THAT(answers, HasSubstr("\r\n\r\n<>HTTP/1.1 200"));
    EXPECT_THAT(answers, EndsWith("<last>"));
}

TEST_F(Requests, NameTheAddressTheyComeFrom) {
    server_.Get("/from", [](const httplib::Request& request, httplib::Response& response) {
        response.set_content(request.remote_addr + " at " + request.local_addr, "text/plain");
    });
    EXPECT_THAT(answerTo(closing(get("/from"))), EndsWith("127.0.0.1 at 127.0.0.1"));
}

class FewConnections : public HttpBench {
protected:
    FewConnections() : HttpBench({.connections = 3}) { serve(); }
};

TEST_F(FewConnections, AreServedAtATimeAndOthersOnceOneIsFree) {
    std::vector<std::unique_ptr<RawBrowser>> open;
    for (int i = 0; i < 3; ++i) {
        open.push_back(std::make_unique<RawBrowser>(port_));
        open.back()->send(get("/echo/open"));
        EXPECT_THAT(open.back()->receive("<open>"), HasSubstr("<open>"));
    }
    const auto refused = answerTo(get("/echo/fourth"));
    EXPECT_THAT(refused, StartsWith("HTTP/1.1 503"));
    const auto body = refused.substr(refused.find("\r\n\r\n") + 4);
    EXPECT_THAT(refused, HasSubstr("Content-Length: " + std::to_string(body.size()) + "\r\n"));

    open.pop_back();
    std::string answer;
    do {  // its thread is not free at once
        answer = answerTo(closing(get("/echo/next")));
    } while (answer.starts_with("HTTP/1.1 503"));
    EXPECT_THAT(answer, EndsWith("<next>"));
    open.front()->send(get("/echo/again"));
    EXPECT_THAT(open.front()->receive("<again>"), HasSubstr("<again>")) << "the others stay";
}

}  // namespace
}  // namespace metier::http
