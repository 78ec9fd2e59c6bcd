// Answers of the page's server to requests of every kind, without any OPC UA server.
#include <gmock/gmock.h>

#include <unistd.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "metier/dashboard/dashboard.hpp"
#include "metier/http/httplib.hpp"
#include "metier/http/testing/raw_browser.hpp"

namespace metier::dashboard {
namespace {

namespace fs = std::filesystem;
using http::testing::RawBrowser;
using nlohmann::json;
using ::testing::AnyOf;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

/// {"user":"aaa..."} with 100,000 letters, by gzip.
constexpr std::array<unsigned char, 147> kPacked{
    0x1f, 0x8b, 0x08, 0x00, 0x00, 0x00, 0x00, 0x00, 0x02, 0x03, 0xed, 0xc1, 0x31, 0x11, 0x00,
    0x20, 0x0c, 0x04, 0x30, 0x2f, 0x2f, 0x03, 0x37, 0x0c, 0x35, 0x00, 0xc7, 0xc4, 0xe1, 0xbd,
    0x36, 0x18, 0x92, 0xdc, 0x9c, 0x5d, 0x2b, 0x23, 0x13, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00,
    0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00,
    0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00,
    0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00,
    0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00,
    0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00,
    0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00,
    0xf8, 0x56, 0x5e, 0x03, 0xfd, 0x57, 0x43, 0x7e, 0xab, 0x86, 0x01, 0x00};

const httplib::Headers kIntent{{"X-Metier", "1"}};

class Page : public ::testing::Test {
protected:
    Page() : folder_(fs::path(::testing::TempDir()) / ("page_" + std::to_string(getpid()))) {
        fs::create_directories(folder_ / "web" / "assets");
        fs::create_directories(folder_ / "meshes" / "ur5");
        std::ofstream(folder_ / "web" / "index.html") << "<p>the page</p>";
        std::ofstream(folder_ / "web" / "assets" / "main.js") << "1;";
        std::ofstream(folder_ / "meshes" / "ur5" / "ur5.urdf") << "<robot/>";
        std::ofstream(folder_ / "secret.txt") << "for nobody";
        Options options;
        options.cell.name = "test";
        options.lab = true;
        options.connector = {[](const std::string&) -> Result<opcua::ClientOptions> {
                                 return fail(Errc::connection_lost, "nobody there");
                             },
                             [](const opcua::Failure&) { return std::string(); }};
        options.web = folder_ / "web";
        options.meshes = folder_ / "meshes";
        options.limits.head_bytes = 4'096;
        options.limits.body_bytes = 10'000;
        options.limits.request_time = std::chrono::seconds(1);
        dashboard_ = Dashboard::start(std::move(options), clock_).value();
        client_ = std::make_unique<httplib::Client>("127.0.0.1", dashboard_->port());
        client_->set_read_timeout(30);
    }
    ~Page() override { fs::remove_all(folder_); }

    /// Status line and rest of the answer to bytes.
    std::string answerTo(const std::string& bytes) {
        RawBrowser browser(dashboard_->port());
        browser.send(bytes);
        return browser.receive();
    }
    httplib::Result post(const std::string& path, const std::string& body,
                         const httplib::Headers& headers = kIntent) {
        return client_->Post(path, headers, body, "application/json");
    }

