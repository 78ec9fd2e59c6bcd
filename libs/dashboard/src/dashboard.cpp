#include "metier/dashboard/dashboard.hpp"

#include <fmt/format.h>

#include <utility>

#include "access.hpp"
#include "api.hpp"
#include "board.hpp"
#include "metier/http/http_server.hpp"
#include "people.hpp"
#include "records_view.hpp"
#include "tabs.hpp"
#include "ticker.hpp"
#include "watches.hpp"
#include "world_watch.hpp"

namespace metier::dashboard {
namespace {

nlohmann::json fixedPart(const Cell& cell) {
    nlohmann::json fixed{{"name", cell.name}, {"world", nullptr}};
    if (cell.world) {
        fixed["world"] = cell.world->fixed;
    }
    return fixed;
}

}  // namespace

struct Dashboard::Impl {
    Impl(Options chosen, const Clock& clock)
        : options(std::move(chosen)),
          board(fixedPart(options.cell), clock),
          watches(board, options.connector, options.models),
          people(options.connector, watches, options.lab ? Access::lab : Access::log_in, clock),
          tabs(board, watches),
          records(options.records, board),
          api({options, board, watches, people, tabs, records}),
          http(options.limits) {}

    const Options options;
    Board board;
    Watches watches;
    People people;
    Tabs tabs;
    RecordsView records;
    Api api;
    http::HttpServer http;
    std::uint16_t port = 0;
    std::unique_ptr<WorldWatch> world;
    Ticker ticker{board};
};

Result<std::unique_ptr<Dashboard>> Dashboard::start(Options options, const Clock& clock) {
    if (options.lab && !isLoopback(options.address)) {
        return fail(Errc::invalid_argument,
                    fmt::format("an insecure lab is for this machine alone: {} is not a loopback "
                                "address",
                                options.address));
    }
    if (options.lab && !options.host_name.empty()) {
        return fail(Errc::invalid_argument,
                    "an insecure lab is for this machine alone: other machines would reach the "
                    "page by a host name");
    }
    auto impl = std::make_unique<Impl>(std::move(options), clock);
    auto& own = *impl;
    if (own.options.cell.world) {
        own.world = std::make_unique<WorldWatch>(*own.options.cell.world, own.board);
    }
    own.board.onWatched([&own](bool watched) {
        own.watches.showLive(watched);
        own.ticker.run(watched);
        own.records.show(watched);
        if (own.world) {
            own.world->show(watched);
        }
    });
    own.api.bind(own.http);
    METIER_ASSIGN(own.port, own.http.serve(own.options.address, own.options.port));
    std::unique_ptr<Dashboard> dashboard(new Dashboard(std::move(impl)));  // NOLINT: private
    for (const auto& server : own.options.cell.servers) {
        dashboard->addServer(server);
    }
    return dashboard;
}

Dashboard::Dashboard(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}

Dashboard::~Dashboard() {
    impl_->board.closeAll();
    impl_->http.end();
    impl_->world.reset();
    impl_->watches.end();
}

std::uint16_t Dashboard::port() const noexcept {
    return impl_->port;
}

void Dashboard::addServer(const CellServer& server) {
    impl_->watches.add(server);
}

}  // namespace metier::dashboard
