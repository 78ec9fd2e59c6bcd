#include "api.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <system_error>
#include <utility>

#include "access.hpp"
#include "files.hpp"
#include "metier/base/random.hpp"

namespace metier::dashboard {

using httplib::Request;
using httplib::Response;
using nlohmann::json;

namespace {

constexpr std::size_t kNameDigits = 32;  // 128 bits: the name of a tab cannot be guessed

Reply notLoggedIn() {
    return errorReply(401, "login_required", "log in first");
}

std::string tokenOf(const Request& request) {
    return cookie(request, sessionCookieName(request));
}

/// Whether a path is that of a file which is only linked to in the folder.
bool leadsElsewhere(const std::filesystem::path& folder, const std::string& path) {
    std::error_code error;
    const auto name = path.ends_with('/') ? path + "index.html" : path;
    const auto file = folder / std::filesystem::path(name).relative_path();
    return std::filesystem::is_regular_file(file, error) && !fileBelow(folder, name);
}

void setToken(const Request& request, const std::string& token, Response& response) {
    response.set_header("Set-Cookie", fmt::format("{}={}; Path=/; HttpOnly; SameSite=Strict{}",
                                                  sessionCookieName(request), token,
                                                  token.empty() ? "; Max-Age=0" : ""));
}

}  // namespace

Api::Api(const Parts& parts)
    : parts_(parts),
      commands_(parts.watches, parts.tabs),
      streams_(parts.board, parts.options.limits) {}

std::shared_ptr<Person> Api::personOf(const Request& request) const {
    return parts_.people.find(tokenOf(request));
}

void Api::get(http::HttpServer& server, const std::string& path, Get handler) {
    server.Get(path,
               [this, handler = std::move(handler)](const Request& request, Response& response) {
                   const auto person = personOf(request);
                   write(person ? handler(request, person) : notLoggedIn(), response);
               });
}

void Api::post(http::HttpServer& server, const std::string& path, Post handler) {
    const auto answer = [this, handler = std::move(handler)](const Request& request) -> Reply {
        METIER_TRY(checkIntent(request));
        const auto person = personOf(request);
        if (!person) {
            return notLoggedIn();
        }
        METIER_ASSIGN(const auto body, parseBody(request.body));
        return handler(body, person);
    };
    server.Post(path, [answer](const Request& request, Response& response) {
        write(answer(request), response);
    });
}

Reply Api::me(const std::shared_ptr<Person>& person) const {
    const bool lab = parts_.people.isLab();
    return {200,
            {{"user", person ? person->user() : ""},
             {"role", person ? person->role() : ""},
             {"lab", lab},
             {"login_required", !lab}}};
}

void Api::bindLogin(http::HttpServer& server) {
    server.Get("/api/me", [this](const Request& request, Response& response) {
        write(me(personOf(request)), response);
    });
    server.Post("/api/login", [this](const Request& request, Response& response) {
        write(login(request, response), response);
    });
    server.Post("/api/logout", [this](const Request& request, Response& response) {
        if (const auto meant = checkIntent(request); !meant) {
            return write(errorReply(meant.error()), response);
        }
        parts_.people.logout(tokenOf(request));
        setToken(request, "", response);
        write(me(nullptr), response);
    });
}

Reply Api::login(const Request& request, Response& response) {
    METIER_TRY(checkIntent(request));
    METIER_ASSIGN(const auto body, parseBody(request.body));
    METIER_ASSIGN(const auto user, textOrNone(body, "user"));
    METIER_ASSIGN(const auto password, textOrNone(body, "password"));
    const auto token = parts_.people.login(user, password);
    if (!token) {
        const auto& [code, why] = token.error();
        return code == Errc::resource_unavailable ? errorReply(429, toString(code), why)
               : code == Errc::access_denied      ? errorReply(401, toString(code), why)
                                                  : errorReply(token.error());
    }
    setToken(request, *token, response);
    return me(parts_.people.find(*token));
}

void Api::beginStream(const Request& request, Response& response) {
    const auto person = personOf(request);
    if (!person) {
        return write(notLoggedIn(), response);
    }
    const auto tab = randomHex(kNameDigits);
    parts_.tabs.open(tab, person);
    const auto may_listen = [this, token = tokenOf(request), person] {
        return parts_.people.find(token) == person;
    };
    if (const auto begun =
            streams_.begin(tab, response, {may_listen, [this, tab] { parts_.tabs.close(tab); }});
        !begun) {
        parts_.tabs.close(tab);
        write(errorReply(503, toString(begun.error().code), begun.error().message), response);
    }
}

void Api::bindCommands(http::HttpServer& server) {
    using Command = Reply (Commands::*)(const json&, const std::shared_ptr<Person>&);
    for (const auto& [path, command] :
         {std::pair<const char*, Command>{"/api/control", &Commands::control},
          {"/api/skills/check", &Commands::check},
          {"/api/skills/start", &Commands::start},
          {"/api/skills/halt", &Commands::haltSkill},
          {"/api/halt", &Commands::halt}}) {
        post(server, path, [this, command = command](const auto& body, const auto& person) {
            return (commands_.*command)(body, person);
        });
    }
    for (const auto& [path, method] : {std::pair{"/api/skills/suspend", skill::Method::suspend},
                                       {"/api/skills/resume", skill::Method::resume},
                                       {"/api/skills/reset", skill::Method::reset}}) {
        post(server, path, [this, method = method](const auto& body, const auto& person) {
            return commands_.call(method, body, person);
        });
    }
}

/// The URDF files of the folder of meshes, as paths in it.
void Api::bindMeshes(http::HttpServer& server) {
    if (parts_.options.meshes.empty()) {
        return;
    }
    server.Get("/meshes/(.+)", [this](const Request& request, Response& response) {
        if (!personOf(request)) {
            return write(notLoggedIn(), response);
        }
        serveFile(fileBelow(parts_.options.meshes, request.matches[1]), response);
    });
    get(server, "/api/meshes", [this](const Request& /*request*/, const auto& /*person*/) {
        namespace fs = std::filesystem;
        constexpr std::size_t kMost = 1'000;
        auto files = json::array();
        std::error_code error;
        for (auto entry = fs::recursive_directory_iterator(parts_.options.meshes, error);
             !error && entry != fs::recursive_directory_iterator() && files.size() < kMost;
             entry.increment(error)) {
            const auto name = entry->path().lexically_relative(parts_.options.meshes).string();
            if (entry->path().extension() == ".urdf" && fileBelow(parts_.options.meshes, name)) {
                files.push_back(name);
            }
        }
        return Reply{200, {{"files", std::move(files)}}};
    });
}

void Api::bindFiles(http::HttpServer& server) {
    for (const auto& [extension, type] :
         {std::pair{"js", "text/javascript"}, {"webmanifest", "application/manifest+json"}}) {
        server.set_file_extension_and_mimetype_mapping(extension, type);
    }
    if (!server.set_mount_point("/", parts_.options.web.string(),
                                {{"Cache-Control", "no-cache"}})) {
        server.Get("/", [web = parts_.options.web.string()](const Request& /*any*/,
                                                            Response& response) {
            response.status = 503;
            response.set_content(
                fmt::format("The files of the page are not there: {} is no folder. The API is at "
                            "/api.\n",
                            web),
                "text/plain");
        });
    }
}

void Api::bind(http::HttpServer& server) {
    server.set_default_headers(protectiveHeaders());
    server.set_pre_routing_handler([this](const Request& request, Response& response) {
        auto own = checkOrigin(request, parts_.options.host_name);
        own = own && parts_.people.isLab() ? checkLocal(request) : own;
        if (!own) {
            write(errorReply(own.error()), response);
        } else if (leadsElsewhere(parts_.options.web, request.path)) {
            write(errorReply(404, "http", "no such file"), response);
        } else {
            return httplib::Server::HandlerResponse::Unhandled;
        }
        return httplib::Server::HandlerResponse::Handled;
    });
    server.set_exception_handler(
        [](const Request& /*request*/, Response& response, std::exception_ptr /*thrown*/) {
            write(errorReply(500, "internal", "a defect of this program; see its log"), response);
        });
    server.set_error_handler([](const Request& request, Response& response) {
        if (response.body.empty()) {
            write(errorReply(response.status, "http",
                             fmt::format("{} {}", response.status, request.path)),
                  response);
        }
    });
    bindMeshes(server);
    bindFiles(server);
    bindLogin(server);
    bindCommands(server);
    get(server, "/api/cell",
        [this](const Request& /*request*/, const std::shared_ptr<Person>& /*person*/) {
            auto cell = parts_.board.cell();
            cell["lab"] = parts_.people.isLab();
            cell["meshes"] = !parts_.options.meshes.empty();
            return Reply{200, std::move(cell)};
        });
    get(server, "/api/records", [this](const Request& request, const auto& /*person*/) {
        return parts_.records.list(request);
    });
    get(server, R"(/api/records/(\d{1,18}))",
        [this](const Request& request, const auto& /*person*/) {
            return parts_.records.one(std::stoll(request.matches[1]));
        });
    server.Get("/api/stream", [this](const Request& request, Response& response) {
        beginStream(request, response);
    });
}

}  // namespace metier::dashboard