    fs::path folder_;
    SystemClock clock_;
    std::unique_ptr<Dashboard> dashboard_;
    std::unique_ptr<httplib::Client> client_;
};

TEST_F(Page, IsServedWithWhatItMayLoad) {
    const auto answer = client_->Get("/");
    ASSERT_TRUE(answer);
    EXPECT_EQ(answer->status, 200);
    EXPECT_EQ(answer->body, "<p>the page</p>");
    EXPECT_THAT(answer->get_header_value("Content-Security-Policy"),
                HasSubstr("script-src 'self'"));
    EXPECT_EQ(answer->get_header_value("X-Content-Type-Options"), "nosniff");
    EXPECT_EQ(client_->Get("/assets/main.js")->get_header_value("Content-Type"), "text/javascript");
}

TEST_F(Page, ServesNothingOutsideOfItsFolder) {
    for (const std::string path :
         {"/../secret.txt", "/%2e%2e/secret.txt", "/assets/../../secret.txt",
          "/assets/..%2f..%2fsecret.txt", "/meshes/../secret.txt", "/..%5csecret.txt",
          "//../secret.txt", "/assets/%2e%2e/%2e%2e/secret.txt"}) {
        const auto answer =
            answerTo("GET " + path + " HTTP/1.1\r\nHost: 127.0.0.1\r\nConnection: close\r\n\r\n");
        EXPECT_THAT(answer, Not(HasSubstr("for nobody"))) << path;
        EXPECT_THAT(answer, Not(HasSubstr("200 OK"))) << path;
    }
}

TEST_F(Page, FollowsNoLinkOutOfItsFolders) {
    std::ofstream(folder_ / "index.html") << "for nobody";
    fs::create_symlink(folder_ / "secret.txt", folder_ / "meshes" / "ur5" / "linked.stl");
    fs::create_symlink(folder_ / "secret.txt", folder_ / "meshes" / "linked.urdf");
    fs::create_directory_symlink(folder_, folder_ / "meshes" / "out");
    fs::create_symlink(folder_ / "secret.txt", folder_ / "web" / "linked.txt");
    fs::create_directory_symlink(folder_, folder_ / "web" / "out");
    fs::create_symlink(folder_ / "meshes" / "ur5" / "ur5.urdf", folder_ / "meshes" / "same.urdf");
    for (const std::string path :
         {"/meshes/ur5/linked.stl", "/meshes/linked.urdf", "/meshes/out/secret.txt", "/linked.txt",
          "/out/secret.txt", "/meshes/out/web/index.html", "/out/"}) {
        EXPECT_EQ(client_->Get(path)->status, 404) << path;
    }
    EXPECT_EQ(client_->Get("/meshes/same.urdf")->body, "<robot/>") << "a link within the folder";
    auto files = json::parse(client_->Get("/api/meshes")->body).at("files");
    std::sort(files.begin(), files.end());
    EXPECT_EQ(files, json::array({"same.urdf", "ur5/ur5.urdf"}));
}

TEST_F(Page, ServesPartsOfMeshes) {
    std::ofstream(folder_ / "meshes" / "long.stl") << std::string(100'000, 'a') << "end";
    std::ofstream(folder_ / "meshes" / "empty.obj");
    const auto whole = client_->Get("/meshes/long.stl");
    EXPECT_EQ(whole->body.size(), 100'003U);
    EXPECT_THAT(whole->body, ::testing::EndsWith("aend"));
    EXPECT_EQ(whole->get_header_value("Content-Type"), "model/stl");
    EXPECT_EQ(client_->Get("/meshes/empty.obj")->body, "");
    EXPECT_EQ(client_->Get("/meshes/ur5")->status, 404);
    EXPECT_EQ(client_->Get("/meshes/")->status, 404);
}

TEST_F(Page, NamesTheCellAndWhoLooks) {
    const auto cell = json::parse(client_->Get("/api/cell")->body);
    EXPECT_EQ(cell.at("name"), "test");
    EXPECT_EQ(cell.at("lab"), true);
    EXPECT_EQ(cell.at("servers"), json::array());
    EXPECT_EQ(cell.at("meshes"), true);
    const auto me = json::parse(client_->Get("/api/me")->body);
    EXPECT_EQ(me.at("login_required"), false);
    EXPECT_EQ(me.at("role"), "operator");
}

TEST_F(Page, ListsTheRobotsOfTheFolderOfMeshes) {
    EXPECT_EQ(json::parse(client_->Get("/api/meshes")->body).at("files"),
              json::array({"ur5/ur5.urdf"}));
    EXPECT_EQ(client_->Get("/meshes/ur5/ur5.urdf")->body, "<robot/>");
}

TEST_F(Page, HasNoRecordsWhereNothingIsRecorded) {
    EXPECT_EQ(json::parse(client_->Get("/api/records")->body),
              json::parse(R"({"records": [], "more": false})"));
    EXPECT_EQ(client_->Get("/api/records/7")->status, 404);
    EXPECT_EQ(client_->Get("/api/records?count=0")->status, 400);
    EXPECT_EQ(client_->Get("/api/records?from=yesterday")->status, 400);
}

TEST_F(Page, SaysInJsonThatAPathIsUnknown) {
    const auto answer = client_->Get("/api/nothing");
    EXPECT_EQ(answer->status, 404);
    EXPECT_TRUE(json::parse(answer->body).contains("error"));
}

TEST_F(Page, IsNotReachedByAForeignName) {
    const auto answer = answerTo(
        "GET /api/cell HTTP/1.1\r\nHost: evil.example\r\n"
        "Connection: close\r\n\r\n");
    EXPECT_THAT(answer, StartsWith("HTTP/1.1 403"));
    EXPECT_THAT(answerTo("GET /api/cell HTTP/1.1\r\nConnection: close\r\n\r\n"),
                StartsWith("HTTP/1.1 403"));
    EXPECT_THAT(answerTo("GET /api/cell HTTP/1.1\r\nHost: localhost:8080\r\n"
                         "Connection: close\r\n\r\n"),
                StartsWith("HTTP/1.1 200"));
}

TEST_F(Page, OfALabIsServedToThisMachineAlone) {
    Options options;
    options.lab = true;
    for (const std::string address : {"0.0.0.0", "::", "192.0.2.1", "127.0.0.1.example", ""}) {
        options.address = address;
        const auto refused = Dashboard::start(options, clock_);
        ASSERT_FALSE(refused) << address;
        EXPECT_EQ(refused.error().code, Errc::invalid_argument);
        EXPECT_THAT(refused.error().message, HasSubstr("is not a loopback address"));
    }
    options.address = "127.0.0.1";
    options.host_name = "cell.example";
    const auto named = Dashboard::start(options, clock_);
    ASSERT_FALSE(named);
    EXPECT_EQ(named.error().code, Errc::invalid_argument);
}

TEST_F(Page, OfALabAnswersNoProxy) {
    for (const auto& [name, value] : {std::pair{"X-Forwarded-For", "192.0.2.7"},
                                      {"Forwarded", "for=192.0.2.7"},
                                      {"X-Real-IP", "192.0.2.7"},
                                      {"Via", "1.1 proxy"},
                                      {"Host", "192.0.2.1:8080"}}) {
        EXPECT_EQ(client_->Get("/api/cell", {{name, value}})->status, 403) << name;
        EXPECT_EQ(post("/api/halt", "{}", {{"X-Metier", "1"}, {name, value}})->status, 403) << name;
    }
    EXPECT_EQ(client_->Get("/api/cell", {{"Host", "localhost:8080"}})->status, 200);
    EXPECT_EQ(client_->Get("/api/cell", {{"Host", "[::1]:8080"}})->status, 200);
}

TEST_F(Page, OfALabTakesNoLogIn) {
    EXPECT_EQ(post("/api/login", R"({"user":"anna","password":"x"})")->status, 401);
}

TEST_F(Page, TakesNothingFromAnotherPage) {
    const auto answer = post("/api/halt", "{}", {{"X-Metier", "1"}, {"Origin", "http://evil"}});
    EXPECT_EQ(answer->status, 403);
    const auto port = std::to_string(dashboard_->port());
    EXPECT_EQ(post("/api/halt", "{}", {{"X-Metier", "1"}, {"Origin", "http://127.0.0.1:" + port}})
                  ->status,
              200);
}

TEST_F(Page, TakesNothingFromTheBodyOfARequestOfAnotherPage) {
    const std::string hidden =
        "POST /api/halt HTTP/1.1\r\nHost: 127.0.0.1\r\nX-Metier: 1\r\n"
        "Content-Type: application/json\r\nContent-Length: 2\r\n\r\n{}";
    for (const std::string path : {"/api/halt", "/api/me", "/nothing"}) {
        const auto answer =
            answerTo("POST " + path +
                     " HTTP/1.1\r\nHost: 127.0.0.1\r\nOrigin: http://evil\r\n"
                     "Content-Type: text/plain\r\nContent-Length: " +
                     std::to_string(hidden.size()) + "\r\n\r\n" + hidden +
                     "GET /api/me HTTP/1.1\r\nHost: 127.0.0.1\r\nConnection: close\r\n\r\n");
        EXPECT_THAT(answer, StartsWith("HTTP/1.1 403")) << path;
        EXPECT_THAT(answer, Not(HasSubstr("halted"))) << path;
        EXPECT_THAT(answer, HasSubstr("login_required")) << "the next request is answered";
    }
}

TEST_F(Page, TakesCommandsWithTheHeaderAlone) {
    for (const std::string path : {"/api/control", "/api/halt", "/api/skills/start",
                                   "/api/skills/halt", "/api/login", "/api/logout"}) {
        EXPECT_EQ(post(path, "{}", {})->status, 403) << path;
    }
    EXPECT_EQ(
        client_->Post("/api/halt", kIntent, "a=b", "application/x-www-form-urlencoded")->status,
        400);
}

TEST_F(Page, RefusesWhatIsNoJsonObject) {
    for (const std::string body : {"", "{", "[]", "7", "{\"tab\": }", "null", "\"{}\""}) {
        const auto answer = post("/api/halt", body);
        EXPECT_EQ(answer->status, 400) << body;
        EXPECT_EQ(json::parse(answer->body).at("error").at("code"), "invalid_argument");
    }
}

TEST_F(Page, RefusesWhatIsMissingOrOfAnotherKind) {
    EXPECT_EQ(post("/api/skills/start", "{}")->status, 400);
    EXPECT_EQ(post("/api/skills/start", R"({"key": 7, "tab": "a"})")->status, 400);
    EXPECT_EQ(post("/api/skills/start", R"({"key": "a/b/c", "tab": "a"})")->status, 404);
    EXPECT_EQ(post("/api/control", R"({"tab": "a", "action": "steal"})")->status, 400);
    EXPECT_EQ(post("/api/halt", R"({"server": "nobody"})")->status, 404);
}

TEST_F(Page, SurvivesDeepJson) {
    EXPECT_EQ(post("/api/halt", std::string(9'000, '['))->status, 400);
    EXPECT_EQ(
        post("/api/halt", R"({"a":)" + std::string(4'000, '[') + std::string(4'000, ']') + "}")
            ->status,
        400);
    EXPECT_EQ(post("/api/halt", R"({"a":[[[[[{"b":[]}]]]]]})")->status, 200);
}

TEST_F(Page, UnpacksNothing) {
    const std::string packed(kPacked.begin(), kPacked.end());
    auto headers = kIntent;
    headers.emplace("Content-Encoding", "gzip");
    const auto answer = post("/api/login", packed, headers);
    EXPECT_EQ(answer->status, 400);
    EXPECT_THAT(answer->body, HasSubstr("JSON object"));
}

TEST_F(Page, AnswersManyRangesOfAFileWithTheFile) {
    std::string ranges = "bytes=0-";
    for (int i = 0; i < 500; ++i) {
        ranges += ",0-";
    }
    const auto answer = client_->Get("/", {{"Range", ranges}});
    EXPECT_EQ(answer->status, 200);
    EXPECT_EQ(answer->body, "<p>the page</p>");
}

TEST_F(Page, RefusesALongBody) {
    EXPECT_EQ(post("/api/halt", "{\"a\": \"" + std::string(20'000, 'x') + "\"}")->status, 413);
}

TEST_F(Page, RefusesABodyThatIsLongerThanItSays) {
    RawBrowser browser(dashboard_->port());
    browser.send(
        "POST /api/halt HTTP/1.1\r\nHost: 127.0.0.1\r\nX-Metier: 1\r\n"
        "Content-Type: application/json\r\nTransfer-Encoding: chunked\r\n\r\n");
    const auto chunk = "400\r\n" + std::string(1'024, 'x') + "\r\n";
    for (int i = 0; i < 100 && browser.send(chunk); ++i) {
    }
    EXPECT_THAT(browser.receive(), Not(HasSubstr("200 OK")));
}

TEST_F(Page, EndsAHeadWithoutEnd) {
    RawBrowser browser(dashboard_->port());
    browser.send("GET / HTTP/1.1\r\nHost: 127.0.0.1\r\n");
    const auto line = "X-More: " + std::string(1'000, 'x') + "\r\n";
    for (int i = 0; i < 100 && browser.send(line); ++i) {
    }
    EXPECT_THAT(browser.receive(), Not(HasSubstr("200 OK")));
}

TEST_F(Page, EndsARequestThatDoesNotCome) {
    RawBrowser browser(dashboard_->port());
    browser.send("GET / HTTP/1.1\r\nHost:");
    EXPECT_THAT(browser.receive(), Not(HasSubstr("200 OK")));  // returns: the connection was ended
    EXPECT_EQ(client_->Get("/api/me")->status, 200);
}

TEST_F(Page, AnswersOnAfterWhatIsNoHttp) {
    answerTo(std::string("\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03\r\n\r\n", 15));
    answerTo("BREW /pot HTCPCP/1.0\r\n\r\n");
    EXPECT_EQ(client_->Get("/api/me")->status, 200);
}

TEST_F(Page, IsNotServedAtAPortThatIsTaken) {
    Options options;
    options.lab = true;
    options.port = dashboard_->port();
    const auto second = Dashboard::start(std::move(options), clock_);
    ASSERT_FALSE(second);
    EXPECT_EQ(second.error().code, Errc::already_exists);
}

TEST_F(Page, IsNotReachedWithoutLogInWhereServersWantIt) {
    Options options;
    options.connector = {[](const std::string&) -> Result<opcua::ClientOptions> {
                             return fail(Errc::connection_lost, "nobody there");
                         },
                         [](const opcua::Failure&) { return std::string(); }};
    options.web = folder_ / "web";
    options.meshes = folder_ / "meshes";
    const auto closed = Dashboard::start(std::move(options), clock_).value();
    httplib::Client stranger("127.0.0.1", closed->port());
    for (const std::string path :
         {"/meshesur5/ur5.urdf", "//meshes/ur5/ur5.urdf", "/meshes%2fur5/ur5.urdf",
          "/./meshes/ur5/ur5.urdf", "/meshes//ur5/ur5.urdf"}) {
        EXPECT_NE(stranger.Get(path)->status, 200) << path;
    }
    for (const std::string path : {"/api/cell", "/api/stream", "/api/records", "/api/records/1",
                                   "/api/meshes", "/meshes/ur5/ur5.urdf"}) {
        const auto answer = stranger.Get(path);
        ASSERT_TRUE(answer);
        EXPECT_EQ(answer->status, 401) << path;
        EXPECT_EQ(json::parse(answer->body).at("error").at("code"), "login_required");
    }
    EXPECT_EQ(stranger.Post("/api/halt", kIntent, "{}", "application/json")->status, 401);
    EXPECT_EQ(json::parse(stranger.Get("/api/me")->body).at("login_required"), true);
    EXPECT_EQ(
        stranger
            .Post("/api/login", kIntent, R"({"user":"anna","password":"x"})", "application/json")
            ->status,
        502);
}

}  // namespace
}  // namespace metier::dashboard
