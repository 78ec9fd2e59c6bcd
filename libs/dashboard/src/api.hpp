#pragma once

#include <functional>
#include <memory>
#include <string>

#include "board.hpp"
#include "commands.hpp"
#include "metier/dashboard/dashboard.hpp"
#include "metier/http/http_server.hpp"
#include "people.hpp"
#include "records_view.hpp"
#include "reply.hpp"
#include "stream.hpp"
#include "watches.hpp"

namespace metier::dashboard {

/// The paths below /api, and the files of the page.
///
/// Threading: handlers run on the connections' threads, many at once.
class Api {
public:
    struct Parts {
        const Options& options;
        Board& board;
        Watches& watches;
        People& people;
        Tabs& tabs;
        RecordsView& records;
    };

    /// `parts` must outlive this, and this must outlive the HTTP server.
    explicit Api(const Parts& parts);

    /// Registers every path at the server.
    void bind(http::HttpServer& server);

private:
    using Get = std::function<Reply(const httplib::Request&, const std::shared_ptr<Person>&)>;
    using Post = std::function<Reply(const nlohmann::json&, const std::shared_ptr<Person>&)>;

    /// Person who sent the request; nullptr: not logged in.
    std::shared_ptr<Person> personOf(const httplib::Request& request) const;
    void get(http::HttpServer& server, const std::string& path, Get handler);
    void post(http::HttpServer& server, const std::string& path, Post handler);
    void bindFiles(http::HttpServer& server);
    void bindLogin(http::HttpServer& server);
    void bindCommands(http::HttpServer& server);
    void bindMeshes(http::HttpServer& server);
    void beginStream(const httplib::Request& request, httplib::Response& response);
    Reply login(const httplib::Request& request, httplib::Response& response);
    Reply me(const std::shared_ptr<Person>& person) const;

    const Parts parts_;
    Commands commands_;
    Streams streams_;
};

}  // namespace metier::dashboard
